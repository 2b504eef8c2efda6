"""Commands of the law of k: measure it on straight fronts, fit it, compare spheres with it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import cast

import click
import xarray as xr

from crackfront.analysis.csv_records import Row, csv_rows, csv_text
from crackfront.cli.option_types import FILE, examples
from crackfront.cli.output_files import check_writable
from crackfront.plots.style import save_picture
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.storage import read_dataset, write_text
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.run_sweep import opened
from crackfront.sweep.sweep import Sweep
from studies.law.cells import LawCell, law_cells, measured_cells
from studies.law.drawing import law_figure, spectra_points
from studies.law.fitting import fitted_law
from studies.law.front_sweeps import write_configurations
from studies.law.page import law_numbers, law_parts
from studies.law.spheres import (
    read_spheres,
    reference_rows,
    scene_rows,
    sphere_points,
    sphere_rows,
    sphere_table,
)
from studies.pages import keep_option, output_option, tell

commands = click.Group()

_configurations = click.argument("configurations", nargs=-1, type=FILE)
_output = output_option(default=Path("results/law"), help="Folder of the results.")
_tables = click.option(
    "--table",
    "tables",
    type=FILE,
    multiple=True,
    default=(Path("docs/reference/spheres.csv"), Path("docs/reference/held-out.csv")),
    show_default=True,
    help="Tables of simulated spheres.",
)


def _rows(configuration: Path, rows: Callable[[Sweep, xr.Dataset], Iterable[Row]]) -> Iterator[Row]:
    """Rows of a sweep that has been run; ValueError if its table is of another configuration."""
    sweep, store, _ = opened(configuration, None)
    store.about(sweep)
    try:
        yield from rows(sweep, read_dataset(store.hysteresis))
    except ValueError as error:
        raise ValueError(f"{configuration}: {error}") from error


@commands.command(epilog=examples("python -m studies law configurations"))
@_output
def configurations(output: Path) -> None:
    """Write the configurations of the straight fronts other than config/line.yaml.

    They are in the subfolder configurations. Their differences are in front_sweeps.yaml.
    """
    for path in write_configurations(output / "configurations"):
        click.echo(f"configuration: {path}")


@commands.command(
    epilog=examples(
        "python -m studies law fit",
        "python -m studies law fit config/line.yaml results/law/configurations/*.yaml",
    )
)
@_configurations
@_output
def fit(configurations: tuple[Path, ...], output: Path) -> None:
    """Fit the law to straight fronts, of sweeps that have been run or of the last fit.

    Writes cells.csv, a row for every spectrum, amplitude and spring, and law.json, the law.
    Predictions use the copies in studies/law/cells.csv and crackfront/analysis/law.json.
    """
    check_writable(output)
    cells = [cell for path in configurations for cell in _rows(path, law_cells)]
    cells.sort(key=lambda cell: (cell.spectrum, cell.disorder, cell.size))
    text = csv_text(cells or measured_cells())
    # The law is fitted to the rows as they are written, to five digits.
    rounded = csv_rows(text, LawCell)
    law = fitted_law(rounded)
    write_text(output / "cells.csv", text)
    write_text(output / "law.json", json.dumps(asdict(law), indent=1) + "\n")
    click.echo(f"{len(rounded)} rows; rms {law.rms:.1%}, worst {law.worst:.1%} for g above 1")
    click.echo(f"law: {output / 'law.json'}")


@commands.command(
    epilog=examples(
        "python -m studies law spheres", "python -m studies law spheres config/spheres.yaml"
    )
)
@_configurations
@_tables
@_output
def spheres(configurations: tuple[Path, ...], tables: tuple[Path, ...], output: Path) -> None:
    """Compare spheres with the law, from sweeps that have been run or from tables.

    For sweeps it writes spheres.csv, which is kept as docs/reference/spheres.csv.
    """
    rows = [row for path in configurations for row in _rows(path, sphere_rows)]
    if rows:
        write_text(output / "spheres.csv", csv_text(rows))
    click.echo(sphere_table(rows or read_spheres(tables)).text())


@commands.command("held-out", epilog=examples("python -m studies law held-out"))
@_output
def held_out(output: Path) -> None:
    """Simulate spheres to which nothing was fitted, and compare them with the law.

    Writes held-out.csv, with the spheres of docs/reference/si-5.nc, which is kept in
    docs/reference.
    """
    check_writable(output)
    schedule = cast(SteadySchedule, load_sweep(Path("config/paper.yaml")).schedule)
    rows = [*scene_rows(), *reference_rows(Path("docs/reference/si-5.nc"), schedule)]
    write_text(output / "held-out.csv", csv_text(rows))
    click.echo(sphere_table(rows).text())


@commands.command(epilog=examples("python -m studies law figure"))
@_tables
@output_option(default=Path("docs/figures"))
def figure(tables: tuple[Path, ...], output: Path) -> None:
    """Draw the law with the fronts to which it is fitted and with spheres, as law.png."""
    check_writable(output)
    points = sphere_points(read_spheres(tables))
    save_picture(law_figure(spectra_points(measured_cells()), points), output / "law.png")
    click.echo(f"figure: {output / 'law.png'}")


@commands.command(epilog=examples("python -m studies law numbers --keep"))
@_tables
@keep_option
def numbers(tables: tuple[Path, ...], keep: bool) -> None:
    """Print the numbers of the law for the pages."""
    rows = read_spheres(tables)
    tell("law", law_parts(rows), numbers=law_numbers(rows), keep=keep)
