"""Main Fig. 2: the loops on rings of high and low work of adhesion."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.figure import figure
from studies.paper.rings import INNERMOST, Rings, first_stops
from tests.studies.paper.made import computed, failed, parameters

COARSE = {"step": 0.025, "samples": 600, "case_wavelengths": (0.02, 0.1, 0.6), "case_step": 0.002}


@pytest.fixture(scope="module")
def loops():
    return computed("main-2", parameters("main-2", **COARSE))


def test_fronts_on_rings_rest_at_the_first_stopping_points(loops):
    assert failed(loops) == []
    first = [c for c in figure("main-2").checks(loops) if "first points" in c.claim]
    assert len(first) == 4


def test_a_front_that_passed_a_ring_fails_its_check(loops):
    passed = loops.radius.copy()
    index = np.flatnonzero(loops.branch(0, 1))[5]
    passed[index] += 1e-6
    claims = failed(replace(loops, radius=passed))
    assert len(claims) == 1
    assert "0.36, approach" in claims[0]


@pytest.mark.parametrize("direction", [1, -1])
def test_the_first_stop_is_the_running_extreme_of_the_equilibria(direction):
    rings, radii = Rings(0.4, 0.36), np.linspace(INNERMOST, 2.4, 400_001)[::direction]
    reached = np.maximum.accumulate(direction * rings.penetration(radii))
    penetration = np.linspace(0.05, 1.15, 7)
    start = radii[0]
    dense = radii[np.searchsorted(reached, direction * penetration)]
    places = first_stops(rings, penetration, direction, start)
    assert places == pytest.approx(dense, abs=2 * abs(radii[1] - radii[0]))


def test_an_instability_lies_where_the_radius_jumps(loops):
    for index, wavelength in enumerate(loops.wavelength):
        for direction in (1, -1):
            branch = loops.branch(index, direction)
            moved = np.abs(np.diff(loops.radius[branch]))
            jumped = loops.jump[branch][1:] > 0
            assert moved[jumped].min() > 0.5 * wavelength > moved[~jumped].max()
