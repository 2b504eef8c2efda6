"""What the commands on measured surfaces share: options, their meaning, and notes."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.report import FILE

if TYPE_CHECKING:
    from crackfront.core.units import Scales
    from crackfront.topography.files import Detrend
    from crackfront.topography.measures import Surface

Command = Callable[..., None]


@dataclass(frozen=True, slots=True)
class Reading:
    """Files of a surface and how to read them, as options say it."""

    scans: tuple[Path, ...]
    detrend: Detrend
    unit: str | None
    size: str | None
    shortest: str | None


@dataclass(frozen=True, slots=True)
class Sphere:
    """What is pressed on a surface, as options say it."""

    modulus: str | None
    poisson: float | None
    radius: str | None
    work_of_adhesion: str | None


def reading_options(command: Command) -> Command:
    """Give a command the argument SCANS and the options of :class:`Reading`, as `reading`."""
    options = (
        click.argument("scans", type=FILE, nargs=-1, required=True),
        click.option(
            "--detrend",
            type=click.Choice(["center", "height", "slope", "curvature"]),
            default="curvature",
            show_default=True,
            help="What is taken off: mean, plane of least height or of least slope, paraboloid.",
        ),
        click.option("--unit", help="Unit of length of files that state none, as in um."),
        click.option(
            "--size", help="Sides of scans that state none, in that unit, as in 50,50 or 50."
        ),
        click.option(
            "--shortest",
            help="Shortest wavelength to trust, as in 0.4um.  [default: what the file says of tip "
            "or resolution, and at least four pixels]",
        ),
    )
    return _with_options(command, "reading", Reading, options)


def sphere_options(*, required: bool) -> Callable[[Command], Command]:
    """Give a command the options of :class:`Sphere`, as `sphere`.

    Parameters
    ----------
    required : bool
        Whether the command cannot do without them.
    """
    options = (
        click.option("--modulus", required=required, help="Young's modulus, as in 0.7MPa."),
        click.option(
            "--poisson",
            type=click.FloatRange(-1, 0.5, min_open=True),
            required=required,
            help="Poisson's ratio.",
        ),
        click.option("--radius", required=required, help="Radius of the sphere, as in 1.25mm."),
        click.option("--work-of-adhesion", required=required, help="w_int, as in 63mJ/m2."),
    )
    return lambda command: _with_options(command, "sphere", Sphere, options)


def surface_of(reading: Reading) -> Surface:
    """Surface of the files that a command names."""
    from crackfront.data.quantities import si_value
    from crackfront.topography.files import Treatment
    from crackfront.topography.measures import measured_surface
    from crackfront.topography.reading import read_measurements

    limit, size = reading.shortest, reading.size
    treatment = Treatment(
        reading.detrend,
        reading.unit,
        None if size is None else _sides(size),
        None if limit is None else si_value(limit, "m", what="--shortest"),
    )
    return measured_surface(read_measurements(reading.scans, treatment))


def scene_of(sphere: Sphere) -> Scales:
    """Scene of a sphere, in SI units.

    Raises
    ------
    ValueError
        If part of it is missing or cannot be read.
    """
    from crackfront.core.units import Scales
    from crackfront.data.quantities import si_value

    modulus, poisson, radius = sphere.modulus, sphere.poisson, sphere.radius
    adhesion = sphere.work_of_adhesion
    if modulus is None or poisson is None or radius is None or adhesion is None:
        raise ValueError(
            "the sphere is incomplete; name all of --modulus, --poisson, --radius and "
            "--work-of-adhesion"
        )
    young = si_value(modulus, "Pa", what="--modulus")
    return Scales(
        radius=si_value(radius, "m", what="--radius"),
        work_of_adhesion=si_value(adhesion, "J/m^2", what="--work-of-adhesion"),
        contact_modulus=young / (1 - poisson**2),
    )


def echo_notes(notes: Iterable[str]) -> None:
    """Print what a reader must know."""
    for number, note in enumerate(notes):
        click.echo(f"  {note}" if number else f"\nNotes\n  {note}")


def _with_options(
    command: Command, name: str, kind: type[Any], options: Sequence[Callable[[Command], Command]]
) -> Command:
    """A command whose options reach it as one record."""
    fields = kind.__dataclass_fields__

    @functools.wraps(command)
    def bundled(**values: Any) -> None:
        given = {field: values.pop(field) for field in fields}
        command(**{name: kind(**given)}, **values)

    wrapped: Command = bundled
    for option in reversed(options):
        wrapped = option(wrapped)
    return wrapped


def _sides(text: str) -> tuple[float, ...]:
    """Sides that an option like 50,50 names."""
    try:
        return tuple(float(side) for side in text.split(","))
    except ValueError as error:
        raise ValueError(
            f"--size is {text!r}; write one number for each direction, as in 50,50"
        ) from error
