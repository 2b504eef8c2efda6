"""Figures of the comparison with boundary elements, drawn from the stored results."""

import numpy as np
import pytest

from crackfront.analysis.validity import excess_coefficient, shipped_validity
from studies.boundary_elements.page import SHORT_CUTOFFS, kept_surfaces
from studies.boundary_elements.picture import hysteresis_figure


@pytest.fixture(scope="module")
def panels():
    """Panels of the stored surfaces."""
    return hysteresis_figure(kept_surfaces()["strong"], SHORT_CUTOFFS["strong"]).axes


def test_all_drawn_values_have_error_bars(panels):
    for axes in panels:
        for container in axes.containers:
            (bars,) = container.lines[2]
            lengths = [np.ptp(segment[:, 1]) for segment in bars.get_segments()]
            assert len(lengths) == len(container.lines[0].get_xdata())
            assert min(lengths) > 0


def test_ratios_follow_the_law_of_predictions(panels):
    coefficient, _ = excess_coefficient(shipped_validity())
    law = next(line for line in panels[1].lines if "law" in line.get_label())
    np.testing.assert_allclose(law.get_ydata(), np.exp(coefficient * law.get_xdata()))
    named = [container for container in panels[1].containers if container.get_label()[0] != "_"]
    assert len(named) == 2
    for limit in named:
        energy, ratio = limit.lines[0].get_data()
        assert np.all(np.abs(np.log(ratio) - coefficient * energy) < 0.3)
