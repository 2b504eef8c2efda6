"""`crackfront loop`: works of adhesion of a loop, and their prediction from scans."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.answers import echo_json
from crackfront.cli.option_types import (
    FILE,
    Number,
    as_json,
    check_needed_option,
    examples,
    option_name,
    options_of,
)
from crackfront.cli.output_files import check_overwriting, check_replaced_page, check_writable
from crackfront.core.bounds import Range
from crackfront.measured.options import (
    ReadingOptions,
    for_files,
    named_options,
    reading_options,
)
from crackfront.surfaces.written_units import si_value

if TYPE_CHECKING:
    from crackfront.measured.loops.loop_result import MeasuredLoop
    from crackfront.measured.prediction.prediction import Prediction

_ERROR = Number(Range(0.0, 0.99))
"""Type of a relative standard error."""

_COLUMNS = {"force": "force", "radius": "contact_radius", "displacement": "displacement"}
"""Options that name a column of a table, by the column."""

_Callback = Callable[[click.Context, click.Parameter, str | None], Any]


def _in_si(unit: str) -> _Callback:
    """Callback that gives an option its value in a unit of SI."""

    def value(_: click.Context, option: click.Parameter, text: str | None) -> float | None:
        return None if text is None else si_value(text, unit, name=option.opts[0])

    return value


def _window(
    _: click.Context, option: click.Parameter, text: str | None
) -> tuple[float, float] | None:
    """Callback that gives an option two contact radii (Units: m)."""
    if text is None:
        return None
    ends = text.split(":")
    if len(ends) != 2:
        raise ValueError(f"--window is {text!r}; give two contact radii, as in 50um:150um")
    low, high = (si_value(end, "m", name=option.opts[0]) for end in ends)
    return low, high


@click.command(
    epilog=examples(
        "crackfront loop examples/rig.csv --radius 100um --modulus 0.7MPa",
        "crackfront loop examples/rig.csv --radius 100um --modulus 0.7MPa \\",
        "    --scans examples/scans/nanodiamond-overview.al3d --work-of-adhesion 63mJ/m2",
        "crackfront loop cycle.nc",
    )
)
@click.argument("path", type=FILE, metavar="FILE")
@click.option("--radius", callback=_in_si("m"), help="Radius of the sphere, as in 1.25mm.")
@click.option(
    "--modulus",
    callback=_in_si("Pa"),
    help="Young's modulus, as in 0.7MPa; fitted if it is left out.",
)
@click.option(
    "--poisson",
    type=Number(Range(-0.99, 0.5)),
    default=0.5,
    show_default=True,
    help="Poisson's ratio.",
)
@click.option(
    "--modulus-error", type=_ERROR, default=0.0, help="Relative standard error of the modulus."
)
@click.option(
    "--radius-error", type=_ERROR, default=0.0, help="Relative standard error of the radius."
)
@click.option("--stiffness", callback=_in_si("N/m"), help="Stiffness of the machine, as in 200N/m.")
@click.option("--window", callback=_window, help="Contact radii to average over, as in 50um:150um.")
@click.option("--loop", type=click.IntRange(min=1), help="Which of several loops, from 1.")
@click.option(
    "--segment", type=click.Choice(("approach", "retract")), help="Branch to evaluate alone."
)
@click.option(
    "--invert",
    type=click.Choice(("force", "displacement")),
    multiple=True,
    help="Column with the opposite sign, as a force that is positive if it pulls.",
)
@click.option("--force", help="Heading of the column of the force.")
@click.option("--force-unit", help="Unit of the force, as in mN.")
@click.option("--contact-radius", help="Heading of the column of the radius.")
@click.option("--radius-unit", help="Unit of the radius, as in um.")
@click.option("--displacement", help="Heading of the column of the displacement.")
@click.option("--displacement-unit", help="Unit of the displacement, as in um.")
@click.option(
    "--scans",
    type=FILE,
    multiple=True,
    help="Scan of the surface, for a prediction. May be repeated.",
)
@options_of(ReadingOptions)
@click.option(
    "--work-of-adhesion",
    callback=_in_si("J/m^2"),
    help="w_int of the prediction, as in 63mJ/m2.",
)
@click.option("--figure", type=FILE, help="Figure of the loop; without suffix PDF and PNG.")
@click.option("--report", type=FILE, help="Page of HTML to send: numbers, reservations and figure.")
@as_json
@click.pass_context
def loop(
    context: click.Context,
    /,
    path: Path,
    radius: float | None,
    modulus: float | None,
    poisson: float,
    scans: tuple[Path, ...],
    work_of_adhesion: float | None,
    figure: Path | None,
    report: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Evaluate a measured or simulated loop of force, contact radius and displacement.

    FILE is a text with headings and two or three of these columns. Works of adhesion are averaged
    over the same contact radii in both branches, as in simulations. FILE may also be a cycle in
    netCDF that `crackfront cycle` or a sweep has written, with the works of adhesion of
    the simulation. They are in reduced units unless the file states a sphere, or --radius,
    --modulus and --work-of-adhesion name one.

    Options of reading, from --channel to --longest, are the same as in `crackfront predict` and
    apply to the --scans.
    """
    from crackfront.measured.scan.netcdf import is_netcdf

    if scans and work_of_adhesion is None:
        raise ValueError("a prediction for --scans needs w_int; give --work-of-adhesion")
    reading = _reading(scans, options)
    rig = {name: options[name] for name in options if name not in ReadingOptions.model_fields}
    check_needed_option(context, "modulus", "poisson")
    check_overwriting([path, *scans], {"--figure": figure, "--report": report})
    check_replaced_page("--report", report)
    for output in filter(None, (figure, report)):
        check_writable(output.parent)
    contact_modulus = None if modulus is None else modulus / (1 - poisson**2)
    if is_netcdf(path):
        if names := [name for name, value in rig.items() if value]:
            option = option_name(names[0])
            raise ValueError(f"{path} is a simulated cycle without a rig; leave out {option}")
        result = _simulated(path, radius, contact_modulus, work_of_adhesion, bool(scans))
    else:
        if work_of_adhesion is not None and not scans:
            raise ValueError("--work-of-adhesion is of a prediction; name --scans too")
        result = _measured(path, radius, contact_modulus, rig)
    prediction, failure = None, None
    if work_of_adhesion is not None and scans:
        try:
            prediction = _prediction(scans, reading, result, work_of_adhesion)
        except (ValueError, OSError) as error:
            failure = error  # The loop is printed and drawn all the same.
    _print(result, prediction, as_json=as_json)
    if figure is not None:
        from crackfront.measured.loops.loop_drawing import loop_figure
        from crackfront.plots.style import save_figure

        for file in save_figure(loop_figure(result, prediction), figure):
            click.echo(f"figure: {file}", err=as_json)
    if report is not None:
        from crackfront.measured.loops.loop_report import loop_report
        from crackfront.simulate.storage import write_text

        write_text(report, loop_report(result, prediction, path.name))
        click.echo(f"report: {report}", err=as_json)
    if failure is not None:
        raise failure


def _reading(scans: tuple[Path, ...], options: dict[str, Any]) -> dict[str, Any]:
    """Options of reading scans that the command names; ValueError without scans."""
    names = named_options(ReadingOptions, options)
    if names and not scans:
        raise ValueError(f"{option_name(names[0])} is of scans; name --scans too")
    reading = for_files({name: options[name] for name in names}, scans)
    reading_options(reading, len(scans), "--")
    return reading


def _measured(
    path: Path, radius: float | None, contact_modulus: float | None, options: dict[str, Any]
) -> MeasuredLoop:
    """Loop of a table, with the options of the rig and of the columns."""
    from crackfront.measured.loops.analysis import analyse_loop
    from crackfront.measured.loops.loop_choice import chosen_loop
    from crackfront.measured.loops.loop_table import read_recording
    from crackfront.measured.loops.rig import Rig

    heads = {name: options[option] for name, option in _COLUMNS.items() if options[option]}
    units = {name: options[f"{name}_unit"] for name in _COLUMNS if options[f"{name}_unit"]}
    recording = read_recording(path, heads, units)
    if radius is None:
        raise ValueError(f"{path} does not state the sphere; give its --radius, as in 1.25mm")
    rig_options = ("modulus_error", "radius_error", "stiffness", "window", "segment")
    rig = Rig(radius, contact_modulus, **{name: options[name] for name in rig_options})
    recording = chosen_loop(recording.inverted(options["invert"]), options["loop"])
    return analyse_loop(recording, rig)


def _simulated(
    path: Path,
    radius: float | None,
    contact_modulus: float | None,
    work_of_adhesion: float | None,
    is_compared: bool,
) -> MeasuredLoop:
    """Loop of a simulated cycle, in SI units if its file or all three options state a sphere."""
    from crackfront.core.units import Scales
    from crackfront.measured.loops.simulated_loop import simulated_loop
    from crackfront.simulate.storage import read_dataset
    from crackfront.surfaces.si_units import in_si_units, stated_scales

    cycle = read_dataset(path)
    if "direction" not in cycle.variables:
        raise ValueError(f"{path} is not a cycle; name a file of crackfront cycle or of a sweep")
    is_in_si = stated_scales(cycle) is not None
    if radius is None and contact_modulus is None:
        if work_of_adhesion is not None and not is_compared:
            raise ValueError(
                "--work-of-adhesion is of a prediction; name --scans too, or --radius and "
                "--modulus for SI units"
            )
        if is_compared and not is_in_si:
            raise ValueError(
                f"{path} is in reduced units, and predictions are not; give --radius and --modulus"
            )
        return simulated_loop(cycle, str(path))
    if is_in_si:
        raise ValueError(f"{path} states its sphere; leave out --radius and --modulus")
    if radius is None or contact_modulus is None or work_of_adhesion is None:
        raise ValueError(
            f"{path} is in reduced units; give --radius, --modulus and --work-of-adhesion for "
            "SI units, or leave all three out"
        )
    scales = Scales(radius, work_of_adhesion, contact_modulus)
    return simulated_loop(in_si_units(cycle, scales), str(path))


def _prediction(
    scans: tuple[Path, ...], reading: dict[str, Any], loop: MeasuredLoop, work_of_adhesion: float
) -> Prediction:
    """Prediction for the sphere on a surface of scans, with the modulus of the loop."""
    from crackfront.core.units import Scales
    from crackfront.measured.predict import predict

    scales = Scales(loop.sphere_radius, work_of_adhesion, loop.contact_modulus.value)
    prediction = predict(scans, scales, **reading)
    if not prediction.applies:
        raise ValueError(f"the theory does not apply: {prediction.reason}")
    return prediction


def _print(loop: MeasuredLoop, prediction: Prediction | None, *, as_json: bool) -> None:
    """Print a loop and its comparison with a prediction, as a page or as JSON."""
    from crackfront.measured.loops.comparison import comparison_lines, machine_readable

    if as_json:
        echo_json(machine_readable(loop, prediction))
        return
    lines = [] if prediction is None else ["", *comparison_lines(loop, prediction)]
    click.echo("\n".join([repr(loop), *lines]))
