"""Commands: the crack-front model against boundary elements."""

from __future__ import annotations

from pathlib import Path

import click

from crackfront.cli.answers import StoppedError, announce_compilation
from crackfront.cli.option_types import FILE, examples
from crackfront.cli.output_files import check_writable
from crackfront.sweep.watching import with_progress
from studies.pages import keep_option, tell


@click.group()
def commands() -> None:
    """The model against boundary elements of the same rough sphere."""


@commands.command(
    epilog=examples("python -m studies boundary-elements validate config/validation.yaml")
)
@click.argument("configuration", type=FILE)
@click.option("--output", type=FILE, help="Folder of the results.  [default: results/<name>]")
def validate(configuration: Path, output: Path | None) -> None:
    """Run rough spheres by boundary elements and by the crack front, and compare them.

    Every load step of the boundary elements is stored at once: a run that was killed continues with
    the next one. The tables grow with every finished case. A terminal shows a bar of the cases.
    """
    from tqdm import tqdm

    from crackfront.simulate.checksums import forget_sums
    from crackfront.simulate.provenance import provenance
    from crackfront.sweep.integrity import write_sums
    from crackfront.sweep.results_folder import check_configuration, results_folder
    from crackfront.sweep.run_sweep import write_source
    from studies.boundary_elements import study
    from studies.boundary_elements.parameters import load_validation

    def above_the_bar(line: str) -> None:
        with tqdm.external_write_mode():
            click.echo(line)

    parameters = load_validation(configuration)
    folder = output or results_folder(configuration)
    study.check_libraries()
    check_writable(folder)
    check_configuration(configuration, folder)
    write_source(configuration, folder)
    origin = provenance(configuration.read_text(encoding="utf-8"))
    announce_compilation()
    try:
        forget_sums(folder)
        study.write_validation(
            folder,
            parameters,
            origin,
            above_the_bar,
            lambda cases: with_progress(cases, len(cases), "cases"),
        )
        write_sums(folder)
    except KeyboardInterrupt as error:
        raise StoppedError("Run the same command to continue with the next load step") from error


@commands.command(epilog=examples("python -m studies boundary-elements numbers --keep"))
@keep_option
def numbers(keep: bool) -> None:
    """Print the comparisons of docs/reference/validation for the pages.

    With --keep the table of the package, validity.csv, is written too.
    """
    from crackfront.analysis.csv_records import csv_text
    from crackfront.simulate.storage import write_text
    from studies.boundary_elements.page import kept_surfaces, kept_validity, page_parts

    if keep:
        table = csv_text(kept_validity(kept_surfaces()))
        write_text(Path("crackfront/analysis/validity.csv"), table)
    for parts, numbers, data in page_parts():
        tell("boundary-elements", parts, numbers=numbers, keep=keep, data=data)
