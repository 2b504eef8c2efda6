"""Laws of the numerical errors: what they state, and the numerics that they choose."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.law_interpolation import combined_error
from crackfront.simulate.laws import LAW_CUTOFFS, SETTINGS, read_laws, sphere_cutoffs
from crackfront.simulate.numerical_errors import numerical_error
from crackfront.simulate.settings import chosen_settings
from studies.accuracy.scenes import SCENES, with_setting

FINER = {"sites": 1.3, "cubic": 1.3, "linear": 1.3, "pixels": 1.3, "tolerance": 0.3}
START = {"sites": 2.0, "cubic": 4.0, "linear": 12.0, "pixels": 3.0, "tolerance": 1e-3}

scenes = st.sampled_from([scene for scene in SCENES.values() if scene.varies_single])


def chosen(scene, error):
    """Numerics for an error."""
    return chosen_settings(error, scene.kind, scene.spectrum, scene.elastic_energy)


def stated(scene, numerics, cutoffs=LAW_CUTOFFS):
    """Stated errors of k of both branches."""
    errors = numerical_error(scene.simulation(numerics, 0), cutoffs)
    return [error / scene.elastic_energy for error in errors]


@given(scene=scenes, setting=st.sampled_from(SETTINGS), steps=st.integers(0, 4))
def test_no_setting_that_is_made_finer_states_a_larger_error(scene, setting, steps):
    coarse = with_setting(chosen(scene, 0.03), setting, START[setting] * FINER[setting] ** steps)
    finer = with_setting(coarse, setting, START[setting] * FINER[setting] ** (steps + 1))
    for before, after in zip(stated(scene, coarse), stated(scene, finer), strict=True):
        assert after <= before * (1 + 1e-12)


@given(scene=scenes, error=st.sampled_from([0.1, 0.03, 0.01]))
def test_the_chosen_settings_state_no_more_than_the_error_that_was_asked_for(scene, error):
    assert max(stated(scene, chosen(scene, error))) <= 1.05 * error


@given(
    kind=st.sampled_from(["roughness", "chemical"]),
    cutoff=st.floats(0.002, 0.1),
    octaves=st.floats(0, 7),
    hurst=st.floats(0.1, 1),
    elastic_energy=st.floats(0.001, 0.4),
    error=st.floats(0.003, 0.1),
)
def test_the_chosen_settings_meet_the_request_and_the_next_fewer_sites_do_not(
    kind, cutoff, octaves, hurst, elastic_energy, error
):
    spectrum = SelfAffineSpectrum(cutoff, cutoff * 2**octaves, hurst)
    settings = chosen_settings(error, kind, spectrum, elastic_energy)
    values = {
        "sites": settings.angles_per_cutoff,
        "cubic": settings.samples_per_cutoff,
        "pixels": settings.pixels_per_cutoff,
        "tolerance": settings.tolerance,
    }

    def over_request(values):
        errors = combined_error(kind, spectrum, elastic_energy, values, sphere_cutoffs(spectrum))
        return max(errors) / (elastic_energy * error)

    # The choice begins at 1.4 sites, and its bisection is precise to 0.1%.
    if values["sites"] > 1.4:
        fewer = values["sites"] - (0.1 if values["sites"] <= 10 else 1)
        assert over_request(values | {"sites": fewer}) > 0.98
    assert over_request(values) < 1 + 1e-12 or 8 in (
        settings.pixels_per_cutoff,
        settings.samples_per_cutoff / 2,
    )


@given(scene=scenes)
def test_a_smaller_error_chooses_no_setting_coarser(scene):
    coarse, fine = chosen(scene, 0.1), chosen(scene, 0.01)
    assert fine.angles_per_cutoff >= coarse.angles_per_cutoff
    assert fine.samples_per_cutoff >= coarse.samples_per_cutoff
    assert fine.pixels_per_cutoff >= coarse.pixels_per_cutoff
    assert fine.tolerance <= coarse.tolerance
    assert fine != coarse


def test_bias_stays_and_scatter_falls_with_the_root_of_the_cutoffs_crossed():
    for law in read_laws():
        start = START[law.setting]
        small, large = (law.error(start, cutoffs) for cutoffs in (LAW_CUTOFFS, 4 * LAW_CUTOFFS))
        assert small / 2 * (1 - 1e-12) <= large <= small
    huge = law.error(START[law.setting], 1e30)
    assert huge == pytest.approx(math.exp(law.bias[0] + law.bias[1] * math.log(START[law.setting])))


def test_between_measured_amplitudes_the_error_lies_between_theirs():
    below, above = SCENES["flat-0.04"], SCENES["flat-0.16"]
    between = replace(below, elastic_energy=0.08)
    numerics = chosen(below, 0.1)
    errors = [stated(scene, numerics)[1] for scene in (below, between, above)]
    assert errors == sorted(errors)
    assert errors[0] < errors[1] < errors[2]


def of_spectrum(spectrum, elastic_energy, kind="roughness", tolerance=1e-7):
    """Stated errors of k of both branches at numerics that leave one."""
    values = {"sites": 1.8, "cubic": 3.0, "pixels": 2.7, "tolerance": tolerance}
    errors = combined_error(kind, spectrum, elastic_energy, values, LAW_CUTOFFS)
    return np.array(errors) / elastic_energy


@pytest.mark.parametrize("name", ["chemical-0.16", "flat-0.16", "h03-0.16", "h08-0.16"])
def test_a_measured_scene_takes_its_own_laws(name):
    scene = SCENES[name]
    chosen_values = {"sites": 2.2, "cubic": 3.0, "pixels": 3.0, "tolerance": 1e-4}
    errors = combined_error(scene.kind, scene.spectrum, 0.16, chosen_values, LAW_CUTOFFS)
    for direction, error in zip((1, -1), errors, strict=True):
        laws_of_scene = {
            law.setting: law.parts(chosen_values[law.setting])
            for law in read_laws()
            if (law.shape, law.elastic_energy, law.direction) == (scene.shape, 0.16, direction)
            and law.setting != "linear"
        }
        bias = max(
            laws_of_scene["cubic"][0],
            laws_of_scene["sites"][0] + laws_of_scene["pixels"][0] + laws_of_scene["tolerance"][0],
        )
        scatter = math.hypot(*(scatter for _, scatter in laws_of_scene.values()))
        assert error == pytest.approx(0.16 * math.hypot(bias, scatter))


def test_shorter_cutoffs_meet_avalanches_at_weaker_disorder():
    long, short, shorter = (SelfAffineSpectrum(size, size, 1.0) for size in (0.02, 0.013, 0.005))
    weak = [of_spectrum(spectrum, 0.003)[0] for spectrum in (long, short, shorter)]
    assert weak[0] < weak[1] < weak[2]
    for spectrum in (short, shorter):
        assert of_spectrum(spectrum, 0.16) == pytest.approx(of_spectrum(long, 0.16))


@pytest.mark.parametrize("elastic_energy", [0.0009, 0.43])
def test_an_error_is_refused_at_amplitudes_where_none_was_measured(elastic_energy):
    flat = SelfAffineSpectrum(0.02, 0.02, 1.0)
    with pytest.raises(ValueError, match=r"errors were measured for e_el/w_int from 0.001 to 0.4"):
        chosen_settings(0.03, "roughness", flat, elastic_energy)
    assert np.all(np.isnan(of_spectrum(flat, elastic_energy)))


def test_a_straight_front_asks_for_the_same_in_all_units():
    settings_found = {
        chosen_settings(
            0.03, "roughness", SelfAffineSpectrum(size, 4 * size, 0.8), 0.005, LAW_CUTOFFS
        )
        for size in (1e-3, 0.02, 1.0)
    }
    assert len(settings_found) == 1
