"""`crackfront loop`: works of adhesion of a loop, and their prediction from scans."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
from crackfront.core.units import plane_strain_modulus
from crackfront.core.words import wrapped
from crackfront.measured.options import (
    PredictionOptions,
    ReadingOptions,
    SphereOptions,
    checked_options,
    for_files,
    named_options,
    reading_options,
    sphere_scales,
)
from crackfront.surfaces.written_units import si_value

if TYPE_CHECKING:
    from crackfront.measured.loops.loop_result import MeasuredLoop
    from crackfront.measured.prediction.prediction import Prediction

_ERROR = Number(Range(0.0, 0.99))
"""Type of a relative standard error."""

_COLUMNS = {"force": "force", "radius": "contact_radius", "displacement": "displacement"}
"""Options that name a column of a table, by the column."""

_SPHERE_AND_PREDICTION = {
    name
    for record in (SphereOptions, ReadingOptions, PredictionOptions)
    for name in record.model_fields
}
"""Options that do not describe the rig or its table."""

_Callback = Callable[[click.Context, click.Parameter, str | None], Any]


def _in_si(unit: str) -> _Callback:
    """Callback that converts the text of an option into a number in a unit of SI."""

    def value(_: click.Context, option: click.Parameter, text: str | None) -> float | None:
        return None if text is None else si_value(text, unit, name=option.opts[0])

    return value


def _window(
    _: click.Context, option: click.Parameter, text: str | None
) -> tuple[float, float] | None:
    """Callback that converts a text such as 50um:150um into two contact radii (Units: m)."""
    if text is None:
        return None
    ends = text.split(":")
    if len(ends) != 2:
        raise ValueError(f"--window is {text!r}; give two contact radii, as in 50um:150um")
    low, high = (si_value(end, "m", name=option.opts[0]) for end in ends)
    return low, high


@click.command(
    epilog=examples(
        "crackfront loop examples/rig.csv --radius 100um --modulus 0.7MPa --poisson 0.5",
        "crackfront loop examples/rig.csv --radius 100um --modulus 0.7MPa --poisson 0.5 \\",
        "    --scans examples/scans/nanodiamond-overview.al3d --work-of-adhesion 63mJ/m2",
        "crackfront loop cycle.nc",
    )
)
@click.argument("path", type=FILE, metavar="FILE")
@options_of(SphereOptions)
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
@options_of(PredictionOptions, without=("pull_off",))
@click.option("--figure", type=FILE, help="Figure of the loop; without suffix PDF and PNG.")
@click.option("--report", type=FILE, help="Page of HTML to send: numbers, reservations and figure.")
@as_json
@click.pass_context
def loop(
    context: click.Context,
    /,
    path: Path,
    scans: tuple[Path, ...],
    figure: Path | None,
    report: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Evaluate a measured or simulated loop of force, contact radius and displacement.

    FILE is a text with headings and two or three of these columns. Works of adhesion are averaged
    over the same contact radii in both branches, as in simulations. The modulus is fitted to force
    and contact radius unless --modulus and --poisson state it. FILE may also be a cycle in netCDF
    that `crackfront cycle` or a sweep has written, with the works of adhesion of the simulation.
    They are in reduced units unless the file states a sphere, or --radius, --modulus, --poisson and
    --work-of-adhesion name one.

    Options of reading, from --channel to --longest, and of the theory, from --range to
    --work-of-adhesion-error, are the same as in `crackfront predict` and apply to the prediction
    for --scans.
    """
    sphere = checked_options(SphereOptions, options, "--")
    check_needed_option(context, "modulus", "poisson")
    check_needed_option(context, "poisson", "modulus")
    if scans and sphere.work_of_adhesion is None:
        raise ValueError("a prediction for --scans needs w_int; give --work-of-adhesion")
    theory = _prediction_options(scans, options)
    rig = {name: value for name, value in options.items() if name not in _SPHERE_AND_PREDICTION}
    _check_outputs([path, *scans], figure, report)
    result = _evaluated(path, sphere, rig, has_scans=bool(scans))
    prediction, failure = None, None
    if sphere.work_of_adhesion is not None and scans:
        try:
            prediction = _prediction(scans, theory, result, sphere.work_of_adhesion)
        except (ValueError, OSError) as error:
            failure = error  # The loop is printed and drawn all the same.
    _print(result, prediction, as_json=as_json)
    if figure is not None:
        for file in _draw(result, prediction, figure):
            click.echo(f"figure: {file}", err=as_json)
    if report is not None:
        _write_report(result, prediction, report, path.name)
        click.echo(f"report: {report}", err=as_json)
    if failure is not None:
        raise failure


def _check_outputs(inputs: Sequence[Path], figure: Path | None, report: Path | None) -> None:
    """Raise before any work if a file cannot be written or would be lost."""
    check_overwriting(inputs, {"--figure": figure, "--report": report})
    check_replaced_page("--report", report)
    for output in (figure, report):
        if output is not None:
            check_writable(output.parent)


def _evaluated(
    path: Path, sphere: SphereOptions, rig: dict[str, Any], *, has_scans: bool
) -> MeasuredLoop:
    """Loop of a file, measured or simulated."""
    from crackfront.measured.scan.netcdf import is_netcdf

    if is_netcdf(path):
        rig_options = [option_name(name) for name, value in rig.items() if value]
        if rig_options:
            raise ValueError(
                f"{path} is a simulated cycle without a rig; leave out {rig_options[0]}"
            )
        return _simulated(path, sphere, has_scans=has_scans)
    if sphere.work_of_adhesion is not None and not has_scans:
        raise ValueError("--work-of-adhesion is of a prediction; name --scans too")
    return _measured(path, sphere, rig)


def _draw(loop: MeasuredLoop, prediction: Prediction | None, figure: Path) -> tuple[Path, ...]:
    """Draw the figure of a loop with its prediction, if there is one; its files."""
    from crackfront.measured.loops.loop_drawing import loop_figure
    from crackfront.plots.style import save_figure

    return save_figure(loop_figure(loop, prediction), figure)


def _write_report(
    loop: MeasuredLoop, prediction: Prediction | None, report: Path, name: str
) -> None:
    """Write the page of the loop of a file of some name, with its prediction, if there is one."""
    from crackfront.measured.loops.loop_report import loop_report
    from crackfront.simulate.storage import write_text

    write_text(report, loop_report(loop, prediction, name))


def _prediction_options(scans: tuple[Path, ...], options: dict[str, Any]) -> dict[str, Any]:
    """Options for scans and theory that the command names; ValueError without scans."""
    names = [
        name
        for record in (ReadingOptions, PredictionOptions)
        for name in named_options(record, options)
    ]
    if names and not scans:
        raise ValueError(f"{option_name(names[0])} is of a prediction; name --scans too")
    chosen = for_files({name: options[name] for name in names}, scans)
    reading_options(chosen, len(scans), "--")
    theory = checked_options(PredictionOptions, chosen, "--")
    return chosen | {
        name: getattr(theory, name) for name in named_options(PredictionOptions, chosen)
    }


def _contact_modulus(sphere: SphereOptions) -> float | None:
    """Contact modulus that a command states (Units: Pa); None to fit it."""
    if sphere.modulus is None or sphere.poisson is None:
        return None
    return plane_strain_modulus(sphere.modulus, sphere.poisson)


def _measured(path: Path, sphere: SphereOptions, options: dict[str, Any]) -> MeasuredLoop:
    """Loop of a table, with the options of the rig and of the columns."""
    from crackfront.measured.loops.analysis import analyse_loop
    from crackfront.measured.loops.loop_choice import chosen_loop
    from crackfront.measured.loops.loop_table import read_recording
    from crackfront.measured.loops.rig import Rig

    heads = {name: options[option] for name, option in _COLUMNS.items() if options[option]}
    units = {name: options[f"{name}_unit"] for name in _COLUMNS if options[f"{name}_unit"]}
    recording = read_recording(path, heads, units)
    if sphere.radius is None:
        raise ValueError(f"{path} does not state the sphere; give its --radius, as in 1.25mm")
    rig_options = ("modulus_error", "radius_error", "stiffness", "window", "segment")
    contact_modulus = _contact_modulus(sphere)
    rig = Rig(sphere.radius, contact_modulus, **{name: options[name] for name in rig_options})
    recording = chosen_loop(recording.inverted(options["invert"]), options["loop"])
    return analyse_loop(recording, rig)


def _simulated(path: Path, sphere: SphereOptions, *, has_scans: bool) -> MeasuredLoop:
    """Loop of a simulated cycle, in SI units if its file or the options state a sphere.

    ValueError if there are scans, with whose prediction it is compared, and it is in reduced units.
    """
    from crackfront.measured.loops.simulated_loop import simulated_loop
    from crackfront.simulate.storage import read_dataset
    from crackfront.surfaces.si_units import in_si_units, stated_scales

    cycle = read_dataset(path)
    if "direction" not in cycle.variables:
        raise ValueError(f"{path} is not a cycle; name a file of crackfront cycle or of a sweep")
    is_in_si = stated_scales(cycle) is not None
    if sphere.radius is None and sphere.modulus is None:
        if sphere.work_of_adhesion is not None and not has_scans:
            raise ValueError(
                "--work-of-adhesion is of a prediction; name --scans too, or --radius, --modulus "
                "and --poisson for SI units"
            )
        if has_scans and not is_in_si:
            raise ValueError(
                f"{path} is in reduced units, and predictions are not; give --radius, --modulus "
                "and --poisson"
            )
        return simulated_loop(cycle, str(path))
    if is_in_si:
        raise ValueError(f"{path} states its sphere; leave out --radius, --modulus and --poisson")
    return simulated_loop(in_si_units(cycle, sphere_scales(sphere, "--")), str(path))


def _prediction(
    scans: tuple[Path, ...], options: dict[str, Any], loop: MeasuredLoop, work_of_adhesion: float
) -> Prediction:
    """Prediction for the sphere on a surface of scans, with the modulus of the loop."""
    from crackfront.core.units import Scales
    from crackfront.measured.predict import predict

    scales = Scales(loop.sphere_radius, work_of_adhesion, loop.contact_modulus.value)
    prediction = predict(scans, scales, **options)
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
    click.echo(wrapped("\n".join([repr(loop), *lines])))
