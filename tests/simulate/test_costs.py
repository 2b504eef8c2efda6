"""What simulations cost: predicted for runs that were held out, and in the direction of sense."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from crackfront.core.adhesion import correlation_length, rough_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.simulate.costs import expected_cost, features, law_coefficients
from crackfront.simulate.sphere.cycle import FullCycle
from crackfront.simulate.sphere.steady import integral_breadth
from crackfront.sweep.configuration import load_configuration
from studies.speed import costs as benchmark

ROOT = Path(__file__).parents[2]
SWEEP = load_configuration(ROOT / "config/test.yaml")
ONE = SWEEP.simulation(SWEEP.spectra[0], 0.1, 0)
RUNS = benchmark.measured_runs()


@pytest.mark.parametrize("held_out", [True, False])
def test_times_of_measured_runs_are_predicted_within_a_factor_one_and_a_half(held_out):
    assert sum(run.held_out == held_out for run in RUNS) >= 15
    assert benchmark.worst_factor(held_out) < 1.5


def test_the_law_in_use_is_that_of_its_runs():
    found = benchmark.fitted_coefficients(RUNS)
    assert law_coefficients() == pytest.approx(found, rel=1e-4, abs=1e-4)


def test_held_out_runs_are_of_other_simulations_than_those_of_the_fit():
    fitted = {run.features for run in RUNS if not run.held_out}
    assert not fitted & {run.features for run in RUNS if run.held_out}


def test_the_measured_runs_are_those_that_the_command_would_measure():
    simulations = [*benchmark.fitted_to(), *benchmark.held_out()]
    assert [run.name for run in RUNS] == [one.label for one in simulations]
    for run, one in zip(RUNS, simulations, strict=True):
        known = run.features
        assert (known.n_angle, known.n_point) == (one.resolution.n_angle, one.resolution.n_point)
        assert known.n_state == pytest.approx(features(one).n_state, rel=1e-5)


def test_numbers_of_states_are_predicted_too():
    found = np.array([run.n_state for run in RUNS])
    expected = [run.features.n_state for run in RUNS]
    # At weak disorder surfaces take 17 to 31 states to the same error of k.
    assert np.all(np.abs(found - expected) <= 2 + 0.2 * found)
    assert np.mean(np.abs(found - expected)) < 1


@pytest.mark.parametrize("step", [0.05, 0.2])
def test_a_cycle_finds_the_states_that_were_expected(step):
    simulation = replace(ONE, schedule=FullCycle(1.0, step))
    measured = benchmark.measured(simulation, held=True)
    assert measured.n_state == pytest.approx(measured.features.n_state, abs=1.5)


def test_more_sites_cost_more_time_and_more_points_more_memory():
    sizes = ONE.resolution
    base = expected_cost(ONE)
    longer = expected_cost(replace(ONE, resolution=replace(sizes, n_angle=20 * sizes.n_angle)))
    larger = expected_cost(replace(ONE, resolution=replace(sizes, n_point=10 * sizes.n_point)))
    fronts = expected_cost(replace(ONE, record_fronts=True))
    assert longer.seconds > 10 * base.seconds
    assert larger.memory > base.memory
    assert fronts.disk > base.disk


def test_a_state_takes_time_however_near_the_last_one_is():
    near, nearer = (replace(ONE, schedule=FullCycle(1.0, step)) for step in (1e-6, 1e-7))
    assert expected_cost(near).seconds > 5e-5 * features(near).n_state
    assert expected_cost(nearer).seconds == pytest.approx(10 * expected_cost(near).seconds, rel=0.1)


@pytest.mark.slow
def test_memory_is_predicted_within_a_factor_one_and_a_half():
    code = (
        "from pathlib import Path\n"
        "from dataclasses import replace\n"
        "from crackfront.sweep.configuration import load_configuration\n"
        "from crackfront.simulate.costs import expected_cost\n"
        "from crackfront.simulate.run import run_simulation\n"
        f"sweep = load_configuration(Path({str(ROOT / 'config/test.yaml')!r}))\n"
        "one = sweep.simulation(sweep.spectra[0], 0.1, 0)\n"
        "one = replace(one, resolution=replace(one.resolution, n_point=2500))\n"
        "print(run_simulation(one).measures.peak_memory / expected_cost(one).memory)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=True
    )
    assert 1 / 1.5 < float(done.stdout) < 1.5


def test_means_along_a_line_vary_as_the_breadth_of_the_spectrum_says(rng):
    # A line of the tile's side holds side / (breadth x correlation length) independent pieces.
    n_point, side = 128, 6.4

    def spread(spectrum):
        """Variance of means along lines, relative to that of points, times independent pieces."""
        length = correlation_length("roughness", spectrum)
        simulation = replace(ONE, spectrum=spectrum, kind="roughness")
        parts = []
        for _ in range(60):
            heights = gaussian_field(spectrum, n_point, side, rng)
            field = rough_adhesion(1e-3 * heights / np.std(heights), side / n_point)
            values = field.work_of_adhesion
            parts.append(np.var(values.mean(axis=1)) / np.var(values))
        return (
            np.mean(parts)
            * side
            / (length * integral_breadth(simulation.kind, simulation.spectrum))
        )

    flat = spread(SelfAffineSpectrum(0.1, 0.1, hurst=1.0))
    broad = SelfAffineSpectrum(0.1, 1.6, hurst=0.3)
    assert integral_breadth("roughness", broad) > 1.5
    assert spread(broad) == pytest.approx(flat, rel=0.15)
