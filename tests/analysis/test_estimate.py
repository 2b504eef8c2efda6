"""Means, resampled means and sums of estimates, against textbooks."""

import numpy as np
import pytest

from crackfront.analysis.estimate import (
    combination,
    mean_estimate,
    resample_counts,
    student_estimate,
)


def test_a_mean_has_the_textbook_interval():
    estimate, count = mean_estimate(np.array([1.0, 2.0, np.nan, 3.0, 6.0]))
    assert count == 4
    assert estimate.value == 3.0
    assert estimate.standard_error == pytest.approx(np.sqrt(14 / 3 / 4))
    assert estimate.high - 3.0 == pytest.approx(3.182446305284263 * np.sqrt(14 / 3 / 4))


def test_a_mean_of_two_values_has_an_error_and_no_interval_which_would_be_13_errors_wide():
    estimate, _ = mean_estimate(np.array([1.0, 3.0]))
    assert estimate.standard_error == pytest.approx(1.0)
    assert np.isnan([estimate.low, estimate.high]).all()


def test_bootstrap_samples_of_n_minus_one_give_the_standard_error_of_a_mean(rng):
    values = rng.standard_normal(4)
    counts = resample_counts(200_000, 4, rng)
    assert np.all(np.sum(counts, axis=1) == 3)
    assert np.std(counts @ values / 3) == pytest.approx(np.std(values, ddof=1) / 2, rel=0.01)


def test_a_combination_of_independent_estimates_follows_welch():
    parts = student_estimate(np.array([1.0, 2.0, np.nan]), np.array([0.3, 0.4, np.nan]), [3, 3, 0])
    combined = combination(parts, np.array([3, 3, 0]), np.array([1.0, 1.0, 0.0]))
    assert combined.value == 3.0
    assert combined.standard_error == pytest.approx(0.5)
    freedom = 0.25**2 / (0.09**2 / 3 + 0.16**2 / 3)
    assert combined.high == pytest.approx(student_estimate(3.0, 0.5, freedom).high, rel=1e-12)
    assert np.isnan(combination(parts, np.array([3, 3, 0]), np.zeros(3)).value)
