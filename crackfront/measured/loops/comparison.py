"""A measured loop next to the prediction for scans of its surface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.measured.loops.loop_page import loop_json, pure_number
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.remarks import remark_text
from crackfront.simulate.jsonable import to_jsonable
from crackfront.surfaces.written_units import prefixed

_NOT_PREDICTED = (
    "The predicted loop is quasi-static and of a half-space: no viscoelasticity, no ageing, no "
    "thin layer, and the preload does not enter. Neither interval covers the errors of modulus and "
    "radius in the prediction, nor what the model leaves out: roughness that is finer than the "
    "scans or outside of them, dissipation at the moving edge (viscoelasticity: repeat at a tenth "
    "of the speed), changes with time in contact (ageing, chemistry: repeat with a longer rest), "
    "and a w_int other than the given one (measure it on a smooth surface)."
)


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


def mean_work(loop: MeasuredLoop) -> Estimate[float]:
    """Mean of w_appr and w_retr (Units: as of the works), which does not depend on the hysteresis.

    Its squared error is half of the sum of theirs less a quarter of the one of the hysteresis, with
    all errors that they share.
    """
    w_appr, w_retr, hysteresis = loop.w_appr, loop.w_retr, loop.hysteresis
    value = (w_appr.value + w_retr.value) / 2

    def reach(*reaches: float) -> float:
        squares = (reaches[0] ** 2 + reaches[1] ** 2) / 2 - reaches[2] ** 2 / 4
        return math.sqrt(max(squares, 0.0))

    parts = (w_appr, w_retr, hysteresis)
    return Estimate(
        value,
        reach(*(part.standard_error for part in parts)),
        value - reach(*(part.value - part.low for part in parts)),
        value + reach(*(part.high - part.value for part in parts)),
    )


def _predicted_mean(prediction: Prediction) -> Estimate[float]:
    """Mean of both works of adhesion by the theory, w_int - e_el (Units: J/m^2)."""
    w_int, e_el = prediction.work_of_adhesion, prediction.e_el
    return Estimate(w_int - e_el.value, e_el.standard_error, w_int - e_el.high, w_int - e_el.low)


def comparison_lines(loop: MeasuredLoop, prediction: Prediction) -> Iterator[str]:
    """Lines on measured and predicted works of adhesion, and on what may explain a difference."""
    yield "Measured and predicted"
    rows = {
        name: (getattr(loop, name), getattr(prediction, name), "predicted")
        for name in ("hysteresis", "w_appr", "w_retr")
    }
    rows["mean of both"] = mean_work(loop), _predicted_mean(prediction), "w_int - e_el"
    for name, (measured, predicted, origin) in rows.items():
        if math.isfinite(measured.value):
            texts = (
                prefixed("J/m2", work.value, work.low, work.high) for work in (measured, predicted)
            )
            yield f"  {name:16}{f'; {origin} '.join(texts)}"
    yield from _ratio_lines(hysteresis_ratio(loop, prediction))
    yield from _mean_lines(mean_work(loop), _predicted_mean(prediction), prediction)
    yield f"{prediction.verdict.heading}."
    yield from _remarks(prediction)
    yield _NOT_PREDICTED


def _ratio_lines(ratio: Estimate[float]) -> Iterator[str]:
    """The ratio of measured to predicted hysteresis, and what its interval says."""
    if not math.isfinite(ratio.value):
        return
    yield f"  {'ratio':16}{pure_number(ratio.value, ratio.low, ratio.high)}"
    if ratio.low <= 1 <= ratio.high:
        yield "Measured and predicted hysteresis agree within their intervals."
    else:
        comparison = "larger" if ratio.low > 1 else "smaller"
        low, high = pure_number(ratio.low), pure_number(ratio.high)
        times = low if low == high else f"{low} to {high}"
        if math.isinf(ratio.high):
            times = f"at least {low}"
        yield (
            f"The measured hysteresis is {comparison} than the predicted one, {times} times as "
            "large; the page Explain a difference (docs/questions.md) says which measurements "
            "distinguish the causes."
        )


def _mean_lines(
    measured: Estimate[float], predicted: Estimate[float], prediction: Prediction
) -> Iterator[str]:
    """Which w_int the mean of both works implies, if it contradicts the w_int of the prediction."""
    if not (measured.low > predicted.high or measured.high < predicted.low):
        return
    e_el = prediction.e_el
    value = measured.value + e_el.value
    below = math.hypot(measured.value - measured.low, e_el.value - e_el.low)
    above = math.hypot(measured.high - measured.value, e_el.high - e_el.value)
    yield (
        f"The mean of both works and e_el give a w_int of "
        f"{prefixed('J/m2', value, value - below, value + above)}, not "
        f"{prefixed('J/m2', prediction.work_of_adhesion)}: measure w_int on a smooth surface, and "
        "check the modulus and the radius of the sphere. Roughness outside of the scans lowers it."
    )


def machine_readable(loop: MeasuredLoop, prediction: Prediction | None) -> dict[str, Any]:
    """Numbers of a loop, and of its prediction if there is one, in the units of the loop."""
    numbers = loop_json(loop)
    if prediction is None:
        return numbers
    names = ("e_el", "w_appr", "w_retr", "hysteresis")
    predicted = {name: to_jsonable(getattr(prediction, name)) for name in names}
    predicted["mean"] = to_jsonable(_predicted_mean(prediction))
    verdict = {"outcome": prediction.verdict.outcome, "remarks": _remarks(prediction)}
    ratio = to_jsonable(hysteresis_ratio(loop, prediction))
    mean = to_jsonable(mean_work(loop))
    return numbers | {"mean": mean, "predicted": predicted | verdict, "ratio": ratio}


def _remarks(prediction: Prediction) -> list[str]:
    """Remarks on a prediction that concern whoever compares it with a loop."""
    return [
        remark_text(remark)
        for remark in prediction.verdict.with_severity("undecided", "reservation")
    ]
