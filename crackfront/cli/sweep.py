"""A sweep while it runs: what it will cost, its simulations, and how far they are."""

from __future__ import annotations

import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import (
    FILE,
    Number,
    StoppedError,
    announce_compilation,
    announce_cost,
    as_json,
    echo_json,
    examples,
    whole,
)
from crackfront.data.bounds import COUNT, Range, in_bytes, refuse_beyond_memory

# The rest is imported where it is used, so that --help does not wait for it.
if TYPE_CHECKING:
    from crackfront.data.provenance import Provenance
    from crackfront.simulate.simulation import Simulation
    from crackfront.sweep.store import Store
    from crackfront.sweep.sweep import NamedSpectrum, Sweep
    from crackfront.sweep.tasks import Finished

_MOST_PROCESSES = 16
"""Processes that status names to a reader."""

configuration_argument = click.argument("configuration", type=FILE)
output_option = click.option(
    "--output", type=FILE, help="Folder of the results.  [default: results/<configuration's name>]"
)


def opened(configuration: Path, output: Path | None) -> tuple[Sweep, Store, Provenance]:
    """Sweep of a configuration file, its store, and the origin of what is computed for it."""
    from crackfront.data.provenance import provenance
    from crackfront.sweep.configuration import load_configuration, results_folder
    from crackfront.sweep.store import Store

    sweep = load_configuration(configuration)
    store = Store(results_folder(configuration) if output is None else output)
    return sweep, store, provenance(configuration.read_text(encoding="utf-8"))


@click.command(
    epilog=examples(
        "crackfront plan config/paper.yaml",
        "crackfront plan config/default.yaml --json",
    )
)
@configuration_argument
@output_option
@click.option("--block", type=whole(COUNT), help="Realisations of a shard.  [default: all]")
@as_json
def plan(configuration: Path, output: Path | None, block: int | None, as_json: bool) -> None:
    """Print the shards of a sweep, their sizes, what is stored of them and what the rest costs."""
    sweep, store, _ = opened(configuration, output)
    shards = sweep.shards(block)
    inventory = store.inventory(sweep.simulations())
    if as_json:
        echo_json(
            {
                "results": store.folder,
                "spectra": [item.name for item in sweep.spectra],
                "elastic_energies": sweep.elastic_energies,
                "realisations": sweep.n_realisation,
                "simulations": sweep.n_simulation,
                "missing": len(inventory.missing),
                "shards": [shard.name for shard in shards],
                **_costs(inventory.missing),
            }
        )
        return
    click.echo("spectrum          lambda_s  lambda_r     H         angles         points    stored")
    rows = []
    left = defaultdict(list)
    for one in inventory.missing:
        left[one.spectrum_name].append(one)
    for item in sweep.spectra:
        missing, total = left[item.name], sweep.n_simulation // len(sweep.spectra)
        examples = [sweep.simulation(item, energy, 0) for energy in sweep.elastic_energies]
        click.echo(f"{_sizes(item, examples)}  {total - len(missing):5}/{total}")
        rows.append(_row(item.name, sum(shard.item is item for shard in shards), missing))
    if sentence := inventory.stale_sentence():
        click.echo(sentence)
    click.echo(
        "\nto run            shards  simulations  core hours  longest s  MB a rank   MB disk"
    )
    click.echo("\n".join([*rows, _row("all", len(shards), inventory.missing)]))
    energies = ", ".join(f"{energy:g}" for energy in sweep.elastic_energies)
    click.echo(f"\n{len(sweep.elastic_energies)} amplitudes e_el/w_int: {energies}")
    click.echo(f"{sweep.n_realisation} realisations; {sweep.n_simulation} simulations")
    click.echo(f"results in {store.folder}/")


def _costs(missing: Sequence[Simulation]) -> dict[str, float]:
    """What simulations are expected to cost, under the names that machines read."""
    from crackfront.simulate.costs import expected_cost

    # All realisations cost the same.
    alike = Counter((one.spectrum_name, one.elastic_energy) for one in missing)
    examples = {(one.spectrum_name, one.elastic_energy): one for one in missing}
    costs = [(expected_cost(examples[name]), count) for name, count in alike.items()]
    return {
        "core_seconds": sum(count * cost.seconds for cost, count in costs),
        "longest_seconds": max((cost.seconds for cost, _ in costs), default=0.0),
        "bytes_a_rank": max((cost.memory for cost, _ in costs), default=0.0),
        "bytes_on_disk": sum(count * cost.disk for cost, count in costs),
    }


def _row(name: str, n_shard: int, missing: Sequence[Simulation]) -> str:
    """What the missing simulations of a spectrum, or of all, are expected to cost."""
    costs = _costs(missing)
    return (
        f"{name:16}  {n_shard:6}  {len(missing):11}  {costs['core_seconds'] / 3600:10.3g}"
        f"  {costs['longest_seconds']:9.3g}  {costs['bytes_a_rank'] / 1e6:9.0f}"
        f"  {costs['bytes_on_disk'] / 1e6:9.3g}"
    )


def _sizes(item: NamedSpectrum, simulations: Sequence[Simulation]) -> str:
    """Shape and sizes of a spectrum."""
    shape, sizes = item.spectrum, [one.resolution for one in simulations]
    hurst = f"{shape.hurst:.2f}" if hasattr(shape, "hurst") else "-"
    return (
        f"{item.name:16}  {shape.short_cutoff:8.4g}  {shape.longest_feature:8.4g}  {hurst:>4}"
        f"  {_span([size.n_angle for size in sizes]):>13}"
        f"  {_span([size.n_point for size in sizes]):>13}"
    )


def _span(values: Sequence[float]) -> str:
    """Range of values over the amplitudes, or the one that all have."""
    low, high = f"{min(values):.0f}", f"{max(values):.0f}"
    return low if low == high else f"{low}-{high}"


def _block(context: click.Context, parameter: click.Parameter, value: str | None) -> range | None:
    """Range that an option like 0-49 means, both ends included."""
    if value is None:
        return None
    first, dash, last = value.partition("-")
    if not (dash and first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
        raise click.BadParameter(
            f"{value!r} is no range of numbers; write the first and the last, as in 0-49"
        )
    return range(int(first), int(last) + 1)


@click.command(
    epilog=examples(
        "crackfront simulate config/default.yaml --ranks 4",
        "crackfront simulate config/default.yaml --spectrum flat --realisations 0-1",
    )
)
@configuration_argument
@output_option
@click.option("--spectrum", help="Only this spectrum.  [default: all]")
@click.option(
    "--realisations",
    callback=_block,
    help="Only these realisations, as in 0-49.  [default: all]",
)
@click.option(
    "--ranks",
    type=whole(Range(1, 1e6)),
    default=1,
    show_default=True,
    help="MPI ranks that simulate, beside one that hands out the work; 1 runs without MPI.",
)
@click.option(
    "--launcher",
    envvar="CRACKFRONT_LAUNCHER",
    help="What starts the ranks, as in 'srun -K1 --mpi=pmi2'; also from CRACKFRONT_LAUNCHER.  "
    "[default: mpiexec beside this Python]",
)
@click.option(
    "--checkpoint",
    type=Number(Range(0, 1e9)),
    default=60.0,
    show_default=True,
    help="Seconds between checkpoints of a running simulation.",
)
def simulate(
    configuration: Path,
    output: Path | None,
    spectrum: str | None,
    realisations: range | None,
    ranks: int,
    launcher: str | None,
    checkpoint: float,
) -> None:
    """Run the simulations of a sweep that are not stored yet.

    Ctrl-C and SIGTERM store running simulations as far as they are, and the exit code is 75. Run
    the same command to continue.
    """
    from crackfront.sweep import parallel

    if not parallel.is_manager(ranks):
        with parallel.deferring_stops():
            parallel.serve_tasks("crackfront.sweep.tasks")
        return
    sweep, store, origin = opened(configuration, output)
    items = sweep.spectra if spectrum is None else (sweep.named(spectrum),)
    chosen = range(sweep.n_realisation) if realisations is None else realisations
    shards = [sweep.named_shard(item, chosen) for item in items]
    simulations = [one for item in items for one in sweep.shard(item, chosen)]
    inventory = store.inventory(simulations)
    busy = min(ranks, len(inventory.missing))
    if inventory.missing and not parallel.under_mpi():
        costs = _costs(inventory.missing)
        refuse_beyond_memory(
            f"{busy} rank(s) of {in_bytes(costs['bytes_a_rank'])}",
            costs["bytes_a_rank"] * (busy if launcher is None else 1),
            "use fewer ranks, coarser numerics or a smaller tile",
        )
        announce_cost(costs["core_seconds"])
    if busy > 1 and not parallel.under_mpi():
        arguments = ["simulate", str(configuration), "--ranks", str(busy)]
        arguments += ["--output", str(store.folder), "--checkpoint", str(checkpoint)]
        arguments += [] if spectrum is None else ["--spectrum", spectrum]
        arguments += ["--realisations", f"{chosen.start}-{chosen.stop - 1}"]
        _launch(arguments, busy, launcher, store.folder)
        return
    click.echo(
        f"{configuration}: {len(simulations) - len(inventory.missing)} of {len(simulations)} "
        "simulations are stored"
    )
    for sentence in inventory.unreadable:
        click.echo(f"Warning: {sentence}; it is computed anew", err=True)
    if sentence := inventory.stale_sentence():
        click.echo(sentence)
    try:
        fill_store(store, inventory.missing, origin, checkpoint)
    except StoppedError as stopped:
        if not parallel.launcher_knows_of_stop():
            raise
        stopped.show()
        return
    for shard in shards:
        manifest = store.write_manifest(shard, sweep.shard(shard.item, shard.realisations))
    click.echo(f"curves: {store.folder / 'curves'}/, lists: {manifest.parent}/")


def _launch(arguments: list[str], ranks: int, launcher: str | None, folder: Path) -> None:
    """Run a command on ranks, and end where they failed."""
    from crackfront.sweep import parallel

    folder.mkdir(parents=True, exist_ok=True)
    code = parallel.launch_ranks(arguments, ranks, launcher, folder)
    if code is None or code == StoppedError.exit_code:
        sys.exit(StoppedError.exit_code)  # the manager has printed its sentence
    if code != 0:
        click.echo(
            f"Error: the ranks ended with exit code {code}; finished simulations are stored, and "
            "the same command continues with the others",
            err=True,
        )
        sys.exit(code if 0 < code < 126 else 1)


def fill_store(
    store: Store,
    missing: tuple[Simulation, ...],
    origin: Provenance,
    checkpoint_seconds: float = 60.0,
) -> None:
    """Run what is missing and report every simulation as it ends."""
    from crackfront.sweep.parallel import deferring_stops
    from crackfront.sweep.tasks import NOT_STORED, STOPPED, fill

    if missing:
        announce_compilation()
    started = time.monotonic()
    outcomes = fill(store, missing, origin, checkpoint_seconds)
    with deferring_stops(), closing(outcomes):
        for count, (line, finished) in enumerate(_reported(outcomes, len(missing))):
            if finished.status == NOT_STORED:
                raise click.ClickException(
                    f"{line}; {count} of {len(missing)} simulations were stored, and the same "
                    "command continues with the others"
                )
            if finished.status == STOPPED:
                raise StoppedError(
                    f"{count} of {len(missing)} simulations are finished and stored, and running "
                    "ones as far as they are; run the same command to continue"
                )
    if missing:
        click.echo(f"{len(missing)} simulations in {time.monotonic() - started:.1f} s")


def _reported(
    outcomes: Iterator[tuple[Simulation, Finished]], total: int
) -> Iterator[tuple[str, Finished]]:
    """Outcomes with their lines: a bar on a terminal, else a line each."""
    from tqdm import tqdm

    from crackfront.sweep.table import COMPLETE

    terminal = sys.stderr.isatty()
    with tqdm(total=total, unit="simulation", disable=not terminal, file=sys.stderr) as bar:
        for count, (simulation, finished) in enumerate(outcomes, start=1):
            line = f"{simulation.label}: {finished.status}"
            line += f", {finished.sentence or f'{finished.seconds:.2f} s'}"
            if not terminal:
                click.echo(f"[{count}/{total}] {line}")
            elif finished.status not in COMPLETE:
                bar.write(line)
            bar.update()
            yield line, finished


@click.command(
    epilog=examples(
        "crackfront status results/default",
        "crackfront status results/default --json",
    )
)
@click.argument("folder", type=FILE)
@as_json
def status(folder: Path, as_json: bool) -> None:
    """Show how far the sweep in a folder is, and which processes run it, here or elsewhere.

    A process on this machine counts as long as it lives, one on another machine as long as
    it shows signs of life.
    """
    from crackfront.data.files import refuse_damaged
    from crackfront.sweep.configuration import load_configuration
    from crackfront.sweep.journal import running
    from crackfront.sweep.store import Store

    store = Store(folder)
    if not store.configuration.is_file():
        raise ValueError(f"{folder} holds no sweep that was begun; name results/<its name>")
    refuse_damaged(store.configuration)
    found = store.progress(load_configuration(store.configuration))
    processes = running(store.journals)
    if as_json:
        spectra, at_work = ([asdict(item) for item in items] for items in (found, processes))
        echo_json({"spectra": spectra, "processes": at_work})
        return
    click.echo("spectrum             done  failed  running  waiting  core hours left")
    for item in found:
        click.echo(
            f"{item.name:16}  {item.done:7}  {item.failed:6}  {item.running:7}  {item.waiting:7}"
            f"  {item.seconds / 3600:15.3g}"
        )
    for one in processes[:_MOST_PROCESSES]:
        click.echo(
            f"process {one.process} on {one.host}: {one.label}, last sign of life "
            f"{one.silent_seconds:.0f} s ago"
        )
    if len(processes) > _MOST_PROCESSES:
        click.echo(f"and {len(processes) - _MOST_PROCESSES} more, listed by --json")
    left, ranks = sum(item.seconds for item in found), len(processes)
    total = sum(item.done + item.failed + item.running + item.waiting for item in found)
    ended = sum(item.done + item.failed for item in found)
    sentence = f"{ended} of {total} simulations have ended"
    if ranks:
        sentence += f"; about {left / ranks / 60:.3g} minutes are left on {ranks} rank(s)"
    elif ended < total:
        sentence += "; nothing runs"
    click.echo(sentence)
