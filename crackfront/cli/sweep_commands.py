"""A sweep while it runs: what it will cost, its simulations, and how far they are."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.answers import announce_compilation, announce_cost, echo_answer, table, warn
from crackfront.cli.option_types import (
    FILE,
    Number,
    as_json,
    examples,
    whole,
)
from crackfront.core.bounds import COUNT, Range
from crackfront.core.resources import check_memory
from crackfront.core.words import counted, in_bytes, in_time, wrapped

# The rest is imported where it is used, so that --help does not wait for it.
if TYPE_CHECKING:
    from crackfront.simulate.provenance import Provenance
    from crackfront.simulate.simulation import Simulation
    from crackfront.sweep.advice import Expectation
    from crackfront.sweep.inventory import Inventory, MissingSimulations
    from crackfront.sweep.parallel import Ranks
    from crackfront.sweep.store import Store
    from crackfront.sweep.sweep import Shard, Sweep
    from crackfront.sweep.sweep_cost import ErrorCost, SweepCost
    from crackfront.sweep.tasks import SimulationOutcome

_ERROR = Number(Range(1e-9, 1.0))
"""Numerical error of k; the finest numerics leave far more than the least."""

configuration_argument = click.argument("configuration", type=FILE)
output_option = click.option(
    "--output", type=FILE, help="Folder of the results.  [default: results/<configuration's name>]"
)


def _errors(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> tuple[float, ...]:
    """Numbers that an option like 0.03,0.01 means."""
    parts = [] if value is None else value.split(",")
    return tuple(_ERROR.convert(part, parameter, context) for part in parts)


@click.command(
    epilog=examples(
        "crackfront plan config/paper.yaml",
        "crackfront plan config/default.yaml --errors 0.1,0.03,0.01",
        "crackfront plan config/default.yaml --json",
    )
)
@configuration_argument
@output_option
@click.option("--block", type=whole(COUNT), help="Realisations of a shard (a job).  [default: all]")
@click.option(
    "--errors",
    callback=_errors,
    help="Also print the cost of the whole sweep for these numerical errors of k, as 0.03,0.01.",
)
@as_json
def plan(
    configuration: Path,
    output: Path | None,
    block: int | None,
    errors: tuple[float, ...],
    as_json: bool,
) -> None:
    """Print what a sweep would run for each spectrum, what is stored and what the rest costs.

    Nothing is computed. Files that are found damaged are renamed to *.damaged, so that the workflow
    makes them again.
    """
    from crackfront.sweep.advice import expectations, small_size_warnings, steady_part_warnings
    from crackfront.sweep.changed_keys import change_sentence
    from crackfront.sweep.inventory import Inventory
    from crackfront.sweep.run_sweep import opened
    from crackfront.sweep.sweep_cost import error_costs

    sweep, store, _ = opened(configuration, output, warn)
    store.set_aside_damaged()
    shards, expected = sweep.shards(block), expectations(sweep)
    progress = {item.name: store.progress(sweep, item) for item in sweep.spectra}
    total = sum(progress.values(), Inventory())
    warnings = [*steady_part_warnings(sweep), *small_size_warnings(sweep)]
    prices = list(error_costs(sweep, errors))
    changed = change_sentence(store.configuration, configuration)
    content = {
        "results": store.folder,
        "spectra": [item.name for item in sweep.spectra],
        "elastic_energies": sweep.elastic_energies,
        "realisations": sweep.n_realisation,
        "fitted_elastic_energies": sweep.fit.chosen(sweep.elastic_energies),
        "simulations": sweep.n_simulation,
        "missing": total.n_missing,
        "arithmetic": sorted(total.arithmetic),
        "shards": [shard.name for shard in shards],
        "unit_of_lengths": "reduced" if sweep.scales is None else "m",
        "expected": expected,
        "warnings": warnings,
        "changed": changed,
        **asdict(_cost(total.missing)),
    }
    if prices:
        content["errors"] = prices
    lines = list(_plan_lines(sweep, store, shards, progress, expected))
    if changed:
        lines.append(changed)
    if prices:
        lines += _price_lines(prices)
    echo_answer(content, [*lines, *map(wrapped, warnings)], as_json=as_json)


def _size_sentence(sweep: Sweep, inventory: Inventory) -> str:
    """How many simulations a sweep has, how many are to run, and how long these take here."""
    factors = (
        (len(sweep.spectra), "spectrum", "spectra"),
        (len(sweep.elastic_energies), "amplitude", "amplitudes"),
        (sweep.n_realisation, "realisation", "realisations"),
    )
    product = " x ".join(f"{n} {singular if n == 1 else plural}" for n, singular, plural in factors)
    n_core = len(os.sched_getaffinity(0))
    seconds = _cost(inventory.missing).core_seconds / n_core
    time_here = f"about {in_time(seconds)} of simulations on {counted(n_core, 'core')}"
    rest = f"{inventory.n_missing} to run, {time_here}"
    if not inventory.n_missing:
        rest = "all are stored"
    return f"{sweep.n_simulation} simulations = {product}; {rest}"


def _plan_lines(
    sweep: Sweep,
    store: Store,
    shards: Sequence[Shard],
    progress: Mapping[str, Inventory],
    expected: Mapping[str, Sequence[Expectation]],
) -> Iterator[str]:
    """Tables of the spectra of a sweep and of what is left to run, and its sizes."""
    from crackfront.sweep.inventory import Inventory, mixture_sentence

    total = sum(progress.values(), Inventory())
    yield f"{wrapped(_size_sentence(sweep, total))}\n"
    yield from _spectra_table(sweep, progress, expected)
    yield "s is w_rms/w_int, g the size, and k what the law expects at the largest load"
    yield from map(wrapped, _uncovered_sentences(sweep))
    yield from map(wrapped, total.sentences())
    if mixture := mixture_sentence(total.arithmetic):
        yield wrapped(mixture)
    yield ""
    yield from _work_table(sweep, shards, progress)
    yield from _jump_lines(_cost(total.missing))
    energies = sweep.elastic_energies
    yield f"\n{counted(len(energies), 'amplitude')} e_el/w_int: {_listed(energies)}"
    yield _fit_sentence(sweep)
    yield f"results in {store.folder}/"


def _uncovered_sentences(sweep: Sweep) -> Iterator[str]:
    """Sentence on the spectra that the law of k does not cover, if there are any."""
    from crackfront.analysis.fit_text import MEASURED_ON

    uncovered = [
        item.name for item in sweep.spectra if not sweep.one_per_amplitude(item)[0].is_covered
    ]
    if uncovered:
        yield f"the law of k does not cover {', '.join(uncovered)}: {MEASURED_ON}"


def _work_table(
    sweep: Sweep, shards: Sequence[Shard], progress: Mapping[str, Inventory]
) -> Iterator[str]:
    """Table of what is left to run of each spectrum and of all, and what it costs."""
    from crackfront.sweep.inventory import Inventory

    rows = []
    for item in sweep.spectra:
        n_shard = sum(shard.item is item for shard in shards)
        rows.append(_work_row(item.name, n_shard, progress[item.name]))
    rows.append(_work_row("all", len(shards), sum(progress.values(), Inventory())))
    heads = "to run", "shards", "simulations", "core hours", "longest s", "MB a rank"
    return table(heads, rows)


def _work_row(name: str, n_shard: int, inventory: Inventory) -> tuple[str, ...]:
    """Row of what the missing simulations of a spectrum, or of all, are expected to cost."""
    cost = _cost(inventory.missing)
    return (
        name,
        str(n_shard),
        str(inventory.n_missing),
        f"{cost.core_seconds / 3600:.3g}",
        f"{cost.longest_seconds:.3g}",
        f"{cost.bytes_a_rank / 1e6:.0f}",
    )


def _spectra_table(
    sweep: Sweep,
    progress: Mapping[str, Inventory],
    expected: Mapping[str, Sequence[Expectation]],
) -> Iterable[str]:
    """Table of the spectra: their shapes, what the law expects, their sizes and what is stored."""
    lateral, unit = (1.0, "") if sweep.scales is None else (sweep.scales.lateral, " (m)")
    rows = []
    for item in sweep.spectra:
        shape, cells, inventory = item.spectrum, expected[item.name], progress[item.name]
        sizes = [simulation.resolution for simulation in sweep.one_per_amplitude(item)]
        row = (
            item.name,
            f"{lateral * shape.short_cutoff:.4g}",
            f"{lateral * shape.longest_feature:.4g}",
            f"{shape.hurst:.2f}" if hasattr(shape, "hurst") else "-",
            _span([cell.disorder for cell in cells], "{:.2g}"),
            _span([cell.size for cell in cells], "{:.2g}"),
            _span([cell.factor for cell in cells], "{:.2g}"),
            _span([size.n_angle for size in sizes]),
            _span([size.n_point for size in sizes]),
            f"{inventory.stored}/{inventory.stored + inventory.n_missing}",
        )
        rows.append(row)
    lengths = f"lambda_s{unit}", f"lambda_r{unit}"
    return table(("spectrum", *lengths, "H", "s", "g", "k", "angles", "points", "stored"), rows)


def _fit_sentence(sweep: Sweep) -> str:
    """Which amplitudes enter the fit of k, and the range that leaves out the others."""
    fitted, n_amplitude = sweep.fit.chosen(sweep.elastic_energies), len(sweep.elastic_energies)
    if len(fitted) == n_amplitude:
        return f"the fit of k takes {'it' if n_amplitude == 1 else 'all of them'}"
    return (
        f"the fit of k takes {len(fitted)} of {n_amplitude} amplitudes: {_listed(fitted)} "
        f"(fit: e_el from {sweep.fit.lowest_elastic_energy:g} "
        f"to {sweep.fit.highest_elastic_energy:g})"
    )


def _listed(values: Iterable[float]) -> str:
    """Numbers with commas."""
    return ", ".join(f"{value:g}" for value in values)


def _cost(missing: Sequence[MissingSimulations]) -> SweepCost:
    """What missing simulations are expected to cost."""
    from crackfront.sweep.sweep_cost import sweep_cost

    return sweep_cost((item.first, item.realisations.size) for item in missing)


def _jump_lines(cost: SweepCost) -> Iterator[str]:
    """What recorded jumps add to the cost; nothing where none are to be recorded."""
    if cost.jump_core_seconds:
        jumps, rest = cost.jump_core_seconds, cost.core_seconds - cost.jump_core_seconds
        yield f"record: [jumps] takes {in_time(jumps)} of processor time, all else {in_time(rest)}"


def _price_lines(prices: Sequence[ErrorCost]) -> Iterator[str]:
    """Table of the cost of the whole sweep against the numerical error of k."""
    rows = []
    for price in prices:
        remaining = price.remaining_error
        row = (
            f"{price.error:g}",
            in_time(price.cost.core_seconds),
            f"{price.cost.longest_seconds:.3g}",
            f"{price.cost.bytes_a_rank / 1e6:.0f}",
            f"no, {remaining:.2g} is left" if remaining else "yes",
        )
        rows.append(row)
    yield "\nthe whole sweep, by the numerical error of k (numerics: error)"
    yield from table(("error", "processor time", "longest s", "MB a rank", "reached"), rows)


def _span(values: Sequence[float | None], form: str = "{:.0f}") -> str:
    """Smallest and largest value of the amplitudes, or a single value if they are equal."""
    present = [value for value in values if value is not None]
    if not present:
        return "-"
    low, high = form.format(min(present)), form.format(max(present))
    return low if low == high else f"{low}-{high}"


def _block(context: click.Context, parameter: click.Parameter, value: str | None) -> range | None:
    """Numbers that an option such as 0-49 means, both ends included."""
    if value is None:
        return None
    first, dash, last = value.partition("-")
    if not (dash and first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
        raise click.BadParameter(
            f"{value!r} is not a range of numbers; write the first and the last, as in 0-49"
        )
    return range(int(first), int(last) + 1)


@click.command(
    epilog=examples(
        "mpiexec -n 5 crackfront simulate config/default.yaml",
        "crackfront simulate config/default.yaml --spectrum flat --realisations 0-1",
    )
)
@configuration_argument
@output_option
@click.option("--spectrum", help="Only this spectrum.  [default: all]")
@click.option(
    "--realisations", callback=_block, help="Only these realisations, as in 0-49.  [default: all]"
)
@click.option(
    "--checkpoint",
    type=Number(Range(0, 1e9)),
    default=60.0,
    help="Seconds between checkpoints of a running simulation.",
)
def simulate(
    configuration: Path,
    output: Path | None,
    spectrum: str | None,
    realisations: range | None,
    checkpoint: float,
) -> None:
    """Run the simulations of a sweep that are not stored yet.

    After Ctrl-C or SIGTERM the states of running simulations are stored, and the exit code is 75.
    Run the same command to continue.
    """
    from crackfront.sweep.parallel import deferring_stops, ranks

    # Ranks wait for the manager within `ranks`.
    with deferring_stops(), ranks() as workers:
        if workers is not None:
            _simulate(configuration, output, spectrum, realisations, checkpoint, workers)


def _simulate(
    configuration: Path,
    output: Path | None,
    spectrum: str | None,
    realisations: range | None,
    checkpoint: float,
    workers: Ranks,
) -> None:
    """Run the missing simulations of the chosen shards, and derive the rows of these shards."""
    from crackfront.sweep.changed_keys import change_sentence
    from crackfront.sweep.finished_shards import finish_shard
    from crackfront.sweep.inventory import Inventory
    from crackfront.sweep.run_sweep import opened, write_source

    sweep, store, origin = opened(configuration, output, warn)
    items = sweep.spectra if spectrum is None else (sweep.named(spectrum),)
    chosen = range(sweep.n_realisation) if realisations is None else realisations
    shards = [sweep.named_shard(item, chosen) for item in items]
    write_source(configuration, store.folder)
    with store.locked(shards):
        inventories = [store.unfinished(sweep, [shard]) for shard in shards]
        inventory = sum(inventories, Inventory())
        total = inventory.stored + inventory.n_missing
        click.echo(f"{configuration}: {inventory.stored} of {total} simulations are stored")
        if changed := change_sentence(store.configuration, configuration):
            click.echo(changed)
        for sentence in inventory.sentences():
            click.echo(sentence)
        if inventory.missing:
            _announce_work(replace(sweep, spectra=items), inventory, workers)
        lacking = [
            (shard, inventory.simulations())
            for shard, inventory in zip(shards, inventories, strict=True)
        ]
        run_missing(store, lacking, origin, workers, checkpoint)
        for shard in shards:
            click.echo(f"rows: {finish_shard(store, sweep, shard, origin)}")


def _announce_work(sweep: Sweep, inventory: Inventory, workers: Ranks) -> None:
    """Print what the missing simulations will cost; raise if the memory does not suffice."""
    from crackfront.sweep.advice import steady_part_warnings

    cost = _cost(inventory.missing)
    n_rank = min(workers.n_here, inventory.n_missing)
    check_memory(
        f"{counted(n_rank, 'rank')} of {in_bytes(cost.bytes_a_rank)}",
        cost.bytes_a_rank * n_rank,
        "use fewer ranks, coarser numerics or a smaller tile",
    )
    task = counted(inventory.n_missing, "simulation")
    announce_cost(task, cost.core_seconds, err=False)
    for sentence in steady_part_warnings(sweep):
        warn(sentence)


def run_missing(
    store: Store,
    lacking: Sequence[tuple[Shard, Sequence[Simulation]]],
    origin: Provenance,
    workers: Ranks,
    checkpoint_seconds: float = 60.0,
) -> None:
    """Run the missing simulations of shards, and show their progress."""
    from crackfront.sweep.tasks import NotStoredError, run_and_store

    started = time.monotonic()
    total = sum(len(simulations) for _, simulations in lacking)
    if total:
        announce_compilation()
    try:
        with closing(
            run_and_store(store, lacking, origin, checkpoint_seconds, workers)
        ) as outcomes:
            _show_outcomes(outcomes, total)
    except NotStoredError as error:
        raise click.ClickException(str(error)) from error
    if total:
        click.echo(f"{total} simulations in {time.monotonic() - started:.1f} s")


def _show_outcomes(outcomes: Iterable[tuple[Simulation, SimulationOutcome]], total: int) -> None:
    """Show simulations as they end: a bar on a terminal, elsewhere a line for each.

    On a terminal, simulations without values have a line too.
    """
    from tqdm import tqdm

    from crackfront.sweep.rows import COMPLETE

    is_terminal = sys.stderr.isatty()
    with tqdm(total=total, unit="simulation", disable=not is_terminal, file=sys.stderr) as bar:
        for count, (simulation, outcome) in enumerate(outcomes, start=1):
            is_complete = outcome.status in COMPLETE
            status = "complete" if is_complete else outcome.status
            details = outcome.sentence or f"{outcome.seconds:.2f} s"
            line = f"{simulation.label}: {status}, {details}"
            if not is_terminal:
                click.echo(f"[{count}/{total}] {line}")
            elif not is_complete:
                bar.write(line)
            bar.update()


@click.command(
    epilog=examples("crackfront status results/default", "crackfront status results/default --json")
)
@click.argument("folder", type=FILE)
@as_json
def status(folder: Path, as_json: bool) -> None:
    """Show the progress of the sweep in a folder, and which of its shards are running.

    Shards that run on other machines are shown where the file system passes their locks on; a batch
    system knows them all. Files that are found damaged are renamed to *.damaged.
    """
    from crackfront.sweep.inventory import Inventory
    from crackfront.sweep.parameters import load_sweep
    from crackfront.sweep.results_folder import check_layout
    from crackfront.sweep.store import Store

    store = Store(folder, warn)
    check_layout(folder)
    if not store.configuration.is_file():
        raise ValueError(
            f"{folder} is not the folder of a sweep that was begun; name results/<its name>"
        )
    sweep = load_sweep(store.configuration)
    inventories = {item.name: store.progress(sweep, item) for item in sweep.spectra}
    progress, running = _progress(inventories), store.running_shards()
    sentences = sum(inventories.values(), Inventory()).sentences()
    content = {"spectra": progress, "running": running, "reasons_to_run_again": sentences}
    echo_answer(content, [*_status_lines(progress, running), *sentences], as_json=as_json)


@dataclass(frozen=True, slots=True)
class Progress:
    """How far one spectrum is."""

    name: str
    """Name of the spectrum."""
    done: int
    """Simulations with values."""
    failed: int
    """Simulations that ended without values."""
    left: int
    """Simulations that are still to be run."""
    seconds: float
    """Processor time that is expected for those that are left. (Units: s)"""


def _progress(inventories: Mapping[str, Inventory]) -> list[Progress]:
    """Progress of each spectrum; the time that is left assumes the speed so far."""
    spent = sum(inventory.cpu_seconds for inventory in inventories.values())
    expected = sum(inventory.expected_seconds for inventory in inventories.values())
    pace = spent / expected if spent else 1.0
    return [
        Progress(
            name,
            inventory.done,
            inventory.failed,
            inventory.n_missing,
            pace * sum(item.seconds for item in inventory.missing),
        )
        for name, inventory in inventories.items()
    ]


def _status_lines(spectra: Sequence[Progress], running: Sequence[str]) -> Iterator[str]:
    """Table of the spectra of a sweep, and the shards that run."""
    rows = [
        (
            item.name,
            str(item.done),
            str(item.failed),
            str(item.left),
            f"{item.seconds / 3600:.3g}",
        )
        for item in spectra
    ]
    yield from table(("spectrum", "done", "failed", "left", "core hours left"), rows)
    if running:
        yield f"running: {', '.join(running)}"
    ended = sum(item.done + item.failed for item in spectra)
    total = ended + sum(item.left for item in spectra)
    sentence = f"{ended} of {total} simulations have ended"
    if ended < total and not running:
        sentence += "; no process that is seen here stores any"
    yield sentence


@click.command(
    epilog=examples(
        "crackfront surfaces config/default.yaml",
        "crackfront surfaces config/default.yaml --spectrum h08",
    )
)
@configuration_argument
@output_option
@click.option("--spectrum", help="Only this spectrum.  [default: all]")
def surfaces(configuration: Path, output: Path | None, spectrum: str | None) -> None:
    """Write the surfaces of a sweep into surfaces/, a netCDF file for each spectrum.

    A file has heights and works of adhesion of each amplitude and realisation, in SI units if the
    sweep has scales. Simulations do not read it: they make their surfaces from the seed.
    """
    from crackfront.sweep.run_sweep import opened
    from crackfront.sweep.surface_files import write_surfaces

    sweep, store, origin = opened(configuration, output, warn)
    for item in sweep.spectra if spectrum is None else (sweep.named(spectrum),):
        click.echo(f"surfaces: {write_surfaces(store.folder, sweep, item, origin)}")
