"""Truncated power laws: recovery of what was drawn, normalisation, errors."""

import numpy as np
import pytest

from studies.paper.power_law import (
    joint_power_law,
    truncated_power_law,
)


def drawn(rng, exponent, cutoff, count):
    """Values from the law above 1, by rejection of a bare power law."""
    values = rng.uniform(size=40 * count) ** (-1 / (exponent - 1))
    return values[rng.uniform(size=values.size) < np.exp(-(values - 1) / cutoff)][:count]


@pytest.mark.usefixtures("_few_draws")
@pytest.mark.parametrize(("exponent", "cutoff"), [(1.28, 100.0), (1.6, 30.0), (2.0, 1e5)])
def test_it_recovers_the_law_of_its_values(rng, exponent, cutoff):
    values = drawn(rng, exponent, cutoff, 3000)
    law = truncated_power_law(3 * values, 3.0, rng)
    assert law.low - 0.03 < exponent < law.high + 0.03
    assert law.high - law.low < 0.3
    assert law.n_value == 3000
    if cutoff < 1e4:
        assert law.cutoff == pytest.approx(3 * cutoff, rel=0.3)


@pytest.mark.slow
def test_its_interval_covers_the_exponent_about_as_often_as_it_says(rng):
    laws = [truncated_power_law(drawn(rng, 1.28, 50.0, 150), 1.0, rng) for _ in range(8)]
    assert sum(law.low <= 1.28 <= law.high for law in laws) >= 6


SCALES = (600.0, 3000.0, 15000.0)


def scaling(rng, exponent, count, shoulder=0.6, tail=1.6, steepness=1.3):
    """Samples from 3 on of a joint law, by inversion of its distribution."""
    samples = []
    for scale in SCALES:
        grid = np.geomspace(3.0, 100 * scale, 20001)
        scaled = grid / scale
        log = shoulder * np.sqrt(scaled) - tail / 4 * scaled**steepness
        mass = np.cumsum(grid ** (1 - exponent) * np.exp(log))
        samples.append(np.interp(rng.uniform(size=count), mass / mass[-1], grid))
    return samples


@pytest.mark.usefixtures("_few_draws")
@pytest.mark.parametrize("exponent", [1.28, 1.56])
def test_a_joint_law_recovers_the_exponent_of_samples_with_a_shoulder(rng, exponent):
    law = joint_power_law(scaling(rng, exponent, 5000), 30.0, rng)
    assert law.low - 0.02 < exponent < law.high + 0.02
    assert law.high - law.low < 0.2
    assert law.exponent == pytest.approx(exponent, abs=0.08)


@pytest.mark.usefixtures("_few_draws")
def test_the_exponent_of_a_joint_law_shifts_with_its_beginning_where_there_is_no_power_law(rng):
    samples = scaling(rng, 1.28, 5000)
    true = joint_power_law(samples, 30.0, rng)
    assert true.shift < true.scatter
    # Twice the values below 60, which a power law would not have.
    bent = [np.concatenate([sample, sample[sample < 60]]) for sample in samples]
    law = joint_power_law(bent, 30.0, rng)
    assert law.exponent - law.later == pytest.approx(law.shift)
    assert law.shift > 2 * law.scatter


def test_too_few_values_of_any_sample_are_refused(rng):
    with pytest.raises(ValueError, match="3 values lie above 1; a power law needs 20"):
        truncated_power_law(np.array([0.5, 1.0, 2.0, 3.0]), 1.0, rng)
    with pytest.raises(ValueError, match="2 values of a sample lie above 30; a power law needs 20"):
        joint_power_law([np.full(50, 40.0), np.array([1.0, 35.0, 50.0])], 30.0, rng)
