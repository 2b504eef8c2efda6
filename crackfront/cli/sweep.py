"""The steps of a sweep: simulate, aggregate, fit, figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import FILE, as_json, block, examples, fill_store, launch

# The rest is imported where it is used, so that --help does not wait for it.
if TYPE_CHECKING:
    from crackfront.analysis.result import SweepFit
    from crackfront.simulate.simulation import Simulation
    from crackfront.sweep.store import Store
    from crackfront.sweep.sweep import NamedSpectrum, Sweep

_configuration = click.argument("configuration", type=FILE)
_output = click.option(
    "--output", type=FILE, help="Folder of the results.  [default: results/<configuration's name>]"
)


@click.command(
    epilog=examples(
        "crackfront simulate config/default.yaml --ranks 4",
        "crackfront simulate config/default.yaml --spectrum flat --realisations 0-1",
    )
)
@_configuration
@_output
@click.option("--spectrum", help="Only this spectrum.  [default: all]")
@click.option(
    "--realisations",
    callback=block,
    help="Only these realisations, as in 0-49.  [default: all]",
)
@click.option(
    "--ranks",
    type=click.IntRange(min=1),
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
    type=click.FloatRange(min=0),
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

    SIGTERM is taken as notice: running simulations are kept as far as they are, and the exit code
    is 75. The same command then goes on from there.
    """
    from crackfront.sweep import notice, parallel

    if not parallel.is_manager(ranks):
        with notice.heeded():
            parallel.serve_tasks("crackfront.sweep.tasks")
        return
    sweep, store = _sweep_and_store(configuration, output)
    items = sweep.spectra if spectrum is None else (sweep.named(spectrum),)
    chosen = range(sweep.n_realisation) if realisations is None else realisations
    shards = [sweep.named_shard(item, chosen) for item in items]
    simulations = [one for item in items for one in sweep.shard(item, chosen)]
    inventory = store.inventory(simulations)
    busy = min(ranks, len(inventory.missing))
    if busy > 1 and not parallel.under_mpi():
        arguments = ["simulate", str(configuration), "--ranks", str(busy)]
        arguments += ["--output", str(store.folder), "--checkpoint", str(checkpoint)]
        arguments += [] if spectrum is None else ["--spectrum", spectrum]
        arguments += ["--realisations", f"{chosen.start}-{chosen.stop - 1}"]
        launch(arguments, busy, launcher, store.folder)
        return
    click.echo(
        f"{configuration}: {len(simulations) - len(inventory.missing)} of {len(simulations)} "
        "simulations are stored"
    )
    for sentence in inventory.unreadable:
        click.echo(f"Warning: {sentence}; it is computed anew", err=True)
    if sentence := inventory.stale_sentence():
        click.echo(sentence)
    fill_store(store, inventory.missing, configuration, checkpoint)
    for shard in shards:
        manifest = store.write_manifest(shard, sweep.shard(shard.item, shard.realisations))
    click.echo(f"curves: {store.folder / 'curves'}/, lists: {manifest.parent}/")


@click.command(
    epilog=examples(
        "crackfront aggregate config/default.yaml",
    )
)
@_configuration
@_output
def aggregate(configuration: Path, output: Path | None) -> None:
    """Collect the stored simulations of a sweep in hysteresis.nc."""
    from crackfront.data.provenance import provenance
    from crackfront.sweep.table import COMPLETE

    sweep, store = _sweep_and_store(configuration, output)
    path, statuses = store.aggregate(sweep, provenance(configuration.read_text(encoding="utf-8")))
    others = {status: count for status, count in statuses.items() if status not in COMPLETE}
    failed, total = sum(others.values()), sweep.n_simulation
    told = ", ".join(f"{count} {status}" for status, count in sorted(others.items()))
    sentence = f"{failed} of {total} simulations have no value: {told}"
    if failed > sweep.failed_fraction * total:
        raise click.ClickException(
            f"{sentence}; failed_fraction of the configuration allows {sweep.failed_fraction:g}. "
            f"What they ended by stands in status_sentence of {path}"
        )
    if failed:
        click.echo(f"Warning: {sentence}", err=True)
    click.echo(f"hysteresis: {path}")


@click.command(
    epilog=examples(
        "crackfront fit config/default.yaml",
        "crackfront fit config/default.yaml --json",
    )
)
@_configuration
@_output
@as_json
def fit(configuration: Path, output: Path | None, as_json: bool) -> None:
    """Fit k to hysteresis.nc; write fit.nc, fit.json and fit.md, and print the last."""
    from crackfront.data.provenance import provenance
    from crackfront.sweep.fit_files import write_fit

    sweep, store = _sweep_and_store(configuration, output)
    fitted = _fitted(sweep, store)
    paths = write_fit(store.folder, fitted, provenance(configuration.read_text(encoding="utf-8")))
    if as_json:
        click.echo(paths[1].read_text(encoding="utf-8"))
        return
    click.echo(paths[2].read_text(encoding="utf-8"))
    click.echo(f"fit: {', '.join(map(str, paths))}")


@click.command(epilog=examples("crackfront summary config/default.yaml"))
@_configuration
@_output
def summary(configuration: Path, output: Path | None) -> None:
    """Write summary.html: the fit, how the simulations ended, the configuration, the origin."""
    from crackfront.data.files import read_attributes, write_text
    from crackfront.sweep.summary import summary_page
    from crackfront.sweep.table import read_statuses

    sweep, store = _sweep_and_store(configuration, output)
    table = store.folder / "hysteresis.nc"
    attributes = {name: str(value) for name, value in read_attributes(table).items()}
    page = summary_page(
        f"Adhesion hysteresis: {configuration.stem}",
        (store.folder / "fit.md").read_text(encoding="utf-8"),
        read_statuses(table),
        attributes.pop("configuration"),
        attributes | {"seed of the sweep": str(sweep.seed)},
    )
    path = store.folder / "summary.html"
    write_text(path, page)
    click.echo(f"summary: {path}")


@click.command(
    epilog=examples(
        "crackfront archive results/default",
        "crackfront archive results/default --no-curves --output numbers.zip",
    )
)
@click.argument("folder", type=FILE)
@click.option("--output", type=FILE, help="The archive.  [default: <folder>.zip]")
@click.option("--no-curves", is_flag=True, help="Without the files of the single simulations.")
def archive(folder: Path, output: Path | None, no_curves: bool) -> None:
    """Pack the results of a sweep into a ZIP file with checksums, SHA256SUMS."""
    from crackfront.sweep.archive import write_archive

    path = folder.with_name(f"{folder.name}.zip") if output is None else output
    click.echo(f"archive: {path}, {write_archive(folder, path, curves=not no_curves)} files")


@click.command(epilog=examples("crackfront figures config/default.yaml"))
@_configuration
@_output
def figures(configuration: Path, output: Path | None) -> None:
    """Draw the figures of a sweep from hysteresis.nc as PDF and PNG."""
    from crackfront.analysis.steady import steady_adhesion
    from crackfront.plots.loop import loop_figure
    from crackfront.plots.style import save_figure
    from crackfront.plots.sweep import factor_figure, hysteresis_figure
    from crackfront.simulate.files import read_simulation

    sweep, store = _sweep_and_store(configuration, output)
    fitted = _fitted(sweep, store)
    item, simulation = _loop_example(sweep)
    result = read_simulation(store.path(simulation), simulation)
    steady = steady_adhesion(result.record, sweep.correlation_length(item))
    loop = loop_figure(
        result.record.states,
        (steady.w_appr, steady.w_retr),
        (steady.lowest_radius, steady.highest_radius),
        elastic_energy=result.measures.e_el,
        kind=sweep.kind,
        title=simulation.label,
    )
    drawn = {
        "hysteresis": hysteresis_figure(fitted.table, fitted),
        "loop": loop,
        "factor": factor_figure(fitted.table, fitted),
    }
    for name, figure in drawn.items():
        for path in save_figure(figure, store.folder / "figures" / name):
            click.echo(f"figure: {path}")


def _sweep_and_store(configuration: Path, output: Path | None) -> tuple[Sweep, Store]:
    """Sweep of a configuration file, and its store."""
    from crackfront.sweep.configuration import load_configuration, results_folder
    from crackfront.sweep.store import Store

    sweep = load_configuration(configuration)
    return sweep, Store(results_folder(configuration) if output is None else output)


def fit_of_sweep(configuration: Path) -> SweepFit:
    """Fit of the results of a sweep, in `results/` under the name of its configuration.

    Raises
    ------
    ValueError
        If the sweep has not been run.
    """
    sweep, store = _sweep_and_store(configuration, None)
    if not (store.folder / "hysteresis.nc").exists():
        raise ValueError(
            f"{store.folder} holds no hysteresis.nc; run the sweep first: "
            f"make SWEEP={configuration}"
        )
    return _fitted(sweep, store)


def _fitted(sweep: Sweep, store: Store) -> SweepFit:
    """Fit of a sweep, always the same for the same table."""
    from crackfront.analysis.sweep import fit_sweep
    from crackfront.sweep.table import read_table

    return fit_sweep(
        read_table(store.folder / "hysteresis.nc"),
        lowest_elastic_energy=sweep.fit.lowest_elastic_energy,
        highest_elastic_energy=sweep.fit.highest_elastic_energy,
        n_bootstrap=sweep.fit.n_bootstrap,
        seed=sweep.seed,
        kind=sweep.kind,
    )


def _loop_example(sweep: Sweep) -> tuple[NamedSpectrum, Simulation]:
    """The simulation that comes nearest to the paper's Fig. 3c."""
    self_affine = [
        item for item in sweep.spectra if item.spectrum.roll_off > item.spectrum.short_cutoff
    ]
    item = (self_affine or sweep.spectra)[0]
    energy = min(sweep.elastic_energies, key=lambda value: abs(value - 0.05))
    return item, sweep.simulation(item, energy, 0)
