"""The animation of the contact on nanodiamond: what it shows, and its file."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from studies.paper.drawing import save_animation
from studies.paper.figure import figure
from tests.studies.paper.made import computed, failed, parameters

SCENE = figure("beyond-video")


@pytest.fixture(scope="module")
def shown():
    coarse = {"error": 0.5, "short_cutoff": 1.05e-6, "step": 960e-9, "retraction_step": 1920e-9}
    return computed("beyond-video", parameters("beyond-video", **coarse))


def test_the_cycle_is_whole_and_no_site_moves_back(shown):
    assert failed(shown) == []
    wrong = replace(shown, front=shown.front[::-1], status="stopped")
    assert len(failed(wrong)) == 2


def test_time_passes_at_the_speed_of_the_sphere(shown):
    steps = np.diff(shown.time)
    approach = shown.direction[1:] > 0
    np.testing.assert_allclose(steps[approach], 960e-9 / 60e-9)
    np.testing.assert_allclose(steps[~approach], 1920e-9 / 60e-9)


def test_the_contact_is_as_wide_as_its_fronts_in_micrometres_and_gone_at_the_end(shown):
    animation = SCENE.animate(shown)
    contact, *_ = animation.moving
    for state in (0, shown.time.size - 1):
        animation.show(state)
        widths = np.hypot(*contact.get_xy().T)
        assert widths.mean() == pytest.approx(1e6 * shown.front[state].mean(), rel=2e-3)
    animation.show(animation.n_frame - 1)
    assert not np.any(contact.get_xy())


def test_its_file_has_a_frame_for_every_state(shown, tmp_path):
    path = save_animation(SCENE.animate(shown), tmp_path / "video")
    with Image.open(path) as image:
        assert image.n_frames >= shown.time.size
