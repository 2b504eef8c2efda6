"""The figure of a prediction."""

import numpy as np
import pytest
from matplotlib.text import Text

from crackfront.measured.page.prediction_figures import prediction_figure


@pytest.fixture(scope="module")
def figure(surface, prediction):
    """The figure, drawn once."""
    drawn = prediction_figure(surface, prediction)
    drawn.canvas.draw()
    return drawn


def test_the_figure_shows_the_measured_and_the_predicted(figure, surface, prediction):
    upper, force, lower = figure.axes[:3]
    if "force" in lower.get_xlabel():
        force, lower = lower, force
    trusted = [scan.trusted for scan in surface.scans]
    profiles = [scan.profile for scan in surface.scans]
    # Behind the points of every scan stands the whole of its density.
    for lines, densities in ((upper.lines[::2], trusted), (lower.lines, profiles)):
        for line, density in zip(lines, densities, strict=False):
            np.testing.assert_array_equal(line.get_ydata(), density.value)
    values, radius = force.lines[1].get_data()
    assert values.min() == pytest.approx(-1e6 * prediction.pull_off_force.value, rel=1e-3)
    assert radius[np.argmin(values)] < 1e6 * prediction.contact_radius
    assert "µN" in force.get_xlabel()


def test_names_of_bars_cover_no_bar_and_titles_of_scans_stay_inside(figure):
    isotropic = figure.axes[0]
    names = [text.get_window_extent() for text in isotropic.texts if "rms" in text.get_text()]
    bars = [line for line in isotropic.lines if line.get_linewidth() > 2]
    assert len(names) == len(bars) == 3
    for name in names:
        assert not any(name.overlaps(bar.get_window_extent()) for bar in bars)
    curve = next(line for line in isotropic.lines if "spectrum" in line.get_label())
    highest = isotropic.transData.transform(curve.get_xydata())[:, 1].max()
    assert all(name.y0 > highest for name in names)
    for title in figure.findobj(lambda artist: isinstance(artist, Text)):
        if "without" in title.get_text():
            assert title.get_window_extent().x0 >= 0
            assert title.get_window_extent().x1 <= figure.bbox.x1
