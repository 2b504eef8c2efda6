"""Commands: the crack-front model against boundary elements."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from crackfront.cli.report import (
    FILE,
    StoppedError,
    announce_compilation,
    announce_cost,
    examples,
    refuse_unwritable,
)


@click.group()
def commands() -> None:
    """The model against boundary elements of the same rough sphere."""


@commands.command(
    epilog=examples(
        "python -m studies boundary-elements validate config/validation.yaml",
        "python -m studies boundary-elements validate config/validation-strong.yaml --finished",
    )
)
@click.argument("configuration", type=FILE)
@click.option("--output", type=FILE, help="Folder of the results.  [default: results/<name>]")
@click.option("--finished", is_flag=True, help="Compare the finished cases, compute no other.")
def validate(configuration: Path, output: Path | None, finished: bool) -> None:
    """Run rough spheres by boundary elements and by the crack front, and compare them.

    Every load step of the boundary elements is on disk at once: a run that is killed goes on with
    the next one. The tables grow with every finished case.
    """
    from crackfront.data.provenance import provenance
    from crackfront.sweep.configuration import results_folder
    from studies.boundary_elements.parameters import load_validation, validation_cases
    from studies.boundary_elements.study import (
        expected_seconds,
        refuse_missing_libraries,
        write_validation,
    )

    parameters = load_validation(configuration)
    folder = output or results_folder(configuration)
    refuse_missing_libraries()
    refuse_unwritable(folder)
    origin = provenance(configuration.read_text(encoding="utf-8"))
    if not finished:
        announce_cost(expected_seconds(validation_cases(parameters), folder))
    announce_compilation()
    try:
        write_validation(folder, parameters, origin, click.echo, compute=not finished)
    except KeyboardInterrupt as error:
        raise StoppedError("Run the same command to continue with the next load step") from error


@commands.command()
@click.argument("configuration", type=FILE, default="config/validation.yaml")
def minimiser(configuration: Path) -> None:
    """Time a load step of the rough cases of a configuration, and by NuMPI's minimiser.

    At the disorder of the case, and at that of the paper's nanodiamond film, e_el/w_int = 0.177.
    """
    from studies.boundary_elements.benchmarks import MINIMISER, minimiser_row
    from studies.boundary_elements.parameters import load_validation, validation_cases
    from studies.pages import markdown_table

    rows = (
        minimiser_row(replace(case, elastic_energy=energy))
        for case in validation_cases(load_validation(configuration))
        if case.elastic_energy > 0
        for energy in (case.elastic_energy, 0.177)
    )
    click.echo(markdown_table(MINIMISER, rows))


@commands.command()
def rotated() -> None:
    """Time the mapping whose crack turns with the angle, and the plain sum over all modes."""
    from studies.boundary_elements.benchmarks import ROTATED, TILES, rotated_row
    from studies.pages import markdown_table

    click.echo(markdown_table(ROTATED, (rotated_row(*tile) for tile in TILES)))
