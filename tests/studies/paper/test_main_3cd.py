"""Main Fig. 3c, d: the loop between its JKR curves, and the fronts on the field."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core.field.rays import front_adhesion
from crackfront.simulate.simulation import simulation_field
from studies.paper.rough import patch_of
from tests.studies.paper.made import computed, failed, parameters


def coarse(**changes):
    defaults = {
        "seed": 1,
        "error": 0.5,
        "short_cutoff": 0.02,
        "elastic_energy": 0.1,
        "step": 0.1,
        "patch_side": 0.4,
        "close_side": 0.2,
    }
    return parameters("main-3cd", **defaults | changes)


@pytest.fixture(scope="module")
def loop():
    return computed("main-3cd", coarse())


def test_a_coarse_loop_fails_no_check_but_those_of_the_paper(loop):
    assert [claim for claim in failed(loop) if "main text" not in claim] == []


def test_the_loop_of_k_3_passes_the_checks_of_the_paper(loop):
    e_el = loop.elastic_energy
    right = replace(loop, approach=1 - 4 * e_el, retraction=1 + 2 * e_el)
    assert failed(right) == []
    wrong = replace(loop, approach=1 - 2 * e_el, retraction=1 + 1.2 * e_el)
    assert len(failed(wrong)) == 3


def test_fronts_that_sample_the_wrong_places_fail_their_checks(loop):
    swapped = replace(loop, front_adhesion=loop.front_adhesion[[1, 0, 2]])
    claims = " ".join(failed(swapped))
    for words in ("approach: below", "retraction: above", "of a G"):
        assert words in claims
    rigid = replace(loop, front_adhesion=loop.front_adhesion[[0, 1, 0]])
    assert "rigid circle: at" in " ".join(failed(rigid))


def test_a_patch_is_the_field_that_the_front_feels():
    simulation = coarse().simulation()
    field = simulation_field(simulation)
    along = front_adhesion(np.full(field.geometry.n_site, 1.2), field) * np.pi
    for ray in (0, field.geometry.n_site // 3):
        place = (1.2 * way[ray : ray + 1] for way in field.geometry)
        np.testing.assert_allclose(patch_of(field, *place)[0, 0], along[ray], atol=1e-3)
