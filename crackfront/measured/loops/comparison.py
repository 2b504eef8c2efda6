"""A measured loop next to the prediction for scans of its surface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.measured.loops.loop_page import loop_json
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.remarks import remark_text
from crackfront.simulate.jsonable import to_jsonable
from crackfront.surfaces.written_units import prefixed

_NOT_PREDICTED = (
    "The predicted loop is quasi-static: no viscoelasticity, no ageing, and the preload does not "
    "enter. Neither interval covers the errors of modulus and radius in the prediction, nor what "
    "the model leaves out: roughness that is finer than the scans or outside of them, dissipation "
    "at the moving edge (viscoelasticity: repeat at a tenth of the speed), changes with time in "
    "contact (ageing, chemistry: repeat with a longer rest), and a w_int other than the given one "
    "(measure it on a smooth surface)."
)

_FAR = 2.0
"""Ratio of measured to predicted hysteresis from which a page on the reasons is named."""


def hysteresis_ratio(loop: MeasuredLoop, prediction: Prediction) -> Estimate[float]:
    """Measured over predicted hysteresis, whose interval combines both intervals.

    The half-widths of the logarithms add in quadrature. The interval starts at zero if the measured
    one or the predicted one reaches zero.
    """
    measured, predicted = loop.hysteresis, prediction.hysteresis
    if not (measured.value > 0 and predicted.value > 0):
        return UNKNOWN
    ratio = measured.value / predicted.value
    above = _reach(measured.high / measured.value, predicted.low / predicted.value)
    below = _reach(measured.low / measured.value, predicted.high / predicted.value)
    return Estimate(ratio, math.nan, ratio * math.exp(-below), ratio * math.exp(above))


def _reach(measured: float, predicted: float) -> float:
    """Half-width of the logarithm of a ratio, from relative ends of two intervals."""
    if min(measured, predicted) <= 0:
        return math.inf
    return math.hypot(math.log(measured), math.log(predicted))


def comparison_lines(loop: MeasuredLoop, prediction: Prediction) -> Iterator[str]:
    """Lines on measured and predicted works of adhesion, and on what may explain a difference."""
    yield "Measured and predicted"
    for name in ("hysteresis", "w_appr", "w_retr"):
        measured, predicted = (
            prefixed("J/m2", work.value, work.low, work.high)
            for work in (getattr(loop, name), getattr(prediction, name))
        )
        yield f"  {name:16}{measured}; predicted {predicted}"
    ratio = hysteresis_ratio(loop, prediction)
    if math.isfinite(ratio.value):
        yield f"  {'ratio':16}{ratio.value:.3g} ({ratio.low:.2g} to {ratio.high:.2g})"
    if ratio.value > _FAR:
        yield (
            f"The measured hysteresis is {ratio.value:.2g} times the predicted one; "
            "the page Questions of an experiment of the documentation (docs/questions.md) says "
            "which measurements distinguish the causes."
        )
    yield f"{prediction.verdict.heading}."
    yield from _remarks(prediction)
    yield _NOT_PREDICTED


def machine_readable(loop: MeasuredLoop, prediction: Prediction | None) -> dict[str, Any]:
    """Numbers of a loop, and of its prediction if there is one, in the units of the loop."""
    numbers = loop_json(loop)
    if prediction is None:
        return numbers
    names = ("e_el", "w_appr", "w_retr", "hysteresis")
    predicted = {name: to_jsonable(getattr(prediction, name)) for name in names}
    verdict = {"outcome": prediction.verdict.outcome, "remarks": _remarks(prediction)}
    ratio = to_jsonable(hysteresis_ratio(loop, prediction))
    return numbers | {"predicted": predicted | verdict, "ratio": ratio}


def _remarks(prediction: Prediction) -> list[str]:
    """Remarks on a prediction that concern whoever compares it with a loop."""
    return [
        remark_text(remark)
        for remark in prediction.verdict.with_severity("undecided", "reservation")
    ]
