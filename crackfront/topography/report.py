"""A surface and its prediction as texts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from crackfront.core.units import Scales
from crackfront.data.quantities import prefixed
from crackfront.topography.fitting import Uncertain
from crackfront.topography.limits import Limit
from crackfront.topography.machine import spectrum_parameters
from crackfront.topography.measures import RmsMeasure, Surface
from crackfront.topography.prediction import REACH, Prediction
from crackfront.topography.simulated import Simulated

_ENERGY = "J/m2"
_ORDER_NAMES = {0.0: "heights", 0.5: "half-derivative", 1.0: "slopes"}
_UNITS = {0.0: "m", 0.5: "m^1/2", 1.0: ""}


def surface_text(surface: Surface) -> str:
    """Measurements, spectrum and measures of a surface.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    """
    return "\n".join(_surface_lines(surface))


def conformity_text(surface: Surface, scales: Scales) -> str:
    """Energy of full conformity and the fluctuation that goes with it.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    scales : Scales
        The scene, in SI units.
    """
    energy = surface.conformity_energy(scales.contact_modulus)
    return "\n".join(_conformity_lines(energy, scales.work_of_adhesion))


def prediction_text(prediction: Prediction, limits: Sequence[Limit]) -> str:
    """A prediction, and where the theory applies.

    Parameters
    ----------
    prediction : Prediction
        What is predicted.
    limits : sequence of Limit
        Conditions of the theory.
    """
    return "\n".join([*_prediction_lines(prediction), "", *_limit_lines(limits)])


def simulation_text(found: Simulated) -> str:
    """What simulations found.

    Parameters
    ----------
    found : Simulated
        Their means.
    """
    lines = [f"Simulated on {found.realisations} synthesised surface(s)"]
    for name, item in (
        ("w_appr", found.w_appr),
        ("w_retr", found.w_retr),
        ("hysteresis", found.hysteresis),
    ):
        lines.append(f"  {name:22}{prefixed(_ENERGY, item.value, item.low, item.high)}")
    factor = _factor(found.k.value, found.k.low, found.k.high)
    lines.append(f"  {'k':22}{factor}, numerical error {found.numerical_error:.2g}")
    lines += [f"  Without a value: {sentence}" for sentence in found.failed]
    return "\n".join(lines)


def _surface_lines(surface: Surface) -> Iterator[str]:
    """Lines of a surface."""
    for item in surface.measurements:
        points = " x ".join(map(str, item.heights.shape))
        sides = " x ".join(prefixed("m", side) for side in item.size)
        yield f"{item.path}: {item.format}, {points} points, {sides}"
        yield f"  trusted wavelengths   {_span(item.shortest, item.longest)}"
        if item.comment:
            yield f"  comment               {item.comment}"
    yield ""
    yield "Fitted self-affine spectrum (± standard error)"
    for name, value, units in spectrum_parameters(surface):
        shown = f"{value.value:.3g} ± {value.error:.1g} {units}"
        if name == "roll_off":
            shown = f"{_pair(value, units)}" + (
                "" if surface.fitted.has_roll_off else ", not resolved"
            )
        yield f"  {name:22}{shown.removesuffix(' 1')}"
    yield (
        f"  {'shortest wavelength':22}{prefixed('m', surface.fitted.spectrum.short_cutoff)}; two "
        f"more decades of the power law would add {surface.unmeasured_share:.0%} to e_el"
    )
    yield ""
    yield "Measures: of the spectrum; scales of 80% of the mean square; scans over the spectrum"
    for measure in surface.measures:
        yield _measure_line(measure)


def _measure_line(measure: RmsMeasure) -> str:
    """Line of a measure."""
    compared = ", ".join(
        f"{found / expected:.2f}"
        for found, expected in zip(measure.measured, measure.expected, strict=True)
    )
    unit, rms = _UNITS[measure.order], measure.rms
    shown = _pair(rms, unit) if unit == "m" else f"{rms.value:.3g} ± {rms.error:.1g} {unit}".strip()
    scales = _span(measure.shortest, measure.longest)
    return f"  rms of {_ORDER_NAMES[measure.order]:16}{shown:24}{scales:22}{compared}"


def _prediction_lines(item: Prediction) -> Iterator[str]:
    """Lines of a prediction."""
    yield "Prediction (95% intervals)"
    yield from _conformity_lines(Uncertain(item.e_el, item.e_el_error), item.work_of_adhesion)
    named = (
        ("correlation length", prefixed("m", item.correlation_length)),
        ("contact radius, F = 0", prefixed("m", item.contact_radius)),
        ("k of the approach", _factor(item.k_appr, item.k_appr_low, item.k_appr_high)),
        ("k of the retraction", _factor(item.k_retr, item.k_retr_low, item.k_retr_high)),
        ("w_appr", prefixed(_ENERGY, item.w_appr, item.w_appr_low, item.w_appr_high)),
        ("w_retr", prefixed(_ENERGY, item.w_retr, item.w_retr_low, item.w_retr_high)),
        (
            "hysteresis",
            prefixed(_ENERGY, item.hysteresis, item.hysteresis_low, item.hysteresis_high),
        ),
        (
            "pull-off, given load",
            prefixed("N", item.pull_off_force, item.pull_off_force_low, item.pull_off_force_high)
            + f"; smooth {prefixed('N', item.pull_off_force_smooth)}",
        ),
        (
            "pull-off, displacement",
            prefixed(
                "N",
                item.pull_off_force_held,
                item.pull_off_force_held_low,
                item.pull_off_force_held_high,
            ),
        ),
        (
            f"with the paper's k = {item.paper_factor:g}",
            f"w_appr {prefixed(_ENERGY, item.paper_w_appr)}, "
            f"w_retr {prefixed(_ENERGY, item.paper_w_retr)}",
        ),
    )
    for name, text in named:
        yield f"  {name:25}{text}"


def _conformity_lines(energy: Uncertain, work_of_adhesion: float) -> Iterator[str]:
    """Lines of e_el and w_rms."""
    value, reach = energy.value, REACH * energy.error
    rms = 2 * math.sqrt(value * work_of_adhesion)
    for name, text, part in (
        ("e_el", prefixed(_ENERGY, value, value - reach, value + reach), value),
        ("w_rms", prefixed(_ENERGY, rms), rms),
    ):
        yield f"  {name:25}{text} = {part / work_of_adhesion:.3g} w_int"


def _limit_lines(limits: Sequence[Limit]) -> Iterator[str]:
    """Lines of the conditions."""
    yield "The theory applies" if all(item.holds for item in limits) else "THE THEORY FAILS"
    for item in limits:
        word = f"inside by a factor of {item.margin:.2g}" if item.holds else "OUTSIDE"
        found, largest = (
            f"{number:.3g}" if item.units == "1" else prefixed(item.units, number)
            for number in (item.value, item.largest)
        )
        yield f"  {item.condition}: {found} against {largest}, {word}"


def _factor(value: float, low: float, high: float) -> str:
    """A factor k with its interval, if it has one."""
    return f"{value:.2f}" + (f" ({low:.2f} to {high:.2f})" if math.isfinite(low) else "")


def _pair(found: Uncertain, unit: str) -> str:
    """A number with its standard error, in the prefix of the number."""
    shown, prefix = prefixed(unit, found.value).split(" ")
    scale = found.value / float(shown)
    return f"{shown} ± {found.error / scale:.1g} {prefix}"


def _span(shortest: float, longest: float) -> str:
    """A range of wavelengths."""
    return f"{prefixed('m', shortest)} to {prefixed('m', longest)}"
