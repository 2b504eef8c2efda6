"""Synthesised surfaces as SurfaceTopography measures them."""

import numpy as np
import pytest
from SurfaceTopography import Topography

from crackfront.core.adhesion import half_derivative_mean_square, rough_adhesion
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

SIDE, N_POINT = 2.56, 128


@pytest.fixture(
    params=[(0.1, 0.1, 1.0), (0.05, 0.2, 0.3)], ids=["flat", "self-affine"], scope="module"
)
def measured(request):
    spectrum = SelfAffineSpectrum(*request.param).with_elastic_energy(0.04)
    heights = gaussian_field(spectrum, N_POINT, SIDE, np.random.default_rng(11))
    return spectrum, heights, Topography(heights, (SIDE, SIDE), periodic=True)


def test_the_energy_of_full_conformity_is_that_of_the_library(measured):
    _, heights, topography = measured
    half = topography.moment_power_spectrum(order=1)
    assert half == pytest.approx(half_derivative_mean_square(heights, SIDE / N_POINT), rel=1e-10)
    energy = CONTACT_MODULUS / 4 * half / WORK_OF_ADHESION
    assert energy == pytest.approx(rough_adhesion(heights, SIDE / N_POINT).e_el, rel=1e-10)


@pytest.mark.parametrize("order", [0.0, 0.5, 1.0])
def test_mean_squares_of_derivatives_are_those_of_the_spectrum(measured, order):
    spectrum, _, topography = measured
    found = topography.moment_power_spectrum(order=2 * order)
    assert found == pytest.approx(spectrum.mean_square(order), rel=0.25)


def test_the_mean_square_height_is_that_of_the_library(measured):
    _, heights, topography = measured
    assert topography.moment_power_spectrum(order=0) == pytest.approx(np.var(heights), rel=1e-10)


def test_the_radial_average_of_the_library_is_the_spectrum(measured):
    spectrum, _, topography = measured
    knee, cutoff = 2 * np.pi / spectrum.roll_off, 2 * np.pi / spectrum.short_cutoff
    edges = np.geomspace(2 * np.pi / SIDE * 2.5, cutoff, 5)
    wavevector, density = topography.power_spectrum_from_area(collocation=edges, reliable=False)[:2]
    expected = spectrum.density(np.asarray(wavevector))
    np.testing.assert_allclose(np.asarray(density), expected, rtol=0.3)
    assert density[-1] < 1.3 * spectrum.density(max(knee, edges[-2]))
