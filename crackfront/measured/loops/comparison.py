"""A measured loop beside what is predicted for scans of its surface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from crackfront.analysis.estimate import Estimate
from crackfront.core.variables import variables
from crackfront.measured.loops.loop import MeasuredLoop
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.remarks import remark_text
from crackfront.simulate.jsonable import to_jsonable
from crackfront.surfaces.written_units import prefixed

_WHAT_IS_LEFT = (
    "The predicted loop is quasi-static: no viscoelasticity, no ageing, and the preload does not "
    "enter. Neither interval covers the errors of modulus and radius in the prediction, nor what "
    "the model leaves out: roughness that is finer than the scans or outside of them, dissipation "
    "at the moving edge (viscoelasticity: repeat at a tenth of the speed), changes with time in "
    "contact (ageing, chemistry: repeat with a longer rest), and a w_int other than the given one "
    "(measure it on a smooth surface)."
)

_FAR = 2.0
"""Ratio of measured to predicted from which a page on the reasons is named."""


def hysteresis_ratio(found: MeasuredLoop, predicted: Prediction) -> Estimate[float]:
    """Measured hysteresis over the predicted one, with the intervals of both.

    Half-widths of the logarithms in quadrature; from 0 on where either interval reaches zero.
    """
    measured, expected = found.hysteresis, predicted.hysteresis
    if not (measured.value > 0 and expected.value > 0):
        return Estimate(math.nan, math.nan, math.nan, math.nan)
    ratio = measured.value / expected.value

    def reach(up: float, down: float) -> float:
        return math.hypot(math.log(up), math.log(down)) if min(up, down) > 0 else math.inf

    higher = reach(measured.high / measured.value, expected.low / expected.value)
    lower = reach(measured.low / measured.value, expected.high / expected.value)
    return Estimate(ratio, math.nan, ratio * math.exp(-lower), ratio * math.exp(higher))


def comparison_lines(found: MeasuredLoop, predicted: Prediction) -> Iterator[str]:
    """Lines on measured and predicted works of adhesion, and on what may explain a difference."""
    yield "Measured beside predicted"
    for name in ("hysteresis", "w_appr", "w_retr"):
        ours, theirs = getattr(found, name), getattr(predicted, name)
        texts = [prefixed("J/m2", one.value, one.low, one.high) for one in (ours, theirs)]
        yield f"  {name:16}{texts[0]}; predicted {texts[1]}"
    ratio = hysteresis_ratio(found, predicted)
    if math.isfinite(ratio.value):
        yield f"  {'ratio':16}{ratio.value:.3g} ({ratio.low:.2g} to {ratio.high:.2g})"
    if ratio.value > _FAR:
        yield (
            f"The measured hysteresis is {ratio.value:.2g} times the predicted one; "
            "the page Questions of an experiment of the documentation (docs/questions.md) says "
            "which measurements distinguish the causes."
        )
    yield f"{predicted.verdict.heading}."
    yield from map(remark_text, predicted.verdict.with_severity("undecided", "reservation"))
    yield _WHAT_IS_LEFT


def machine_readable(found: MeasuredLoop, predicted: Prediction | None) -> dict[str, Any]:
    """Numbers of a loop, and of its prediction where there is one, in the units of the loop."""
    numbers = {
        item.name: to_jsonable(getattr(found, item.name))
        for item in variables(MeasuredLoop)
        if not item.dims
    }
    units = "reduced" if found.reduced else "SI"
    numbers |= {"units": units, "window": list(found.window), "remarks": list(found.remarks)}
    if predicted is None:
        return numbers
    names = ("e_el", "w_appr", "w_retr", "hysteresis")
    reservations = predicted.verdict.with_severity("undecided", "reservation")
    return numbers | {
        "predicted": {name: to_jsonable(getattr(predicted, name)) for name in names}
        | {
            "outcome": predicted.verdict.outcome,
            "remarks": [*map(remark_text, reservations)],
        },
        "ratio": to_jsonable(hysteresis_ratio(found, predicted)),
    }
