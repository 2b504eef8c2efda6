"""What a plan says before the run: where loads leave no steady part, and how deep they must go."""

from dataclasses import replace

import pytest

from crackfront.analysis.steady import steady_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.laws import Knobs
from crackfront.simulate.numerics import Numerics, simulation_of
from crackfront.simulate.run import run_simulation
from crackfront.simulate.sphere.cycle import FullCycle
from crackfront.simulate.sphere.steady import SteadySchedule
from crackfront.sweep.expectation import expectation

NUMERICS = Numerics(Knobs(None, 4, 4, "cubic", 4, 1e-5), tile_roll_offs=4, tile_cutoffs=40)
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
        found = steady_adhesion(run_simulation(one).record, one.correlation_length)
        steady.append(not found.sentence)
        assert (expectation(one).needed_penetration is None) == steady[-1]
    assert steady == [False, True]
