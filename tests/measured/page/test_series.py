"""The figure of a series of samples."""

import math

import numpy as np
import pytest

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.measured.page.series import SeriesPoint, series_figure


def points():
    """Predicted and measured, a least value, measured alone, and neither."""
    first, second = Estimate(20e-3, math.nan, 15e-3, 30e-3), Estimate(22e-3, 1e-3, 20e-3, 24e-3)
    bare = Estimate(9e-3, math.nan, math.nan, math.nan)
    return [
        SeriesPoint("A", "film", first, second, is_lower_bound=False),
        SeriesPoint("B", "film", first, UNKNOWN, is_lower_bound=True),
        SeriesPoint("C", "glass", UNKNOWN, bare, is_lower_bound=False),
        SeriesPoint("D", "glass", UNKNOWN, UNKNOWN, is_lower_bound=False),
    ]


def test_every_number_is_drawn_in_its_unit_with_its_interval():
    [axes] = series_figure(points(), "hysteresis").axes
    drawn = [container.lines for container in axes.containers]
    values = [float(line.get_ydata()[0]) for line, _, _ in drawn]
    assert values == pytest.approx([20, 22, 20, 9])
    is_open = [line.get_markerfacecolor() == "white" for line, _, _ in drawn]
    assert is_open == [False, True, False, True]
    bars = [np.array(bar.get_segments()[0])[:, 1] for _, _, bars in drawn for bar in bars]
    np.testing.assert_allclose(bars, [(15, 30), (20, 24), (15, 30)])
    assert [text.get_text() for text in axes.texts] == ["↑", "none", "none"]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["A", "B", "C", "D"]
    assert "mJ" in axes.get_ylabel()
