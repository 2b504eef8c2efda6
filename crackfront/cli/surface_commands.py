"""`crackfront surface` and `crackfront predict`: what scans tell of a surface, and its adhesion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from crackfront.cli.answers import announce_compilation, echo_answer, echo_json
from crackfront.cli.option_types import (
    FILE,
    Command,
    as_json,
    check_needed_option,
    check_together,
    examples,
    option_name,
    options_of,
    whole,
)
from crackfront.cli.output_files import (
    check_overwriting,
    check_replaced_netcdf,
    check_replaced_page,
    check_replaced_table,
    check_writable,
)
from crackfront.cli.samples_command import exit_code, write_samples
from crackfront.core.bounds import SEED, Range
from crackfront.core.words import counted, in_time, wrapped
from crackfront.measured.options import (
    PredictionOptions,
    PsdOptions,
    ReadingOptions,
    SelfAffineOptions,
    SphereOptions,
    checked_options,
    for_files,
    named_options,
    reading_options,
    sphere_scales,
)

if TYPE_CHECKING:
    from crackfront.core.units import Scales
    from crackfront.measured.density.bands import Scan
    from crackfront.measured.prediction.prediction import Prediction
    from crackfront.measured.prediction.remarks import Outcome
    from crackfront.measured.prediction.simulated_prediction import Simulated
    from crackfront.measured.spectrum.measured_surface import MeasuredSurface
    from crackfront.measured.spectrum.stated import Surface


def _list_channels_and_exit(
    context: click.Context, parameter: click.Parameter, scans: tuple[Path, ...]
) -> tuple[Path, ...]:
    """The scans; with --list-channels, print their channels and end the command instead."""
    if context.params.get("list_channels"):
        if not scans:
            raise ValueError("--list-channels lists the channels of scans; name SCANS")
        from crackfront.measured.scan.instruments import list_channels

        for scan in scans:
            click.echo("\n  ".join(map(str, (scan, *list_channels(scan)))))
        context.exit()
    return scans


def _scans(*, required: bool) -> Callable[[Command], Command]:
    """Give a command its scans; eager, so that channels are listed without its other options."""

    def decorated(command: Command) -> Command:
        command = click.option(
            "--list-channels", is_flag=True, is_eager=True, help="Only list the channels of SCANS."
        )(command)
        scans = click.argument(
            "scans",
            type=FILE,
            nargs=-1,
            required=required,
            is_eager=True,
            callback=_list_channels_and_exit,
        )
        return scans(command)

    return decorated


@click.command(
    epilog=examples(
        "crackfront predict examples/scans/nanodiamond-detail.al3d --modulus 0.7MPa \\",
        "    --poisson 0.5 --radius 1.25mm --work-of-adhesion 63mJ/m2 --json",
        "crackfront predict --rms 60nm --correlation-length 1um --hurst 0.8 --modulus 0.7MPa \\",
        "    --poisson 0.5 --radius 1.25mm --work-of-adhesion 63mJ/m2",
    )
)
@_scans(required=False)
@options_of(ReadingOptions)
@click.option("--psd", type=FILE, help="Text file of a spectral density, instead of scans.")
@options_of(PsdOptions)
@options_of(SelfAffineOptions)
@options_of(SphereOptions, required=True)
@options_of(PredictionOptions)
@as_json
@click.option("--simulate", is_flag=True, help="Also simulate surfaces of the measured spectrum.")
@click.option(
    "--realisations",
    type=whole(Range(1, 1e6)),
    default=3,
    help="Synthesised surfaces that --simulate runs.",
)
@click.option("--seed", type=whole(SEED), default=0, help="Seed of these surfaces.")
@click.option(
    "--figure",
    type=FILE,
    help="Figure: talk.svg, or without suffix PDF and PNG.  [default: results/predict/<scan>]",
)
@click.option("--panel", type=click.Choice("abcd"), help="Draw one panel of the figure alone.")
@click.option("--no-figure", is_flag=True, help="Draw no figure, which saves most of the time.")
@click.option(
    "--csv",
    "table",
    type=FILE,
    help="Treat each scan as a sample, and write a row for it; - prints the rows.",
)
@click.option("--long", "is_long", is_flag=True, help="Print all results instead of one page.")
@click.option(
    "--report", type=FILE, help="Page of HTML to send: numbers, reservations, figure and origin."
)
@click.option("--strict", is_flag=True, help="Exit with 3 if there are reservations.")
@click.pass_context
def predict(
    context: click.Context,
    /,
    scans: tuple[Path, ...],
    psd: Path | None,
    table: Path | None,
    strict: bool,
    **options: Any,
) -> None:
    """Predict how strongly a soft sphere sticks to a measured surface, from the fitted law.

    SCANS are files of instruments in any format that SurfaceTopography reads, one measurement of
    the surface or several. Instead of scans, --psd names an exported spectral density, or --rms,
    --hurst and --correlation-length or --roll-off describe a self-affine surface. Works of
    adhesion are w_int - e_el -+ k e_el. k is the factor of `crackfront law`, divided by the
    ratio of the front to boundary elements.

    Exit code 0: a prediction, with reservations where there are any or where it cannot be decided
    whether the theory applies (3 with --strict). 4: the theory does not apply; nothing is
    predicted, and the output says which modulus, radius, roughness or w_int would meet the
    condition. With --csv the code is the largest of all samples; a scan that cannot be used counts
    as 4.
    """
    scales = _scales(options)
    theory = checked_options(PredictionOptions, options, "--")
    _check_one_surface(scans, psd, options)
    _check_outputs(context, scans if psd is None else (psd,))
    if table is not None:
        outcomes = _write_rows(table, scans, options, scales, theory)
        context.exit(max(exit_code(outcome, strict) for outcome in outcomes))
    outputs = _outputs(options, _surface_name(scans, psd))
    surface: Surface = _surface(scans, options) if scans else _stated_surface(psd, options)
    outcome = _predict(surface, scales, theory, outputs)
    context.exit(exit_code(outcome, strict))


@dataclass(frozen=True, slots=True)
class _Outputs:
    """What a prediction prints, draws, simulates and writes."""

    as_json: bool
    is_long: bool
    figure: Path | None
    """File or stem of the figure; None without one."""
    panel: str | None
    report: Path | None
    simulations: int
    """Number of simulations to run."""
    seed: int

    def say(self, text: str) -> None:
        """Print a text, unless the answer is JSON."""
        if not self.as_json:
            click.echo(text)


def _check_outputs(context: click.Context, inputs: tuple[Path, ...]) -> None:
    """Raise before any work if options contradict each other, or a file would be lost."""
    options = context.params
    check_needed_option(context, "simulate", "realisations", "seed")
    check_together(context, "no_figure", "figure", "panel")
    check_together(context, "as_json", "is_long")
    table, figure, report = options["table"], options["figure"], options["report"]
    check_overwriting(inputs, {"--csv": table, "--figure": figure, "--report": report})
    check_replaced_table("--csv", table, "scan")
    check_replaced_page("--report", report)
    unused = ("as_json", "simulate", "is_long", "panel", "figure", "report")
    if table is not None and any(options[name] for name in unused):
        raise ValueError("--csv writes rows alone; leave out what prints, draws or simulates")


def _outputs(options: Mapping[str, Any], name: str) -> _Outputs:
    """Outputs that the options request; `name` is the name of the surface.

    OSError if a folder cannot be written.
    """
    figure = None if options["no_figure"] else options["figure"] or Path("results/predict", name)
    for path in filter(None, (figure, options["report"])):
        check_writable(path.parent)
    return _Outputs(
        as_json=options["as_json"],
        is_long=options["is_long"],
        figure=figure,
        panel=options["panel"],
        report=options["report"],
        simulations=options["realisations"] if options["simulate"] else 0,
        seed=options["seed"],
    )


def _predict(
    surface: Surface, scales: Scales, theory: PredictionOptions, outputs: _Outputs
) -> Outcome:
    """Predict, and print, draw, simulate and write what is asked for; the outcome."""
    from crackfront.measured.page.texts import machine_readable, report_text
    from crackfront.measured.prediction.prediction import check_and_predict, not_predicted

    verdict, prediction = check_and_predict(surface, scales, theory)
    result = not_predicted(surface, scales, verdict) if prediction is None else prediction
    simulated = None
    outputs.say(repr(result))
    if outputs.is_long:
        outputs.say("\n" + report_text(surface, scales, verdict, prediction))
    if prediction is not None:
        _draw(prediction, outputs)
        simulated = _simulated(prediction, scales, outputs)
    if outputs.report is not None:
        _write_report(outputs.report, result, simulated, outputs)
    if outputs.as_json:
        echo_json(machine_readable(surface, scales, verdict, prediction, simulated))
    return verdict.outcome


def _draw(prediction: Prediction, outputs: _Outputs) -> None:
    """Write the figure of a prediction, if there is to be one."""
    if outputs.figure is None:
        return
    from crackfront.measured.page.prediction_figures import prediction_figure
    from crackfront.plots.style import save_figure

    drawn = prediction_figure(prediction.surface, prediction, outputs.panel)
    for path in save_figure(drawn, outputs.figure):
        outputs.say(f"figure: {path}")


def _write_report(
    path: Path, prediction: Prediction, simulated: Simulated | None, outputs: _Outputs
) -> None:
    """Write the page of a prediction, or of the reasons why there is none."""
    from crackfront.measured.page.report import prediction_report
    from crackfront.measured.page.texts import simulation_text
    from crackfront.simulate.storage import write_text

    text = "" if simulated is None else simulation_text(simulated, prediction)
    write_text(path, prediction_report(prediction, text, with_figure=outputs.figure is not None))
    outputs.say(f"report: {path}")


def _check_one_surface(
    scans: tuple[Path, ...], psd: Path | None, options: Mapping[str, Any]
) -> None:
    """Raise ValueError unless the surface and its options are stated in exactly one way."""
    self_affine = named_options(SelfAffineOptions, options)
    ways = []
    if scans:
        ways.append("SCANS")
    if psd is not None:
        ways.append("--psd")
    if self_affine:
        ways.append(option_name(self_affine[0]))
    if len(ways) != 1:
        stated = f"by {' and '.join(ways)}" if ways else "in no way"
        raise ValueError(
            f"the surface is given {stated}; name scans, or a spectral density with --psd, or "
            "numbers with --rms"
        )
    density_options = named_options(PsdOptions, options)
    if psd is None and density_options:
        raise ValueError(f"{option_name(density_options[0])} is of a density; name it with --psd")
    reading = named_options(ReadingOptions, options)
    if not scans and reading:
        raise ValueError(f"{option_name(reading[0])} is of scans; leave it out")


def _surface_name(scans: tuple[Path, ...], psd: Path | None) -> str:
    """Name of a surface, which its figure has by default."""
    if scans:
        return scans[0].stem
    return "numbers" if psd is None else psd.stem


def _write_rows(
    table: Path,
    scans: tuple[Path, ...],
    options: Mapping[str, Any],
    scales: Scales,
    theory: PredictionOptions,
) -> list[str]:
    """Write a row for each scan, as for a sample; their outcomes."""
    from crackfront.measured.samples.sample import scans_as_samples

    if not scans:
        raise ValueError("--csv writes a row for each scan; name scans")
    reading = reading_options(for_files(options, scans), len(scans), "--")
    samples = scans_as_samples(scans, reading, scales, theory)
    return [result.outcome for result in write_samples(table, samples, "scan")]


def _stated_surface(psd: Path | None, options: Mapping[str, Any]) -> Surface:
    """Surface of a density or of numbers that a command names."""
    from crackfront.measured.scan.psd import read_psd_file
    from crackfront.measured.spectrum.stated import density_surface, self_affine_surface_of

    if psd is None:
        return self_affine_surface_of(checked_options(SelfAffineOptions, options, "--"))
    return density_surface(read_psd_file(psd, checked_options(PsdOptions, options, "--")))


def _simulated(prediction: Prediction, scales: Scales, outputs: _Outputs) -> Simulated | None:
    """Run the simulations of a predicted surface, if any, and print their cost and results."""
    if not outputs.simulations:
        return None
    from crackfront.measured.page.texts import simulation_text
    from crackfront.measured.prediction.simulated_prediction import prediction_plan, simulated

    announce_compilation(err=outputs.as_json)
    plan = prediction_plan(prediction.surface, scales, outputs.simulations, outputs.seed)
    seconds = in_time(plan.expected_seconds)
    about = f"simulating {counted(outputs.simulations, 'surface')}, about {seconds} ..."
    outputs.say("\n".join(filter(None, (plan.remark, about))))
    result = simulated(plan, scales)
    outputs.say(simulation_text(result, prediction))
    return result


@click.command(
    epilog=examples(
        "crackfront surface examples/scans/nanodiamond-detail.al3d",
        "crackfront surface scan.x3p --modulus 0.7MPa --poisson 0.5 --radius 20um \\",
        "    --work-of-adhesion 63mJ/m2 --field field.nc",
    )
)
@_scans(required=True)
@options_of(ReadingOptions)
@options_of(SphereOptions)
@as_json
@click.option("--field", type=FILE, help="Write the map as a field for crackfront cycle.")
def surface(scans: tuple[Path, ...], as_json: bool, field: Path | None, **options: Any) -> None:
    """Analyse one measurement of a surface or several: spectrum, rms measures, their scales.

    SCANS are files of instruments in any format that SurfaceTopography reads. Options of
    the sphere add e_el and w_rms.
    """
    from crackfront.measured.page.texts import machine_readable, report_text

    is_pressed = any(options[name] is not None for name in SphereOptions.model_fields)
    scales = _scales(options) if is_pressed or field is not None else None
    if field is not None:
        _check_field_file(field, scans)
    measured = _surface(scans, options)
    content = machine_readable(measured, scales)
    echo_answer(content, [wrapped(report_text(measured, scales))], as_json=as_json)
    if field is None or scales is None:
        return
    if len(measured.scans) > 1:
        raise ValueError(f"--field takes one scan, and {scans[0]} contains {len(measured.scans)}")
    energy = _write_field(field, measured.scans[0], scales)
    if not as_json:
        click.echo(f"field: {field}, e_el {energy:.4g} w_int on the tile")


def _check_field_file(field: Path, scans: tuple[Path, ...]) -> None:
    """Raise before any work if the file of a field cannot be written, or is of several scans."""
    from crackfront.simulate.storage import check_regular_file

    check_overwriting(scans, {"--field": field})
    check_replaced_netcdf("--field", field)
    if len(scans) > 1:
        raise ValueError(f"--field takes one scan, not {len(scans)}; name the one to press on")
    check_regular_file(field)
    check_writable(field.parent)


def _write_field(field: Path, scan: Scan, scales: Scales) -> float:
    """Write a scan as a field for `crackfront cycle`; e_el of its tile (Units: w_int)."""
    from crackfront.measured.tile import scan_surface
    from crackfront.surfaces.saving import save_result
    from crackfront.surfaces.surface_adhesion import surface_adhesion

    pressed = scan_surface(scan, scales)
    energy = float(surface_adhesion(pressed).e_el)
    save_result(pressed, field)
    return energy


def _surface(scans: tuple[Path, ...], options: Mapping[str, Any]) -> MeasuredSurface:
    """Surface of the files that a command names, read by its options."""
    reading = reading_options(for_files(options, scans), len(scans), "--")
    from crackfront.measured.spectrum.measured_surface import read_surface

    return read_surface(scans, reading)


def _scales(options: Mapping[str, Any]) -> Scales:
    """Scales of the sphere of a command, in SI units."""
    return sphere_scales(checked_options(SphereOptions, options, "--"), "--")
