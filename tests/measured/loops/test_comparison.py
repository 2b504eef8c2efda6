"""Measured loops beside predictions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from crackfront.analysis.estimate import Estimate
from crackfront.measured.loops.comparison import hysteresis_ratio


def test_the_ratio_has_the_intervals_of_both():
    estimate = Estimate(2.0, float("nan"), 1.0, 4.0)
    loop = SimpleNamespace(hysteresis=estimate)
    ratio = hysteresis_ratio(loop, SimpleNamespace(hysteresis=estimate))
    assert (ratio.low, ratio.high) == pytest.approx((0.5**2**0.5, 2**2**0.5))
    narrower = SimpleNamespace(hysteresis=replace(estimate, low=1.8, high=2.5))
    ratio = hysteresis_ratio(loop, narrower)
    reaches = np.hypot(np.log(2), np.log([2.5 / 2, 2 / 1.8]))
    assert (ratio.low, ratio.high) == pytest.approx(np.exp(reaches * [-1, 1]))
    none = SimpleNamespace(hysteresis=replace(estimate, low=0.0))
    assert hysteresis_ratio(none, loop).low == 0
