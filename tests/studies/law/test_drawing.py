"""The figure of the law of k."""

from pathlib import Path

import numpy as np
from click.testing import CliRunner

from crackfront.analysis.law import LEAST_SIZE, TYPICAL_BREADTH, law_value, shipped_law
from studies.__main__ import main
from studies.law.cells import measured_cells
from studies.law.drawing import LawPoints, law_figure, spectra_points

ROOT = Path(__file__).parents[3]


def drawn_at(container):
    """Points of errorbars."""
    return np.transpose(container.lines[0].get_data())


def test_the_figure_collapses_fronts_and_spheres_on_one_curve():
    law = shipped_law()
    fronts = spectra_points(measured_cells())
    s, g = np.array([0.2, 0.4]), np.array([5.0, 10.0])
    spheres = LawPoints(
        "spheres",
        s,
        g,
        law_value(law.coefficients, s, g),
        np.full(2, 0.01),
        np.full(2, TYPICAL_BREADTH),
    )
    figure = law_figure(fronts, spheres)
    left, right = figure.axes
    curve = left.get_lines()[0].get_xydata()
    points = drawn_at(left.containers[len(fronts)])
    expected = np.interp(np.log(points[:, 0]), np.log(curve[:, 0]), curve[:, 1])
    np.testing.assert_allclose(points[:, 1], expected, rtol=1e-3)
    # Extrapolated they lie on the limit.
    np.testing.assert_allclose(
        drawn_at(right.containers[-1]), np.transpose([s, law_value(law.coefficients, s, np.inf)])
    )
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(labels) == len(fronts) + 2
    assert {"$H=0.8$", "flat, chemical", "$H=0.9$, then $0.3$"} <= set(labels)
    assert (curve[0, 0], left.get_lines()[1].get_xdata()[-1]) == (LEAST_SIZE, LEAST_SIZE)
    looks = {(one[0].get_color(), one[0].get_marker()) for one in left.containers}
    assert len(looks) == len(fronts) + 1
    theories = [text.get_text() for text in right.get_legend().get_texts()]
    assert [one[:5] for one in theories if "k = " in one] == ["$k = ", "$k = "]


def test_the_command_draws_the_law(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    done = CliRunner().invoke(main, ["law", "figure", "--output", str(tmp_path / "figures")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "figures/law.png").stat().st_size > 10_000
