"""`crackfront cycle`: one approach and retraction on a field from a file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import FILE, announce_compilation, as_json, echo_json, examples

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from crackfront.core.cycle.record import CycleState
    from crackfront.core.field.kinds import Field, Interpolation


@click.command(
    epilog=examples(
        "crackfront cycle --field tile.nc --max-penetration 1 --output cycle.nc --watch",
        "crackfront cycle --field tile.nc --max-penetration 1 --step 0.05 --record fronts \\",
        "  --record energy --output cycle.nc",
    )
)
@click.option("--field", "field_file", type=FILE, required=True, help="netCDF file of the field.")
@click.option("--max-penetration", type=float, required=True, help="Largest penetration.")
@click.option(
    "--step",
    type=float,
    help="Difference of penetrations.  [default: 0.004, dissipated energies to 1%]",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0, min_open=True),
    default=1e-8,
    show_default=True,
    help="Force that may be left, relative to w_int per front length.",
)
@click.option(
    "--solver",
    default="newton",
    show_default=True,
    help="newton, or reference (the paper's algorithm); both find the same states.",
)
@click.option(
    "--max-sweeps",
    type=click.IntRange(min=1),
    default=10_000_000,
    show_default=True,
    help="Limit on the sweeps of one load step.",
)
@click.option(
    "--record",
    type=click.Choice(["fronts", "energy"]),
    multiple=True,
    help="Record the fronts, the dissipated energy too; may be repeated.",
)
@click.option(
    "--angles",
    type=click.IntRange(min=4),
    help="Sites of the front on a tile.  [default: one or more a pixel on the largest circle]",
)
@click.option(
    "--samples-per-pixel",
    type=click.FloatRange(min=0, min_open=True),
    help="Samples along a ray on a tile, per pixel.  [default: 2, or 4 where linear]",
)
@click.option(
    "--interpolation",
    type=click.Choice(["cubic", "linear"]),
    help="Pieces between samples of a ray.  [default: cubic on a tile, linear on polar samples]",
)
@click.option("--output", type=FILE, required=True, help="netCDF file of the cycle.")
@click.option(
    "--watch",
    is_flag=True,
    help="Show front and loop on the terminal as they grow; elsewhere print a line a state.",
)
@as_json
def cycle(
    field_file: Path,
    max_penetration: float,
    step: float | None,
    tolerance: float,
    solver: str,
    max_sweeps: int,
    record: tuple[str, ...],
    angles: int | None,
    samples_per_pixel: float | None,
    interpolation: Interpolation | None,
    output: Path,
    watch: bool,
    as_json: bool,
) -> None:
    """Run one approach and retraction on a field from a file.

    The field is a periodic tile work_of_adhesion(x, y), whose centre is the apex of the sphere,
    or samples work_of_adhesion(radius, angle), whose angles are the sites of the front. On rings,
    work_of_adhesion(radius), the front is a circle and the problem scalar. All quantities are in
    reduced units: R = 1, w_int = 1/pi, E' = 3/4. Surfaces of the Python library, saved by
    surface.to_netcdf, are fields as well.

    The exit code is 0 where the cycle ended by losing contact and 1 where it ended early; the
    output is written in both cases. It is 2 where the input cannot be used.
    """
    import numpy as np

    from crackfront.cli.watch import Watch
    from crackfront.core.cycle.run import run_cycle
    from crackfront.core.cycle.schedule import DEFAULT_STEP, LoadSchedule
    from crackfront.core.field.kinds import n_angle
    from crackfront.core.solver.relax import Status
    from crackfront.data.provenance import provenance
    from crackfront.simulate.files import write_cycle

    schedule = LoadSchedule(max_penetration, DEFAULT_STEP if step is None else step)
    field, directions = _contact(
        field_file, max_penetration, angles, samples_per_pixel, interpolation
    )
    if "fronts" in record and n_angle(field) == 1:
        raise ValueError(
            "--record fronts: on rings the front is a circle, whose radius every record holds as "
            "mean_radius; leave it out"
        )
    announce_compilation(err=as_json)
    shown = Watch(max_penetration) if watch else None
    outcome = run_cycle(
        field,
        schedule,
        tolerance=tolerance,
        max_sweeps=max_sweeps,
        solver=solver,
        record_fronts="fronts" in record,
        record_energy="energy" in record,
        progress=None if watch else _report,
        keep=shown,
    )
    if shown is not None:
        shown.finish()
    write_cycle(output, outcome, provenance(), directions)
    if as_json:
        echo_json(
            {
                "output": output,
                "states": outcome.penetration.size,
                "status": outcome.status.name.lower(),
                "end_penetration": outcome.end_penetration,
                "lowest_force": float(np.min(outcome.force)) if outcome.force.size else None,
            }
        )
    else:
        click.echo(f"{outcome.penetration.size} states: {output}")
    if outcome.status is not Status.LOST_CONTACT:
        raise click.ClickException(
            f"at penetration {outcome.end_penetration:.6g} {outcome.status.value}"
        )
    if not as_json:
        click.echo(f"contact was lost at penetration {outcome.end_penetration:.6g}")


def _contact(
    path: Path,
    max_penetration: float,
    angles: int | None,
    samples_per_pixel: float | None,
    interpolation: Interpolation | None,
) -> tuple[Field, NDArray[np.float64] | None]:
    """Field of a file, and the angles of its rays; a tile is kept as its splines alone."""
    from crackfront.core.adhesion import AdhesionMap
    from crackfront.simulate.contact import tile_contact
    from crackfront.simulate.field_files import read_field

    given = read_field(path, interpolation or "linear")
    if isinstance(given, AdhesionMap):
        pieces = interpolation or "cubic"
        return tile_contact(given, max_penetration, angles, samples_per_pixel, pieces), None
    if angles is None and samples_per_pixel is None:
        return given.field, given.angles
    raise ValueError(
        "--angles and --samples-per-pixel are for tiles; a polar field brings its own samples"
    )


def _report(state: CycleState) -> None:
    """Tell on a terminal which state was found last."""
    if sys.stderr.isatty():
        branch = "approach" if state.direction > 0 else "retraction"
        line = f"{branch} to penetration {state.penetration:8.4f}, radius {state.mean_radius:.4f}"
        click.echo(f"\r{line}", nl=False, err=True)
