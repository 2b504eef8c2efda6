"""Measured loops beside predictions."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from crackfront.analysis.estimate import Estimate
from crackfront.measured.loops.comparison import comparison_lines, hysteresis_ratio


def test_the_ratio_has_the_intervals_of_both():
    hysteresis = Estimate(2.0, float("nan"), 1.0, 4.0)
    loop = SimpleNamespace(hysteresis=hysteresis)
    ratio = hysteresis_ratio(loop, SimpleNamespace(hysteresis=hysteresis))
    assert (ratio.low, ratio.high) == pytest.approx((0.5**2**0.5, 2**2**0.5))
    narrower = SimpleNamespace(hysteresis=replace(hysteresis, low=1.8, high=2.5))
    ratio = hysteresis_ratio(loop, narrower)
    reaches = np.hypot(np.log(2), np.log([2.5 / 2, 2 / 1.8]))
    assert (ratio.low, ratio.high) == pytest.approx(np.exp(reaches * [-1, 1]))
    none = SimpleNamespace(hysteresis=replace(hysteresis, low=0.0))
    assert hysteresis_ratio(none, loop).low == 0


@pytest.mark.parametrize(
    ("predicted", "row", "sentence"),
    [
        ((1.0, 1.0), "2", ", 2 times as large"),
        ((0.5, 1.5), "2 (1.33 to 4)", ", 1.33 to 4 times as large"),
        ((0.0, 1.5), "2 (1.33 to inf)", ", at least 1.33 times as large"),
    ],
)
def test_an_interval_of_the_ratio_is_written_where_it_has_a_width(predicted, row, sentence):
    unknown, nothing = Estimate(*4 * [np.nan]), SimpleNamespace
    loop = nothing(hysteresis=Estimate(2.0, 0.0, 2.0, 2.0), w_appr=unknown, w_retr=unknown)
    verdict = nothing(heading="", outcome="", with_severity=lambda *_: [])
    interval = Estimate(1.0, np.nan, *predicted)
    works = {"hysteresis": interval, "w_appr": interval, "w_retr": interval, "e_el": interval}
    prediction = nothing(work_of_adhesion=1.0, verdict=verdict, **works)
    lines = list(comparison_lines(loop, prediction))
    assert [line.split(maxsplit=1)[1] for line in lines if line.startswith("  ratio")] == [row]
    assert sum(sentence in line for line in lines) == 1
