"""`crackfront surface`: what measurements of a surface hold, and the very map as a field."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import FILE, as_json, echo_json, examples
from crackfront.cli.scans import (
    Reading,
    Sphere,
    echo_notes,
    reading_options,
    scene_of,
    sphere_options,
    surface_of,
)

if TYPE_CHECKING:
    from crackfront.core.units import Scales
    from crackfront.topography.measures import Surface
    from crackfront.topography.tile import Placement


@click.command(
    epilog=examples(
        "crackfront surface examples/scans/nanodiamond-detail.al3d",
        "crackfront surface scan.x3p --modulus 0.7MPa --poisson 0.5 --radius 20um \\",
        "    --work-of-adhesion 63mJ/m2 --field field.nc",
    )
)
@reading_options
@sphere_options(required=False)
@as_json
@click.option("--field", type=FILE, help="Write the very map as a field for crackfront cycle.")
@click.option(
    "--place",
    type=click.Choice(["tiled", "within"]),
    default="tiled",
    show_default=True,
    help="Field: let the contact go on to mirror images of the scan, or refuse that.",
)
def surface(
    reading: Reading,
    sphere: Sphere,
    as_json: bool,
    field: Path | None,
    place: Placement,
) -> None:
    """Analyse one measurement of a surface or several: spectrum, rms measures, their scales.

    SCANS are files of instruments in any format that SurfaceTopography reads. With the sphere,
    e_el and w_rms too.
    """
    from crackfront.topography.limits import surface_notes
    from crackfront.topography.machine import machine_readable
    from crackfront.topography.report import conformity_text, surface_text

    named = sphere != Sphere(None, None, None, None)
    scene = scene_of(sphere) if named or field is not None else None
    if field is not None and len(reading.scans) > 1:
        raise ValueError(
            f"--field takes one scan, not {len(reading.scans)}; name the one to press on"
        )
    found = surface_of(reading)
    notes = tuple(surface_notes(found))
    if as_json:
        echo_json(machine_readable(found, scene, notes=notes))
    else:
        click.echo(surface_text(found))
        if scene is not None:
            click.echo("\n" + conformity_text(found, scene))
        echo_notes(notes)
    if field is not None and scene is not None:
        _write_field(found, scene, place, field, quiet=as_json)


def _write_field(
    surface: Surface, scene: Scales, place: Placement, path: Path, quiet: bool
) -> None:
    """Write the map of a surface as a field."""
    from crackfront.data.provenance import provenance
    from crackfront.simulate.fields import write_field
    from crackfront.topography.tile import measured_adhesion

    [measurement] = surface.measurements
    adhesion = measured_adhesion(measurement, scene, place)
    write_field(
        path,
        adhesion,
        provenance(),
        source=f"{measurement.path}, checksum {measurement.checksum}",
        placement=place,
        **{name: getattr(scene, name) for name in scene.__slots__},
    )
    if not quiet:
        click.echo(f"field: {path}, e_el {adhesion.elastic_energy:.4g} w_int on the tile")
