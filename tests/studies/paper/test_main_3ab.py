"""Main Fig. 3a, b on a coarse contact, and what makes its checks fail."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from studies.paper.figure import figure
from tests.studies.paper.made import computed, failed, parameters

SCENE = figure("main-3ab")
COARSE = {
    "short_cutoff": 0.14,
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


def test_a_missing_instability_breaks_the_balance(record):
    largest = int(np.argmax(record.energy))
    energy = np.where(np.arange(record.energy.size) == largest, 1e-9, record.energy)
    assert any("not stored" in claim for claim in failed(replace(record, energy=energy)))


def test_wrong_signs_extents_and_branches_fail(record):
    assert any(
        "dissipates energy" in claim for claim in failed(replace(record, energy=-record.energy))
    )
    assert any(
        "smallest extent" in claim for claim in failed(replace(record, extent=9 * record.extent))
    )
    swapped = replace(record, state_direction=-record.state_direction)
    assert "b = 0: the radius in approach (A) is below that in retraction (B)" in failed(swapped)


def test_disorder_in_the_wrong_order_is_refused():
    with pytest.raises(ValidationError, match="the first must be the larger"):
        parameters("main-3ab", **COARSE, weak=0.1)


def test_both_contacts_take_the_sites_of_the_larger():
    steps = {"load_step": 1.0, "travel": 0.5, "precision": 1e-3}
    coarse = parameters("main-3ab", **COARSE | steps | {"error": 0.1, "least_angles": 4})
    sites = [
        coarse.contact(energy, coarse.precision / 10).field.geometry.n_site
        for energy in (coarse.strong, coarse.weak)
    ]
    assert sites[0] != sites[1]
    assert computed("main-3ab", coarse).before.shape[1] == max(sites)


def test_its_drawing_has_patches_and_a_cycle(record):
    drawn = SCENE.draw(record)
    patches, cycle = drawn.axes[:2]
    assert len(patches.collections) == 2
    assert "force" in cycle.get_ylabel()
