"""The front on the heights of a case, and the states that it shares with boundary elements."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core import jkr
from studies.boundary_elements.cycle import N_ANGLE
from studies.boundary_elements.front import front_cycle, shared_states, shown_states


def test_the_front_of_a_smooth_sphere_is_jkr(smooth_case):
    found = front_cycle(smooth_case, 64, 0.05)
    expected = [jkr.equilibrium_radius(b) for b in found.states.penetration]
    np.testing.assert_allclose(found.states.mean_radius, expected, rtol=1e-4)
    everywhere = np.repeat(np.array(expected)[:, None], N_ANGLE, axis=1)
    np.testing.assert_allclose(found.radius, everywhere, rtol=1e-4)


def test_states_are_shared_by_penetration_and_direction(front):
    states = front.states
    fewer = replace(
        states,
        penetration=states.penetration[1:],
        direction=states.direction[1:],
        force=states.force[1:],
    )
    one, other = shared_states(states, fewer)
    np.testing.assert_array_equal(one, np.arange(1, states.penetration.size))
    np.testing.assert_array_equal(other, one - 1)


def test_contacts_are_shown_where_both_branches_have_them(case, front):
    here = front.states.penetration[shown_states(case, front.states)]
    assert here == pytest.approx([0.3, 0.3])
    deep = replace(case, loads=case.loads.model_copy(update={"shown_penetration": -3.0}))
    with pytest.raises(ValueError, match=r"penetration -3 in approach; raise shown"):
        shown_states(deep, front.states)
