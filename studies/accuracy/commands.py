"""Numerical errors: measure them scene by scene, and report all of them."""

from __future__ import annotations

import difflib
from pathlib import Path

import click

from crackfront.cli.report import (
    FILE,
    announce_compilation,
    announce_cost,
    examples,
    refuse_unwritable,
    whole,
)
from crackfront.data.bounds import Range


@click.group()
def commands() -> None:
    """Errors of the numerics, the fit of their laws, and what the errors rest on."""


_output = click.option(
    "--output",
    type=FILE,
    default=Path("results/accuracy"),
    show_default=True,
    help="Folder of the results.",
)


@commands.command(
    epilog=examples(
        "python -m studies accuracy scene flat-0.04",
        "python -m studies accuracy scene flat-0.04 --study asked --realisations 4",
    )
)
@click.argument("scene")
@_output
@click.option(
    "--study",
    type=click.Choice(["knobs", "asked", "unseen", "averages", "coverage"]),
    default="knobs",
    show_default=True,
    help="Errors of single knobs; of numerics that the laws choose; of these on surfaces without a "
    "part in the laws; of schedules and tiles; true errors beside the stated ones.",
)
@click.option(
    "--realisations", type=whole(Range(2, 1e6)), default=8, show_default=True, help="Surfaces."
)
def scene(scene: str, output: Path, study: str, realisations: int) -> None:
    """Measure the errors of one scene."""
    from crackfront.data.files import write_dataset
    from crackfront.data.provenance import provenance
    from crackfront.simulate.run import compile_solver
    from studies.accuracy.files import SECONDS, STUDIES
    from studies.accuracy.scenes import SCENES

    if scene not in SCENES:
        near = difflib.get_close_matches(scene, SCENES, n=1)
        names = ", ".join(SCENES)
        hint = f"did you mean {near[0]}?" if near else f"choose one of {names}"
        raise click.BadParameter(f"there is no scene {scene!r}; {hint}")
    refuse_unwritable(output)
    announce_cost(realisations * SECONDS[study](SCENES[scene]))
    announce_compilation()
    compile_solver("newton")
    found = STUDIES[study](SCENES[scene], realisations, click.echo)
    path = output / f"{study}-{scene}.nc"
    write_dataset(path, found, provenance())
    click.echo(f"errors: {path}")


@commands.command(
    "report", epilog=examples("python -m studies accuracy report --page docs/accuracy.md")
)
@_output
@click.option("--page", type=FILE, help="Page whose tables are written anew, as docs/accuracy.md.")
def accuracy_report(output: Path, page: Path | None) -> None:
    """Fit the laws, write the tables, and draw the figures of all measured scenes."""
    from studies.accuracy.report import write_report

    write_report(output, page, click.echo)
