"""Main Fig. 3a, b on a coarse contact, and what makes its checks fail."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.figure import figure
from tests.studies.paper.made import computed, failed, parameters

SCENE = figure("main-3ab")
COARSE = {
    "short_cutoff": 0.2,
    "load_step": 0.1,
    "precision": 1e-4,
    "error": 0.3,
    "least_angles": 160,
}


@pytest.fixture(scope="module")
def record():
    return computed("main-3ab", parameters("main-3ab", **COARSE))


def test_its_claims_hold_for_a_coarse_contact(record):
    assert failed(record) == []


def test_the_patches_of_a_retraction_do_not_overlap(record):
    for index in (0, 1):
        chosen = record.disorder_index == index
        assert np.all(record.after[chosen] <= record.before[chosen])
        assert np.all(record.before[chosen][1:] <= record.after[chosen][:-1])


def test_wrong_signs_extents_and_branches_fail(record):
    assert any(
        "dissipates energy" in claim for claim in failed(replace(record, energy=-record.energy))
    )
    assert any(
        "smallest extent" in claim for claim in failed(replace(record, extent=9 * record.extent))
    )
    swapped = replace(record, state_direction=-record.state_direction)
    assert "b = 0: the radius in approach (A) is below that in retraction (B)" in failed(swapped)


def test_its_drawing_has_patches_and_a_cycle(record):
    drawn = SCENE.draw(record)
    patches, cycle = drawn.axes[:2]
    assert len(patches.collections) == 2
    assert "force" in cycle.get_xlabel()
