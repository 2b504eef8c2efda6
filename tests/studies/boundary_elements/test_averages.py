"""Averages over surfaces, and their limit of no range."""

import math
from dataclasses import fields, replace
from operator import attrgetter

import numpy as np
import pytest
from scipy.special import stdtrit

from studies.boundary_elements.averages import Setting, limit_settings, range_limits
from studies.boundary_elements.hysteresis import Hysteresis

BOUNDARY, FRONT = attrgetter("boundary_difference"), attrgetter("front_difference")


def surface(**changes):
    row = Hysteresis(*(0,) * len(fields(Hysteresis)))
    return replace(row, roll_off=1.0, hurst=1.0, asked_energy=0.1, **changes)


def test_the_ratio_of_hystereses_is_that_of_the_means_with_the_error_of_the_jackknife():
    pairs = ((0.2, 0.1), (0.4, 0.3), (0.3, 0.2))
    rows = [
        surface(seed=seed, front_retraction=front_value, boundary_retraction=element_value)
        for seed, (front_value, element_value) in enumerate(pairs)
    ]
    ratio = Setting(tuple(rows)).excess(0.05)
    assert float(ratio.value) == pytest.approx(math.log(0.9 / 0.45))
    left = np.log([0.7 / 0.4, 0.5 / 0.2, 0.6 / 0.3])
    expected = math.sqrt(2 / 3 * np.sum((left - left.mean()) ** 2))
    assert float(ratio.standard_error) == pytest.approx(expected)
    assert math.isnan(Setting(tuple(rows[:1])).excess(0.0).standard_error)


def test_a_limit_has_the_longer_range_of_all_surfaces_and_its_change_on_some(rng):
    def row(seed, length, value):
        return surface(
            seed=seed, interaction_range=length, boundary_retraction=value, front_retraction=1.0
        )

    long = rng.uniform(0.2, 0.3, 6)
    rows = [row(seed, 0.4, value) for seed, value in enumerate(long)]
    rows += [row(seed, 0.2, long[seed] + change) for seed, change in enumerate((0.07, 0.14))]
    (limit,) = limit_settings(rows)
    assert (limit.surfaces, len(limit.rows)) == (6, 2)
    # Halved, the range leaves a seventh of what it changes: 0.08 and 0.16 in all.
    assert float(limit.mean(BOUNDARY).value) == pytest.approx(long.mean() + 0.12)
    left = [np.delete(long, seed).mean() + (0.16, 0.08, 0.12)[min(seed, 2)] for seed in range(6)]
    error = math.sqrt(5 / 6 * np.sum((np.array(left) - np.mean(left)) ** 2))
    mean = limit.mean(BOUNDARY)
    assert float(mean.standard_error) == pytest.approx(error)
    # The two with both ranges have one degree of freedom, the four others four.
    squares = (np.array(left) - np.mean(left)) ** 2
    shared, rest = squares[:2].sum(), squares[2:].sum()
    freedom = (shared + rest) ** 2 / (shared**2 + rest**2 / 4)
    assert float(mean.high - mean.value) == pytest.approx(error * stdtrit(freedom, 0.975))
    assert float(limit.mean(FRONT).standard_error) == pytest.approx(0, abs=1e-12)
    assert float(limit.excess(0.0).value) == pytest.approx(-math.log(long.mean() + 0.12))


def test_a_vanishing_range_is_extrapolated_by_its_cube():
    def row(length, **changes):
        return surface(
            interaction_range=length,
            boundary_approach=0.6 + 2 * length**3,
            boundary_retraction=0.4 - 3 * length**3,
            front_retraction=0.41,
            **changes,
        )

    (limit,) = range_limits([row(0.4), row(0.2, n_point=512), row(0.3)])
    assert limit.interaction_range == 0
    assert limit.n_point == 512
    assert limit.boundary_approach == pytest.approx(0.6)
    assert limit.boundary_retraction == pytest.approx(0.4)
    assert limit.front_retraction == 0.41
    assert range_limits([row(0.2), row(0.3, seed=1), row(0.4, step=0.1)]) == []
