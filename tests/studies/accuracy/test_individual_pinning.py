"""Straight fronts far beyond w_rms = w_int pin site by site."""

import numpy as np
import pytest

from studies.accuracy import individual_pinning
from studies.accuracy.individual_pinning import (
    exponent,
    front_hysteresis,
    independent_hysteresis,
)


@pytest.fixture
def _small_tile(monkeypatch):
    """A tile of a quarter of the side, with springs and travel to match."""
    monkeypatch.setattr(individual_pinning, "SIDE", 32)
    monkeypatch.setattr(individual_pinning, "SPRING", 3.0)
    monkeypatch.setattr(individual_pinning, "TRANSIENT", 16.0)


@pytest.mark.usefixtures("_small_tile")
def test_a_line_of_vanishing_stiffness_has_the_hysteresis_of_independent_sites():
    independent = independent_hysteresis(0)
    shares = [front_hysteresis(s, 0) / independent for s in (1.0, 30.0, 1000.0)]
    assert shares == sorted(shares)
    assert shares[0] < 0.5
    assert shares[-1] == pytest.approx(1.0, abs=0.03)


@pytest.mark.usefixtures("_small_tile")
def test_the_exponent_falls_from_above_one_and_a_half_to_one():
    weak, strong = (
        exponent(*(np.array([front_hysteresis(s, seed) for seed in (0, 1)]) for s in pair), 2.0)
        for pair in ((0.4, 0.8), (1000.0, 2000.0))
    )
    assert weak.value > 1.3
    assert strong.value == pytest.approx(1.0, abs=0.02)
