"""The figure of a prediction."""

import numpy as np
import pytest

from crackfront.measured.page.prediction_figures import prediction_figure


def test_the_figure_shows_the_measured_and_the_predicted(surface, prediction):
    upper, force, lower = prediction_figure(surface, prediction).axes[:3]
    if upper.get_ylabel() == "" or "force" in lower.get_ylabel():
        force, lower = lower, force
    trusted = [scan.trusted for scan in surface.scans]
    profiles = [scan.profile for scan in surface.scans]
    # Behind the points of every scan stands the whole of its density.
    for lines, densities in ((upper.lines[::2], trusted), (lower.lines, profiles)):
        for line, density in zip(lines, densities, strict=False):
            np.testing.assert_array_equal(line.get_ydata(), density.value)
    radius, values = force.lines[1].get_data()
    assert values.min() == pytest.approx(-1e6 * prediction.pull_off_force.value, rel=1e-3)
    assert radius[np.argmin(values)] < 1e6 * prediction.contact_radius
    assert "µN" in force.get_ylabel()
