"""`crackfront loop`: works of adhesion of a loop, beside what is predicted for scans."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.common import (
    FILE,
    Number,
    as_json,
    echo_json,
    examples,
    options_of,
    refuse_overwriting,
    refuse_unwritable,
    refuse_without,
)
from crackfront.core.bounds import Range
from crackfront.measured.options import (
    ReadingOptions,
    for_files,
    named_options,
    reading_options,
)
from crackfront.surfaces.written_units import si_value

if TYPE_CHECKING:
    from crackfront.measured.loops.loop import MeasuredLoop
    from crackfront.measured.prediction.prediction import Prediction

_SHARE = Number(Range(0.0, 0.99))

_COLUMNS = (("force", "N"), ("radius", "m"), ("displacement", "m"))


def _columns(command: Any) -> Any:
    """Options that name the columns of a table and their units."""
    for name, unit in reversed(_COLUMNS):
        symbol = "mN" if unit == "N" else "um"
        command = click.option(f"--{name}-unit", help=f"Unit of the {name}, as in {symbol}.")(
            command
        )
        option = "--contact-radius" if name == "radius" else f"--{name}"
        command = click.option(option, name, help=f"Heading of the column of the {name}.")(command)
    return command


@click.command(
    epilog=examples(
        "crackfront loop examples/rig.csv --radius 100um --modulus 0.7MPa",
        "crackfront loop examples/rig.csv --radius 100um --modulus 0.7MPa \\",
        "    --scans examples/scans/nanodiamond-overview.al3d --work-of-adhesion 63mJ/m2",
        "crackfront loop cycle.nc",
    )
)
@click.argument("path", type=FILE, metavar="FILE")
@click.option("--radius", "sphere", help="Radius of the sphere, as in 1.25mm.")
@click.option("--modulus", help="Young's modulus, as in 0.7MPa; fitted if it is left out.")
@click.option(
    "--poisson",
    type=Number(Range(-0.99, 0.5)),
    default=0.5,
    show_default=True,
    help="Poisson's ratio.",
)
@click.option(
    "--modulus-error", type=_SHARE, default=0.0, help="Relative standard error of the modulus."
)
@click.option(
    "--radius-error", type=_SHARE, default=0.0, help="Relative standard error of the radius."
)
@click.option("--stiffness", help="Stiffness of the machine, as in 200N/m.")
@click.option("--window", help="Contact radii to average over, as in 50um:150um.")
@_columns
@click.option(
    "--scans",
    type=FILE,
    multiple=True,
    help="Scan of the surface, for a prediction. May be repeated.",
)
@options_of(ReadingOptions)
@click.option("--work-of-adhesion", help="w_int of the prediction, as in 63mJ/m2.")
@click.option("--figure", type=FILE, help="Figure of the loop; without suffix PDF and PNG.")
@as_json
@click.pass_context
def loop(
    context: click.Context,
    /,
    path: Path,
    sphere: str | None,
    modulus: str | None,
    poisson: float,
    scans: tuple[Path, ...],
    work_of_adhesion: str | None,
    figure: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Evaluate a measured or simulated loop of force, contact radius and displacement.

    FILE is a text with headings and two or three of these columns. Works of adhesion are averaged
    over the same contact radii in both branches, as in simulations. FILE may also be a cycle in
    netCDF that `crackfront cycle` or a sweep has written. Its works of adhesion are those of the
    simulation; they are in reduced units unless the file states a sphere, or --radius, --modulus
    and --work-of-adhesion name one.

    Options of reading, from --channel to --longest, are those of `crackfront predict` and apply to
    the --scans.
    """
    from crackfront.measured.loops.simulated_loop import is_netcdf

    if scans and work_of_adhesion is None:
        raise ValueError("a prediction for --scans needs w_int; give --work-of-adhesion")
    reading = _reading(scans, options)
    of_rig = {name: options[name] for name in options if name not in ReadingOptions.model_fields}
    refuse_without(context, "modulus", "poisson")
    refuse_overwriting([path, *scans], {"--figure": figure})
    if figure is not None:
        refuse_unwritable(figure.parent)
    radius = None if sphere is None else si_value(sphere, "m", what="--radius")
    young = None if modulus is None else si_value(modulus, "Pa", what="--modulus")
    contact_modulus = None if young is None else young / (1 - poisson**2)
    adhesion = (
        None
        if work_of_adhesion is None
        else si_value(work_of_adhesion, "J/m^2", what="--work-of-adhesion")
    )
    simulated = is_netcdf(path)
    of_sphere = simulated and (sphere is not None or modulus is not None)
    if adhesion is not None and not scans and not of_sphere:
        sphere_too = ", or --radius and --modulus for SI units" if simulated else ""
        raise ValueError(f"--work-of-adhesion is of a prediction; name --scans too{sphere_too}")
    if simulated:
        if given := [name for name, value in of_rig.items() if value]:
            option = {"radius": "contact-radius"}.get(given[0], given[0].replace("_", "-"))
            raise ValueError(f"{path} is a simulated cycle without a rig; leave out --{option}")
        found = _simulated(path, radius, contact_modulus, adhesion)
        if scans and found.reduced:
            raise ValueError(
                f"{path} is in reduced units, and predictions are not; give --radius and --modulus"
            )
    else:
        found = _measured(path, radius, contact_modulus, of_rig)
    predicted, failure = None, None
    if scans and adhesion is not None:
        try:
            predicted = _predicted(scans, reading, found, adhesion)
        except (ValueError, OSError) as error:
            failure = error  # The loop is shown, drawn and printed all the same.
    if as_json:
        from crackfront.measured.loops.comparison import machine_readable

        echo_json(machine_readable(found, predicted))
    else:
        from crackfront.measured.loops.comparison import comparison_lines

        lines = [] if predicted is None else ["", *comparison_lines(found, predicted)]
        click.echo("\n".join([repr(found), *lines]))
    if figure is not None:
        from crackfront.measured.loops.loop_drawing import loop_figure
        from crackfront.plots.style import save_figure

        for file in save_figure(loop_figure(found, predicted), figure):
            click.echo(f"figure: {file}", err=as_json)
    if failure is not None:
        raise failure


def _reading(scans: tuple[Path, ...], options: dict[str, Any]) -> dict[str, Any]:
    """Options of reading that a command names, refused where they are wrong or without scans."""
    named = named_options(ReadingOptions, options)
    if named and not scans:
        raise ValueError(f"--{named[0].replace('_', '-')} is of scans; name --scans too")
    given = for_files({name: options[name] for name in named}, scans)
    reading_options(given, len(scans), "--")
    return given


def _measured(
    path: Path, radius: float | None, contact_modulus: float | None, of_rig: dict[str, Any]
) -> MeasuredLoop:
    """Loop of a table, with the options of the rig and of the columns."""
    from crackfront.measured.loops.loop import Rig, analyse_loop
    from crackfront.measured.loops.recording import read_recording

    named = {name: of_rig[name] for name, _ in _COLUMNS if of_rig[name]}
    units = {name: of_rig[f"{name}_unit"] for name, _ in _COLUMNS if of_rig[f"{name}_unit"]}
    recording = read_recording(path, named, units)
    if radius is None:
        raise ValueError(f"{path} does not state the sphere; give its --radius, as in 1.25mm")
    stiffness, window = of_rig["stiffness"], of_rig["window"]
    rig = Rig(
        radius=radius,
        contact_modulus=contact_modulus,
        modulus_error=of_rig["modulus_error"],
        radius_error=of_rig["radius_error"],
        stiffness=None if stiffness is None else si_value(stiffness, "N/m", what="--stiffness"),
        window=None if window is None else _window(window),
    )
    return analyse_loop(recording, rig)


def _simulated(
    path: Path, radius: float | None, contact_modulus: float | None, adhesion: float | None
) -> MeasuredLoop:
    """Loop of a simulated cycle, in SI units if its file or all three options state a sphere."""
    from crackfront.core.units import Scales
    from crackfront.measured.loops.simulated_loop import simulated_loop
    from crackfront.simulate.storage import read_dataset
    from crackfront.surfaces.si_units import in_si_units, stated_scales

    cycle = read_dataset(path)
    if "direction" not in cycle.variables:
        raise ValueError(f"{path} holds no cycle; name a file of crackfront cycle or of a sweep")
    if radius is None and contact_modulus is None:
        return simulated_loop(cycle, str(path))
    if stated_scales(cycle) is not None:
        raise ValueError(f"{path} states its sphere; leave out --radius and --modulus")
    if radius is None or contact_modulus is None or adhesion is None:
        raise ValueError(
            f"{path} is in reduced units; give --radius, --modulus and --work-of-adhesion for "
            "those of SI, or none of them"
        )
    scales = Scales(radius, adhesion, contact_modulus)
    return simulated_loop(in_si_units(cycle, scales), str(path))


def _window(text: str) -> tuple[float, float]:
    """Two contact radii (Units: m)."""
    ends = text.split(":")
    if len(ends) != 2:
        raise ValueError(f"--window is {text!r}; give two contact radii, as in 50um:150um")
    low, high = (si_value(end, "m", what="--window") for end in ends)
    return low, high


def _predicted(
    scans: tuple[Path, ...], reading: dict[str, Any], found: MeasuredLoop, adhesion: float
) -> Prediction:
    """What is predicted for the sphere on a surface of scans, by the modulus of the loop."""
    from crackfront.core.units import Scales
    from crackfront.measured.predict import predict

    scales = Scales(found.sphere_radius, adhesion, found.contact_modulus.value)
    return predict(scans, scales, **reading)
