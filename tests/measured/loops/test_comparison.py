"""Measured loops beside predictions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from crackfront.analysis.estimate import Estimate
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.comparison import comparison_lines, hysteresis_ratio
from crackfront.measured.loops.rig import Rig
from crackfront.measured.prediction.remarks import Remark, Verdict
from tests.measured.loops.made import MODULUS, RADIUS, loop


@pytest.mark.parametrize(("times", "is_far"), [(1.0, False), (3.0, True)])
def test_a_hysteresis_far_beyond_the_prediction_names_the_page_of_reasons(times, is_far):
    found = analyse_loop(loop(0), Rig(RADIUS, MODULUS))
    doubt = Remark("small slopes", "reservation", "slopes are large")
    verdict = Verdict((doubt, Remark("k", "note", "as usual")))
    predicted = SimpleNamespace(
        verdict=verdict,
        work_of_adhesion=0.05,
        e_el=Estimate(0.005, 0.001, 0.003, 0.007),
        **{name: getattr(found, name) for name in ("w_appr", "w_retr", "hysteresis")},
    )
    larger = replace(found, hysteresis=found.hysteresis.each(lambda work: times * work))
    lines = list(comparison_lines(larger, predicted))
    assert hysteresis_ratio(larger, predicted).value == pytest.approx(times)
    assert any("docs/questions.md" in line for line in lines) == is_far
    assert "no viscoelasticity, no ageing, and the preload does not enter" in lines[-1]
    assert "The theory applies with 1 reservation." in lines
    assert any("slopes are large" in line for line in lines)
    assert not any("as usual" in line for line in lines)


def test_the_ratio_has_the_intervals_of_both():
    known = Estimate(2.0, float("nan"), 1.0, 4.0)
    one = SimpleNamespace(hysteresis=known)
    ratio = hysteresis_ratio(one, SimpleNamespace(hysteresis=known))
    assert (ratio.low, ratio.high) == pytest.approx((0.5**2**0.5, 2**2**0.5))
    narrower = SimpleNamespace(hysteresis=replace(known, low=1.8, high=2.5))
    ratio = hysteresis_ratio(one, narrower)
    reaches = np.hypot(np.log(2), np.log([2.5 / 2, 2 / 1.8]))
    assert (ratio.low, ratio.high) == pytest.approx(np.exp(reaches * [-1, 1]))
    none = SimpleNamespace(hysteresis=replace(known, low=0.0))
    assert hysteresis_ratio(none, one).low == 0
