"""Surfaces by a spectral density or by numbers alone, beside spectra that are known exactly."""

from dataclasses import replace

import numpy as np
import pytest

import crackfront as cf
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.measured.options import SelfAffineOptions
from crackfront.measured.scan.psd import Psd
from crackfront.measured.spectrum.stated import density_surface, self_affine_surface_of
from tests.measured.made import SCENE

SURFACE = SelfAffineSpectrum(20e-9, 2e-6, hurst=0.8, plateau=1e-27)


def psd(tmp_path, shortest=100e-9, longest=20e-6, spectrum=SURFACE, *, is_profile=True):
    """Density of a surface as a file has it."""
    q = 2 * np.pi / np.geomspace(longest, shortest, 45)
    value = spectrum.profile_density(q) if is_profile else spectrum.density(q)
    return Psd(tmp_path / "psd.csv", "0" * 8, q, value, is_profile, "a density", ())


@pytest.mark.parametrize("hurst", [0.3, 0.8, 1.0])
def test_profiles_have_the_isotropic_density_that_they_are_the_projection_of(tmp_path, hurst):
    spectrum = replace(SURFACE, hurst=0.8, short_cutoff=1e-12)
    surface = density_surface(psd(tmp_path, spectrum=spectrum))
    q = 2 * np.pi / np.array(surface.spectrum.wavelengths)
    np.testing.assert_allclose(surface.spectrum.densities, spectrum.density(q), rtol=0.15)
    energy = spectrum.mean_square_between(0.5, 100e-9, 1.0)
    assert surface.half_derivative.value == pytest.approx(energy, rel=0.02)


def test_profiles_and_isotropic_densities_predict_the_same(tmp_path):
    spectrum = replace(SURFACE, short_cutoff=1e-12)
    by_profile, by_map = (
        cf.predict(density_surface(psd(tmp_path, spectrum=spectrum, is_profile=kind)), SCENE)
        for kind in (True, False)
    )
    assert by_profile.hysteresis.value == pytest.approx(by_map.hysteresis.value, rel=0.03)
    assert by_profile.e_el.low == by_profile.e_el.value == by_profile.e_el.high
    assert by_profile.hysteresis.low < by_profile.hysteresis.value


def test_numbers_give_the_surface_that_has_them():
    options = SelfAffineOptions(
        rms="60nm", correlation_length="1um", hurst=0.8, short_cutoff="100nm"
    )
    surface = self_affine_surface_of(options)
    assert surface.measures[0].rms.value == pytest.approx(60e-9)
    assert surface.doubts == ()
    # Autocorrelation by the transform of the density, of a period of many correlation lengths.
    n, side = 2048, 64e-6
    axis = 2 * np.pi * np.fft.fftfreq(n, side / n)
    density = surface.spectrum.density(np.hypot(axis[:, None], axis))
    correlation = np.fft.ifft2(density).real[:, 0]
    distance = side / n * np.arange(n // 4)
    there = np.interp(1e-6, distance, correlation[: n // 4] / correlation[0])
    assert there == pytest.approx(np.exp(-1), abs=0.01)


def test_an_unnamed_cutoff_is_assumed_or_asked_for():
    surface = cf.self_affine_surface(rms="60nm", correlation_length="1um", hurst=0.8)
    [doubt] = surface.doubts
    assert "continued to 1 nm" in doubt
    assert "8% of e_el" in doubt
    with pytest.raises(ValueError, match=r"Hurst exponent is 0\.5.*as short cutoff, as in 10nm"):
        cf.self_affine_surface(rms="60nm", correlation_length="1um", hurst=0.5)


@pytest.mark.parametrize(
    ("numbers", "sentence"),
    [
        ({"rms": "60nm", "hurst": 0.8}, "needs rms, hurst, and either"),
        ({"rms": "60nm", "roll_off": "1um"}, "needs rms, hurst, and either"),
        (
            {"rms": "60nm", "roll_off": "1um", "correlation_length": "1um", "hurst": 0.8},
            "both lengths are named",
        ),
        (
            {"rms": "60nm", "roll_off": "1um", "short_cutoff": "2um", "hurst": 0.8},
            "the roll-off, 1 um, is shorter than the short cutoff, 2 um",
        ),
        *(
            (
                {"rms": "60nm", "correlation_length": "1um", "short_cutoff": cutoff, "hurst": 0.8},
                "correlation length of 1 um; name a shorter",
            )
            for cutoff in ("10um", "20um")
        ),
        (
            {"rms": "60nm", "correlation_length": "1um", "short_cutoff": "1nm", "hurst": 0.02},
            "exponent of 0.02 .* 1 um needs a roll-off above 100 um; name the roll-off",
        ),
        ({"rms": "60", "roll_off": "1um", "hurst": 0.8}, "rms is '60', without a unit"),
    ],
)
def test_numbers_that_are_no_surface_are_refused(numbers, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.self_affine_surface(**numbers)


def test_what_needs_heights_is_said_and_not_checked():
    rough = cf.self_affine_surface(rms="20nm", roll_off="2um", hurst=0.8, short_cutoff="20nm")
    prediction = cf.predict(rough, SCENE)
    reservations = [remark.sentence for remark in prediction.verdict.with_severity("reservation")]
    [sentence_of_heights] = [sentence for sentence in reservations if "heights" in sentence]
    assert "isotropic" in sentence_of_heights
    assert not [
        remark for remark in prediction.verdict.remarks if remark.concerns == "random roughness"
    ]
    page = repr(prediction)
    assert "rms height        20 nm; waves from 20 nm to 2 um" in page
    with pytest.raises(TypeError, match="unexpected keyword argument 'unit'"):
        cf.predict(rough, SCENE, unit="um")
