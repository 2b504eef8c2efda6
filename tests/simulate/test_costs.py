"""What simulations cost: as measured within a factor of two, and in the direction of sense."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from crackfront.core.adhesion import correlation_length, rough_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import integral_breadth
from crackfront.sweep.parameters import load_sweep
from studies.law.front_sweeps import front_sweeps
from tests.places import ROOT

SWEEP = load_sweep(ROOT / "config/test.yaml")
ONE = SWEEP.simulation(SWEEP.spectra[0], 0.1, 0)

# Processor times of an AMD EPYC with other work on its cores: medians of two realisations of
# line-quick, and single runs of the others.
MEASURED = [
    ("default", "flat", 0.002, 1.26),
    ("default", "flat-coarse", 0.002, 0.34),
    ("default", "h08", 0.002, 1.17),
    ("default", "h03-wide", 0.002, 0.97),
    ("default", "h03", 0.002, 0.67),
    ("line-quick", "flat-L3", 0.01, 0.125),
    ("line-quick", "flat-L10", 0.1764, 0.485),
    ("test", "flat", 0.1, 0.0253),
    ("test", "rough", 0.1, 0.0226),
    ("line", "h03-L30", 0.0025, 5.3),
    ("line", "two-reversed-L3", 0.04, 0.156),
    ("line-strong", "h03-L0p5", 0.36, 0.913),
    ("line-strong", "two-reversed-L5", 0.36, 0.761),
    ("line-chemical", "gaussian-L3", 0.0025, 0.0586),
    ("line-chemical-strong", "gaussian-L0p5", 0.1764, 0.0996),
    ("line-weak", "ring-L0p3", 0.0225, 0.179),
    ("line-long", "two-reversed-L90", 0.0025, 15.6),
]

# The same of simulations that record jumps.
MEASURED_JUMPS = [
    ("config/jumps.yaml", "flat-L3", 0.1764, 10.9),
    ("config/jumps.yaml", "flat-L10", 0.1764, 13.2),
    ("config/test.yaml", "flat", 0.1, 1.51),
    ("config/test.yaml", "rough", 0.02, 0.96),
    ("tests/line-test.yaml", "flat-L2", 0.04, 0.37),
    ("tests/line-test.yaml", "flat-L8", 0.16, 6.35),
]


@pytest.fixture(scope="module")
def fronts(tmp_path_factory):
    """Sweeps of the law of k."""
    return front_sweeps(tmp_path_factory.mktemp("fronts"))


@pytest.mark.parametrize(("configuration", "spectrum", "energy", "seconds"), MEASURED)
def test_times_are_expected_within_a_factor_of_two(
    fronts, configuration, spectrum, energy, seconds
):
    sweep = fronts.get(configuration)
    if sweep is None:
        sweep = load_sweep(ROOT / f"config/{configuration}.yaml")
    [energy] = [value for value in sweep.elastic_energies if value == pytest.approx(energy)]
    expected = expected_cost(sweep.simulation(sweep.named(spectrum), energy, 0)).seconds
    assert 0.5 < expected / seconds < 2


@pytest.mark.parametrize(("configuration", "spectrum", "energy", "seconds"), MEASURED_JUMPS)
def test_times_of_jumps_are_expected_within_a_factor_of_two(
    configuration, spectrum, energy, seconds
):
    sweep = replace(load_sweep(ROOT / configuration), record=("jumps",))
    [energy] = [value for value in sweep.elastic_energies if value == pytest.approx(energy)]
    cost = expected_cost(sweep.simulation(sweep.named(spectrum), energy, 0))
    assert seconds / 2 < cost.seconds < 2 * seconds
    assert cost.jump_seconds > 0.9 * cost.seconds


@pytest.mark.parametrize("step", [0.05, 0.2])
def test_a_cycle_finds_the_states_that_were_expected(step):
    simulation = replace(ONE, schedule=FullCycle(1.0, step))
    states = run_simulation(simulation).record.states
    expected = simulation.schedule.expected_motion(simulation.surface).n_state
    assert states.penetration.size == pytest.approx(expected, abs=1.5)


def test_more_sites_cost_more_time_and_more_points_and_fronts_more_memory():
    resolution = ONE.resolution
    base = expected_cost(ONE)
    finer_front = replace(resolution, n_angle=20 * resolution.n_angle)
    larger_tile = replace(resolution, n_point=10 * resolution.n_point)
    longer = expected_cost(replace(ONE, resolution=finer_front))
    larger = expected_cost(replace(ONE, resolution=larger_tile))
    assert longer.seconds > 10 * base.seconds
    assert larger.memory > base.memory
    assert expected_cost(replace(ONE, record_fronts=True)).memory > base.memory


@pytest.mark.slow
def test_memory_is_predicted_within_a_factor_one_and_a_half():
    code = (
        "from pathlib import Path\n"
        "from dataclasses import replace\n"
        "from crackfront.sweep.parameters import load_sweep\n"
        "from crackfront.simulate.costs import expected_cost\n"
        "from crackfront.simulate.run_simulation import run_simulation\n"
        f"sweep = load_sweep(Path({str(ROOT / 'config/test.yaml')!r}))\n"
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
