"""Differences of the front from boundary elements, state by state, and jumps of both."""

from dataclasses import replace

import numpy as np
import pytest

from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.differences import differences, jumps
from studies.boundary_elements.front import front_cycle


@pytest.fixture(scope="module")
def boundary(case, front):
    """A cycle that is that of the front, as boundary elements would record it."""
    states = front.states
    ones, nothing = np.ones(states.penetration.size), np.zeros((case.n_point, case.n_point))
    return BoundaryCycle(
        status="lost contact",
        **{name: getattr(states, name) for name in ("penetration", "direction", "force")},
        radius=front.radius,
        **dict.fromkeys(("energy", "released", "products", "seconds"), ones),
        **dict.fromkeys(("barriers", "saddles", "residual"), 0 * ones),
        shown_pressure=np.zeros((2, case.n_point, case.n_point)),
        pressure=nothing,
        trust_radius=1.0,
    )


@pytest.fixture
def circle():
    return np.ones(360)


def test_an_arc_that_moves_far_is_a_jump_where_it_moved_furthest(circle):
    angle = 2 * np.pi * np.arange(360) / 360
    bump = 0.1 * np.exp(-((np.rad2deg(angle) - 20) ** 2) / 50)
    second_bump = 0.6 * np.roll(bump, 90)
    radius = np.stack([circle, circle + bump + second_bump, circle + bump + second_bump])
    jumps_seen = jumps(np.array([0.0, 0.1, 0.2]), np.array([1, 1, 1]), radius, 0.05)
    jumps_seen.sort(key=lambda jump: jump.angle)
    assert [jump.penetration for jump in jumps_seen] == [0.1, 0.1]
    assert np.rad2deg([jump.angle for jump in jumps_seen]) == pytest.approx([20, 110])
    assert [jump.distance for jump in jumps_seen] == pytest.approx([0.1, 0.06])


def test_a_receding_arc_is_a_jump_in_retraction_only_and_turning_round_is_none(circle):
    radius = np.stack([circle, circle - 0.1 * (np.arange(360) < 30)])
    loads = np.array([0.1, 0.0])
    assert len(jumps(loads, np.array([-1, -1]), radius, 0.05)) == 1
    assert jumps(loads, np.array([1, 1]), radius, 0.05) == []
    assert jumps(loads, np.array([1, -1]), np.stack([circle, circle + 0.1]), 0.05) == []


def test_a_front_does_not_differ_from_itself(case, boundary, front):
    row = differences(case, boundary, front)
    assert row.force_largest == 0
    assert row.perimeter_all == pytest.approx(0, abs=1e-12)
    assert row.area_rms == pytest.approx(0, abs=1e-8)
    assert row.jumps_shared == row.jumps_front == row.jumps_boundary > 0
    assert row.jump_spread == 0


def test_differences_are_those_of_the_boundary_elements_minus_the_front(case, boundary, front):
    shifted = replace(boundary, force=boundary.force - 0.1, radius=1.01 * boundary.radius)
    row = differences(case, shifted, front)
    assert row.force_mean == pytest.approx(-0.1)
    assert row.force_rms == pytest.approx(0.1)
    assert row.area_mean == pytest.approx(0.0201)
    assert row.pull_off_force == pytest.approx(-0.1)
    radius = front.states.mean_radius[np.isclose(front.states.penetration, 0.3)][0]
    assert row.perimeter_approach == pytest.approx(0.01 * radius / 0.6, rel=1e-6)


def test_a_crack_that_does_not_turn_gives_another_front(case, boundary):
    row = differences(case, boundary, front_cycle(case, 64, 0.05, rotated=False))
    assert row.perimeter_all > 0.01
