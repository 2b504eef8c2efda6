"""A surface and its prediction as text, and as a mapping for JSON in SI units."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.core.units import Scales
from crackfront.core.variables import variables
from crackfront.core.words import counted
from crackfront.measured.density.bands import BandLimit, Scan
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.prediction_texts import ENERGY, estimate_text, wavelengths_text
from crackfront.measured.prediction.remarks import (
    Verdict,
    remark_entries,
    remark_lines,
    remark_text,
)
from crackfront.measured.prediction.surface_remarks import is_lower_bound, surface_remarks
from crackfront.measured.prediction.works_by_source import (
    reason_for_differences,
    works_by_source,
)
from crackfront.measured.spectrum.joining import part_of_energy
from crackfront.measured.spectrum.joint_fit import Fit
from crackfront.measured.spectrum.measured_surface import MeasuredSurface
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.simulate.jsonable import to_jsonable
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    # The import takes a second that a prediction without simulations does not need.
    from crackfront.measured.prediction.simulated_prediction import Simulated

Number = Estimate[float]

_MEASURES = {0.0: ("heights", "m"), 0.5: ("half-derivative", "m^1/2"), 1.0: ("slopes", "1")}
"""Names and units of rms measures, by the order of the derivative."""

ADHESIONS = ("w_appr", "w_retr", "hysteresis")
"""Names of works of adhesion."""


def report_text(
    surface: Surface,
    scales: Scales | None = None,
    verdict: Verdict | None = None,
    prediction: Prediction | None = None,
) -> str:
    """All results for a surface, with all remarks.

    The verdict comes first if the theory does not apply. Without a prediction, scales in SI units
    add the energy of full conformity.
    """
    parts = [surface_lines(surface)]
    if verdict is None:
        parts.append(remark_lines(surface_remarks(surface)))
    else:
        verdict_lines = iter([verdict.heading, *remark_lines(verdict.remarks)])
        parts.insert(0 if verdict.outcome == "does not apply" else 1, verdict_lines)
    if prediction is not None:
        parts += [_prediction_lines(prediction), _source_lines(prediction)]
    elif scales is not None:
        energy = surface.conformity_energy(scales.contact_modulus)
        parts.append(_conformity_lines(energy, scales.work_of_adhesion))
    return "\n\n".join("\n".join(lines) for lines in parts)


def simulation_text(simulated: Simulated, prediction: Prediction) -> str:
    """Results of simulations and of the prediction, for the front itself and corrected."""
    surfaces = counted(simulated.realisations, "synthesised surface")
    lines = [f"Simulated on {surfaces}, with the prediction"]
    corrected = simulated.corrected(prediction)
    rows = {"front, not corrected": (simulated.hysteresis, prediction.front_hysteresis)}
    rows |= {name: (getattr(corrected, name), getattr(prediction, name)) for name in ADHESIONS}
    for name, (result, predicted) in rows.items():
        expected = estimate_text(ENERGY, predicted)
        lines.append(f"  {name:22}{estimate_text(ENERGY, result)}; predicted {expected}")
    law = estimate_text("1", prediction.k)
    lines.append(
        f"  {'k of the front':22}{estimate_text('1', simulated.k)}, numerical error "
        f"{simulated.numerical_error:.2g}; predicted {law}"
    )
    if simulated.remark:
        lines.append(f"  {simulated.remark}")
    lines += [f"  Without a value: {sentence}" for sentence in simulated.failed]
    return "\n".join(lines)


def machine_readable(
    surface: Surface,
    scales: Scales | None = None,
    verdict: Verdict | None = None,
    prediction: Prediction | None = None,
    simulated: Simulated | None = None,
) -> dict[str, Any]:
    """All results for JSON, by the names of the records and in SI units."""
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
    remarks = surface_remarks(surface) if verdict is None else verdict.remarks
    entries = {
        **origin,
        "measures": to_jsonable(surface.measures),
        "e_el": None if scales is None else _energy_entry(surface, scales.contact_modulus),
        "prediction": None,
        "factors": None,
        "excess": None,
        "works_by_source": None,
        "outcome": None if verdict is None else verdict.outcome,
        "at_least": is_lower_bound(surface),
        "remarks": remark_entries(remarks),
        "simulation": None,
    }
    if prediction is not None:
        entries |= prediction.to_dict()
        if simulated is not None:
            corrected = to_jsonable(simulated.corrected(prediction))
            entries["simulation"] = to_jsonable(simulated) | {"corrected": corrected}
    return entries


def _stated_entries(surface: StatedSurface) -> dict[str, Any]:
    """Origin of a surface without scans."""
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


def sample_row(
    surface: Surface, scales: Scales, verdict: Verdict, prediction: Prediction | None
) -> dict[str, Any]:
    """Row of a surface in a table: numbers and the ends of their 95% intervals, in SI units."""
    remarks = verdict.with_severity("fails", "undecided", "reservation")
    sentences = {
        "outcome": verdict.outcome,
        "failed": "; ".join(remark.concerns for remark in verdict.with_severity("fails")),
        "undecided": "; ".join(remark.concerns for remark in verdict.with_severity("undecided")),
        "at_least": is_lower_bound(surface),
        "none_expected": None if prediction is None else prediction.none_is_expected,
        "remarks": " ".join(map(remark_text, remarks)),
    }
    numbers = {}
    for measure in surface.measures:
        name, _ = _MEASURES[measure.order]
        numbers[f"rms_{name.replace('-', '_')}"] = to_jsonable(measure.rms)
    numbers["e_el"] = to_jsonable(surface.conformity_energy(scales.contact_modulus))
    if prediction is not None:
        numbers |= prediction.number_entries()
    row = dict(sentences)
    for name, entry in numbers.items():
        for end, suffix in (("value", ""), ("low", "_low"), ("high", "_high")):
            if end in entry:
                row[f"{name}{suffix}"] = entry[end]
    return row


def _continuation(fit: Fit) -> tuple[tuple[str, Number, str], ...]:
    """Names, values and units of the parameters of the model that continues a density."""
    return (
        ("roll_off", fit.roll_off, "m"),
        ("hurst", fit.hurst, "1"),
        ("plateau", fit.plateau, "m^4"),
    )


def surface_lines(surface: Surface) -> Iterator[str]:
    """Lines on a surface and its rms measures."""
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
    for scan in surface.scans:
        yield from _scan_lines(scan)
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
    for name, number, units in _continuation(joint.fit):
        text = estimate_text(units, number)
        if name == "roll_off" and not joint.fit.has_roll_off:
            text += ", not resolved"
        yield f"    {name:20}{text}"
    yield (
        f"  {'missing':22}waves down to {prefixed('m', joint.extended.short_cutoff)} would add "
        f"{part_of_energy(shares.missing_short)}"
    )
    yield (
        f"  {'longer':22}waves above {prefixed('m', joint.longest)} have "
        f"{part_of_energy(shares.continued_long)}"
    )


def _scan_lines(scan: Scan) -> Iterator[str]:
    """Lines on one measurement."""
    measurement, band = scan.measurement, scan.band
    points = " x ".join(map(str, measurement.heights.shape))
    sides = " x ".join(prefixed("m", side) for side in measurement.size)
    yield f"{measurement.path}: {measurement.format}, {points} points, {sides}"
    yield f"  trusted wavelengths   {' to '.join(map(_limit_text, band.ends))}"
    other_limits = [limit for limit in band.limits if limit not in band.ends]
    if other_limits:
        yield f"  other limits          {', '.join(map(_limit_text, other_limits))}"
    if measurement.channel:
        yield f"  channel               {measurement.channel}"
    yield f"  taken off             {measurement.levelling}"
    if measurement.comment:
        yield f"  comment               {measurement.comment}"


def _prediction_lines(prediction: Prediction) -> Iterator[str]:
    """Lines with all predicted numbers, as files and JSON name them."""
    yield "Prediction (95% intervals)"
    for name, text in number_rows(prediction):
        yield f"  {name:58}{text}"


def number_rows(prediction: Prediction) -> Iterator[tuple[str, str]]:
    """Long names and texts of all predicted numbers that are not NaN."""
    for variable in variables(Prediction):
        value = getattr(prediction, variable.name)
        number = value if isinstance(value, Estimate) else replace(UNKNOWN, value=value)
        if math.isfinite(number.value):
            yield variable.attributes["long_name"], estimate_text(variable.units, number)


def _source_lines(prediction: Prediction) -> Iterator[str]:
    """Lines with the works of adhesion by the paper, by the law and as predicted, and why."""
    for row in (("Works of adhesion by", *ADHESIONS), *source_rows(prediction)):
        source, *works = row
        yield f"  {source:25}{''.join(f'  {work:>26}' for work in works)}"
    yield f"  {reason_for_differences(prediction)}"


def source_rows(prediction: Prediction) -> Iterator[tuple[str, ...]]:
    """Works of adhesion by their source, as texts."""
    for row in works_by_source(prediction):
        works = (row.w_appr, row.w_retr, row.hysteresis)
        yield row.source, *(estimate_text(ENERGY, work) for work in works)


def _conformity_lines(energy: Number, work_of_adhesion: float) -> Iterator[str]:
    """Lines of e_el and w_rms."""
    rms = 2 * math.sqrt(energy.value * work_of_adhesion)
    shown, part = estimate_text(ENERGY, energy), energy.value / work_of_adhesion
    yield f"  {'e_el':25}{shown} = {part:.3g} w_int"
    yield f"  {'w_rms':25}{prefixed(ENERGY, rms)} = {rms / work_of_adhesion:.3g} w_int"


def _limit_text(limit: BandLimit) -> str:
    """A limit of the trusted wavelengths with its cause."""
    return f"{prefixed('m', limit.wavelength)} ({limit.cause})"


def _scan_entries(surface: MeasuredSurface) -> Iterator[dict[str, Any]]:
    """Scans for JSON, without heights: files, trusted wavelengths and densities."""
    joint = surface.joint.density
    for index, scan in enumerate(surface.scans):
        measurement = scan.measurement
        names = [item.name for item in fields(measurement) if item.name not in ("heights", "gaps")]
        yield {
            **{name: to_jsonable(getattr(measurement, name)) for name in names},
            "missing": measurement.missing,
            "missing_weight": scan.missing_weight,
            "points": list(measurement.heights.shape),
            **to_jsonable(scan.band),
            "density": to_jsonable(scan.trusted),
            "profile_density": to_jsonable(scan.profile),
            "level": to_jsonable(joint.levels[index]),
            "disagrees": joint.disagrees(index),
        }


def _energy_entry(surface: Surface, contact_modulus: float) -> dict[str, Any]:
    """e_el by the spectrum and by the recorded waves (Units: J / m^2)."""
    return to_jsonable(surface.conformity_energy(contact_modulus)) | {
        "recorded": to_jsonable(surface.conformity_energy(contact_modulus, surface.recorded))
    }
