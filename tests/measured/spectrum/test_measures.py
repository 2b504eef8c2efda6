"""What a surface is: spectrum and rms measures of one scan or several."""

import numpy as np
import pytest

from crackfront.core.adhesion import half_derivative_mean_square
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.options import ReadingOptions
from crackfront.measured.prediction.surface_remarks import spectrum_remarks
from crackfront.measured.scan.library import surface_library
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.joining import joint_spectrum
from crackfront.measured.spectrum.measured_surface import measured_surface
from tests.measured.made import (
    SIDE,
    SPECTRUM,
    map_heights,
    measured_mean_square,
    periodic_measurement,
    write_al3d,
    write_line,
)

# A batch says what a surface is; how many there should be, test_draws.py asks.
pytestmark = pytest.mark.usefixtures("few_draws")


def half(surface):
    """Mean square half-derivative of a surface's spectrum, with its standard error."""
    return surface.half_derivative


def test_the_spectrum_of_the_shipped_scans_is_that_of_nanodiamond(surface):
    fit, truth = surface.joint.fit, SelfAffineSpectrum(0.1e-6, 2.1e-6, 1.0, 8.4e-27)
    for estimate, value in ((fit.roll_off, 2.1e-6), (fit.hurst, 1.0), (fit.plateau, 8.4e-27)):
        assert 0.99 * estimate.low < value < 1.01 * estimate.high
    assert fit.has_roll_off
    assert 0.2 < fit.misfit < 1.5
    estimate = half(surface)
    assert estimate.value == pytest.approx(truth.mean_square(0.5), rel=0.1)
    assert estimate.low < truth.mean_square(0.5) < estimate.high < 1.5 * estimate.low
    assert surface.joint.shares.measured > 0.9


def test_the_measures_of_a_periodic_map_are_ours_and_the_librarys(rng):
    heights = gaussian_field(SPECTRUM, 128, SIDE, rng)
    measurement = periodic_measurement(heights)
    pixel = SIDE / 128
    library = surface_library().Topography(heights, measurement.size, periodic=True)
    mean_squares = [
        measured_mean_square(analysed_scan(measurement), order) for order in (0.0, 0.5, 1.0)
    ]
    assert mean_squares[0] == pytest.approx(np.mean(heights**2), rel=1e-9)
    assert mean_squares[0] == pytest.approx(library.moment_power_spectrum(order=0), rel=1e-9)
    assert mean_squares[1] == pytest.approx(half_derivative_mean_square(heights, pixel), rel=1e-9)
    assert mean_squares[1] == pytest.approx(library.variance_half_derivative(), rel=1e-9)
    slopes = library.moment_power_spectrum(order=2)
    assert mean_squares[2] == pytest.approx(slopes, rel=1e-9)


def test_a_second_measurement_widens_the_wavelengths(rng, tmp_path, scan):
    fine = SelfAffineSpectrum(0.08e-6, 3e-6, 0.8, 1e-26)
    heights = map_heights(rng, spectrum=fine, side=5e-6)
    detail = write_al3d(tmp_path / "detail.al3d", heights, 5e-6)
    scans = [analysed_scan(measurement) for measurement in read_measurements([scan, detail])]
    alone, joined = joint_spectrum(scans[:1]), joint_spectrum(scans)
    assert joined.shortest == pytest.approx(4 * 5e-6 / 128, rel=0.1)
    assert joined.longest == pytest.approx(alone.longest) == pytest.approx(10e-6, rel=0.15)
    assert joined.fit.hurst.low < 0.8 < joined.fit.hurst.high
    widths = [estimate.high - estimate.low for estimate in (joined.fit.hurst, alone.fit.hurst)]
    assert widths[0] < widths[1]
    assert not any(joined.density.disagrees(index) for index in range(2))


def test_the_surface_does_not_depend_on_a_tilt_or_a_curvature(tmp_path, heights, scan):
    x = np.linspace(0, 1, len(heights))[:, None]
    bent = heights + 1e-5 * x + 3e-5 * x**2 - 2e-5 * x.T**2
    bent_path = write_al3d(tmp_path / "bent.al3d", bent)
    straight, bent_energy = (
        measured_surface(read_measurements([path])) for path in (scan, bent_path)
    )
    assert half(bent_energy).value == pytest.approx(half(straight).value, rel=1e-4)
    [raw] = read_measurements([bent_path], ReadingOptions(detrend="center"))
    assert np.ptp(raw.heights) > 10 * np.ptp(straight.scans[0].measurement.heights)


def test_line_scans_stand_for_an_isotropic_surface(rng, tmp_path):
    truth = SPECTRUM.mean_square(0.5)
    heights = 1e6 * map_heights(rng)
    paths = [
        write_line(tmp_path / f"{number}.xyz", heights[:, 25 * number], 20 / 128)
        for number in range(5)
    ]
    surface = measured_surface(read_measurements(paths, ReadingOptions(unit="um")))
    assert all(scan.density.is_profile for scan in surface.scans)
    assert all(scan.measurement.is_line for scan in surface.scans)
    mean_square = half(surface)
    assert 0.95 * mean_square.low < truth < mean_square.high < 4 * mean_square.low


@pytest.mark.parametrize("angle", [30, -60])
def test_anisotropy_is_seen_in_any_direction(rng, tmp_path, angle):
    """A surface that hardly changes across a direction."""
    wave_x, wave_y = np.ix_(np.fft.fftfreq(128), np.fft.fftfreq(128))
    along = np.cos(np.radians(angle)) * wave_x + np.sin(np.radians(angle)) * wave_y
    across = -np.sin(np.radians(angle)) * wave_x + np.cos(np.radians(angle)) * wave_y
    size = np.hypot(along, across)
    filtered = np.exp(-((30 * across) ** 2)) / (0.02 + size) * (size < 0.2)
    heights = np.fft.ifft2(filtered * np.fft.fft2(rng.standard_normal((128, 128)))).real
    path = write_al3d(tmp_path / "grooves.al3d", 1e-8 * heights / heights.std())
    surface = measured_surface(read_measurements([path]))
    ratio, ratio_seen = surface.scans[0].band.anisotropy
    assert ratio > 2
    assert ratio_seen == pytest.approx(angle, abs=5)
    [told] = [
        wave_x.sentence for wave_x in spectrum_remarks(surface) if "isotropic" in wave_x.sentence
    ]
    assert "degrees from x is" in told
