"""What a plan says before the run: where loads leave no steady part, and how deep they must go."""

import re
from dataclasses import replace

import pytest

from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import Scales
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import simulation_of
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.sweep.advice import (
    expectation,
    expectations,
    small_size_warnings,
    steady_part_warnings,
)
from crackfront.sweep.parameters import load_sweep
from tests.places import TEST

NUMERICS = Numerics(
    settings=Settings(None, 4, 4, "cubic", 4, 1e-5), tile_roll_offs=4, tile_cutoffs=40
)
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
        case = simulation_of("roughness", flat, energy, load, NUMERICS, seed=1)
        works = steady_adhesion(run_simulation(case).record, case.correlation_length)
        steady.append(not works.sentence)
        assert (expectation(case).needed_penetration is None) == steady[-1]
    assert steady == [False, True]


@pytest.mark.parametrize("key", ["max_penetration", "start", "travel"])
def test_each_key_that_a_plan_advises_leaves_a_steady_part_with_its_value(key):
    flat, shallow = SelfAffineSpectrum(0.05, 0.05, hurst=1.0), SteadySchedule(1.0, 1.5, 1.5, 0.05)

    def simulation(load, realisation=0):
        return simulation_of(
            "roughness", flat, 0.02, load, NUMERICS, seed=1, realisation=realisation
        )

    def steady(load):
        results = (run_simulation(simulation(load, number)) for number in range(2))
        return [not result.steady_adhesion.sentence for result in results]

    doubt = expectation(simulation(shallow))
    needed = {
        "max_penetration": doubt.needed_penetration,
        "start": doubt.needed_start,
        "travel": doubt.needed_travel,
    }
    assert needed["max_penetration"] > 1.5
    assert 0 < needed["start"] < 1.0
    assert 0 < needed["travel"] < 1.5
    assert steady(shallow) == [False, False]
    helped = replace(shallow, **{key: needed[key]})
    assert steady(helped) == [True, True]
    assert expectation(simulation(helped)).needed_penetration is None


def test_a_plan_advises_values_that_help_at_all_amplitudes():
    sweep = replace(load_sweep(TEST), schedule=SteadySchedule(2.0, 2.5, 1.0, 0.05))
    cells = expectations(sweep)["flat"]
    sentence = next(steady_part_warnings(sweep))
    advised = re.search(r"travel to (\S+) or lower start to (\S+) or .* to (\S+)$", sentence)
    travel, start, depth = map(float, advised.groups())
    for number, name in ((travel, "needed_travel"), (start, "needed_start")):
        least = min(getattr(cell, name) for cell in cells)
        assert 0.9 * least < number <= least
    assert depth >= max(cell.needed_penetration for cell in cells)


def test_a_plan_does_not_advise_far_more_than_is_needed():
    flat, shallow = SelfAffineSpectrum(0.1, 0.1, hurst=1.0), SteadySchedule(1.0, 2.5, 1.5, 0.05)
    case = simulation_of("roughness", flat, 0.15, shallow, NUMERICS, seed=1)
    needed = expectation(case).needed_penetration
    slightly_less = replace(case, schedule=replace(shallow, max_penetration=needed / 1.3))
    assert expectation(slightly_less).needed_penetration is not None


def test_wavelengths_that_a_plan_advises_for_a_small_contact_give_it_the_size_1(tmp_path):
    coarse = load_sweep(TEST)
    warnings = dict(zip(("flat", "rough"), small_size_warnings(coarse), strict=True))
    scales = Scales(1.25e-3, 63e-3, 0.93e6)
    metres = [*small_size_warnings(replace(coarse, scales=scales))]
    configuration = tmp_path / "finer.yaml"
    text = TEST.read_text()
    for name, lengths in (("flat", (0.1,)), ("rough", (0.1, 0.2))):
        divisor = float(re.search(r"divide its wavelengths by ([\d.]+)", warnings[name])[1])
        cutoff = float(re.search(r"short_cutoff ([\d.]+)\)", warnings[name])[1])
        assert cutoff == pytest.approx(0.1 / divisor, rel=0.1)
        [in_metres] = [sentence for sentence in metres if sentence.startswith(name)]
        length = float(re.search(r"short_cutoff (\S+) m\)", in_metres)[1])
        assert length == pytest.approx(scales.lateral * cutoff, rel=0.1)
        line = next(line for line in text.splitlines() if f"name: {name}" in line)
        finer = line
        for length in lengths:
            finer = finer.replace(f": {length},", f": {length / divisor},")
        text = text.replace(line, finer)
    configuration.write_text(text)
    fine = load_sweep(configuration)
    assert not [*small_size_warnings(fine)]
    for weakest, *_ in expectations(fine).values():
        assert weakest.size == pytest.approx(1.0, rel=0.05)


def test_a_steady_load_that_failed_names_keys_that_it_has():
    flat = SelfAffineSpectrum(0.1, 0.1, hurst=1.0)
    sentences = []
    for load in SHALLOW:
        case = simulation_of("roughness", flat, 0.05, load, NUMERICS, seed=1)
        sentences.append(run_simulation(case).steady_adhesion.sentence)
    cycle, steady = sentences
    assert "step" in cycle
    assert "step" not in steady
    assert {"max_penetration", "start", "travel"} <= set(re.findall(r"\w+", steady))
