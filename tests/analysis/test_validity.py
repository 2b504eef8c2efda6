"""What the shipped table of the front's hysteresis against boundary elements is made to say."""

import math

import numpy as np
import pytest

from crackfront.analysis.validity import (
    ValidityRow,
    excess_coefficient,
    front_excess,
    size_error,
)


def row(energy, ratio, size=1.0, error=0.05):
    return ValidityRow(1.0, 1.0, energy, size, ratio, error, 4, 4, 256)


def test_the_coefficient_weighs_amplitudes_by_their_errors():
    rows = [row(0.1, math.exp(0.2)), row(0.2, math.exp(0.6), error=0.05)]
    coefficient, error = excess_coefficient(rows)
    assert 2 < coefficient < 3
    assert excess_coefficient([*rows, row(0.2, 9.0, error=math.nan)]) == (coefficient, error)


def test_a_hysteresis_is_divided_everywhere_with_an_interval_that_grows_beyond_what_was_compared():
    rows = [row(0.05, 1.1, 0.5), row(0.18, 1.5, 1.3)]
    within, *beyond = (front_excess(0.1, size, rows) for size in (1.0, 10.0, 100.0))
    expected = math.exp(0.1 * excess_coefficient(rows)[0])
    reach, *reaches = (math.log(case.ratio.high / expected) for case in (within, *beyond))
    for corrected in (within, *beyond):
        assert (corrected.is_measured, corrected.ratio.value) == (True, pytest.approx(expected))
    # What is not known of the size adds in quadrature, by the logarithm of the size.
    added = 1.96 * 0.1 * size_error(rows) * np.log([10 / 1.3, 100 / 1.3])
    assert np.sqrt(np.square(reaches) - reach**2) == pytest.approx(added)
    assert "g = 1.3; here they are 0.1 and 100" in beyond[1].sentence
    stronger = front_excess(0.4, 1.0, rows)
    coefficient = excess_coefficient(rows)[0]
    assert not stronger.is_measured
    assert stronger.ratio.value == pytest.approx(math.exp(0.4 * coefficient))
    assert stronger.ratio.low < math.exp(0.18 * coefficient) * 1.2
    # Nothing jumps where the comparison ends.
    last, next_one = (front_excess(energy, 1.0, rows).ratio for energy in (0.18, 0.18001))
    for end in ("low", "value", "high"):
        assert getattr(next_one, end) == pytest.approx(getattr(last, end), rel=1e-3)
