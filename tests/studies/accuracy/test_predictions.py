"""Predictions from scans, held against simulations of the surfaces."""

import numpy as np
import pytest

from studies.accuracy import predictions
from studies.accuracy.predictions import comparison_table
from studies.numbers import stored
from tests.places import ROOT


@pytest.fixture(scope="module")
def comparisons():
    """Predictions beside simulations; half a minute."""
    return tuple(predictions.comparisons())


def is_met(predicted, simulated):
    """Whether two intervals are no further apart than both allow."""
    reach = np.hypot(*((item.high - item.low) / 2 for item in (predicted, simulated)))
    return abs(predicted.value - simulated.value) < reach


@pytest.mark.slow
def test_predictions_hold_for_surfaces_that_the_law_was_not_fitted_to(comparisons):
    for item in comparisons:
        simulated, law = item.simulations, item.prediction
        k = law.factors.both
        assert is_met(k, simulated.k)
        assert abs(simulated.k.value - k.value) < 0.3
        assert is_met(law.front_hysteresis, simulated.hysteresis)


@pytest.mark.slow
def test_the_stored_table_has_the_predictions_and_their_simulations(comparisons, monkeypatch):
    monkeypatch.chdir(ROOT)
    assert comparison_table(comparisons) == stored("accuracy").tables["Predictions"].table
