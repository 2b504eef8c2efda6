"""The front on the heights of a case, and the states that it shares with boundary elements."""

from dataclasses import replace

import numpy as np

from crackfront.core import jkr
from studies.boundary_elements.cycle import N_ANGLE
from studies.boundary_elements.front import front_cycle, shared_states


def test_the_front_of_a_smooth_sphere_is_jkr(smooth_case):
    cycle = front_cycle(smooth_case, 64, 0.05)
    expected = [jkr.equilibrium_radius(b) for b in cycle.states.penetration]
    np.testing.assert_allclose(cycle.states.mean_radius, expected, rtol=1e-4)
    everywhere = np.repeat(np.array(expected)[:, None], N_ANGLE, axis=1)
    np.testing.assert_allclose(cycle.radius, everywhere, rtol=1e-4)


def test_states_are_shared_by_penetration_and_direction(front):
    states = front.states
    fewer = replace(
        states,
        penetration=states.penetration[1:],
        direction=states.direction[1:],
        force=states.force[1:],
    )
    shared, shared_fewer = shared_states(states, fewer)
    np.testing.assert_array_equal(shared, np.arange(1, states.penetration.size))
    np.testing.assert_array_equal(shared_fewer, shared - 1)
