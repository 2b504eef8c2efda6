"""`crackfront validate`: the crack-front model against boundary elements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import FILE, announce_compilation, examples, refuse_unwritable

if TYPE_CHECKING:
    from crackfront.data.provenance import Provenance
    from crackfront.studies.boundary_elements.cycle import BoundaryCycle
    from crackfront.studies.boundary_elements.parameters import Case


@click.command(
    epilog=examples(
        "crackfront validate config/validation.yaml",
        "crackfront validate config/validation-512.yaml --output results/validation-512",
    )
)
@click.argument("configuration", type=FILE)
@click.option("--output", type=FILE, help="Folder of the results.  [default: results/<name>]")
def validate(configuration: Path, output: Path | None) -> None:
    """Run one rough sphere by boundary elements and by the crack front, and compare them.

    Every load step of the boundary elements is on disk at once: a run that is killed goes on with
    the next one.
    """
    from crackfront.data.files import write_text
    from crackfront.data.provenance import provenance
    from crackfront.data.records import write_record, write_records
    from crackfront.plots.style import save_figure
    from crackfront.studies.boundary_elements.configuration import load_validation
    from crackfront.studies.boundary_elements.drawing import validation_figure
    from crackfront.studies.boundary_elements.parameters import validation_cases
    from crackfront.studies.boundary_elements.report import validation_report
    from crackfront.studies.boundary_elements.study import refuse_missing_libraries, validation
    from crackfront.sweep.configuration import results_folder

    parameters = load_validation(configuration)
    folder = output or results_folder(configuration)
    refuse_missing_libraries()
    refuse_unwritable(folder)
    origin = provenance(configuration.read_text(encoding="utf-8"))
    announce_compilation()
    cycles = [
        (case, _boundary_cycle(case, folder / f"{case.stem}.nc", origin))
        for case in validation_cases(parameters)
    ]
    found = validation(parameters, cycles, click.echo)
    for name, rows, along in (
        ("differences", found.differences, "case"),
        ("speed", found.speeds, "case"),
        ("rotation", found.effects, "surface"),
        ("jumps-boundary", found.boundary_jumps, "jump"),
        ("jumps-front", found.front_jumps, "jump"),
    ):
        if rows:
            write_records(folder / f"{name}.nc", rows, along, origin)
    if found.picture is not None:
        write_record(folder / "picture.nc", found.picture, origin)
        drawn = validation_figure(found.picture)
        for path in save_figure(drawn, folder / "validation"):
            click.echo(f"figure: {path}")
    report = validation_report(found.differences, found.speeds, found.effects)
    write_text(folder / "validation.md", report)
    click.echo(f"tables: {folder / 'validation.md'}")


def _boundary_cycle(case: Case, path: Path, origin: Provenance) -> BoundaryCycle:
    """Cycle of a case: read, continued or computed."""
    from crackfront.data.records import read_record, write_record
    from crackfront.studies.boundary_elements.contact import half_space_contact
    from crackfront.studies.boundary_elements.cycle import RUNNING, BoundaryCycle, boundary_cycle

    def keep(cycle: BoundaryCycle) -> None:
        write_record(path, cycle, origin, case=case.label)
        branch = "approach" if cycle.direction[-1] > 0 else "retraction"
        click.echo(
            f"{case.label}: {branch} to {cycle.penetration[-1]:.4g}, force {cycle.force[-1]:.4f}, "
            f"{cycle.seconds[-1]:.2f} s"
        )

    known = read_record(path, BoundaryCycle) if path.exists() else None
    if known is not None and known.status != RUNNING:
        return known
    heights = case.heights()
    contact = half_space_contact(
        heights, case.pixel, case.interaction_range, case.schedule.max_penetration
    )
    return boundary_cycle(
        contact,
        case.schedule,
        case.elastic_energy,
        case.shown_penetration,
        tolerance=case.tolerance,
        resume=known,
        keep=keep,
    )
