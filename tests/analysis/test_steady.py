"""w_appr and w_retr of exact records."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.analysis.steady_adhesion import steady_adhesion, steady_means
from crackfront.core import jkr
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status


def smooth_record(w_appr, w_retr, n_state=9):
    """Two branches of smooth JKR spheres between radius 1.2 and 1.8."""
    radius = np.concatenate([np.linspace(1.2, 1.8, n_state), np.linspace(1.75, 0.9, n_state)])
    direction = np.repeat([1, -1], n_state)
    adhesion = np.where(direction > 0, w_appr, w_retr)
    zero = np.zeros(radius.size)
    return CycleRecord(
        status=Status.LOST_CONTACT,
        end_load=-0.5,
        states=ContactState(
            penetration=jkr.equilibrium_penetration(radius, adhesion),
            direction=direction,
            mean_radius=radius,
            min_radius=radius,
            max_radius=radius,
            rms_radius=zero,
            force=jkr.equilibrium_force(radius, adhesion),
            contact_area=np.pi * radius**2,
            apparent_work_of_adhesion=adhesion,
            least_travel=np.abs(radius - np.where(direction > 0, 0.0, 1.8)),
            iterations=zero.astype(int),
            updates=zero.astype(int),
            residual=zero,
        ),
    )


def test_smooth_branches_return_their_works_of_adhesion_to_round_off():
    steady = steady_adhesion(smooth_record(0.8, 1.3), correlation_length=0.1)
    assert steady.sentence == ""
    assert steady.w_appr == pytest.approx(0.8, rel=1e-14)
    assert steady.w_retr == pytest.approx(1.3, rel=1e-14)
    assert steady.hysteresis == pytest.approx(0.5, rel=1e-13)
    assert steady.midpoint == pytest.approx(1.05, rel=1e-14)
    assert steady.w_appr_from_force == pytest.approx(0.8, rel=1e-13)
    assert steady.w_retr_from_force == pytest.approx(1.3, rel=1e-13)


def test_both_branches_are_averaged_over_one_window_of_radii_without_transients():
    record = smooth_record(0.8, 1.3)
    radius, forward = record.states.mean_radius, record.states.direction > 0
    drifting = replace(record.states, apparent_work_of_adhesion=radius)
    steady = steady_adhesion(replace(record, states=drifting), correlation_length=0.2)
    # Retraction starts at 1.8: its first steady state lies 0.2 below. Approach starts at 1.2.
    last = np.max(radius[~forward & (radius <= 1.6)])
    approach = forward & (radius >= 1.2) & (radius <= last)
    assert steady.lowest_radius == 1.2
    assert steady.highest_radius == last
    assert steady.w_appr == pytest.approx(np.mean(radius[approach]))
    assert steady.w_appr < 1.6
    assert steady.n_approach == np.count_nonzero(approach)


def test_places_of_a_tile_count_once():
    states = smooth_record(0.8, 1.3).states
    columns = states.apparent_work_of_adhesion, states.mean_radius, states.rms_radius
    whole, cut = (steady_means(states, columns, "radii", 0.1, period) for period in (1.0, 0.25))
    assert (whole.n_approach, whole.n_retraction) == (6, 5)
    assert (cut.n_approach, cut.n_retraction) == (3, 3)


@pytest.mark.parametrize(
    ("record", "length", "words"),
    [
        (smooth_record(0.8, 1.3), 0.9, "9 steady states in approach and 1 in retraction; 3 each"),
        (smooth_record(0.8, 1.3, n_state=2), 0.1, "2 steady states in approach and 1"),
        (smooth_record(0.8, 1.3), 0.55, "share"),
    ],
)
def test_too_few_steady_states_give_no_value_and_say_why(record, length, words):
    steady = steady_adhesion(record, correlation_length=length)
    assert np.isnan([steady.w_appr, steady.w_retr, steady.w_appr_from_force]).all()
    assert words in steady.sentence
