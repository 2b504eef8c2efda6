"""Commands: the crack-front model against boundary elements."""

from __future__ import annotations

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
    from studies.boundary_elements import study
    from studies.boundary_elements.parameters import load_validation, validation_cases

    parameters = load_validation(configuration)
    folder = output or results_folder(configuration)
    study.refuse_missing_libraries()
    refuse_unwritable(folder)
    origin = provenance(configuration.read_text(encoding="utf-8"))
    if not finished:
        announce_cost(study.expected_seconds(validation_cases(parameters), folder))
    announce_compilation()
    try:
        study.write_validation(folder, parameters, origin, click.echo, compute=not finished)
    except KeyboardInterrupt as error:
        raise StoppedError("Run the same command to continue with the next load step") from error
