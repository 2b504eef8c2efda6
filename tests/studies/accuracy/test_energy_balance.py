"""The energy of a cycle: exact as the work of its steps, of first order as that of the loop."""

import numpy as np
import pytest

from crackfront.core.cycle.load_schedule import DEFAULT_STEP
from studies.accuracy.energy_balance import cycle, energies


def test_the_dissipated_energy_is_the_work_of_the_steps_and_a_first_order_above_the_loop():
    balances = [energies(cycle(0.4, 0, step)) for step in (0.1, 0.05, 0.025)]
    lost, work, trapezoid = np.transpose(balances)
    assert np.allclose(lost, work, rtol=1e-13)
    assert np.all(np.diff(lost) < 0)
    gap = lost - trapezoid
    assert np.allclose(gap[:-1] / gap[1:], 2, atol=0.15)
    assert gap[1] > 0.05 * work[1]


@pytest.mark.slow
@pytest.mark.parametrize("rms", [0.4, 0.1, 0.84])
def test_the_default_step_leaves_one_percent_of_the_energy_of_the_quasi_static_loop(rms):
    fine, default = (energies(cycle(rms, 0, step))[0] for step in (DEFAULT_STEP / 2, DEFAULT_STEP))
    assert 0 < default / (2 * fine - default) - 1 < 0.01
