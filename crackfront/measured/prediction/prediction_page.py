"""A prediction as one page of text, or the reasons why there is none."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from crackfront.analysis.law import shipped_law
from crackfront.measured.prediction.next_scan import measure_next
from crackfront.measured.prediction.prediction_remarks import repelled_remarks
from crackfront.measured.prediction.prediction_texts import ENERGY, estimate_text, wavelengths_text
from crackfront.measured.prediction.remarks import remark_text
from crackfront.measured.prediction.surface_remarks import disagreements
from crackfront.measured.prediction.works_by_source import works_by_source
from crackfront.measured.spectrum.stated import StatedSurface
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    from crackfront.measured.prediction.prediction import Prediction

NOT_MODELLED = (
    "Quasi-static: rate, viscoelasticity, ageing and the preload do not enter; the soft body is a "
    "half-space."
)
"""What the model leaves out."""

_MOST_EQUAL = 1.25
"""Ratio of e_el as recorded to e_el, or its inverse, above which the page explains it."""


def prediction_page(prediction: Prediction) -> str:
    """The most important numbers, their reservations, and the next measurement, as a page."""
    verdict = prediction.verdict
    conflicts = [*disagreements(prediction.surface)]
    if prediction.factors is None:
        lines = _lines_without_numbers(prediction)
        return "\n".join([*map(remark_text, conflicts), *lines])
    further = [
        remark
        for remark in verdict.with_severity("undecided", "reservation")
        if remark not in conflicts
    ]
    met = [remark for remark in verdict.with_severity("holds") if remark.concerns == "thickness"]
    return "\n".join(
        [
            *map(remark_text, conflicts),
            *(f"{name:18}{text}" for name, text in headline_rows(prediction)),
            _paper_line(prediction),
            f"{verdict.heading}. {prediction.excess.sentence}",
            *map(remark_text, repelled_remarks(prediction.w_appr)),
            *map(remark_text, further),
            *map(remark_text, met),
            remark_text(measure_next(prediction.surface)),
            NOT_MODELLED,
            "Intervals are 95% intervals; --long prints all results.",
        ]
    )


def _lines_without_numbers(prediction: Prediction) -> Iterator[str]:
    """Why a prediction is not made, and e_el, which decides most of the conditions."""
    yield f"{prediction.verdict.heading}; nothing is predicted."
    yield from map(remark_text, prediction.verdict.with_severity("fails", "undecided"))
    yield f"{'e_el':18}{_energy_text(prediction)}"
    yield "--long prints all conditions and the surface."


def headline_rows(prediction: Prediction) -> Iterator[tuple[str, str]]:
    """Names and texts of the numbers of the page."""
    at_least, at_most = ("at least ", "at most ") if prediction.at_least else ("", "")
    hysteresis = at_least + estimate_text(ENERGY, prediction.hysteresis)
    if prediction.none_is_expected:
        smallest = shipped_law().size[0]
        hysteresis += f"; none expected: g {prediction.size:.2g} is below {smallest:.2g}"
    yield "hysteresis", hysteresis
    yield "w_appr", at_most + estimate_text(ENERGY, prediction.w_appr)
    yield "w_retr", estimate_text(ENERGY, prediction.w_retr)
    pull_off = estimate_text("N", prediction.pull_off_force)
    smooth = prefixed("N", prediction.pull_off_force_smooth)
    yield "pull-off force", f"{pull_off}; smooth sphere {smooth}"
    if math.isfinite(prediction.implied_work_of_adhesion.value):
        yield (
            "w_int by pull-off",
            estimate_text(ENERGY, prediction.implied_work_of_adhesion),
        )
    yield "e_el", at_least + _energy_text(prediction)
    yield _source_row(prediction)


def _paper_line(prediction: Prediction) -> str:
    """Values of the paper's Eq. (6) and of the law for the front, to compare with the headline."""
    paper, front, _ = works_by_source(prediction)
    hysteresis, w_appr, w_retr, by_law = (
        prefixed(ENERGY, work.value)
        for work in (paper.hysteresis, paper.w_appr, paper.w_retr, front.hysteresis)
    )
    return (
        f"{paper.source:18}hysteresis {hysteresis}, w_appr {w_appr}, w_retr {w_retr}; the law of k "
        f"for a front, not corrected, {by_law}; --long says why they differ"
    )


def _energy_text(prediction: Prediction) -> str:
    """The energy of full conformity, also in units of w_int."""
    relative = prediction.e_el.value / prediction.work_of_adhesion
    return f"{estimate_text(ENERGY, prediction.e_el)} = {relative:.3g} w_int"


def _source_row(prediction: Prediction) -> tuple[str, str]:
    """The height or energy of the surface as it was stated or recorded, and its waves."""
    surface = prediction.surface
    if isinstance(surface, StatedSurface):
        rms = prefixed("m", surface.measures[0].rms.value)
        waves = wavelengths_text(surface.shortest, surface.longest)
        return "rms height", f"{rms}; waves from {waves}"
    modulus = prediction.contact_modulus
    recorded = surface.conformity_energy(modulus, surface.recorded).value
    ratio = recorded / surface.conformity_energy(modulus).value
    text = prefixed(ENERGY, recorded)
    if ratio > _MOST_EQUAL:
        text += (
            f", {ratio:.2g} times e_el because it includes shorter waves that the scans contain "
            "but that are not trusted (instrument, noise)"
        )
    elif ratio < 1 / _MOST_EQUAL:
        text += f", {ratio:.2g} times e_el because it lacks the waves that a model continues"
    ends = [scan.band.wavelengths for scan in surface.scans]
    waves = wavelengths_text(min(low for low, _ in ends), max(high for _, high in ends))
    return "as recorded", f"{text}; trusted waves from {waves}"
