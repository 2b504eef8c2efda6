"""The fit of k in disorder and size: planted powers, their intervals, and cells without a fit."""

import numpy as np
import pytest

from crackfront.analysis.powers import power_fit

S, G = np.array([[0.3, 0.6, 0.8]] * 2), np.array([[0.5, 2.0, 4.0], [3.0, 12.0, 20.0]])
K = 2 * S**-0.3 * G**0.5
LAW = 3 * S**-0.2 * G**0.4
FREEDOM = np.array([5, 5])


def noisy(rng, k, scatter, number):
    """Relative noise of so many draws."""
    return k * np.exp(scatter * rng.standard_normal((number, *np.shape(k))))


def test_planted_powers_are_recovered_also_where_cells_are_missing():
    gaps = np.where([[True, True, True], [True, False, True]], K, np.nan)
    for k in (K, gaps):
        fit = power_fit(S, G, k, LAW, [None, None], FREEDOM - 5)
        assert fit.disorder_power.value == pytest.approx(-0.3)
        assert fit.size_power.value == pytest.approx(0.5)
        middle = 2 * fit.disorder**-0.3 * fit.size**0.5
        assert fit.factor.value == pytest.approx(float(middle))
        assert np.isnan(fit.size_power.low)
        assert (fit.law_disorder_power, fit.law_size_power) == pytest.approx((-0.2, 0.4))


def test_intervals_contain_the_planted_powers_as_often_as_they_say(rng):
    hits = []
    for _ in range(300):
        k = noisy(rng, K, 0.05, 1)[0]
        draws = [noisy(rng, row, 0.05, 200) for row in k]
        fit = power_fit(S, G, k, LAW, draws, FREEDOM + 1000)
        hits.append(fit.size_power.low < 0.5 < fit.size_power.high)
    # Three standard deviations of a binomial around 0.95 are 0.038.
    assert np.mean(hits) == pytest.approx(0.95, abs=0.04)


def test_a_larger_scatter_widens_the_interval_in_proportion(rng):
    widths = []
    for scatter in (0.02, 0.04):
        draws = [noisy(rng, row, scatter, 4000) for row in K]
        power = power_fit(S, G, K, LAW, draws, FREEDOM).disorder_power
        widths.append(power.high - power.low)
    assert widths[1] == pytest.approx(2 * widths[0], rel=0.1)


@pytest.mark.parametrize(
    ("s", "g"),
    [(S[:1], S[:1] ** 2 * 5), (S[:1], np.full((1, 3), 2.0)), (S, np.full(S.shape, np.nan))],
    ids=["equal springs", "equal sizes of three cells", "no sizes"],
)
def test_cells_that_do_not_span_disorder_and_size_have_no_fit(s, g):
    fit = power_fit(s, g, K[: len(s)], LAW[: len(s)], [None] * len(s), FREEDOM[: len(s)])
    assert np.isnan([fit.factor.value, fit.size_power.value, fit.disorder]).all()
