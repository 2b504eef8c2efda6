"""What a sweep will cost, before it runs, and how far it is, while it does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import FILE, as_json, echo_json, examples

if TYPE_CHECKING:
    from crackfront.simulate.simulation import Simulation
    from crackfront.sweep.sweep import NamedSpectrum, Shard, Sweep


@click.command(
    epilog=examples(
        "crackfront plan config/paper.yaml",
        "crackfront plan config/default.yaml --json",
    )
)
@click.argument("configuration", type=FILE)
@click.option(
    "--output", type=FILE, help="Folder of the results.  [default: results/<configuration's name>]"
)
@click.option(
    "--block", type=click.IntRange(min=1), help="Realisations of a shard.  [default: all]"
)
@as_json
def plan(configuration: Path, output: Path | None, block: int | None, as_json: bool) -> None:
    """Print the shards of a sweep, their sizes, what is stored of them and what the rest costs."""
    from crackfront.sweep.configuration import load_configuration, results_folder
    from crackfront.sweep.store import Store

    sweep = load_configuration(configuration)
    store = Store(results_folder(configuration) if output is None else output)
    shards = sweep.shards(block)
    shapes = {item: sweep.shard(item) for item in sweep.spectra}
    inventory = store.inventory([one for simulations in shapes.values() for one in simulations])
    if as_json:
        echo_json(_plan(sweep, store.folder, shards, inventory.missing))
        return
    click.echo("spectrum          lambda_s  lambda_r     H         angles         points    stored")
    costs = []
    for item, simulations in shapes.items():
        missing = [one for one in inventory.missing if one.spectrum_name == item.name]
        stored = len(simulations) - len(missing)
        click.echo(f"{_sizes(item, simulations)}  {stored:5}/{len(simulations)}")
        costs.append(_costs(item.name, sum(shard.item is item for shard in shards), missing))
    if sentence := inventory.stale_sentence():
        click.echo(sentence)
    click.echo(
        "\nto run            shards  simulations  core hours  longest s  MB a rank   MB disk"
    )
    click.echo("\n".join([*costs, _costs("all", len(shards), inventory.missing)]))
    energies = ", ".join(f"{energy:g}" for energy in sweep.elastic_energies)
    click.echo(f"\n{len(sweep.elastic_energies)} amplitudes e_el/w_int: {energies}")
    click.echo(f"{sweep.n_realisation} realisations; {sweep.n_simulation} simulations")
    click.echo(f"results in {store.folder}/")


@click.command(
    epilog=examples(
        "crackfront status results/default",
        "crackfront status results/default --json",
    )
)
@click.argument("folder", type=FILE)
@as_json
def status(folder: Path, as_json: bool) -> None:
    """Tell how far the sweep in a folder is; also while it runs, here or elsewhere."""
    from crackfront.sweep.configuration import load_configuration
    from crackfront.sweep.progress import sweep_progress
    from crackfront.sweep.store import Store

    configuration = Store(folder).configuration
    if not configuration.is_file():
        raise ValueError(f"{folder} holds no sweep that was begun; name results/<its name>")
    found = sweep_progress(folder, load_configuration(configuration))
    if as_json:
        echo_json({"spectra": [asdict(item) for item in found]})
        return
    click.echo("spectrum             done  failed  running  waiting  core hours left")
    for item in found:
        click.echo(
            f"{item.name:16}  {item.done:7}  {item.failed:6}  {item.running:7}  {item.waiting:7}"
            f"  {item.seconds / 3600:15.3g}"
        )
    left, at_work = sum(item.seconds for item in found), sum(item.running for item in found)
    total = sum(item.done + item.failed + item.running + item.waiting for item in found)
    ended = sum(item.done + item.failed for item in found)
    sentence = f"{ended} of {total} simulations have ended"
    if at_work:
        sentence += f"; about {left / at_work / 60:.3g} minutes are left on {at_work} rank(s)"
    elif ended < total:
        sentence += "; nothing runs"
    click.echo(sentence)


def _plan(
    sweep: Sweep, folder: Path, shards: Sequence[Shard], missing: Sequence[Simulation]
) -> dict[str, object]:
    """What a machine wants to know of a plan; costs are those of what is missing."""
    from crackfront.simulate.costs import expected_cost

    costs = [expected_cost(one) for one in missing]
    return {
        "results": folder,
        "spectra": [item.name for item in sweep.spectra],
        "elastic_energies": sweep.elastic_energies,
        "realisations": sweep.n_realisation,
        "simulations": sweep.n_simulation,
        "missing": len(missing),
        "shards": [shard.name for shard in shards],
        "core_seconds": sum(cost.seconds for cost in costs),
        "longest_seconds": max((cost.seconds for cost in costs), default=0.0),
        "bytes_a_rank": max((cost.memory for cost in costs), default=0.0),
        "bytes_on_disk": sum(cost.disk for cost in costs),
    }


def _sizes(item: NamedSpectrum, simulations: Sequence[Simulation]) -> str:
    """Shape and sizes of a spectrum."""
    shape, sizes = item.spectrum, [one.resolution for one in simulations]
    return (
        f"{item.name:16}  {shape.short_cutoff:8.4g}  {shape.roll_off:8.4g}  {shape.hurst:4.2f}"
        f"  {_span([size.n_angle for size in sizes]):>13}"
        f"  {_span([size.n_point for size in sizes]):>13}"
    )


def _costs(name: str, n_shard: int, missing: Sequence[Simulation]) -> str:
    """What the missing simulations of a spectrum, or of all, are expected to cost."""
    from crackfront.simulate.costs import expected_cost

    costs = [expected_cost(one) for one in missing]
    seconds = [cost.seconds for cost in costs]
    return (
        f"{name:16}  {n_shard:6}  {len(costs):11}  {sum(seconds) / 3600:10.3g}"
        f"  {max(seconds, default=0):9.3g}  {max((c.memory for c in costs), default=0) / 1e6:9.0f}"
        f"  {sum(cost.disk for cost in costs) / 1e6:9.3g}"
    )


def _span(values: Sequence[float]) -> str:
    """Range of values over the amplitudes, or the one that all have."""
    low, high = f"{min(values):.0f}", f"{max(values):.0f}"
    return low if low == high else f"{low}-{high}"
