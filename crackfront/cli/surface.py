"""`crackfront surface` and `crackfront predict`: what scans of a surface hold, and its adhesion."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.report import (
    FILE,
    Number,
    announce_compilation,
    as_json,
    echo_json,
    examples,
    refuse_unwritable,
    whole,
)
from crackfront.data.bounds import SEED, Range, in_time

if TYPE_CHECKING:
    from crackfront.core.units import Scales
    from crackfront.topography.measures import MeasuredSurface
    from crackfront.topography.prediction import Prediction
    from crackfront.topography.simulated import Simulated
    from crackfront.topography.tile import Placement

Command = Callable[..., None]

_RESULTS = Path("results/predict")

_EXIT_CODES = {"applies": 0, "applies with reservations": 3, "does not apply": 4}


@dataclass(frozen=True, slots=True)
class _Reading:
    """Files of a surface, and the words of :class:`crackfront.topography.wording.Wording`."""

    scans: tuple[Path, ...]
    channel: tuple[str, ...]
    crop: tuple[str, ...]
    detrend: str
    mask: tuple[str, ...]
    unit: str | None
    size: str | None
    shortest: str | None
    longest: str | None


@dataclass(frozen=True, slots=True)
class _Sphere:
    """What is pressed on a surface, as options say it."""

    modulus: str | None
    poisson: float | None
    radius: str | None
    work_of_adhesion: str | None


def _bundled(
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


def _reading_options(command: Command) -> Command:
    """Give a command the argument SCANS and the options of :class:`_Reading`, as `reading`."""
    options = (
        click.argument("scans", type=FILE, nargs=-1, required=True),
        click.option(
            "--channel",
            multiple=True,
            help="Channel by name or number, for files with several; once, or once for each scan.",
        ),
        click.option(
            "--crop",
            multiple=True,
            help="Part of the scan to use, as in 2um:8um,0um:5um; once, or once for each scan.",
        ),
        click.option(
            "--detrend",
            default="curvature",
            show_default=True,
            metavar="NAME|ORDER",
            help="What is taken off: center (mean), height (plane of least height), slope (that of "
            "least slope), curvature (paraboloid), or the polynomial of an order up to 9.",
        ),
        click.option(
            "--mask",
            multiple=True,
            help="What the levelling leaves out and the map keeps: a part of the scan as above, or "
            "a file with a number for each point, not zero there. May be repeated.",
        ),
        click.option("--unit", help="Unit of length of files that state none, as in um."),
        click.option(
            "--size", help="Sides of scans that state none, in that unit, as in 50,50 or 50."
        ),
        click.option(
            "--shortest",
            help="Shortest wavelength to trust, as in 0.4um.  [default: found by resolution, "
            "noise, what the file says of its tip, and four pixels]",
        ),
        click.option(
            "--longest",
            help="Longest wavelength to trust.  [default: found by what is left of the form, and "
            "half a side]",
        ),
    )
    return _bundled(command, "reading", _Reading, options)


def _sphere_options(*, required: bool) -> Callable[[Command], Command]:
    """Give a command the options of :class:`_Sphere`, as `sphere`."""
    options = (
        click.option("--modulus", required=required, help="Young's modulus, as in 0.7MPa."),
        click.option(
            "--poisson",
            type=Number(Range(-0.99, 0.5)),
            required=required,
            help="Poisson's ratio.",
        ),
        click.option("--radius", required=required, help="Radius of the sphere, as in 1.25mm."),
        click.option("--work-of-adhesion", required=required, help="w_int, as in 63mJ/m2."),
    )
    return lambda command: _bundled(command, "sphere", _Sphere, options)


@click.command(
    epilog=examples(
        "crackfront predict examples/scans/nanodiamond-detail.al3d --modulus 0.7MPa \\",
        "    --poisson 0.5 --radius 1.25mm --work-of-adhesion 63mJ/m2 --json",
    )
)
@_reading_options
@_sphere_options(required=True)
@click.option(
    "--range",
    "attraction_range",
    help="Range of the attraction, as in 0.3nm.  [default: 0.5nm, of van der Waals forces]",
)
@as_json
@click.option(
    "--simulate", is_flag=True, help="Run the simulations that the prediction stands for."
)
@click.option(
    "--realisations",
    type=whole(Range(1, 1e6)),
    default=3,
    show_default=True,
    help="Synthesised surfaces that --simulate runs.",
)
@click.option("--seed", type=whole(SEED), default=0, show_default=True, help="Seed of their noise.")
@click.option(
    "--figure",
    type=FILE,
    help="Figure, without suffix; PDF and PNG.  [default: results/predict/<first scan>]",
)
@click.option("--no-figure", is_flag=True, help="Draw none: most of the time goes into it.")
@click.pass_context
def predict(
    context: click.Context,
    reading: _Reading,
    sphere: _Sphere,
    attraction_range: str | None,
    as_json: bool,
    simulate: bool,
    realisations: int,
    seed: int,
    figure: Path | None,
    no_figure: bool,
) -> None:
    """Predict how strongly a soft sphere sticks to a measured surface, from the fitted law.

    SCANS are files of instruments in any format that SurfaceTopography reads, one measurement of
    the surface or several. w = w_int - e_el -+ k e_el with k by the law of straight fronts
    (crackfront law).

    Exit code 0: the theory applies. 3: it applies with reservations, which are named. 4: it does
    not apply; nothing is predicted, and it is said what modulus, radius or roughness would do.
    """
    from crackfront.topography.prediction import predicted, prediction_notes, surface_notes
    from crackfront.topography.report import (
        conformity_text,
        machine_readable,
        prediction_text,
        simulation_text,
        surface_text,
        verdict_text,
    )
    from crackfront.topography.verdict import verdict

    scales = _scales_of(sphere)
    reach = _range_of(attraction_range)
    stem = _RESULTS / reading.scans[0].stem if figure is None else figure
    if not no_figure:
        refuse_unwritable(stem.parent)
    found = _surface_of(reading)
    ruling = verdict(found, scales, reach)
    if ruling.outcome == "does not apply":
        if as_json:
            echo_json(machine_readable(found, scales, ruling=ruling))
        else:
            energy = conformity_text(found, scales)
            click.echo(f"{surface_text(found)}\n\n{verdict_text(ruling)}\n\n{energy}")
            _echo_notes(surface_notes(found))
        context.exit(_EXIT_CODES[ruling.outcome])
    prediction = predicted(found, scales)
    ruling = verdict(found, scales, reach, prediction)
    if not as_json:
        texts = surface_text(found), verdict_text(ruling), prediction_text(prediction)
        click.echo("\n\n".join(texts))
        _echo_notes(prediction_notes(found, prediction))
    paths = () if no_figure else _drawn(found, prediction, stem)
    outcome = _simulated(found, scales, realisations, seed, as_json) if simulate else None
    if as_json:
        echo_json(machine_readable(found, scales, prediction, outcome, ruling))
    else:
        for path in paths:
            click.echo(f"figure: {path}")
        if outcome is not None:
            click.echo(simulation_text(outcome))
    context.exit(_EXIT_CODES[ruling.outcome])


def _drawn(surface: MeasuredSurface, prediction: Prediction, stem: Path) -> tuple[Path, ...]:
    """Files of the figure of a prediction."""
    from crackfront.plots.style import save_figure
    from crackfront.topography.drawing import prediction_figure

    return tuple(save_figure(prediction_figure(surface, prediction), stem))


def _range_of(text: str | None) -> float | None:
    """Range of attraction that an option names, in metres."""
    from crackfront.data.written_units import si_value

    return None if text is None else si_value(text, "m", what="--range")


def _simulated(
    surface: MeasuredSurface, scales: Scales, realisations: int, seed: int, quiet: bool
) -> Simulated:
    """Run the simulations behind a prediction."""
    from crackfront.topography.simulated import prediction_plan, simulated

    plan = prediction_plan(surface, scales, realisations, seed)
    if not quiet:
        announce_compilation()
        if plan.remark:
            click.echo(plan.remark)
        click.echo(
            f"simulating {realisations} surface(s), about {in_time(plan.expected_seconds)} ..."
        )
    return simulated(plan, scales)


@click.command(
    epilog=examples(
        "crackfront surface examples/scans/nanodiamond-detail.al3d",
        "crackfront surface scan.x3p --modulus 0.7MPa --poisson 0.5 --radius 20um \\",
        "    --work-of-adhesion 63mJ/m2 --field field.nc",
    )
)
@_reading_options
@_sphere_options(required=False)
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
    reading: _Reading,
    sphere: _Sphere,
    as_json: bool,
    field: Path | None,
    place: Placement,
) -> None:
    """Analyse one measurement of a surface or several: spectrum, rms measures, their scales.

    SCANS are files of instruments in any format that SurfaceTopography reads. With the sphere,
    e_el and w_rms too.
    """
    from crackfront.topography.prediction import surface_doubts, surface_notes
    from crackfront.topography.report import conformity_text, machine_readable, surface_text

    named = sphere != _Sphere(None, None, None, None)
    scales = _scales_of(sphere) if named or field is not None else None
    if field is not None and len(reading.scans) > 1:
        raise ValueError(
            f"--field takes one scan, not {len(reading.scans)}; name the one to press on"
        )
    found = _surface_of(reading)
    if as_json:
        echo_json(machine_readable(found, scales))
    else:
        click.echo(surface_text(found))
        if scales is not None:
            click.echo("\n" + conformity_text(found, scales))
        _echo_notes([*surface_notes(found), *surface_doubts(found)])
    if field is not None and scales is not None:
        _write_field(found, scales, place, field, quiet=as_json)


def _write_field(
    surface: MeasuredSurface, scales: Scales, place: Placement, path: Path, quiet: bool
) -> None:
    """Write the map of a surface as a field."""
    from crackfront.data.provenance import provenance
    from crackfront.simulate.fields import write_field
    from crackfront.topography.tile import measured_adhesion

    [one] = surface.scans
    measurement = one.trusted_measurement
    adhesion = measured_adhesion(measurement, scales, place)
    write_field(
        path,
        adhesion,
        provenance(),
        source=f"{measurement.path}, checksum {measurement.checksum}",
        placement=place,
        **{name: getattr(scales, name) for name in scales.__slots__},
    )
    if not quiet:
        click.echo(f"field: {path}, e_el {adhesion.e_el:.4g} w_int on the tile")


def _surface_of(reading: _Reading) -> MeasuredSurface:
    """Surface of the files that a command names."""
    from crackfront.topography.wording import Wording

    words = {name: getattr(reading, name) for name in reading.__slots__ if name != "scans"}
    return Wording(**words, prefix="--").surface(reading.scans)


def _scales_of(sphere: _Sphere) -> Scales:
    """Scene of a sphere, in SI units."""
    from crackfront.core.units import Scales
    from crackfront.data.written_units import si_value

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


def _echo_notes(notes: Iterable[str]) -> None:
    """Print what a reader must know."""
    for number, note in enumerate(notes):
        click.echo(f"  {note}" if number else f"\nNotes\n  {note}")
