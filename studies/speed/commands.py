"""Commands that measure speed: solvers, requests, the cost model, the scaling of sweeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import click

from crackfront.cli.option_types import examples
from crackfront.cli.output_files import check_writable
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import write_text
from studies.numbers import Number
from studies.pages import keep_option, output_option, tell
from studies.records import write_records
from studies.speed import cost_ratios as cost_model
from studies.speed import needs as requests
from studies.speed import scaling as sweeps
from studies.speed import solvers as pairs
from studies.speed.machine import in_fresh_process
from studies.speed.problems import PROBLEMS, Group
from studies.tables import Table

commands = click.Group()

_output = output_option(default=Path("results/benchmark"), help="Folder of the results.")


def _write(
    path: Path,
    title: str,
    tables: Mapping[str, Table],
    rows: Sequence[Any] = (),
    *,
    keep: bool,
    numbers: Mapping[str, Number] | None = None,
) -> None:
    """Write and print tables, and their rows as netCDF; the path lacks a suffix."""
    origin = provenance()
    machine = f"Machine: {origin.processor}, {origin.platform}; commit {origin.git_commit}."
    texts = (table.text() for table in tables.values())
    page = "\n\n".join([f"# {title}", machine, *texts]) + "\n"
    write_text(path.with_suffix(".md"), page)
    if rows:
        write_records(path.with_suffix(".nc"), rows, "row", origin, title=title)
    tell("speed", tables, numbers=numbers, keep=keep)
    click.echo(f"results: {path.with_suffix('.md')}")


@commands.command(epilog=examples("python -m studies speed solvers --group scaling --repeats 1"))
@click.option(
    "--group",
    "groups",
    type=click.Choice(get_args(Group)),
    multiple=True,
    default=("disorder", "scaling"),
    show_default=True,
    help="Problems to run.",
)
@click.option("--repeats", type=click.IntRange(min=1), default=2, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True)
@_output
@keep_option
def solvers(groups: tuple[Group, ...], repeats: int, seed: int, output: Path, keep: bool) -> None:
    """Time the solvers against the reference on problems of known size."""
    check_writable(output)
    rows = []
    for problem in PROBLEMS:
        if problem.group in groups:
            # A process before the measured one compiles what the problem needs.
            in_fresh_process(pairs.measured, problem.smallest(), seed, 1)
            rows.append(row := in_fresh_process(pairs.measured, problem, seed, repeats))
            click.echo(f"{row.label}: {row.ratio:.1f} times, error {row.error:.1e}")
    tables = {"solvers": pairs.solver_table(rows, repeats)}
    numbers = {f"newton faster, {row.label}": Number(row.ratio) for row in rows}
    title = "The solvers against the reference"
    _write(output / "solvers", title, tables, rows, keep=keep, numbers=numbers)


@commands.command(epilog=examples("python -m studies speed needs"))
@_output
@keep_option
def needs(output: Path, keep: bool) -> None:
    """Measure what each request of a contact costs: time, memory, disk, samples."""
    check_writable(output)
    rows = []
    for need in requests.NEEDS:
        # A process before the measured one compiles what the request needs.
        in_fresh_process(requests.measured, requests.SMALL, need)
        rows.append(row := in_fresh_process(requests.measured, requests.SCENE, need))
        click.echo(f"{row.name}: {row.seconds:.3g} s, {row.peak:.1f} MB, {row.file:.1f} kB")
    tables = {"needs": requests.need_table(rows)}
    _write(output / "needs", "What each request costs", tables, rows, keep=keep)


@commands.command(epilog=examples("python -m studies speed costs"))
@_output
@keep_option
def costs(output: Path, keep: bool) -> None:
    """Compare the expected processor time of simulations with the measured one."""
    check_writable(output)
    sweeps = cost_model.compared_sweeps(output / "configurations")
    measured = cost_model.measured_costs(sweeps, click.echo)
    tables = {"costs": cost_model.ratio_table(measured)}
    _write(output / "costs", "Expected over measured processor time", tables, keep=keep)


@commands.command(epilog=examples("python -m studies speed scaling"))
@_output
@keep_option
def scaling(output: Path, keep: bool) -> None:
    """Measure dispatch, start of jobs and later commands; simulate a sweep of a million runs."""
    check_writable(output)
    _write(output / "scaling", "How a sweep scales", sweeps.tables(), keep=keep)
