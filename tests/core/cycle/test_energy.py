"""The energy that a front loses, against the work of the load."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core import jkr
from crackfront.core.cycle.energy import contact_energy, dissipated_energy
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import first_place
from crackfront.core.field.rays import front_adhesion, swept_adhesion
from crackfront.core.geometry.sphere import line_energy
from crackfront.core.solver.relax import SOLVERS, front_force, relax
from crackfront.core.units import CONTACT_MODULUS
from tests.core.cycle.made import (
    branch,
    cycles_of_few_sites,
    noisy_field,
)
from tests.core.solvers import every_solver


def energy(front, penetration, field, origin):
    """Total energy written down once more: rings, line, minus the adhesion within the front."""
    rings = 0.75 * (penetration**2 * front - 2 * front**3 * penetration / 3 + front**5 / 5)
    return rings.mean() + line_energy(front) - swept_adhesion(origin, front, field)


def test_dissipated_energy_is_the_fall_of_the_total_energy(rng):
    field = noisy_field(8)
    origin = np.full(24, first_place(field))
    before, after = rng.uniform(0.8, 1.3, 24), rng.uniform(1.3, 2.2, 24)
    for start, end in ((before, after), (after, before)):
        fall = energy(start, 0.4, field, origin) - energy(end, 0.4, field, origin)
        assert dissipated_energy(start, end, 0.4, field) == pytest.approx(fall, rel=1e-12)


def test_the_force_on_a_site_is_the_derivative_of_the_dissipated_energy(rng):
    field = noisy_field(9)
    front = rng.uniform(1.31, 1.37, 24)
    start = np.full(24, 1.0)
    expected = 2 * np.pi / 24 * front_force(front, 0.2, field)
    for site in range(24):
        step = np.zeros(24)
        # Both ends of the difference stay on one linear piece, samples are 0.06 apart.
        step[site] = 1e-6
        slope = dissipated_energy(start, front + step, 0.2, field) - dissipated_energy(
            start, front - step, 0.2, field
        )
        assert slope / 2e-6 == pytest.approx(expected[site], rel=1e-6, abs=1e-7)


def test_the_force_on_the_sphere_is_the_derivative_of_the_energy_in_penetration(rng):
    field = noisy_field(10)
    front, origin = rng.uniform(1.2, 1.9, 24), np.full(24, 0.06)
    step = 1e-3
    slope = (
        energy(front, 0.3 + step, field, origin) - energy(front, 0.3 - step, field, origin)
    ) / (2 * step)
    assert jkr.force(front, 0.3).mean() == pytest.approx(slope, rel=1e-10)


@every_solver
@given(seed=st.integers(0, 2**32 - 1), amplitude=st.sampled_from([0.0, 0.1, 0.4]))
def test_no_load_step_creates_energy(solver, seed, amplitude):
    record = run_cycle(
        noisy_field(seed, amplitude=amplitude),
        LoadSchedule(0.8, 0.1),
        SOLVERS[solver](),
        Recorder(energy=True),
    )
    assert record.dissipated_energy.shape == record.states.penetration.shape
    assert np.all(record.dissipated_energy >= -1e-11)


@every_solver
@pytest.mark.parametrize("amplitude", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("step", [0.05, 0.4])
def test_a_cycle_dissipates_the_work_of_its_load_steps_to_round_off(solver, amplitude, step):
    record = run_cycle(
        noisy_field(3, 32, amplitude, largest=3.2),
        LoadSchedule(0.6, step),
        SOLVERS[solver](1e-6),
        Recorder(energy=True),
    )
    # While the load changes the front is held, so that the force is linear in penetration.
    change = np.diff(np.append(record.states.penetration, record.end_load))
    work = np.sum(
        (record.states.force + CONTACT_MODULUS * record.states.mean_radius * change) * change
    )
    lost = record.dissipated_energy.sum() + record.pull_off_energy
    assert lost == pytest.approx(work, rel=1e-13)


def repulsion_within(before, penetration, field):
    """Integral of -w_loc where it repels, between a front and the edge of open contact."""
    after = np.maximum(before, np.sqrt(max(penetration, 0.0)))
    share = (np.arange(1000) + 0.5) / 1000
    front = before + share[:, None] * (after - before)
    repels = [np.maximum(-front_adhesion(a, field), 0.0) for a in front]
    return 2 * np.pi * np.mean(np.mean(front * repels, axis=0) * (after - before))


def test_energy_is_gained_only_where_an_edge_in_compression_is_closed_over_repelling_places():
    gained, paid = 0.0, 0.0
    for seed in range(4):
        field = noisy_field(seed, 32, amplitude=2.0, largest=3.2)
        record = run_cycle(
            field, LoadSchedule(0.6, 0.05), recorder=Recorder(fronts=True, energy=True)
        )
        assert np.all(record.dissipated_energy[branch(record, -1)] > -1e-11)
        for row in range(1, np.count_nonzero(branch(record, 1))):
            lost = record.dissipated_energy[row]
            bound = repulsion_within(record.fronts[row - 1], record.states.penetration[row], field)
            assert lost > -bound * (1 + 1e-3) - 1e-11
            gained, paid = min(gained, lost), max(paid, bound)
    # It does happen, and the bound is of the same size.
    assert -0.02 < gained < -1e-3
    assert paid < 20 * -gained


@pytest.mark.slow
def test_making_contact_gains_no_more_than_the_first_circle_costs():
    least = 0.0
    for field, record in cycles_of_few_sites("cubic"):
        circle = np.full(field.geometry.n_site, first_place(field))
        lost = record.dissipated_energy[0]
        assert lost > -max(contact_energy(circle, 0.0, field), 0.0) - 1e-9
        least = min(least, lost)
    # It does happen.
    assert -0.1 < least < -0.01


@pytest.mark.slow
def test_losing_contact_gains_no_more_than_what_adheres_when_one_site_has_passed_the_apex():
    least = 0.0
    for field, record in cycles_of_few_sites("cubic"):
        assert record.dissipated_energy.sum() + record.pull_off_energy > 0
        if record.pull_off_energy >= 0:
            continue
        outcome = relax(record.fronts[-1], record.end_load, -1, field)
        left = np.maximum(outcome.front, first_place(field))
        assert record.pull_off_energy > contact_energy(left, record.end_load, field) - 1e-6
        least = min(least, record.pull_off_energy)
    assert -1.5 < least < -0.3
