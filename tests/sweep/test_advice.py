"""What a plan says before the run: where loads leave no steady part, and how deep they must go."""

from dataclasses import replace

import pytest

from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import simulation_of
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.sweep.advice import expectation

NUMERICS = Numerics(Settings(None, 4, 4, "cubic", 4, 1e-5), tile_roll_offs=4, tile_cutoffs=40)
SHALLOW = (FullCycle(0.1, 0.02), SteadySchedule(0.0, 0.1, 0.5, 0.05))


@pytest.mark.parametrize("schedule", SHALLOW, ids=["cycle", "steady"])
@pytest.mark.parametrize("energy", [0.01, 0.05, 0.16])
def test_a_load_that_is_too_shallow_is_found_and_at_the_named_depth_there_is_a_steady_part(
    schedule, energy
):
    flat = SelfAffineSpectrum(0.1, 0.1, hurst=1.0)
    deeper = expectation(
        simulation_of("roughness", flat, energy, schedule, NUMERICS, seed=1)
    ).needed_penetration
    steady = []
    for depth in (schedule.max_penetration, deeper):
        load = replace(schedule, max_penetration=depth)
        one = simulation_of("roughness", flat, energy, load, NUMERICS, seed=1)
        works = steady_adhesion(run_simulation(one).record, one.correlation_length)
        steady.append(not works.sentence)
        assert (expectation(one).needed_penetration is None) == steady[-1]
    assert steady == [False, True]
