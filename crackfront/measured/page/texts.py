"""A surface and its prediction as texts, and as a mapping for machines in SI units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from crackfront.analysis.estimate import Estimate
from crackfront.core.units import Scales
from crackfront.core.variables import variables
from crackfront.core.words import counted
from crackfront.measured.density.bands import BandLimit
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.remarks import (
    Remark,
    Verdict,
    remark_lines,
    remark_text,
)
from crackfront.measured.prediction.surface_remarks import is_lower_bound, surface_remarks
from crackfront.measured.prediction.texts import ENERGY, estimate_text, wavelengths_text
from crackfront.measured.spectrum.fit import Fit
from crackfront.measured.spectrum.joining import part_of_energy
from crackfront.measured.spectrum.measured_surface import MeasuredSurface
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.simulate.jsonable import to_jsonable
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    # Importing it compiles nothing, but takes a second that a prediction does not need.
    from crackfront.measured.prediction.simulated_prediction import Simulated

Number = Estimate[float]

_MEASURES = {0.0: ("heights", "m"), 0.5: ("half-derivative", "m^1/2"), 1.0: ("slopes", "1")}
"""Names and units of rms measures by the orders of their derivatives."""

_ADHESIONS = ("w_appr", "w_retr", "hysteresis")


def report_text(
    surface: Surface,
    scales: Scales | None = None,
    verdict: Verdict | None = None,
    prediction: Prediction | None = None,
) -> str:
    """All of surface, verdict and prediction, each where it is known, with all remarks.

    The verdict stands first where the theory does not apply. Without a prediction, scales in SI
    units add the energy of full conformity.
    """
    parts = [_surface_lines(surface)]
    if verdict is None:
        parts.append(remark_lines(surface_remarks(surface)))
    else:
        first = verdict.outcome == "does not apply"
        said = iter([verdict.heading, *remark_lines(verdict.remarks)])
        parts.insert(0 if first else 1, said)
    if prediction is not None:
        parts.append(_prediction_lines(prediction))
    elif scales is not None:
        energy = surface.conformity_energy(scales.contact_modulus)
        parts.append(_conformity_lines(energy, scales.work_of_adhesion))
    return "\n\n".join("\n".join(lines) for lines in parts)


def simulation_text(found: Simulated, prediction: Prediction) -> str:
    """What simulations found beside what is predicted: of the front itself, and corrected."""
    surfaces = counted(found.realisations, "synthesised surface")
    lines = [f"Simulated on {surfaces}, beside the prediction"]
    front = (
        estimate_text(ENERGY, found.hysteresis),
        estimate_text(ENERGY, prediction.front_hysteresis),
    )
    lines.append(f"  {'front, not corrected':22}{front[0]}; predicted {front[1]}")
    corrected = found.corrected(prediction)
    for name in _ADHESIONS:
        ours, theirs = getattr(corrected, name), getattr(prediction, name)
        lines.append(
            f"  {name:22}{estimate_text(ENERGY, ours)}; predicted {estimate_text(ENERGY, theirs)}"
        )
    law = estimate_text("1", prediction.factors.both)
    lines.append(
        f"  {'k of the front':22}{estimate_text('1', found.k)}, numerical error "
        f"{found.numerical_error:.2g}; predicted {law}"
    )
    if found.remark:
        lines.append(f"  {found.remark}")
    lines += [f"  Without a value: {sentence}" for sentence in found.failed]
    return "\n".join(lines)


def machine_readable(
    surface: Surface,
    scales: Scales | None = None,
    verdict: Verdict | None = None,
    prediction: Prediction | None = None,
    found: Simulated | None = None,
) -> dict[str, Any]:
    """What the texts say, for JSON, by the names of records and in their SI units."""
    if isinstance(surface, StatedSurface):
        origin = _stated_entries(surface)
    else:
        origin = _measured_entries(surface)
    origin["spectrum"] |= {
        "wavelength": list(surface.spectrum.wavelengths),
        "density": list(surface.spectrum.densities),
        "share_of_e_el": to_jsonable(surface.shares),
        "shortest": surface.shortest,
        "longest": surface.longest,
        "end": surface.spectrum.short_cutoff,
    }
    return {
        **origin,
        "measures": to_jsonable(surface.measures),
        "e_el": None if scales is None else _energy_entry(surface, scales.contact_modulus),
        "prediction": None if prediction is None else _prediction_entries(prediction),
        "factors": None if prediction is None else to_jsonable(prediction.factors),
        "excess": None if prediction is None else to_jsonable(prediction.excess),
        "outcome": None if verdict is None else verdict.outcome,
        "remarks": _remark_entries(
            surface_remarks(surface) if verdict is None else verdict.remarks
        ),
        "simulation": None
        if found is None or prediction is None
        else _simulation(found, prediction),
    }


def _stated_entries(surface: StatedSurface) -> dict[str, Any]:
    """What a spectrum comes from that is stated."""
    return {"measurements": [], "spectrum": {"origin": surface.origin}, "continuation": None}


def _measured_entries(surface: MeasuredSurface) -> dict[str, Any]:
    """Scans, their joint density and the model that continues it."""
    joint = surface.joint
    return {
        "measurements": list(_scan_entries(surface)),
        "spectrum": {
            "measured": to_jsonable(joint.density),
            "draws": {
                "number": len(joint.draws.weight),
                "effective": joint.draws.effective,
                "unsettled": joint.draws.unsettled,
            },
        },
        "continuation": {
            **{name: to_jsonable(number) for name, number, _ in _continuation(joint.fit)},
            "deviance_per_freedom": joint.fit.misfit,
            "has_roll_off": joint.fit.has_roll_off,
        },
    }


def _simulation(found: Simulated, prediction: Prediction) -> dict[str, Any]:
    """What simulations found: of the front itself, and corrected as the prediction is."""
    return to_jsonable(found) | {"corrected": to_jsonable(found.corrected(prediction))}


def sample_row(
    surface: Surface, scales: Scales, verdict: Verdict, prediction: Prediction | None
) -> dict[str, Any]:
    """Row of a surface in a table: numbers and the ends of their 95% intervals, in SI units."""
    remarks = " ".join(map(remark_text, verdict.of("fails", "undecided", "reservation")))
    sentences = {
        "outcome": verdict.outcome,
        "failed": "; ".join(one.concerns for one in verdict.of("fails")),
        "undecided": "; ".join(one.concerns for one in verdict.of("undecided")),
        "at_least": is_lower_bound(surface),
        "none_expected": None if prediction is None else prediction.none_is_expected,
        "remarks": remarks,
    }
    numbers = {
        f"rms_{_MEASURES[one.order][0].replace('-', '_')}": to_jsonable(one.rms)
        for one in surface.measures
    }
    numbers["e_el"] = to_jsonable(surface.conformity_energy(scales.contact_modulus))
    numbers |= {} if prediction is None else _prediction_entries(prediction)
    heads = {"value": "", "low": "_low", "high": "_high"}
    return sentences | {
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


def _surface_lines(surface: Surface) -> Iterator[str]:
    """Lines on what is known of a surface, and its rms measures."""
    if isinstance(surface, StatedSurface):
        yield surface.origin
        yield f"  {'waves':22}{wavelengths_text(surface.shortest, surface.longest)}"
    else:
        yield from _measured_lines(surface)
    yield ""
    yield "Measures of the spectrum, and the scales of 80% of their mean squares"
    for measure in surface.measures:
        name, unit = _MEASURES[measure.order]
        rms = estimate_text(unit, measure.rms)
        yield f"  rms of {name:16}{rms:40}{wavelengths_text(measure.shortest, measure.longest)}"


def _measured_lines(surface: MeasuredSurface) -> Iterator[str]:
    """Lines on the measurements and their spectrum."""
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
    waves = wavelengths_text(joint.shortest, joint.longest)
    yield f"  {'measured':22}{waves}, {shares.measured:.0%} of e_el"
    if len(surface.scans) > 1:
        yield f"  {'scatter of scans':22}{joint.density.scatter:.0%} of the density"
    yield (
        f"  {'continued':22}down to {prefixed('m', joint.spectrum.short_cutoff)} and to longer "
        f"waves, {shares.continued:.0%} of e_el"
    )
    for name, found, units in _continuation(joint.fit):
        unsure = name == "roll_off" and not joint.fit.has_roll_off
        yield f"    {name:20}{estimate_text(units, found)}{', not resolved' if unsure else ''}"
    yield (
        f"  {'missing':22}two more decades of short waves would add "
        f"{part_of_energy(shares.missing_short)}; waves above {prefixed('m', joint.longest)} have "
        f"{shares.continued_long:.0%}"
    )


def _prediction_lines(item: Prediction) -> Iterator[str]:
    """Lines with all predicted numbers, as files and JSON name them."""
    yield "Prediction (95% intervals)"
    for one in variables(Prediction):
        found = getattr(item, one.name)
        number = found if isinstance(found, Estimate) else Estimate(found, *[math.nan] * 3)
        if math.isfinite(number.value):
            yield f"  {one.attributes['long_name']:58}{estimate_text(one.units, number)}"


def _conformity_lines(energy: Number, work_of_adhesion: float) -> Iterator[str]:
    """Lines of e_el and w_rms."""
    rms = 2 * math.sqrt(energy.value * work_of_adhesion)
    shown, part = estimate_text(ENERGY, energy), energy.value / work_of_adhesion
    yield f"  {'e_el':25}{shown} = {part:.3g} w_int"
    yield f"  {'w_rms':25}{prefixed(ENERGY, rms)} = {rms / work_of_adhesion:.3g} w_int"


def _remark_entries(remarks: Iterable[Remark]) -> list[dict[str, Any]]:
    """Remarks, with the margins of conditions."""
    return [
        to_jsonable(one)
        | {
            "comparison": None
            if one.comparison is None
            else to_jsonable(one.comparison) | {"margin": to_jsonable(one.comparison.margin)}
        }
        for one in remarks
    ]


def _limit_text(limit: BandLimit) -> str:
    """A wavelength with the cause of its being a limit."""
    return f"{prefixed('m', limit.wavelength)} ({limit.cause})"


def _scan_entries(surface: MeasuredSurface) -> Iterator[dict[str, Any]]:
    """Scans without heights: their files, trusted wavelengths, and what their densities show."""
    joined = surface.joint.density
    for index, one in enumerate(surface.scans):
        item = one.measurement
        names = (entry.name for entry in fields(item) if entry.name not in ("heights", "gaps"))
        yield {
            **{name: to_jsonable(getattr(item, name)) for name in names},
            "missing": item.missing,
            "missing_weight": one.missing_weight,
            "points": list(item.heights.shape),
            **to_jsonable(one.band),
            "density": to_jsonable(one.trusted),
            "profile_density": to_jsonable(one.profile),
            "level": to_jsonable(joined.levels[index]),
            "disagrees": joined.disagrees(index),
        }


def _energy_entry(surface: Surface, contact_modulus: float) -> dict[str, Any]:
    """e_el, and that of what is recorded (Units: J / m^2)."""
    return to_jsonable(surface.conformity_energy(contact_modulus)) | {
        "recorded": to_jsonable(surface.conformity_energy(contact_modulus, surface.recorded))
    }


def _prediction_entries(prediction: Prediction) -> dict[str, dict[str, Any]]:
    """Numbers of a prediction by name, with what they have of standard errors and intervals."""
    items = [(item, to_jsonable(getattr(prediction, item.name))) for item in variables(Prediction)]
    return {
        item.name: (found if isinstance(found, dict) else {"value": found}) | item.attributes
        for item, found in items
    }
