"""Main Fig. 2: the loops on rings of high and low work of adhesion."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

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


def test_a_hysteresis_that_is_too_small_fails_its_checks(loops):
    claims = failed(replace(loops, case_retraction=loops.case_retraction - 0.01))
    assert [claim.split(":")[0] for claim in claims] == [
        f"amplitude 0.2, rings of {wavelength}" for wavelength in (0.1, 0.6)
    ]


@pytest.mark.parametrize("direction", [1, -1])
def test_the_first_stop_is_the_running_extreme_of_the_equilibria(direction):
    rings, radii = Rings(0.4, 0.36), np.linspace(INNERMOST, 2.4, 400_001)[::direction]
    reached = np.maximum.accumulate(direction * rings.penetration(radii))
    penetration = np.linspace(0.05, 1.15, 7)
    start = radii[0]
    dense = radii[np.searchsorted(reached, direction * penetration)]
    found = first_stops(rings, penetration, direction, start)
    assert found == pytest.approx(dense, abs=2 * abs(radii[1] - radii[0]))


def test_a_front_has_no_stop_below_the_deepest_equilibrium():
    assert np.isnan(first_stops(Rings(0.4, 0.36), np.array([-1.5]), -1, 1.6)).all()


def test_an_instability_lies_where_the_radius_jumps(loops):
    for index, wavelength in enumerate(loops.wavelength):
        for direction in (1, -1):
            branch = loops.branch(index, direction)
            moved = np.abs(np.diff(loops.radius[branch]))
            jumped = loops.jump[branch][1:] > 0
            assert moved[jumped].min() > 0.5 * wavelength > moved[~jumped].max()


def test_a_figure_of_rings_shows_units_on_every_axis(loops):
    drawn = figure("main-2").draw(loops)
    assert len(drawn.axes) == 5
    assert all("/" in axes.get_ylabel() for axes in drawn.axes)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"wavelengths": (0.05, 0.36)}, "wavelengths are .0.05, 0.36.; they must decrease"),
        ({"case_window": (0.7, 0.3)}, "case_window are .0.7, 0.3.; they must increase"),
        ({"amplitude": 1.0}, "less than 1"),
        ({"samples": 8}, "samples is 8; a ring needs at least 16"),
        ({"case_step": 0.5}, "case_step 0.5 is longer than case_window"),
    ],
)
def test_rings_that_cannot_be_computed_are_refused(change, sentence):
    with pytest.raises(ValidationError, match=sentence):
        parameters("main-2", **COARSE | change)
