"""Laws of the numerical errors: what they state, and the numerics that they choose."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.laws import KNOBS, LAW_SIZE, chosen_knobs, read_laws, spectral_shape
from crackfront.simulate.simulation import numerical_error
from crackfront.studies.accuracy.scenes import SCENES, with_knob

ENERGIES = (0.0025, 0.01, 0.04, 0.16)
FINER = {"sites": 1.3, "cubic": 1.3, "linear": 1.3, "pixels": 1.3, "tolerance": 0.3}
START = {"sites": 2.0, "cubic": 4.0, "linear": 12.0, "pixels": 3.0, "tolerance": 1e-3}

scenes = st.sampled_from([scene for scene in SCENES.values() if scene.single_knobs])


def chosen(scene, error):
    """Numerics for an error."""
    return chosen_knobs(error, scene.kind, scene.spectrum, scene.elastic_energy)


def stated(scene, numerics, size=LAW_SIZE):
    """Stated errors of k of both branches."""
    errors = numerical_error(scene.simulation(numerics, 0), size)
    return [error / scene.elastic_energy for error in errors]


def test_every_shape_amplitude_knob_and_branch_has_a_law():
    laws = {(law.shape, law.elastic_energy, law.knob, law.direction) for law in read_laws()}
    assert laws == {
        (shape, energy, knob, direction)
        for shape in ("chemical", "flat", "h08", "h03")
        for energy in ENERGIES
        for knob in KNOBS
        for direction in (1, -1)
    }


@given(scene=scenes, knob=st.sampled_from(KNOBS), steps=st.integers(0, 4))
def test_no_knob_that_is_made_finer_states_a_larger_error(scene, knob, steps):
    coarse = with_knob(chosen(scene, 0.03), knob, START[knob] * FINER[knob] ** steps)
    finer = with_knob(coarse, knob, START[knob] * FINER[knob] ** (steps + 1))
    for before, after in zip(stated(scene, coarse), stated(scene, finer), strict=True):
        assert after <= before * (1 + 1e-12)


@given(scene=scenes, error=st.sampled_from([0.1, 0.03, 0.01]))
def test_the_chosen_knobs_state_no_more_than_the_error_that_was_asked_for(scene, error):
    assert max(stated(scene, chosen(scene, error))) <= 1.05 * error


def test_the_chosen_knobs_are_not_much_finer_than_the_error_needs():
    for scene in SCENES.values():
        if scene.elastic_energy >= 0.04 and scene.single_knobs:
            assert max(stated(scene, chosen(scene, 0.01))) > 0.007


@given(scene=scenes)
def test_a_smaller_error_chooses_no_knob_coarser(scene):
    coarse, fine = chosen(scene, 0.1), chosen(scene, 0.01)
    assert fine.angles_per_cutoff >= coarse.angles_per_cutoff
    assert fine.samples_per_cutoff >= coarse.samples_per_cutoff
    assert fine.pixels_per_cutoff >= coarse.pixels_per_cutoff
    assert fine.tolerance <= coarse.tolerance
    assert fine != coarse


def test_strong_disorder_needs_more_sites_and_weak_disorder_a_tighter_tolerance():
    strong, weak = chosen(SCENES["flat-0.16"], 0.03), chosen(SCENES["flat-0.0025"], 0.03)
    assert strong.angles_per_cutoff > 1.5 * weak.angles_per_cutoff
    assert weak.tolerance < strong.tolerance


def test_bias_stays_and_scatter_falls_with_the_root_of_the_size():
    for law in read_laws():
        small, large = (law.error(START[law.knob], size) for size in (LAW_SIZE, 4 * LAW_SIZE))
        assert small / 2 * (1 - 1e-12) <= large <= small
    huge = law.error(START[law.knob], 1e30)
    assert huge == pytest.approx(math.exp(law.bias[0] + law.bias[1] * math.log(START[law.knob])))


def test_between_measured_amplitudes_the_error_lies_between_theirs():
    below, above = SCENES["flat-0.04"], SCENES["flat-0.16"]
    between = replace(below, elastic_energy=0.08)
    numerics = chosen(below, 0.1)
    errors = [stated(scene, numerics)[1] for scene in (below, between, above)]
    assert errors == sorted(errors)
    assert errors[0] < errors[1] < errors[2]


def test_a_number_of_sites_counts_on_the_largest_circle():
    scene = SCENES["flat-0.16"]
    per_cutoff = chosen(scene, 0.1)
    sites = scene.simulation(per_cutoff, 0).resolution.n_angle
    assert stated(scene, replace(per_cutoff, angles=sites)) == stated(scene, per_cutoff)
    assert stated(scene, replace(per_cutoff, angles=2 * sites)) < stated(scene, per_cutoff)


@pytest.mark.parametrize(
    ("kind", "roll_off", "hurst", "shape"),
    [
        ("chemical", 0.02, 1.0, "chemical"),
        ("roughness", 0.02, 0.3, "flat"),
        ("roughness", 0.4, 0.3, "h03"),
        ("chemical", 0.4, 0.3, "h03"),
        ("roughness", 0.4, 1.0, "h08"),
    ],
)
def test_a_spectrum_takes_the_laws_of_the_nearest_shape(kind, roll_off, hurst, shape):
    assert spectral_shape(kind, SelfAffineSpectrum(0.02, roll_off, hurst)) == shape
