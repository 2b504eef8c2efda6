"""States that the published code of the model's authors found, against both solvers.

`published_code.npz` has a full cycle of ContactEngineering/CrackFront on a chemical field: w_loc on
rays, as its difference from 1.1 w_int in steps of 4e-5 w_int, 60 states and three whole fronts.
The tolerance of that code was 1e-8; the steps of w_loc move a front by up to 3e-6.
"""

from pathlib import Path

import numpy as np
import pytest

from crackfront.core import jkr
from crackfront.core.cycle.follow import Load, follow
from crackfront.core.geometry.sphere import polar_field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS
from crackfront.core.units import WORK_OF_ADHESION

FRONTS = {20: "front_of_state_20", 35: "front_of_state_35", -1: "front_of_last_state"}
LOAD_STEP = 0.05


@pytest.fixture(scope="module")
def published():
    return dict(np.load(Path(__file__).with_name("published_code.npz")))


@pytest.fixture(scope="module", params=SOLVERS)
def steps(request, published):
    """Steps at all penetrations of the published cycle and at the next one."""
    adhesion = 1.1 + 4e-5 * published["adhesion"]
    field = polar_field(published["radii"], WORK_OF_ADHESION * adhesion, "linear")
    penetrations = published["penetration"]
    turn = np.argmax(penetrations)
    loads = [Load(b, 1 if index <= turn else -1) for index, b in enumerate(penetrations)]
    loads.append(Load(penetrations[-1] - LOAD_STEP, -1))
    start = np.full(adhesion.shape[1], published["radii"][0])
    return [*follow(field, start, loads, SOLVERS[request.param](1e-10))]


def test_both_solvers_find_the_states_of_the_published_code(steps, published):
    fronts = np.array([step.front for step in steps[:-1]])
    np.testing.assert_allclose(fronts.mean(axis=1), published["mean_radius"], rtol=0, atol=1e-6)
    force = jkr.force(fronts, published["penetration"][:, None]).mean(axis=1)
    np.testing.assert_allclose(force, published["force"], rtol=0, atol=3e-6)


def test_both_solvers_find_the_fronts_of_the_published_code(steps, published):
    fronts = [step.front for step in steps[:-1]]
    for state, name in FRONTS.items():
        np.testing.assert_allclose(fronts[state], published[name], rtol=0, atol=5e-6)


def test_contact_is_lost_one_load_step_after_the_last_state_of_the_published_code(steps):
    assert [step.status for step in steps] == [Status.CONVERGED] * 60 + [Status.LOST_CONTACT]
