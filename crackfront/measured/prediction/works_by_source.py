"""Works of adhesion by the paper's Eq. (6), by the law of k, and as they are predicted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.finding import PAPER_FACTOR

if TYPE_CHECKING:
    from crackfront.measured.prediction.prediction import Prediction


@dataclass(frozen=True, slots=True)
class SourcedWorks:
    """Works of adhesion of both branches by one source (Units: J / m^2)."""

    source: str
    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]


def works_by_source(prediction: Prediction) -> tuple[SourcedWorks, ...]:
    """Works by Eq. (6) of the paper with k = 3, by the law of the front, and as predicted."""
    by_paper, w_int, e_el = PAPER_FACTOR, prediction.work_of_adhesion, prediction.e_el
    k_appr, k_retr = prediction.k_appr.value, prediction.k_retr.value
    return (
        SourcedWorks(
            f"paper, k = {by_paper:g}",
            _linear(e_el, w_int, -1 - by_paper),
            _linear(e_el, w_int, -1 + by_paper),
            _linear(e_el, 0.0, 2 * by_paper),
        ),
        SourcedWorks(
            "law of k, front",
            _exact(w_int - (1 + k_appr) * e_el.value),
            _exact(w_int - (1 - k_retr) * e_el.value),
            prediction.front_hysteresis,
        ),
        SourcedWorks(
            "corrected, as predicted", prediction.w_appr, prediction.w_retr, prediction.hysteresis
        ),
    )


def reason_for_differences(prediction: Prediction) -> str:
    """Why the sources differ, with the numbers of this prediction."""
    disorder = prediction.w_rms / prediction.work_of_adhesion
    sentence = (
        f"Eq. (6) of the paper has k = {PAPER_FACTOR:g} for all surfaces; by the law k falls with "
        "the disorder and rises with the size of the contact, and is "
        f"{prediction.k.value:.3g} at w_rms/w_int {disorder:.2g} and g {prediction.size:.3g}."
    )
    ratio = f"{prediction.front_excess.value:.2f}"
    if ratio == "1.00":
        return sentence
    return f"{sentence} A front has {ratio} times the hysteresis of boundary elements."


def _linear(energy: Estimate[float], start: float, slope: float) -> Estimate[float]:
    """A linear function of e_el with the interval that follows from it."""
    value, *ends = (start + slope * end for end in (energy.value, energy.low, energy.high))
    return Estimate(value, math.nan, min(ends), max(ends))


def _exact(value: float) -> Estimate[float]:
    """A number without an interval."""
    return Estimate(value, math.nan, math.nan, math.nan)
