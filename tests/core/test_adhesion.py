import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import struve
from SurfaceTopography import Topography

from crackfront.core.adhesion import (
    chemical_adhesion,
    front_stress_intensity,
    half_derivative_mean_square,
    rough_adhesion,
)
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION, Scales

SPECTRA = [
    SelfAffineSpectrum(0.05, 0.05, 0.8),
    SelfAffineSpectrum(0.05, 0.25, 0.3),
    SelfAffineSpectrum(0.05, 0.25, 0.8),
]


def surface(spectrum, energy, seed=1, n_point=64, length=1.0):
    return gaussian_field(
        spectrum.with_elastic_energy(energy), n_point, length, np.random.default_rng(seed)
    )


def grid(n_x, n_y, pixel=1.0):
    x, y = pixel * np.arange(n_x), pixel * np.arange(n_y)
    return np.meshgrid(x, y, indexing="ij")


def test_a_wave_across_the_front_is_shifted_by_an_eighth_of_a_period():
    x, _ = grid(16, 9)
    q = 2 * np.pi * 3 / 16
    stress = front_stress_intensity(np.cos(q * x + 0.3), 1.0, modulus=2.0)
    shifted = np.cos(q * x + 0.3 + np.pi / 4)
    assert np.allclose(stress, -2.0 / np.sqrt(2) * np.sqrt(q) * shifted, atol=1e-13)


@given(st.integers(-7, 7), st.integers(-7, 7), st.floats(0, 6))
def test_an_oblique_wave_meets_the_kernel_of_the_paper(row, column, phase):
    x, y = grid(16, 16, pixel=0.5)
    q_x, q_y = 2 * np.pi * row / 8, 2 * np.pi * column / 8
    wave = np.exp(1j * (q_x * x + q_y * y + phase))
    expected = -(1.0 / np.sqrt(2)) * np.real(np.sqrt(1j * q_x + abs(q_y)) * wave)
    assert np.allclose(front_stress_intensity(wave.real, 0.5, modulus=1.0), expected, atol=1e-13)


def test_circular_waviness_far_from_its_centre_is_a_wave_across_the_front():
    # Exact for the profile f = A (1 - cos k r), i.e. heights A cos k r: K follows from the Struve
    # function H0 (facts.md); its part 2 / (pi k a) that does not oscillate vanishes far out.
    amplitude, n_point = 1.0, 64
    k = 2 * np.pi
    radius = 200.0 + np.arange(n_point) / n_point
    waves = struve(0, k * radius) - 2 / (np.pi * k * radius)
    exact = CONTACT_MODULUS / np.sqrt(np.pi * radius) * np.pi**2 * amplitude * radius * waves
    heights = amplitude * np.cos(k * radius)[:, None] * np.ones((1, 4))
    straight = front_stress_intensity(heights, 1 / n_point)[:, 0]
    assert np.allclose(straight, exact, atol=2e-3 * np.abs(exact).max())


def test_the_nyquist_wave_across_the_front_takes_the_mean_over_both_signs():
    zigzag = (-1.0) ** np.arange(8)[:, None] * np.ones((1, 8))
    stress = front_stress_intensity(zigzag, 1.0, modulus=1.0)
    # Mean of sqrt(i pi) and sqrt(-i pi) is sqrt(pi / 2).
    assert np.allclose(stress, -np.sqrt(np.pi / 2) / np.sqrt(2) * zigzag, atol=1e-14)


def test_the_nyquist_wave_does_not_break_the_mirror_symmetry_along_the_front(rng):
    heights = rng.standard_normal((8, 8))
    mirrored = front_stress_intensity(heights[:, ::-1], 1.0)
    assert np.allclose(mirrored, front_stress_intensity(heights, 1.0)[:, ::-1], atol=1e-13)


@pytest.mark.parametrize("shape", [(8, 8), (9, 9), (8, 12), (7, 10)])
def test_stress_intensity_is_real_has_zero_mean_and_moves_with_the_surface(shape, rng):
    heights = rng.standard_normal(shape)
    stress = front_stress_intensity(heights, 0.3)
    assert stress.shape == shape
    assert stress.mean() == pytest.approx(0.0, abs=1e-13)
    rolled = front_stress_intensity(np.roll(heights, (2, 3), axis=(0, 1)), 0.3)
    assert np.allclose(rolled, np.roll(stress, (2, 3), axis=(0, 1)), atol=1e-12)


@pytest.mark.parametrize("spectrum", SPECTRA)
def test_the_energy_of_full_conformity_is_that_of_surface_topography(spectrum):
    heights = surface(spectrum, 0.04)
    half = Topography(heights, (1.0, 1.0), periodic=True).moment_power_spectrum(order=1)
    energy = CONTACT_MODULUS / 4 * half / WORK_OF_ADHESION
    assert energy == pytest.approx(rough_adhesion(heights, 1 / 64).e_el, rel=1e-10)


@pytest.mark.parametrize("spectrum", SPECTRA)
@pytest.mark.parametrize(("energy", "n_point"), [(0.002, 64), (0.05, 41), (0.05, 42), (0.15, 81)])
def test_rms_is_twice_the_root_of_the_elastic_energy_by_parseval(spectrum, energy, n_point):
    adhesion = rough_adhesion(surface(spectrum, energy, n_point=n_point), 1 / n_point)
    assert adhesion.w_rms == pytest.approx(2 * np.sqrt(adhesion.e_el), rel=1e-12)
    measured = np.std(adhesion.work_of_adhesion) / WORK_OF_ADHESION
    assert measured == pytest.approx(2 * np.sqrt(adhesion.e_el), rel=1e-12)


@pytest.mark.parametrize("spectrum", SPECTRA)
def test_mean_adhesion_is_lowered_by_the_elastic_energy(spectrum):
    adhesion = rough_adhesion(surface(spectrum, 0.1), 1 / 64)
    mean = adhesion.work_of_adhesion.mean() / WORK_OF_ADHESION
    assert mean == pytest.approx(1 - adhesion.e_el, rel=1e-13)


def test_adhesion_computed_in_si_is_the_reduced_one_rescaled():
    scales = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)
    heights = surface(SPECTRA[2], 0.1)
    in_si = scales.vertical * heights
    pixel = scales.lateral / 64
    modulus, intrinsic = scales.contact_modulus, scales.work_of_adhesion
    stress = front_stress_intensity(in_si, pixel, modulus)
    energy = modulus / 4 * half_derivative_mean_square(in_si, pixel)
    expected = intrinsic - energy - np.sqrt(2 * intrinsic / modulus) * stress
    reduced = rough_adhesion(heights, 1 / 64).work_of_adhesion
    back = scales.energy_per_area * reduced
    assert np.allclose(back, expected, rtol=0, atol=1e-13 * expected.max())


@pytest.mark.parametrize("factor", [1.0001, 3.0])
def test_a_surface_that_cannot_conform_is_refused(factor):
    heights = surface(SPECTRA[0], 0.05)
    measured = rough_adhesion(heights, 1 / 64).e_el
    too_rough = heights * np.sqrt(factor / measured)
    with pytest.raises(ValueError, match=r"full conformity is .* w_int; .* lower the roughness"):
        rough_adhesion(too_rough, 1 / 64)


def test_a_chemical_field_keeps_its_mean_and_states_its_equivalent_energy(rng):
    fluctuation = 0.3 * rng.standard_normal((16, 16))
    fluctuation -= fluctuation.mean()
    adhesion = chemical_adhesion(fluctuation, 0.1)
    assert adhesion.work_of_adhesion.mean() == pytest.approx(WORK_OF_ADHESION, rel=1e-14)
    assert adhesion.w_rms == pytest.approx(fluctuation.std(), rel=1e-13)
    assert adhesion.w_rms == pytest.approx(2 * np.sqrt(adhesion.e_el), rel=1e-14)
    assert adhesion.pixel == 0.1
