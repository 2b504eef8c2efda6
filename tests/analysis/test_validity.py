"""What the shipped table of the front's hysteresis against boundary elements is made to say."""

import math

import pytest

from crackfront.analysis.validity import ValidityRow, excess_coefficient, front_excess


def row(energy, ratio, size=1.0, error=0.05):
    return ValidityRow(1.0, 1.0, energy, size, ratio, error, 4, 4, 256)


def test_the_coefficient_weighs_amplitudes_by_their_errors():
    rows = [row(0.1, math.exp(0.2)), row(0.2, math.exp(0.6), error=0.05)]
    both, error = excess_coefficient(rows)
    assert 2 < both < 3
    assert excess_coefficient([*rows, row(0.2, 9.0, error=math.nan)]) == (both, error)


def test_a_hysteresis_is_divided_where_both_were_compared_and_else_its_interval_reaches_there():
    rows = [row(0.05, 1.1, 0.5), row(0.18, 1.5, 1.3)]
    inside, larger, stronger = (
        front_excess(*scene, rows) for scene in ((0.1, 1.0), (0.1, 10.0), (0.4, 1.0))
    )
    assert inside.is_measured
    assert inside.ratio.value == pytest.approx(math.exp(0.1 * excess_coefficient(rows)[0]))
    for outside in (larger, stronger):
        assert (outside.is_measured, outside.ratio.value) == (False, 1)
