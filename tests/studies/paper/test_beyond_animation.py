"""The animation of a cycle: what it shows, and how it is written."""

from dataclasses import replace

import pytest

from tests.studies.paper.made import computed, failed, parameters


@pytest.fixture(scope="module")
def shown():
    coarse = {"seed": 1, "error": 0.5, "tile_roll_offs": 10.0, "short_cutoff": 0.3}
    shown_parameters = parameters("beyond-animation", max_penetration=0.6, step=0.2, **coarse)
    return computed("beyond-animation", shown_parameters)


def test_the_animation_shows_a_cycle_whose_energies_close(shown):
    assert failed(shown) == []
    wrong = replace(shown, dissipated_energy=shown.dissipated_energy - 0.1, front=shown.front[::-1])
    assert len(failed(wrong)) == 4
