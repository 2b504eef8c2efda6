"""Cycles of spheres: exact answers, order of states, and how they end."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core import jkr
from crackfront.core.adhesion import rough_adhesion
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import tile_field
from crackfront.core.field.rays import front_adhesion
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS, Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from tests.commands import slow
from tests.core.cycle.made import (
    branch,
    cycles_of_few_sites,
    noisy_field,
    patches,
    smooth_field,
)
from tests.core.solvers import every_solver

# --- smooth limit


@every_solver
@pytest.mark.parametrize("n_angle", [1, 5, 8, 23, 24])
def test_every_state_of_a_smooth_sphere_is_jkr(solver, n_angle):
    record = run_cycle(smooth_field(n_angle), LoadSchedule(1.0, 0.1), SOLVERS[solver](1e-14))
    exact = np.array([jkr.equilibrium_radius(b) for b in record.states.penetration])
    assert np.allclose(record.states.mean_radius, exact, rtol=0, atol=1e-10)
    assert np.allclose(record.states.force, jkr.equilibrium_force(exact), rtol=0, atol=1e-9)
    assert np.allclose(record.states.apparent_work_of_adhesion, 1.0, rtol=0, atol=1e-10)
    assert np.allclose(record.states.contact_area, np.pi * exact**2, rtol=0, atol=1e-9)
    assert np.all(record.states.rms_radius < 1e-12)


# --- axisymmetric disorder


def rings(radii, ring, n_angle):
    """Field that depends on the radius alone, on one ray or on many."""
    return polar_field(radii, WORK_OF_ADHESION * np.repeat(ring[:, None], n_angle, axis=1))


@every_solver
@pytest.mark.parametrize("n_angle", [1, 16])
def test_rings_follow_the_running_extrema_of_the_equilibrium_penetration(solver, n_angle):
    spacing, period = 0.0005, 0.1
    radii = spacing * np.arange(1, 4200)
    ring = 1 + 0.2 * np.sin(2 * np.pi * radii / period)
    record = run_cycle(rings(radii, ring, n_angle), LoadSchedule(1.0, 0.05), SOLVERS[solver](1e-12))
    fine = np.linspace(0.5, 2.09, 400_001)
    # The field as sampled: linear in radius times adhesion.
    adhesion = np.interp(fine, radii, radii * ring) / fine
    penetration = jkr.equilibrium_penetration(fine, adhesion)
    # Approach: the running maximum. Retraction: the running minimum from outside, where the front
    # was when the load turned.
    turn = fine <= record.states.mean_radius[branch(record, 1)][-1]
    outward = np.maximum.accumulate(penetration)
    inward = np.minimum.accumulate(penetration[turn][::-1])[::-1]
    for row in np.flatnonzero(record.states.penetration > 0):
        load = record.states.penetration[row]
        curve = outward if record.states.direction[row] > 0 else inward
        place = min(np.searchsorted(curve, load), curve.size - 1)
        assert record.states.mean_radius[row] == pytest.approx(fine[place], abs=1e-5)


# --- what the record says


@every_solver
def test_the_measures_of_a_record_are_those_of_its_fronts(solver):
    field = noisy_field(1)
    record = run_cycle(field, LoadSchedule(0.8, 0.1), SOLVERS[solver](), Recorder(fronts=True))
    assert record.fronts.shape == (record.states.penetration.size, 24)
    assert np.allclose(record.states.mean_radius, record.fronts.mean(axis=1), rtol=1e-14)
    assert np.array_equal(record.states.min_radius, record.fronts.min(axis=1))
    assert np.array_equal(record.states.max_radius, record.fronts.max(axis=1))
    assert np.allclose(record.states.rms_radius, record.fronts.std(axis=1), rtol=1e-13)
    assert np.allclose(
        record.states.contact_area, np.pi * (record.fronts**2).mean(axis=1), rtol=1e-13
    )
    load = record.states.penetration[:, None]
    force = record.fronts**3 + 1.5 * record.fronts * (load - record.fronts**2)
    assert np.allclose(record.states.force, force.mean(axis=1), rtol=1e-12, atol=1e-13)


@every_solver
@given(seed=st.integers(0, 2**32 - 1), n_angle=st.integers(8, 40))
def test_apparent_adhesion_is_the_mean_adhesion_along_the_front(solver, seed, n_angle):
    field = noisy_field(seed, n_angle, amplitude=0.2)
    record = run_cycle(field, LoadSchedule(0.6, 0.2), SOLVERS[solver](1e-12), Recorder(fronts=True))
    for front, apparent in zip(record.fronts, record.states.apparent_work_of_adhesion, strict=True):
        held = front * front_adhesion(front, field) / WORK_OF_ADHESION
        assert held.mean() / front.mean() == pytest.approx(apparent, abs=1e-10)


@every_solver
@given(seed=st.integers(0, 2**32 - 1))
def test_the_contact_is_never_smaller_in_retraction_than_in_approach(solver, seed):
    record = run_cycle(noisy_field(seed), LoadSchedule(0.8, 0.1), SOLVERS[solver]())
    up, down = branch(record, 1), branch(record, -1)
    n_common = min(up.sum() - 1, down.sum())
    grown = record.states.mean_radius[up][:-1][::-1][:n_common]
    assert np.all(record.states.mean_radius[down][:n_common] >= grown - 1e-8)


# --- rough spheres


def rough_branches(energy, seed):
    """Means of the apparent adhesion in retraction and approach, and the measured energy."""
    cutoff, n_point = 0.1, 160
    spectrum = SelfAffineSpectrum(cutoff, cutoff, 0.8).with_elastic_energy(energy)
    heights = gaussian_field(spectrum, n_point, 20 * cutoff, np.random.default_rng(seed))
    adhesion = rough_adhesion(heights, 20 * cutoff / n_point)
    field = tile_field(adhesion, sphere(256), cutoff / 12, 2.8)
    record = run_cycle(field, LoadSchedule(1.4, 0.05), Newton(1e-6))
    assert record.status is Status.LOST_CONTACT
    steady = (record.states.penetration > 0.2) & (record.states.penetration < 0.7)
    retraction, approach = (
        record.states.apparent_work_of_adhesion[steady & branch(record, direction)].mean()
        for direction in (-1, 1)
    )
    return retraction, approach, adhesion.e_el


@pytest.mark.parametrize("seed", [0, slow(1)])
def test_hysteresis_grows_with_roughness_and_stays_below_perturbation_theory(seed):
    hysteresis = []
    for requested in (0.002, 0.02, 0.05, 0.1):
        retraction, approach, energy = rough_branches(requested, seed)
        hysteresis.append(retraction - approach)
        # k = 4 is the limit of weak disorder and infinite size; this sphere is small.
        assert retraction - approach < 2 * 4 * energy
        assert (retraction + approach) / 2 == pytest.approx(1 - energy, abs=0.04)
    assert np.all(np.diff(hysteresis) > 0)
    # Below the Larkin length the front follows the disorder without an instability.
    assert hysteresis[0] < 1e-3
    assert hysteresis[-1] > 0.1


# --- how a cycle ends, and bad input


@every_solver
def test_a_cycle_that_leaves_the_field_inward_says_so_and_keeps_its_states(solver):
    radii = 1.2 + 0.05 * np.arange(30)
    field = polar_field(radii, np.full((30, 8), WORK_OF_ADHESION))
    record = run_cycle(field, LoadSchedule(0.5, 0.1), SOLVERS[solver]())
    assert record.status is Status.LEFT_FIELD_INWARD
    # A smooth sphere of radius 1.2 rests at a penetration of about -0.35.
    assert record.end_load == pytest.approx(-0.4)
    assert record.states.min_radius.min() > 1.2


def test_a_contact_that_outgrows_the_field_is_refused_before_it_starts():
    field = smooth_field(largest=1.8)
    with pytest.raises(
        ValueError,
        match=r"contact outgrows the field: a smooth sphere at penetration 1.5 has radius 1\.9",
    ):
        run_cycle(field, LoadSchedule(1.5, 0.1))


@pytest.mark.slow
def test_the_apparent_work_is_less_in_retraction_only_where_the_mean_radius_has_grown_more():
    most = 0.0
    for _, record in cycles_of_few_sites("linear"):
        states = record.states
        work = states.apparent_work_of_adhesion
        release = work * states.mean_radius
        for up in np.flatnonzero(branch(record, 1)):
            same = branch(record, -1) & np.isclose(states.penetration, states.penetration[up])
            for down in np.flatnonzero(same):
                assert np.min(record.fronts[down] - record.fronts[up]) > -1e-6
                # The mean of a G grows with the radius of every site, that of a may grow faster.
                assert release[down] > release[up] - 1e-6
                most = max(most, work[up] - work[down])
    assert 0.01 < most < 0.2


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_means_over_the_branches_are_not_reversed_by_more_than_their_errors(interpolation):
    deviations = []
    for seed in range(400):
        field, spacing = patches([8, seed], (8, 64), (100, 251), interpolation)
        steady = steady_adhesion(run_cycle(field, LoadSchedule(1.5, 0.05)), 1.5 * spacing)
        if not steady.sentence:
            deviations.append(steady)
    assert len(deviations) > 60
    for deviation in deviations:
        assert deviation.w_retr - deviation.w_appr > -np.hypot(
            deviation.w_appr_error, deviation.w_retr_error
        )
