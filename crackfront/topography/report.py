"""A surface and its prediction as texts, and as a mapping for machines in SI units."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.law import shipped_law
from crackfront.core.units import Scales
from crackfront.core.variables import variables
from crackfront.data.plain import plain
from crackfront.data.written_units import prefixed
from crackfront.topography.bands import BandLimit
from crackfront.topography.cautions import measure_next, scan_notes, surface_doubts
from crackfront.topography.fitting import Fit
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.prediction import (
    Prediction,
    corrected_works,
    prediction_notes,
    repelled_note,
)
from crackfront.topography.verdict import Condition, Outcome, Verdict

if TYPE_CHECKING:
    from crackfront.topography.simulated import Simulated

Number = Estimate[float]

_ENERGY = "J/m2"
_MEASURES = {0.0: ("heights", "m"), 0.5: ("half-derivative", "m^1/2"), 1.0: ("slopes", "1")}
"""Names and units of rms measures by the orders of their derivatives."""

_FAR = 1000.0
"""Factor to a limit from which on it is not worth a number."""

_ADHESIONS = ("w_appr", "w_retr", "hysteresis")


def report_text(
    surface: MeasuredSurface,
    scales: Scales | None = None,
    ruling: Verdict | None = None,
    prediction: Prediction | None = None,
) -> str:
    """All of surface, verdict and prediction, each where it is known, and what a reader must know.

    Without a prediction, scales in SI units add the energy of full conformity.
    """
    parts = [_surface_lines(surface)]
    if ruling is not None:
        parts.append(_verdict_lines(ruling))
    if prediction is not None:
        parts.append(_prediction_lines(prediction))
    elif scales is not None:
        energy = surface.conformity_energy(scales.contact_modulus)
        parts.append(_conformity_lines(energy, scales.work_of_adhesion))
    notes = _notes(surface, prediction)
    if ruling is None:
        notes += surface_doubts(surface)
    if notes:
        parts.append(iter(["Notes", *(f"  {note}" for note in notes)]))
    return "\n\n".join("\n".join(lines) for lines in parts)


def prediction_page(prediction: Prediction) -> str:
    """What an experimenter wants first: numbers, how far to trust them, what to measure next."""
    surface, e_el = prediction.surface, prediction.e_el
    joint, smallest = surface.joint, shipped_law().size[0]
    hysteresis = _shown(_ENERGY, prediction.hysteresis)
    if prediction.size < smallest:
        hysteresis += f"; none expected: g {prediction.size:.2g} is below {smallest:.2g}"
    smooth = prefixed("N", prediction.pull_off_force_smooth)
    relative = e_el.value / prediction.work_of_adhesion
    recorded = surface.conformity_energy(prediction.contact_modulus, surface.recorded)
    waves = _span(joint.shortest, joint.longest)
    rows = [
        ("hysteresis", hysteresis),
        *((name, _shown(_ENERGY, getattr(prediction, name))) for name in ("w_appr", "w_retr")),
        ("pull-off force", f"{_shown('N', prediction.pull_off_force)}; smooth sphere {smooth}"),
        ("e_el", f"{_shown(_ENERGY, e_el)} = {relative:.3g} w_int"),
        ("recorded of it", f"{prefixed(_ENERGY, recorded.value)}; trusted waves from {waves}"),
    ]
    if math.isfinite(prediction.implied_work_of_adhesion.value):
        implied = _shown(_ENERGY, prediction.implied_work_of_adhesion)
        rows.insert(4, ("w_int by pull-off", implied))
    doubts = prediction.verdict.reservations
    trust = _heading(prediction.verdict)
    return "\n".join(
        [
            *(f"{name:18}{text}" for name, text in rows),
            f"{trust}. {prediction.excess.sentence}",
            *repelled_note(prediction),
            *doubts[:2],  # the most important ones
            measure_next(surface),
            "Intervals hold 95%; --long says all.",
        ]
    )


def _notes(surface: MeasuredSurface, prediction: Prediction | None) -> list[str]:
    """Notes of a surface, and of its prediction where there is one."""
    return list(scan_notes(surface.scans) if prediction is None else prediction_notes(prediction))


def simulation_text(found: Simulated, prediction: Prediction) -> str:
    """What simulations found beside what is predicted: of the front itself, and corrected."""
    several = "s" if found.realisations > 1 else ""
    lines = [
        f"Simulated on {found.realisations} synthesised surface{several}, beside the prediction"
    ]
    front = _shown(_ENERGY, found.hysteresis), _shown(_ENERGY, prediction.front_hysteresis)
    lines.append(f"  {'front, not corrected':22}{front[0]}; predicted {front[1]}")
    corrected = corrected_works(found, prediction)
    for name in _ADHESIONS:
        ours, theirs = getattr(corrected, name), getattr(prediction, name)
        lines.append(f"  {name:22}{_shown(_ENERGY, ours)}; predicted {_shown(_ENERGY, theirs)}")
    law = _shown("1", prediction.factors.both)
    lines.append(
        f"  {'k of the front':22}{_shown('1', found.k)}, numerical error "
        f"{found.numerical_error:.2g}; predicted {law}"
    )
    if found.remark:
        lines.append(f"  {found.remark}")
    lines += [f"  Without a value: {sentence}" for sentence in found.failed]
    return "\n".join(lines)


def machine_readable(
    surface: MeasuredSurface,
    scales: Scales | None = None,
    ruling: Verdict | None = None,
    prediction: Prediction | None = None,
    found: Simulated | None = None,
) -> dict[str, Any]:
    """What the texts and notes say, for JSON, by the names of records and in their SI units."""
    joint = surface.joint
    return {
        "measurements": list(_scan_entries(surface)),
        "spectrum": {
            "wavelength": list(joint.spectrum.wavelengths),
            "density": list(joint.spectrum.densities),
            "measured": plain(joint.density),
            "share_of_e_el": plain(joint.shares),
            "shortest": joint.shortest,
            "longest": joint.longest,
            "end": joint.spectrum.short_cutoff,
            "draws": {
                "number": len(joint.draws.weight),
                "effective": joint.draws.effective,
                "unsettled": joint.draws.unsettled,
            },
        },
        "continuation": {
            **{name: plain(number) for name, number, _ in _continuation(joint.fit)},
            "deviance_per_freedom": joint.fit.misfit,
            "has_roll_off": joint.fit.has_roll_off,
        },
        "measures": plain(surface.measures),
        "e_el": None if scales is None else _energy_entry(surface, scales.contact_modulus),
        "prediction": None if prediction is None else _prediction_entries(prediction),
        "factors": None if prediction is None else plain(prediction.factors),
        "excess": None if prediction is None else plain(prediction.excess),
        "verdict": None if ruling is None else _verdict_entry(ruling),
        "notes": _notes(surface, prediction),
        "simulation": None
        if found is None or prediction is None
        else _simulation(found, prediction),
    }


def _simulation(found: Simulated | None, prediction: Prediction | None) -> dict[str, Any] | None:
    """What simulations found: of the front itself, and corrected as the prediction is."""
    if found is None or prediction is None:
        return None
    return plain(found) | {"corrected": plain(corrected_works(found, prediction))}


def sample_row(
    surface: MeasuredSurface, scales: Scales, ruling: Verdict, prediction: Prediction | None
) -> dict[str, Any]:
    """Row of a surface in a table: numbers and the ends of their 95% intervals, in SI units."""
    remarks = " ".join(ruling.reservations or ruling.remedies)
    numbers = {
        f"rms_{_MEASURES[one.order][0].replace('-', '_')}": plain(one.rms)
        for one in surface.measures
    }
    numbers["e_el"] = plain(surface.conformity_energy(scales.contact_modulus))
    numbers |= {} if prediction is None else _prediction_entries(prediction)
    heads = {"value": "", "low": "_low", "high": "_high"}
    return {"outcome": ruling.outcome, "remarks": remarks} | {
        f"{name}{head}": entry[end]
        for name, entry in numbers.items()
        for end, head in heads.items()
        if end in entry
    }


def _continuation(fit: Fit) -> tuple[tuple[str, Number, str], ...]:
    """Parameters of the model that continues a density, and units."""
    return (
        ("roll_off", fit.roll_off, "m"),
        ("hurst", fit.hurst, "1"),
        ("plateau", fit.plateau, "m^4"),
    )


def _surface_lines(surface: MeasuredSurface) -> Iterator[str]:
    """Lines on the measurements, the spectrum and the rms measures."""
    for one in surface.scans:
        item = one.measurement
        points = " x ".join(map(str, item.heights.shape))
        sides = " x ".join(prefixed("m", side) for side in item.size)
        yield f"{item.path}: {item.format}, {points} points, {sides}"
        yield f"  trusted wavelengths   {' to '.join(map(_limit_text, one.band.ends))}"
        others = [limit for limit in one.band.limits if limit not in one.band.ends]
        if others:
            yield f"  other limits          {', '.join(map(_limit_text, others))}"
        if item.channel:
            yield f"  channel               {item.channel}"
        yield f"  taken off             {item.levelling}"
        if item.comment:
            yield f"  comment               {item.comment}"
    yield ""
    joint = surface.joint
    yield "Spectrum"
    shares = joint.shares
    yield f"  {'measured':22}{_span(joint.shortest, joint.longest)}, {shares.measured:.0%} of e_el"
    if len(surface.scans) > 1:
        yield f"  {'scatter of scans':22}{joint.density.scatter:.0%} of the density"
    yield (
        f"  {'continued':22}down to {prefixed('m', joint.spectrum.short_cutoff)} and to longer "
        f"waves, {shares.continued:.0%} of e_el"
    )
    for name, found, units in _continuation(joint.fit):
        unsure = name == "roll_off" and not joint.fit.has_roll_off
        yield f"    {name:20}{_shown(units, found)}{', not resolved' if unsure else ''}"
    yield (
        f"  {'missing':22}two more decades of short waves would add {shares.missing_short:.0%} "
        f"to e_el; waves above {prefixed('m', joint.longest)} have {shares.continued_long:.0%}"
    )
    yield ""
    yield "Measures of the spectrum, and the scales of 80% of their mean squares"
    for measure in surface.measures:
        name, unit = _MEASURES[measure.order]
        rms = _shown(unit, measure.rms)
        yield f"  rms of {name:16}{rms:40}{_span(measure.shortest, measure.longest)}"


def _prediction_lines(item: Prediction) -> Iterator[str]:
    """Lines with all predicted numbers, as files and JSON name them."""
    yield "Prediction (95% intervals)"
    for one in variables(Prediction):
        found = getattr(item, one.name)
        number = found if isinstance(found, Estimate) else Estimate(found, *[math.nan] * 3)
        if math.isfinite(number.value):
            yield f"  {one.attributes['long_name']:58}{_shown(one.units, number)}"


def _conformity_lines(energy: Number, work_of_adhesion: float) -> Iterator[str]:
    """Lines of e_el and w_rms."""
    rms = 2 * math.sqrt(energy.value * work_of_adhesion)
    shown, part = _shown(_ENERGY, energy), energy.value / work_of_adhesion
    yield f"  {'e_el':25}{shown} = {part:.3g} w_int"
    yield f"  {'w_rms':25}{prefixed(_ENERGY, rms)} = {rms / work_of_adhesion:.3g} w_int"


def _verdict_lines(found: Verdict) -> Iterator[str]:
    """Lines on whether the theory applies, with conditions, remedies and reservations."""
    yield _heading(found)
    for item in found.conditions:
        yield f"  {item.name}: {item.found}, {_standing(item)}"
    if found.remedies:
        yield "What would make it apply, each change alone"
        yield from (f"  {remedy}" for remedy in found.remedies)
    if found.reservations:
        yield "Reservations"
        yield from (f"  {number}. {text}" for number, text in enumerate(found.reservations, 1))
    if found.assumption:
        yield f"Assumed\n  {found.assumption}"


def _heading(found: Verdict) -> str:
    """Whether the theory applies."""
    count = len(found.reservations)
    headings: dict[Outcome, str] = {
        "applies": "The theory applies",
        "applies with reservations": (
            f"The theory applies with {count} reservation{'s' if count > 1 else ''}"
        ),
        "cannot be decided": (
            "WHETHER THE THEORY APPLIES CANNOT BE DECIDED; the numbers hold if it does"
        ),
        "does not apply": "THE THEORY DOES NOT APPLY",
    }
    return headings[found.outcome]


def _standing(item: Condition) -> str:
    """By what factor a condition holds, or where it comes into doubt or fails."""
    if item.standing == "holds":
        factor = f"inside by a factor of {float(f'{item.margin:.2g}'):g}"
        return factor if item.margin < _FAR else "far inside"
    words = {"in doubt": "IN DOUBT", "undecided": "UNDECIDED", "fails": "FAILS"}
    end = item.doubtful if item.standing == "in doubt" else item.limit
    return f"{words[item.standing]} {'below' if item.rising else 'above'} {item.shown(end)}"


def _verdict_entry(found: Verdict) -> dict[str, Any]:
    """A verdict with the standing of every condition."""
    conditions = [
        plain(item) | {"standing": item.standing, "margin": plain(item.margin)}
        for item in found.conditions
    ]
    more = {"conditions": conditions, "remedies": found.remedies}
    return {"outcome": found.outcome} | plain(found) | more


def _shown(unit: str, found: Number) -> str:
    """A number with its interval, if it has one; powers of lengths have no prefix."""
    unit = unit.replace("J m-2", _ENERGY)
    if unit in ("m", "N", "Pa", _ENERGY):
        return prefixed(unit, found.value, found.low, found.high)
    interval = f" ({found.low:.3g} to {found.high:.3g})" if math.isfinite(found.low) else ""
    return f"{found.value:.3g}{interval} {unit}".removesuffix(" 1")


def _limit_text(limit: BandLimit) -> str:
    """A wavelength with the cause of its being a limit."""
    return f"{prefixed('m', limit.wavelength)} ({limit.cause})"


def _span(shortest: float, longest: float) -> str:
    """A range of wavelengths."""
    return f"{prefixed('m', shortest)} to {prefixed('m', longest)}"


def _scan_entries(surface: MeasuredSurface) -> Iterator[dict[str, Any]]:
    """Scans without heights: their files, trusted wavelengths, and what their densities show."""
    joined = surface.joint.density
    for index, (one, profile) in enumerate(zip(surface.scans, surface.profiles, strict=True)):
        item = one.measurement
        told = (entry.name for entry in fields(item) if entry.name != "heights")
        yield {
            **{name: plain(getattr(item, name)) for name in told},
            "points": list(item.heights.shape),
            **plain(one.band),
            "density": plain(one.trusted),
            "profile_density": plain(profile),
            "level": plain(joined.levels[index]),
            "disagrees": joined.disagrees(index),
        }


def _energy_entry(surface: MeasuredSurface, contact_modulus: float) -> dict[str, Any]:
    """e_el, and that of what is recorded (Units: J / m^2)."""
    return plain(surface.conformity_energy(contact_modulus)) | {
        "recorded": plain(surface.conformity_energy(contact_modulus, surface.recorded))
    }


def _prediction_entries(prediction: Prediction) -> dict[str, dict[str, Any]]:
    """Numbers of a prediction by name, with what they have of standard errors and intervals."""
    items = [(item, plain(getattr(prediction, item.name))) for item in variables(Prediction)]
    return {
        item.name: (found if isinstance(found, dict) else {"value": found}) | item.attributes
        for item, found in items
    }
