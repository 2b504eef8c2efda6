"""Errors of numerics: their orders of convergence, settings, files and Pareto front."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest

from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.provenance import provenance
from crackfront.simulate.settings import chosen_settings
from crackfront.simulate.simulation import simulation_field
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.storage import write_dataset
from studies.accuracy.files import errors_dataset, read_errors
from studies.accuracy.scenes import SCENES, with_setting
from studies.accuracy.study import (
    Errors,
    front_difference,
    measured_branches,
    pareto_front,
    rms,
    scene_errors,
)

MODERATE, SMALL = SCENES["chemical-0.04"], SCENES["small-0.04"]

# So weak that no front is pinned: errors are smooth, and their orders those of the theory.
FINEST = replace(
    MODERATE.reference,
    angles_per_cutoff=4,
    samples_per_cutoff=48,
    pixels_per_cutoff=24,
    tolerance=1e-10,
)
WEAK = replace(
    MODERATE,
    spectrum=SelfAffineSpectrum(0.08, 0.08, 1.0),
    elastic_energy=4e-4,
    tile_cutoffs=32,
    reference=FINEST,
)


@pytest.fixture(scope="module")
def converged():
    return [measured_branches(WEAK, FINEST, number) for number in range(3)]


def observed_order(converged, setting, coarse, fine):
    """Order at which the radius converges on the surfaces of the weak scene."""
    errors = []
    for value in (coarse, fine):
        branches = [
            measured_branches(WEAK, with_setting(FINEST, setting, value), n) for n in range(3)
        ]
        pairs = zip(branches, converged, strict=True)
        errors.append(rms(np.array([front_difference(a.radius, b.radius) for a, b in pairs])))
    return -math.log(errors[1] / errors[0]) / math.log(fine / coarse)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("setting", "coarse", "fine", "order"),
    [
        ("cubic", 6, 16, 4),
        ("linear", 16, 64, 2),
        ("pixels", 4, 12, 4),
        ("tolerance", 1e-2, 1e-6, -1),
    ],
)
def test_the_front_converges_with_the_order_of_the_setting(converged, setting, coarse, fine, order):
    assert abs(observed_order(converged, setting, coarse, fine) - order) < 0.3


@pytest.mark.slow
def test_more_sites_converge_faster_than_any_power(converged):
    orders = [observed_order(converged, "sites", *pair) for pair in ((1.4, 2), (2, 2.8))]
    assert min(orders) > 5


def test_a_branch_has_the_states_of_a_full_cycle_at_the_same_loads():
    numerics = chosen_settings(0.03, "roughness", SMALL.spectrum, 0.04)
    numerics = replace(numerics, tolerance=1e-9)
    branches = measured_branches(SMALL, numerics, 1)
    simulation = SMALL.simulation(numerics, 1)
    field = simulation_field(simulation)
    cycle = run_cycle(field, FullCycle(1.0, 0.1), Newton(1e-9), Recorder(fronts=True))
    approach = cycle.states.direction > 0
    assert np.allclose(SMALL.penetrations, cycle.states.penetration[approach][-8:])
    assert np.allclose(branches.radius[0], cycle.fronts[approach][-8:], rtol=0, atol=1e-7)
    # The branch begins outside the turn of the cycle, which has left the turn behind at 0.4.
    assert np.allclose(cycle.states.penetration[~approach][5:7], SMALL.penetrations[1::-1])
    retraction = cycle.fronts[~approach][5:7]
    assert np.allclose(branches.radius[1, 1::-1], retraction, rtol=0, atol=1e-7)


@pytest.fixture(scope="module")
def small_study():
    finer = [setting for setting in SMALL.single_trials if setting[0] == "finer"]
    return scene_errors(SMALL, finer + SMALL.requested_trials(), range(3))


@pytest.mark.slow
def test_errors_fall_with_the_error_that_is_asked_for(small_study):
    assert SMALL.elastic_energy == 0.04
    requested = [errors for errors in small_study.errors if errors.setting == "requested"]
    error = {errors.value: rms(errors.adhesion) for errors in requested}
    assert error[0.1] > 3 * error[0.003]
    for errors in requested:
        assert np.all(errors.front_rms <= errors.front_max)
    finer = small_study.errors[0]
    assert finer.setting == "finer"
    # One surface may have an avalanche that the reference just misses.
    assert np.median(np.abs(finer.adhesion)) < 0.01 * np.max(np.abs(requested[0].adhesion))


@pytest.mark.slow
def test_a_study_is_read_as_it_was_written(small_study, tmp_path):
    path = tmp_path / "numerics.nc"
    write_dataset(path, errors_dataset(small_study), provenance())
    again = read_errors(path)
    assert again.scene == SMALL
    assert np.array_equal(again.reference_adhesion, small_study.reference_adhesion)
    assert np.array_equal(again.reference_seconds, small_study.reference_seconds)
    for row, read_row in zip(again.errors, small_study.errors, strict=True):
        for item in fields(Errors):
            assert np.array_equal(getattr(row, item.name), getattr(read_row, item.name)), item.name


def test_no_setting_of_the_pareto_front_is_beaten():
    rng = np.random.default_rng(3)
    seconds, error = rng.uniform(size=(2, 40))
    best = pareto_front(seconds, error)
    for index in range(40):
        beaten = np.any((seconds < seconds[index]) & (error < error[index]))
        assert (index in best) == (not beaten)
    assert np.all(np.diff(seconds[best]) > 0)
    assert list(pareto_front(np.array([1.0, 1.0, 2.0]), np.array([2.0, 1.0, 1.0]))) == [1]
