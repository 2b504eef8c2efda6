"""One simulation of a sweep: its sizes, its seed, its key, its field and its result."""

import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest

from crackfront.core import jkr
from crackfront.core.adhesion import correlation_length
from crackfront.core.solver.relax import Newton, Reference
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import (
    Simulation,
    resolution,
    simulation_adhesion,
)
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.tiles import Resolution

SETTINGS = Settings(None, 2, 4, "cubic", 4, 1e-6)
NUMERICS = Numerics(
    settings=SETTINGS,
    tile_roll_offs=10,
    tile_cutoffs=20,
    max_sweeps=100_000,
    solver="reference",
)
SIMULATION = Simulation(
    spectrum_name="rough",
    kind="roughness",
    spectrum=SelfAffineSpectrum(short_cutoff=0.2, roll_off=0.4, hurst=0.8),
    elastic_energy=0.05,
    realisation=0,
    sweep_seed=1,
    resolution=Resolution(
        n_angle=64, spacing=0.025, interpolation="cubic", tile_side=4.0, n_point=80
    ),
    schedule=FullCycle(0.5, 0.25),
    solver=Reference(1e-6, max_sweeps=100_000),
)

CYCLE = FullCycle(1.0, 0.1)


def test_the_tile_resolves_the_cutoff_and_holds_the_roll_off():
    spectrum = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.7, hurst=0.5)
    sizes = resolution(spectrum, NUMERICS, SETTINGS, CYCLE)
    assert sizes.tile_side == pytest.approx(7.0, rel=1e-15)
    assert sizes.tile_side / sizes.n_point <= 0.1 / 4
    assert sizes.spacing == 0.1 / 4


@pytest.mark.parametrize("both_or_neither", [{}, {"settings": SETTINGS, "error": 0.03}])
def test_numerics_need_either_settings_or_an_error(both_or_neither):
    with pytest.raises(ValueError, match=r"settings and error; give one"):
        Numerics(**both_or_neither)


def test_a_flat_spectrum_gets_the_smallest_tile_in_cutoffs():
    flat = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=0.5)
    assert resolution(flat, NUMERICS, SETTINGS, CYCLE).tile_side == 2.0


def test_the_front_has_enough_sites_for_the_largest_circle_and_fast_transforms():
    spectrum = SelfAffineSpectrum(short_cutoff=0.1, roll_off=0.1, hurst=0.5)
    n_angle = resolution(spectrum, NUMERICS, SETTINGS, CYCLE).n_angle
    least = 2 * np.pi * jkr.equilibrium_radius(1.0) / 0.1 * 2
    assert n_angle % 2 == 0
    assert least <= n_angle < 1.2 * least
    for factor in (2, 3, 5):
        while n_angle % factor == 0:
            n_angle //= factor
    assert n_angle == 1


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "chemical"},
        {"spectrum": SelfAffineSpectrum(0.2, 0.4, 0.81)},
        {"elastic_energy": 0.0500001},
        {"realisation": 1},
        {"sweep_seed": 2},
        {"resolution": Resolution(64, 0.025, "cubic", 4.0, 81)},
        {"schedule": FullCycle(0.5, 0.125)},
        {"solver": Reference(1e-7, max_sweeps=100_000)},
        {"solver": Newton(1e-6, max_sweeps=100_000)},
        {"record_fronts": True},
        {"record_energy": True},
    ],
    ids=lambda change: next(iter(change)),
)
def test_the_key_changes_with_everything_that_determines_the_result(change):
    assert replace(SIMULATION, **change).key != SIMULATION.key


def test_the_key_is_a_digest_of_the_parameters_as_json_with_the_realisation():
    changed = replace(SIMULATION, elastic_energy=0.07, realisation=7)
    text = json.dumps(changed.parameters, sort_keys=True)
    assert changed.key == f"{hashlib.sha256(text.encode()).hexdigest()[:16]}-7"


@pytest.mark.parametrize(
    ("simulation", "key"),
    [
        (SIMULATION, "bba097ba69287f7b-0"),
        (replace(SIMULATION, solver=Newton(1e-6), record_fronts=True), "46efa6e4fdd1c3ab-0"),
        (replace(SIMULATION, schedule=SteadySchedule(1.0, 1.5, 1.5, 0.1)), "d62704806b0a1f61-0"),
        (
            replace(SIMULATION, schedule=LineSchedule(3.0, 60.0, 60.0, 5.0, 0.5, True)),
            "6cfadd6c54ae4f88-0",
        ),
    ],
)
def test_results_that_are_stored_keep_their_keys(simulation, key):
    assert simulation.key == key


@pytest.mark.parametrize(
    "change",
    [
        {"elastic_energy": SIMULATION.elastic_energy * (1 + 1e-15)},
        {"spectrum_name": "other"},
        {"spectrum": SIMULATION.spectrum.with_elastic_energy(0.3)},
    ],
    ids=["last digits", "name", "plateau"],
)
def test_what_does_not_determine_the_result_is_not_in_the_key(change):
    assert replace(SIMULATION, **change).key == SIMULATION.key


def test_amplitudes_and_grids_share_the_seed_of_a_realisation():
    finer = Resolution(128, 0.0125, "cubic", 4.0, 160)
    for change in ({"elastic_energy": 0.1}, {"resolution": finer}, {"spectrum_name": "b"}):
        assert replace(SIMULATION, **change).seed == SIMULATION.seed


def test_realisations_spectra_tiles_and_sweeps_have_seeds_of_their_own():
    changes = (
        {},
        {"realisation": 1},
        {"sweep_seed": 2},
        {"spectrum": SelfAffineSpectrum(0.2, 0.4, 0.9)},
        {"spectrum": SelfAffineSpectrum(0.2, 0.5, 0.8)},
        {"resolution": Resolution(64, 0.025, "cubic", 5.0, 80)},
    )
    seeds = [replace(SIMULATION, **change).seed for change in changes]
    assert len(set(seeds)) == len(seeds)
    assert all(0 <= seed < 2**63 for seed in seeds)


def test_the_seed_is_the_same_for_ever():
    # A change of this number changes the surfaces of all sweeps.
    assert SIMULATION.seed == 9036307460067312527


def test_amplitudes_of_a_realisation_are_one_surface_scaled():
    weak = simulation_adhesion(replace(SIMULATION, elastic_energy=0.02))
    strong = simulation_adhesion(replace(SIMULATION, elastic_energy=0.08))
    fluctuations = [
        field.work_of_adhesion - WORK_OF_ADHESION * (1 - field.e_el) for field in (weak, strong)
    ]
    assert fluctuations[1] == pytest.approx(2 * fluctuations[0], rel=1e-9, abs=1e-15)
    assert strong.e_el == pytest.approx(4 * weak.e_el, rel=1e-12)


def test_a_chemical_field_has_the_spectrum_itself_and_keeps_the_mean():
    field = simulation_adhesion(replace(SIMULATION, kind="chemical"))
    assert np.mean(field.work_of_adhesion) == pytest.approx(WORK_OF_ADHESION, rel=1e-12)
    flat = SelfAffineSpectrum(short_cutoff=0.2, roll_off=0.2, hurst=0.8)
    # C(q) = const: <q> = 2 q_s / 3, while roughness weighs by q once more: <q> = 3 q_s / 4.
    assert correlation_length("chemical", flat) == pytest.approx(0.2 * 3 / 2)
    assert correlation_length("roughness", flat) == pytest.approx(0.2 * 4 / 3)


def test_a_simulation_gives_the_same_bits_again():
    first, again = run_simulation(SIMULATION), run_simulation(SIMULATION)
    assert np.array_equal(first.record.states.force, again.record.states.force)
    assert first.measures.w_rms == again.measures.w_rms
