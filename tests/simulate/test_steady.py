"""The steady parts alone: the states of the full cycle, at a part of its cost."""

import math
from dataclasses import replace

import numpy as np
import pytest

from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core.adhesion import correlation_length
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.touch import first_touch
from crackfront.core.field.rays import front_adhesion
from crackfront.core.geometry.sphere import contact_field, polar_field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.contact import Problem
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import Simulation, simulation_adhesion
from crackfront.simulate.sphere.steady_branches import (
    SteadySchedule,
    branch_part,
    standard_error,
)
from crackfront.simulate.tiles import Resolution

SPECTRUM = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=1.0)
LENGTH = correlation_length("roughness", SPECTRUM)
SCHEDULE = SteadySchedule(start=0.4, max_penetration=1.0, travel=0.15, standard_error=1e-6)


def simulation(elastic_energy=0.04, realisation=0, schedule=SCHEDULE):
    return Simulation(
        spectrum_name="flat",
        kind="roughness",
        spectrum=SPECTRUM,
        elastic_energy=elastic_energy,
        realisation=realisation,
        sweep_seed=3,
        resolution=Resolution(320, 0.025, "cubic", 4.0, 160),
        schedule=schedule,
        solver=Newton(1e-9),
        record_fronts=True,
    )


def field_of(case):
    resolution = case.resolution
    return contact_field(
        simulation_adhesion(case),
        1.6,
        resolution.n_angle,
        resolution.spacing,
        band_limited=True,
    )


@pytest.mark.parametrize("elastic_energy", [0.0005, 0.01, 0.04, 0.177])
def test_its_fronts_are_those_of_the_full_cycle(elastic_energy):
    case = simulation(elastic_energy)
    field = field_of(case)
    steady = run_simulation(case).record
    assert steady.status is Status.STEADY
    # The cycle goes deeper, so that both of its branches are steady over the same radii.
    n_approach = np.count_nonzero(steady.states.direction > 0)
    loads = [Load(b, 1) for b in (*steady.states.penetration[:n_approach], 1.6)]
    loads += [Load(b, -1) for b in steady.states.penetration[n_approach:]]
    cycle = Recorder(fronts=True)
    cycle.run(field, first_touch(field), loads, Newton(1e-9))
    expected = cycle.record()
    fronts = np.delete(expected.fronts, n_approach, axis=0)
    travel = np.delete(expected.states.least_travel, n_approach)
    compared = (travel >= LENGTH) & (steady.states.least_travel >= LENGTH)
    assert np.count_nonzero(compared[:n_approach]) >= 5
    assert np.count_nonzero(compared[n_approach:]) >= 3
    difference = np.max(np.abs(fronts - steady.fronts)[compared])
    assert difference < 1e-5 * SPECTRUM.short_cutoff


def test_it_passes_the_same_radii_in_both_directions_and_not_many_more():
    record = run_simulation(simulation()).record
    approach, retraction = record.states.direction > 0, record.states.direction < 0
    steady = approach & (record.states.least_travel >= LENGTH)
    lowest = record.states.mean_radius[steady].min()
    assert np.count_nonzero(record.states.mean_radius[retraction] < lowest) == 1
    assert record.states.penetration[approach][0] == 0.4
    assert 0.95 < record.states.penetration[approach][-1] <= 1.0
    adhesion = steady_adhesion(record, LENGTH)
    assert adhesion.sentence == ""
    assert adhesion.n_retraction >= 5


def test_the_approach_ends_when_k_has_the_requested_error():
    results = {}
    field = field_of(simulation())
    for error in (1e-6, 0.25, 1.0):
        record = run_simulation(simulation(schedule=replace(SCHEDULE, standard_error=error))).record
        steady = (record.states.direction > 0) & (record.states.least_travel >= LENGTH)
        values, radius, roughness = (
            getattr(record.states, name)[steady]
            for name in ("apparent_work_of_adhesion", "mean_radius", "rms_radius")
        )
        circles = [front_adhesion(np.full(320, mean), field) for mean in radius]
        shared = np.mean(circles, axis=1) / WORK_OF_ADHESION

        def error_of_k(n, values=values, shared=shared, radius=radius, roughness=roughness):
            parts = branch_part(values[:n], shared[:n])
            spread = math.sqrt(2) * standard_error(parts, radius[:n], roughness[:n], LENGTH)
            return spread / (2 * 0.04)

        results[error] = values.size
        if error > 1e-3:
            assert error_of_k(values.size) <= error
            assert values.size == 8 or error_of_k(values.size - 1) > error
    assert 8 == results[1.0] < results[0.25] < results[1e-6]


@pytest.mark.slow
def test_at_weak_disorder_k_scatters_by_the_error_that_was_asked_for():
    asked, factors, stated, distances = 0.1, [], [], []
    spectrum = SelfAffineSpectrum(short_cutoff=0.025, roll_off=0.025, hurst=1.0)
    fine = replace(
        simulation(0.002, schedule=SteadySchedule(0.4, 2.0, travel=1.5, standard_error=asked)),
        spectrum=spectrum,
        resolution=Resolution(1200, 0.00625, "cubic", 1.0, 160),
        solver=Newton(1e-6),
    )
    for realisation in range(16):
        result = run_simulation(replace(fine, realisation=realisation))
        adhesion = steady_adhesion(result.record, correlation_length("roughness", spectrum))
        unit = 2 * result.measures.e_el
        factors.append(adhesion.hysteresis / unit)
        stated.append(adhesion.hysteresis_error / unit)
        distances.append(math.hypot(adhesion.w_appr_error, adhesion.w_retr_error) / unit)
    scatter = np.std(factors, ddof=1)
    assert 0.6 * asked < scatter < 1.7 * asked
    # The errors of both branches by themselves would say far more, as they share most of it.
    assert 0.6 < np.mean(stated) / scatter < 1.7 < np.mean(distances) / scatter


def test_contact_that_is_lost_on_the_way_back_is_told():
    # Pinning so strong that the retraction loses contact at a radius above that of first contact.
    radii = 0.002 * np.arange(1, 1501)
    phase = np.random.default_rng(1).uniform(0, 2 * np.pi, 8)
    strength = 1 + np.sin(2 * np.pi * radii[:, None] / 0.02 + phase)
    field = polar_field(radii, WORK_OF_ADHESION * strength)
    schedule = SteadySchedule(0.0, 1.0, 2.0, 1e-9)
    problem = Problem(field, correlation_length=0.05, elastic_energy=0.25)
    record = schedule.run(problem, None, Recorder())
    assert record.status is Status.LOST_CONTACT
    assert record.states.mean_radius[0] < record.states.mean_radius[-1]
    assert -1.8 < record.end_load < record.states.penetration[-1] < -1


def test_states_closer_than_a_correlation_length_count_as_one():
    values = np.array([1.0, 2.0, 3.0, 2.0, 1.0, 2.0])
    spread = np.std(values, ddof=1)
    radius, smooth = np.linspace(1.0, 2.0, 6), np.full(6, 0.01)
    assert standard_error(values, radius, smooth, 0.1) == pytest.approx(spread / math.sqrt(6))
    assert standard_error(values, radius, smooth, 0.5) == pytest.approx(spread / math.sqrt(3))
    assert standard_error(values, radius[::-1], smooth, 0.5) == pytest.approx(spread / math.sqrt(3))
    assert standard_error(values[:2], radius[:2], smooth[:2], 0.1) == math.inf


def test_a_rough_front_has_to_pass_three_times_its_depth():
    values = np.array([1.0, 2.0, 3.0, 2.0, 1.0, 2.0])
    spread = np.std(values, ddof=1)
    radius, rough = np.linspace(1.0, 2.0, 6), np.linspace(0.1, 0.3, 6)
    error = standard_error(values, radius, rough, 0.1)
    assert error == pytest.approx(spread / math.sqrt(1 + 1 / 0.6))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"travel": 0.0}, "travel is 0.0; it must be positive"),
        ({"standard_error": math.inf}, "standard_error is inf; it must be positive"),
        (
            {"start": 1.0},
            "start is 1.0; it must be 0 or more, and below the largest penetration 1.0",
        ),
        ({"start": -0.1}, "start is -0.1; it must be 0 or more"),
        ({"max_penetration": math.nan}, "below the largest penetration nan"),
    ],
)
def test_an_impossible_schedule_is_refused(change, sentence):
    with pytest.raises(ValueError, match=sentence):
        replace(SCHEDULE, **change)
