"""The figure of a prediction."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from crackfront.measured.page.prediction_figures import draw_scan, prediction_figure


def test_the_figure_shows_the_measured_and_the_predicted(surface, prediction):
    upper, force, lower = prediction_figure(surface, prediction).axes[:3]
    if upper.get_ylabel() == "" or "force" in lower.get_ylabel():
        force, lower = lower, force
    trusted = [one.trusted for one in surface.scans]
    profiles = [one.profile for one in surface.scans]
    # Behind the points of every scan stands the whole of its density.
    for lines, densities in ((upper.lines[::2], trusted), (lower.lines, profiles)):
        for line, density in zip(lines, densities, strict=False):
            np.testing.assert_array_equal(line.get_ydata(), density.value)
    radius, values = force.lines[1].get_data()
    assert values.min() == pytest.approx(-1e6 * prediction.pull_off_force.value, rel=1e-3)
    assert radius[np.argmin(values)] < 1e6 * prediction.contact_radius
    assert "µN" in force.get_ylabel()


@pytest.mark.parametrize(("panel", "label"), [("a", "C"), ("b", "C"), ("c", "force"), ("d", "y")])
def test_a_panel_alone_has_labels_of_its_own(surface, prediction, panel, label):
    axes = prediction_figure(surface, prediction, panel).axes[0]
    assert label in axes.get_ylabel()
    assert axes.get_xlabel()


def test_the_figure_says_which_waves_the_density_leaves_out(surface):
    axes = Figure().add_subplot()
    draw_scan(axes, surface.scans[0].measurement, stripes=(0, 1))
    assert axes.get_title().endswith(
        "without the paraboloid\n(a) without waves along x and y alone"
    )
