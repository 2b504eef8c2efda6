"""Truncated power laws: recovery of what was drawn, normalisation, refusal."""

import numpy as np
import pytest
from scipy.integrate import quad

from crackfront.analysis.power_law import PowerLaw, truncated_power_law


def drawn(rng, exponent, cutoff, count):
    """Values from the law above 1, by rejection of a bare power law."""
    values = rng.uniform(size=40 * count) ** (-1 / (exponent - 1))
    return values[rng.uniform(size=values.size) < np.exp(-(values - 1) / cutoff)][:count]


@pytest.mark.parametrize(("exponent", "cutoff"), [(1.28, 100.0), (1.6, 30.0), (2.0, 1e5)])
def test_it_recovers_the_law_of_its_values(rng, exponent, cutoff):
    values = drawn(rng, exponent, cutoff, 3000)
    law = truncated_power_law(3 * values, 3.0, rng)
    assert law.low - 0.03 < exponent < law.high + 0.03
    assert law.high - law.low < 0.3
    assert law.n_value == 3000
    if cutoff < 1e4:
        assert law.cutoff == pytest.approx(3 * cutoff, rel=0.3)


def test_its_interval_covers_the_exponent_about_as_often_as_it_says(rng):
    laws = [truncated_power_law(drawn(rng, 1.28, 50.0, 150), 1.0, rng) for _ in range(8)]
    assert sum(law.low <= 1.28 <= law.high for law in laws) >= 6


def test_values_below_the_smallest_have_no_part(rng):
    values = drawn(rng, 1.5, 50.0, 500)
    more = np.concatenate([values, np.full(300, 0.5)])
    one = truncated_power_law(values, 1.0, np.random.default_rng(1))
    other = truncated_power_law(more, 1.0, np.random.default_rng(1))
    assert one.exponent == pytest.approx(other.exponent, abs=1e-12)


def test_its_density_is_normalised():
    law = PowerLaw(1.28, 1.2, 1.4, cutoff=80.0, smallest=2.0, n_value=100)
    integral = sum(
        quad(law.density, *ends, limit=200)[0] for ends in [(2.0, 20.0), (20.0, 200.0), (200, 8000)]
    )
    assert integral == pytest.approx(1.0, abs=1e-7)


def test_too_few_values_are_refused(rng):
    with pytest.raises(ValueError, match="3 values lie above 1; a power law needs 20"):
        truncated_power_law(np.array([0.5, 1.0, 2.0, 3.0]), 1.0, rng)
