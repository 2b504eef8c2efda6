"""Numerical errors: measure them scene by scene, and report all of them."""

from __future__ import annotations

import difflib
from pathlib import Path

import click

from crackfront.cli.report import FILE, announce_compilation, examples

_output = click.option(
    "--output",
    type=FILE,
    default=Path("results/accuracy"),
    show_default=True,
    help="Folder of the results.",
)

_SHOWN = ("chemical-0.0025", "chemical-0.04", "flat-0.16", "h03-0.04")
"""Scenes of the figure of time against error."""

_ASKED = (0.1, 0.03, 0.01)
"""Errors of k whose coverage is measured."""


@click.command(
    epilog=examples(
        "crackfront accuracy flat-0.04",
        "crackfront accuracy flat-0.04 --study asked --realisations 4",
    )
)
@click.argument("scene")
@_output
@click.option(
    "--study",
    type=click.Choice(["knobs", "asked", "averages", "coverage"]),
    default="knobs",
    show_default=True,
    help="Errors of single knobs; of numerics that the laws choose; of schedules and tiles; true "
    "errors beside the stated ones.",
)
@click.option(
    "--realisations", type=click.IntRange(min=2), default=8, show_default=True, help="Surfaces."
)
def accuracy(scene: str, output: Path, study: str, realisations: int) -> None:
    """Measure the errors of one scene."""
    from crackfront.data.provenance import provenance
    from crackfront.simulate.run import compile_solver
    from crackfront.studies.accuracy.coverage import held_out_coverage
    from crackfront.studies.accuracy.files import write_coverage, write_errors, write_samples
    from crackfront.studies.accuracy.sampling import sampling_errors
    from crackfront.studies.accuracy.scenes import SCENES
    from crackfront.studies.accuracy.study import scene_errors

    if scene not in SCENES:
        near = difflib.get_close_matches(scene, SCENES, n=1)
        names = ", ".join(SCENES)
        hint = f"did you mean {near[0]}?" if near else f"choose one of {names}"
        raise click.BadParameter(f"there is no scene {scene!r}; {hint}")
    announce_compilation()
    compile_solver("newton")
    chosen, path = SCENES[scene], output / f"{study}-{scene}.nc"
    if study in ("knobs", "asked"):
        settings = chosen.single_settings if study == "knobs" else chosen.asked_settings
        errors = scene_errors(chosen, settings, range(realisations), click.echo)
        write_errors(path, errors, provenance())
    elif study == "averages":
        samples = sampling_errors(chosen, range(realisations), click.echo)
        write_samples(path, chosen, samples, provenance())
    else:
        found = held_out_coverage(chosen, _ASKED, realisations, click.echo)
        write_coverage(path, chosen, found, provenance())
    click.echo(f"errors: {path}")


@click.command(
    "accuracy-report",
    epilog=examples(
        "crackfront accuracy-report --page docs/accuracy.md",
    ),
)
@_output
@click.option("--page", type=FILE, help="Page whose tables are written anew, as docs/accuracy.md.")
def accuracy_report(output: Path, page: Path | None) -> None:
    """Fit the laws, write the tables, and draw the figures of all measured scenes."""
    from crackfront.data.files import write_text
    from crackfront.plots.style import save_figure
    from crackfront.studies.accuracy.drawing import laws_figure, work_precision_figure
    from crackfront.studies.accuracy.files import (
        laws_text,
        read_coverage,
        read_errors,
        read_samples,
    )
    from crackfront.studies.accuracy.fitting import fit_laws
    from crackfront.studies.accuracy.report import accuracy_report, accuracy_tables, filled_page
    from crackfront.studies.accuracy.scenes import SCENES
    from crackfront.studies.accuracy.study import joined

    def stored(study: str) -> dict[str, Path]:
        paths = {name: output / f"{study}-{name}.nc" for name in SCENES}
        return {name: path for name, path in paths.items() if path.exists()}

    knobs, asked = (
        {name: read_errors(path) for name, path in stored(study).items()}
        for study in ("knobs", "asked")
    )
    names = [name for name in SCENES if name in knobs | asked]
    if not names:
        raise ValueError(f"{output} holds no measured errors; run crackfront accuracy first")
    studies = {
        name: joined(*(part[name] for part in (knobs, asked) if name in part)) for name in names
    }
    samples = [read_samples(path) for path in stored("averages").values()]
    coverages = [read_coverage(path) for path in stored("coverage").values()]
    laws = list(fit_laws(study for study in knobs.values() if study.scene.single_knobs))
    write_text(output / "laws.csv", laws_text(laws))
    tables = accuracy_tables(list(studies.values()), samples, coverages)
    write_text(output / "accuracy.md", accuracy_report(tables))
    if page is not None:
        text = page.read_text(encoding="utf-8")
        write_text(page, filled_page(text, tables))
    shown = [studies[name] for name in _SHOWN if name in studies]
    flat = [study for study in knobs.values() if study.scene.shape == "flat"]
    drawn = {}
    if shown:
        drawn["work-precision"] = work_precision_figure(shown)
    if flat:
        drawn["laws"] = laws_figure(flat, laws)
    for name, figure in drawn.items():
        for path in save_figure(figure, output / name):
            click.echo(f"figure: {path}")
    click.echo(f"laws: {output / 'laws.csv'}")
    click.echo(f"tables: {output / 'accuracy.md'}")
