"""What a sweep that has run becomes: one file, its fit with figures and a page, and an archive."""

from __future__ import annotations

import os
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.answers import announce_cost, warn
from crackfront.cli.option_types import FILE, as_json, examples
from crackfront.cli.sweep_commands import configuration_argument, output_option
from crackfront.sweep.watching import with_progress

if TYPE_CHECKING:
    from crackfront.analysis.result import SweepFit
    from crackfront.analysis.table import SweepTable
    from crackfront.simulate.provenance import Provenance
    from crackfront.simulate.run_simulation import SimulationResult
    from crackfront.simulate.simulation import Simulation
    from crackfront.sweep.store import Store
    from crackfront.sweep.sweep import NamedSpectrum, Sweep


@click.command(epilog=examples("crackfront aggregate config/default.yaml"))
@configuration_argument
@output_option
def aggregate(configuration: Path, output: Path | None) -> None:
    """Collect the rows of all shards of a sweep in hysteresis.nc."""
    from crackfront.sweep.run_sweep import opened, without_value

    sweep, store, origin = opened(configuration, output, warn)
    path = store.aggregate(
        sweep, origin, lambda shards: with_progress(shards, len(shards), "shards")
    )
    failed, sentence = without_value(path)
    if failed > sweep.failed_fraction * sweep.n_simulation:
        raise click.ClickException(
            f"{sentence}; failed_fraction of the configuration allows {sweep.failed_fraction:g}"
        )
    if failed:
        warn(sentence)
    click.echo(f"hysteresis: {path}")


@click.command(
    epilog=examples(
        "crackfront fit config/default.yaml", "crackfront fit config/default.yaml --json"
    )
)
@configuration_argument
@output_option
@as_json
def fit(configuration: Path, output: Path | None, as_json: bool) -> None:
    """Fit k to hysteresis.nc and show it: fit.nc, fit.json, fit.md, figures, summary.html.

    The page has the result, the figures, the fit, how simulations ended, the configuration and the
    origin. Without the stored simulations, curves/, one is run again for its figure.
    """
    from crackfront.analysis.fit_text import fit_result
    from crackfront.simulate.checksums import forget_sums
    from crackfront.sweep.fit_files import write_fit
    from crackfront.sweep.requests import fit_request
    from crackfront.sweep.run_sweep import opened
    from crackfront.sweep.store import write_request

    sweep, store, origin = opened(configuration, output, warn)
    fitted = _fitted(sweep, store)
    example = _stored_or_run(store, sweep, _loop_example(sweep, fitted.table))
    forget_sums(store.folder)
    request = fit_request(sweep)
    store.keep_configuration(origin.configuration)
    write_request(store.folder, request)
    paths = write_fit(store.folder, fitted, request.digest, origin)
    figures = _write_figures(store.folder, fitted, example)
    page = _write_page(store, sweep, fitted, configuration.stem, origin)
    if as_json:
        click.echo(paths[1].read_text(encoding="utf-8"))
        return
    click.echo(fit_result(fitted))
    click.echo(f"fit: {', '.join(map(str, paths))}")
    for path in figures:
        click.echo(f"figure: {path}")
    click.echo(f"summary: {page}")


def _stored_or_run(store: Store, sweep: Sweep, simulation: Simulation) -> SimulationResult:
    """Result of a simulation, which is run where it is not stored."""
    from crackfront.simulate.costs import expected_cost
    from crackfront.simulate.run_simulation import run_simulation
    from crackfront.simulate.storage import UnreadableFileError

    try:
        return store.result(sweep, simulation)
    except UnreadableFileError:  # as in an archive without curves
        announce_cost(simulation.label, expected_cost(simulation).seconds)
        return run_simulation(simulation)


def _write_figures(folder: Path, fitted: SweepFit, example: SimulationResult) -> list[Path]:
    """Draw the figures of a sweep, one of them of a single simulation, as PDF and PNG."""
    from crackfront.plots.loop_figures import simulation_figure
    from crackfront.plots.style import save_figure
    from crackfront.plots.sweep_figures import factor_figure, hysteresis_figure

    drawn = {
        "hysteresis": hysteresis_figure(fitted),
        "loop": simulation_figure(example),
        "factor": factor_figure(fitted),
    }
    paths: list[Path] = []
    for name, figure in drawn.items():
        paths += save_figure(figure, folder / "figures" / name)
    return paths


_EXAMPLE_ENERGY = 0.05
"""e_el of the paper's Fig. 3c, next to which a loop is drawn as an example. (Units: w_int)"""

_CAPTIONS = {
    "factor": "k against e_el/w_int (a), and averaged over the range of the fit against the "
    "correlation length of w_loc (b). Straight fronts: k against size g (a), and k of the infinite "
    "contact against disorder (b).",
    "hysteresis": "Hysteresis against disorder (a), and the spectra (b).",
    "loop": "One simulation of the sweep: the loop of radius against force, or of a straight front "
    "the pinning force against its load.",
}


def _write_page(
    store: Store, sweep: Sweep, fitted: SweepFit, name: str, origin: Provenance
) -> Path:
    """Write the page of a sweep of this name, whose figures are drawn, and return its path."""
    from crackfront.analysis.fit_text import fit_table
    from crackfront.simulate.storage import write_text
    from crackfront.sweep.summary import summary_page
    from crackfront.sweep.table_file import read_statuses

    about = {key: text for key, text in store.about(sweep).items() if key != "configuration"}
    page = summary_page(
        f"Adhesion hysteresis: {name}",
        fit_table(fitted),
        {text: store.folder / "figures" / f"{figure}.png" for figure, text in _CAPTIONS.items()},
        read_statuses(store.hysteresis),
        origin.configuration,
        about | {"seed of the sweep": str(sweep.seed)},
    )
    path = store.folder / "summary.html"
    write_text(path, page)
    return path


@click.command(
    epilog=examples(
        "crackfront archive results/default",
        "crackfront archive results/default --no-curves --output numbers.zip",
    )
)
@click.argument("folder", type=FILE)
@click.option("--output", type=FILE, help="The archive.  [default: <folder>.zip]")
@click.option("--no-curves", is_flag=True, help="Leave out the finished simulations, curves/.")
def archive(folder: Path, output: Path | None, no_curves: bool) -> None:
    """Pack the results of a folder into a ZIP file with their checksums, SHA256SUMS.

    The folder must have the list, and agree with it; links are followed.
    """
    from crackfront.sweep.integrity import archive_results

    named = folder if folder.name not in ("", "..") else folder.resolve()
    path = named.with_name(f"{named.name}.zip") if output is None else output
    if path.suffix.lower() != ".zip":
        raise ValueError(f"--output is {path}; name a ZIP file, as in {named.name}.zip")
    if Path(os.path.realpath(folder)) in Path(os.path.realpath(path)).parents:
        raise ValueError(f"--output is {path}, among the results; name a file outside of {folder}")
    number = archive_results(named, path, curves=not no_curves)
    click.echo(f"archive: {path}, {number} files")


def fit_of_sweep(configuration: Path) -> SweepFit:
    """Fit of a sweep that stands in `results/`; ValueError where it has not been run."""
    from crackfront.sweep.run_sweep import opened

    sweep, store, _ = opened(configuration, None)
    if not store.hysteresis.exists():
        raise ValueError(
            f"{store.folder} lacks hysteresis.nc; run the sweep first: make SWEEP={configuration}"
        )
    return _fitted(sweep, store)


def _fitted(sweep: Sweep, store: Store) -> SweepFit:
    """Fit of a sweep, always the same for the same table."""
    from crackfront.analysis.sweep_fit import fit_sweep
    from crackfront.simulate.line.line_loads import LineLoad

    loads = sweep.schedule
    return fit_sweep(
        store.table(sweep),
        **asdict(sweep.fit),
        seed=sweep.seed,
        kind=sweep.kind,
        uncorrelated=isinstance(loads, LineLoad) and loads.uncorrelated,
        watched=lambda spectra: with_progress(spectra, len(spectra), "spectra"),
    )


def _loop_example(sweep: Sweep, table: SweepTable) -> Simulation:
    """The simulation with a value that is closest to the paper's Fig. 3c.

    A simulation of the spectrum of :func:`_example_spectrum` is preferred, then a similar e_el.
    """
    import numpy as np

    preferred = _example_spectrum(sweep)

    def distance(place: tuple[int, ...]) -> tuple[bool, float, int]:
        spectrum, amplitude, realisation = place
        energy = sweep.elastic_energies[amplitude]
        is_elsewhere = sweep.spectra[spectrum] is not preferred
        return is_elsewhere, abs(energy - _EXAMPLE_ENERGY), realisation

    # A simulation without a value may lack a curve.
    places = [tuple(place) for place in np.argwhere(table.finite).tolist()]
    spectrum, amplitude, realisation = min(places, key=distance)
    return sweep.simulation(sweep.spectra[spectrum], sweep.elastic_energies[amplitude], realisation)


def _example_spectrum(sweep: Sweep) -> NamedSpectrum:
    """The self-affine spectrum with the longest springs; for spheres the first of them."""
    self_affine = [
        item for item in sweep.spectra if item.spectrum.longest_feature > item.spectrum.short_cutoff
    ]
    return max(self_affine or sweep.spectra, key=lambda item: item.spring)
