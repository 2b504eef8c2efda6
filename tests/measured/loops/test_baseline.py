"""Rows out of contact: the zero and the drift of the force, spikes, and rows without a force."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront import measured_loop
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.contact_rows import rows_in_contact
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, TRUTH, W_APPR, W_RETR, in_contact, loop


def test_a_bent_drift_widens_the_intervals():
    whole, time = loop(0), np.linspace(-1, 1, 320)
    bent = whole.force + 0.05 * np.max(whole.force) * time**2
    result = analyse_loop(replace(whole, force=bent), Rig(RADIUS, MODULUS))
    for name, truth in TRUTH.items():
        estimate = getattr(result, name)
        assert estimate.low <= truth <= estimate.high
    pull = -np.min(loop(0, force_noise=0.0).force)
    assert result.pull_off_force.low < pull < result.pull_off_force.high


@pytest.mark.parametrize("drift", [-0.3, 0.3])
def test_a_jump_into_contact_that_noise_hides_is_found_under_a_drift_of_either_sign(drift):
    with_radius = loop(0, drift=drift, preload=3.0, n_away=100)
    is_contact = rows_in_contact(replace(with_radius, radius=None))
    # The force of first contact is lost in the noise, but not the hundred rows out of contact.
    assert np.sum(is_contact != (with_radius.radius > 0)) < 50


def drift_is_named(recording):
    remarks = analyse_loop(recording, Rig(RADIUS, MODULUS)).remarks
    return any("drift along one line" in text and "Cut out a rest" in text for text in remarks)


def taken(recording, rows):
    columns = (recording.force, recording.radius, recording.displacement)
    return Recording(*(column[rows] for column in columns))


def test_a_drift_over_rows_of_unequal_times_is_named():
    whole = loop(0, drift=0.3)
    every, fifth = np.arange(170), np.arange(170, whole.force.size, 5)
    assert drift_is_named(taken(whole, np.concatenate([every, fifth])))
    whole = loop(0, drift=0.1)
    rest = np.repeat(np.arange(whole.force.size), 1 + 300 * (np.arange(320) == 160))
    assert drift_is_named(taken(whole, rest))


@pytest.mark.parametrize("seed", range(5))
def test_a_steady_drift_over_equal_times_is_not_named(seed):
    assert not drift_is_named(loop(seed, drift=0.3))


@pytest.mark.parametrize(("shift", "remedy"), [(8, "up by 8 rows"), (-8, "down by 8 rows")])
def test_a_shifted_radius_says_by_how_many_rows_to_move_it(shift, remedy):
    whole = loop(0)
    shifted = replace(whole, radius=np.roll(whole.radius, shift))
    remarks = analyse_loop(shifted, Rig(RADIUS, MODULUS)).remarks
    assert any(remedy in text for text in remarks)


def test_a_spike_out_of_contact_is_no_contact():
    whole = loop(0, without="radius")
    for row in (5, -8):
        force = whole.force.copy()
        force[row] += 0.2 * np.max(force)
        spiked = Recording(force, None, whole.displacement)
        result = analyse_loop(spiked, Rig(RADIUS, MODULUS, stiffness=1e3))
        assert result.hysteresis.value == pytest.approx(W_RETR - W_APPR, rel=0.1)


def test_the_last_row_before_a_sharp_pull_off_is_no_spike():
    whole = loop(0, without="radius", force_noise=2e-4)
    last = int(np.flatnonzero(np.abs(whole.force) > 0.05 * np.max(whole.force))[-1])
    force = np.array(whole.force)
    force[last + 1] = 1.5 * force[last]
    sharp = replace(whole, force=force)
    touches = rows_in_contact(sharp)
    assert touches[last + 1]
    assert not touches[last + 2]


@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_rows_in_contact_give_no_zero_of_the_force(noise):
    columns = in_contact(force_noise=noise, radius_noise=0.0, stiffness=1e9)
    del columns["radius"]
    result = measured_loop(columns, radius=RADIUS, contact_modulus=MODULUS)
    assert "The zero of the force is taken from the file, as all rows are in contact." in (
        result.remarks
    )
    for name, truth in TRUTH.items():
        estimate = getattr(result, name)
        assert estimate.low - 1e-6 <= truth <= estimate.high + 1e-6
        assert estimate.value == pytest.approx(truth, rel=1e-4 if noise == 0 else 0.2)
