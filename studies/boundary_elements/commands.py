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
        "python -m studies boundary-elements validate config/validation-512.yaml",
        "python -m studies boundary-elements validate config/validation-strong.yaml --finished",
    )
)
@click.argument("configuration", type=FILE)
@click.option("--output", type=FILE, help="Folder of the results.  [default: results/<name>]")
@click.option("--finished", is_flag=True, help="Compare the finished cases, compute no other.")
def validate(configuration: Path, output: Path | None, finished: bool) -> None:
    """Run rough spheres by boundary elements and by the crack front, and compare them.

    Every load step of the boundary elements is on disk at once: a run that is killed goes on with
    the next one. With `elastic_energies` in the configuration the hysteresis of both models is
    compared by amplitude, and the tables grow with every finished case.
    """
    from crackfront.data.provenance import provenance
    from crackfront.sweep.configuration import results_folder
    from studies.boundary_elements.amplitude_report import write_amplitudes
    from studies.boundary_elements.costs import expected_seconds
    from studies.boundary_elements.parameters import (
        AmplitudeParameters,
        amplitude_cases,
        load_validation,
        validation_cases,
    )
    from studies.boundary_elements.report import write_validation
    from studies.boundary_elements.study import refuse_missing_libraries

    parameters = load_validation(configuration)
    if finished and not isinstance(parameters, AmplitudeParameters):
        raise click.UsageError(
            f"--finished is for configurations with elastic_energies; {configuration} has cases"
        )
    folder = output or results_folder(configuration)
    refuse_missing_libraries()
    refuse_unwritable(folder)
    origin = provenance(configuration.read_text(encoding="utf-8"))
    if not finished:
        cases = (
            amplitude_cases(parameters)
            if isinstance(parameters, AmplitudeParameters)
            else validation_cases(parameters)
        )
        announce_cost(expected_seconds(cases, folder))
    announce_compilation()
    try:
        if isinstance(parameters, AmplitudeParameters):
            write_amplitudes(folder, parameters, origin, click.echo, compute=not finished)
        else:
            write_validation(folder, parameters, origin, click.echo)
    except KeyboardInterrupt as error:
        raise StoppedError("the same command goes on with the next load step") from error
