"""Scans that hardly show a spectrum: an interval that may be believed, or a sentence."""

from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.prediction.surface_remarks import spectrum_remarks
from crackfront.measured.scan.reading import Measurement
from crackfront.measured.spectrum.joining import joint_spectrum
from crackfront.measured.spectrum.measured_surface import measured_surface

# A batch is enough to see whether there is an answer.
pytestmark = pytest.mark.usefixtures("few_draws")

PIXEL = 0.1e-6


def measurement(heights, name="scan"):
    """Heights as they are read from a file."""
    sides = tuple(PIXEL * count for count in heights.shape)
    return Measurement(Path(name), "", "", "", sides, heights, False, 4 * PIXEL, min(sides) / 2)


def profile(rng, n_point=64, hurst=0.8):
    """A self-affine line, whose ends do not fit together."""
    waves = np.arange(n_point + 1)
    amplitude = np.maximum(waves, n_point / 4) ** (-0.5 - hurst)
    amplitude[0] = 0
    parts = rng.standard_normal((2, waves.size))
    heights = np.fft.irfft(amplitude * (parts[0] + 1j * parts[1]))[:n_point]
    return 1e-8 * (heights - heights.mean()) / heights.std()


def waves_up_to(number, rng, shape=(48, 48)):
    """A map without any wave beyond some in its side."""
    transform = np.fft.rfft2(rng.standard_normal(shape))
    along = np.fft.fftfreq(shape[0], 1 / shape[0])
    transform[np.hypot(along[:, None], np.arange(transform.shape[1])) > number] = 0
    return 1e-8 * np.fft.irfft2(transform, shape)


def refusal(*measurements):
    """The sentence by which measurements are refused."""
    with pytest.raises(ValueError, match=r".") as caught:
        measured_surface(measurements)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert str(measurements[0].path) in sentence
    return sentence


def test_a_line_with_nothing_below_its_trusted_waves_has_a_spectrum(rng):
    """As of a blurred profile, whose noise begins where its trusted waves end."""
    heights = profile(rng, 128)
    scan = analysed_scan(measurement(heights), 6 * PIXEL, 32 * PIXEL)
    scan = replace(scan, band=replace(scan.band, noise_limit=scan.band.shortest.wavelength))
    joint = joint_spectrum([scan])
    energy = joint.draws.mean_square(0.5)
    assert 0 < energy.low <= energy.value <= energy.high < np.inf
    assert joint.recorded.mean_square(0.5) > 0


def shown(heights):
    """Mean square half-derivative of the waves of a periodic map (Units: m)."""
    along = [2 * np.pi * np.fft.fftfreq(count, PIXEL) for count in heights.shape]
    power = np.abs(np.fft.fft2(heights, norm="forward")) ** 2
    return float(np.sum(np.hypot(*np.ix_(*along)) * power))


@pytest.mark.parametrize(
    "heights",
    [
        pytest.param(lambda rng: waves_up_to(3, rng), id="three waves"),
        pytest.param(lambda rng: waves_up_to(5, rng, (48, 80)), id="five waves, oblong"),
    ],
)
def test_intervals_of_maps_whose_waves_end_hold_them_whatever_the_rounding(heights, rng):
    heights = heights(rng)
    rounding = 1e-16 * np.std(heights) * rng.standard_normal(heights.shape)
    energy, rounded = (
        measured_surface([measurement(values)]).half_derivative
        for values in (heights, heights + rounding)
    )
    # Of one map of few waves, whose own e_el is not that of its surface.
    assert energy.low / 2 < shown(heights) < energy.high
    assert energy.high < 30 * energy.low
    assert_allclose(astuple(rounded), astuple(energy), rtol=1e-6)


@pytest.mark.parametrize(
    "heights",
    [
        pytest.param(np.sin(np.arange(64) * np.pi / 4), id="line"),
        pytest.param(np.sin(np.arange(48)[:, None] * np.pi / 4) + np.zeros(48), id="map"),
    ],
)
def test_one_wave_does_not_determine_e_el(heights):
    assert "does not determine e_el" in refusal(measurement(1e-8 * heights))


@pytest.mark.parametrize(
    "heights",
    [
        pytest.param(lambda rng: 1e-9 * rng.standard_normal(64), id="line of white noise"),
        pytest.param(lambda rng: 1e-9 * rng.standard_normal((32, 32)), id="smallest map"),
        pytest.param(lambda rng: 1e-8 * (np.arange(64) > 32.0), id="one step"),
    ],
)
def test_small_scans_have_intervals(heights, rng):
    energy = measured_surface([measurement(heights(rng))]).half_derivative
    assert 0 < energy.low < energy.value < energy.high < 1e4 * energy.low


@pytest.mark.parametrize(("shortest", "longest"), [(1e-5, 4e-5), (2.9e-6, 5.9e-6)])
def test_named_ends_between_which_there_is_no_wave_are_refused(rng, shortest, longest):
    named = measurement(profile(rng))
    with pytest.raises(ValueError, match=r"scan: its density has [01] values between") as caught:
        analysed_scan(named, shortest, longest)
    assert "--shortest and --longest" in str(caught.value)


@pytest.mark.parametrize("deep", [False, True])
def test_grooves_among_other_roughness_are_a_reservation_if_they_hold_most_of_e_el(rng, deep):
    """Rows that an instrument has shifted by a little are none."""
    grooves = np.repeat(profile(rng, 256)[:, None], 256, axis=1)
    isotropic = waves_up_to(60, rng, (256, 256))
    isotropic *= (0.1 if deep else 1.0) * 1e-8 / isotropic.std()
    surface = measured_surface([measurement(isotropic + grooves)])
    assert surface.scans[0].band.stripes == (0,)
    told = [
        remark for remark in spectrum_remarks(surface) if "waves along x alone" in remark.sentence
    ]
    assert [remark.severity for remark in told] == ["reservation"] * deep
