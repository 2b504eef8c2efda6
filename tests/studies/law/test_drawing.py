"""The figure of the law of k."""

import numpy as np
from click.testing import CliRunner

from studies.__main__ import main
from studies.law.cells import measured_cells
from studies.law.drawing import LawPoints, law_figure, spectra_points
from tests.places import ROOT


def test_the_command_draws_the_law(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    done = CliRunner().invoke(main, ["law", "figure", "--output", str(tmp_path / "figures")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "figures/law.png").stat().st_size > 10_000


def test_all_fronts_are_drawn_in_few_families_and_large_contacts_are_near_their_limit():
    fronts = spectra_points(measured_cells())
    values = (np.array([value]) for value in (0.4, 30.0, 2.8, 0.02, 1.75))
    collapse = law_figure(fronts, LawPoints("spheres", *values)).axes[0]
    drawn = [container.lines[0].get_data() for container in collapse.containers]
    assert sum(size.size for size, _ in drawn) == sum(points.size.size for points in fronts) + 1
    assert len(collapse.get_legend().get_texts()) == 7
    large = np.concatenate([share[size > 30] for size, share in drawn])
    assert large.size > 0
    assert np.all((large > 0.85) & (large < 1.05))
