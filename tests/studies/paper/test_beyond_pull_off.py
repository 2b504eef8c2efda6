"""Pull-off force against h_rms: surfaces of equal h_rms, and what makes the checks fail."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.figure import figure
from tests.studies.paper.made import computed, drawn_from_file, failed, is_labelled, parameters

SCENE = figure("beyond-pull-off")


def coarse(**changes):
    defaults = {"short_cutoffs": (0.2, 0.1), "error": 0.5, "tile_roll_offs": 10.0, "step": 0.05}
    return parameters("beyond-pull-off", **defaults | changes)


@pytest.fixture(scope="module")
def record():
    return computed("beyond-pull-off", coarse())


def test_surfaces_of_one_height_share_their_rms_and_short_waves_matter_more_below_a_half(
    record,
):
    np.testing.assert_allclose(record.rms_height[:, 0], record.rms_height[:, 1], rtol=1e-12)
    above, below = record.elastic_energy[:, 1] / record.elastic_energy[:, 0]
    assert np.all(above > 1)
    assert np.all(below > above)


def test_roughness_makes_pull_off_stronger_than_of_a_smooth_sphere_only_by_pinning(record):
    assert np.all(record.force < -1.2)
    assert np.all(record.force > -1.5 * (1 + 2 * record.elastic_energy[..., None]))


def test_forces_that_fall_with_the_height_fail(record):
    rising = replace(record, force=-1.5 * (1 + record.elastic_energy[..., None] * np.ones(4)))
    assert not any("> 0.5: the pull-off" in claim for claim in failed(rising))
    falling = replace(rising, force=-1.5 * (1 - record.elastic_energy[..., None] * np.ones(4)))
    assert any("> 0.5: the pull-off" in claim for claim in failed(falling))


def test_a_difference_within_the_scatter_of_surfaces_is_undecided(record, rng):
    clear = replace(record, force=-1.5 * (1 + record.elastic_energy[..., None] * np.ones(4)))
    assert SCENE.checks(clear)[1].result == "agrees"
    noise = 0.05 * rng.standard_normal(clear.force.shape)
    assert SCENE.checks(replace(clear, force=clear.force + noise))[1].result == "cannot be decided"


def test_its_drawing_has_a_panel_for_each_hurst_exponent(record, tmp_path):
    panels = drawn_from_file(record, tmp_path).axes
    assert [axes.get_legend().get_title().get_text() for axes in panels] == ["$H=0.8$", "$H=0.3$"]
    assert is_labelled(panels[:1])
