"""The penetrations of a cycle."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core.cycle.load_schedule import LoadSchedule


@given(st.floats(0.0, 3.0), st.floats(0.01, 1.0))
def test_approach_goes_up_in_whole_steps_and_visits_the_largest_penetration(largest, step):
    loads = list(LoadSchedule(largest, step).approach())
    assert loads[0] == 0
    assert loads[-1] == pytest.approx(largest, rel=1e-9, abs=1e-12)
    assert np.all(np.diff(loads) > 0)
    assert np.allclose(loads[:-1], step * np.arange(len(loads) - 1), rtol=1e-12, atol=0)


@given(st.floats(0.0, 3.0), st.floats(0.01, 1.0))
def test_retraction_comes_back_over_the_penetrations_of_the_approach(largest, step):
    schedule = LoadSchedule(largest, step)
    up = list(schedule.approach())
    down = list(itertools.islice(schedule.retraction(), len(up) + 3))
    assert down[: len(up) - 1] == up[-2::-1]
    assert np.allclose(np.diff(down), -step, rtol=1e-9)
    assert down[-1] < -2 * step


@pytest.mark.parametrize("step", [0.1, 0.05, 0.01, 0.3, 1 / 3, 0.7, 2.0])
def test_round_off_of_the_step_adds_no_penetration_and_leaves_none_out(step):
    loads = list(LoadSchedule(1.0, step).approach())
    assert len(loads) == int(np.ceil(1 / step - 1e-9)) + 1
    assert loads[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("step", [0.0, -0.1, float("nan"), float("inf")])
def test_a_load_step_that_is_not_positive_is_refused(step):
    with pytest.raises(ValueError, match=f"step is {step}; it must be positive"):
        LoadSchedule(1.0, step)


@pytest.mark.parametrize("largest", [-0.01, float("nan"), float("inf")])
def test_a_penetration_that_never_makes_contact_is_refused(largest):
    with pytest.raises(
        ValueError, match=rf"max penetration {largest} never makes contact; .* set it to 0 or more"
    ):
        LoadSchedule(largest, 0.1)
