"""Spectral densities of measurements, held against spectra and other implementations."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import get_window

from crackfront.core.synthesis import gaussian_field
from crackfront.measured.density.densities import cosine_window, periodogram
from crackfront.measured.scan.library import surface_library
from studies.paper.si_6 import profile_periodogram
from tests.measured.made import SIDE, SPECTRUM, map_heights, periodic_measurement


@pytest.mark.parametrize("name", ["hann", "blackman"])
def test_windows_are_those_of_scipy_to_the_bit(name):
    for count in (8, 9, 144, 1000):
        assert np.array_equal(cosine_window(name, count), get_window(name, count))


def test_our_density_of_profiles_is_the_librarys(rng):
    heights = gaussian_field(SPECTRUM, 128, SIDE, rng)
    library = surface_library().Topography(heights, (SIDE, SIDE), periodic=True)
    _, density = library.power_spectrum_from_profile(resampling_method=None, reliable=False)
    ours = profile_periodogram(heights, SIDE / 128)
    assert ours == pytest.approx(density[1:], rel=1e-9, abs=1e-9 * ours.max())


@pytest.mark.parametrize("is_line", [False, True])
def test_densities_scatter_about_the_spectrum_as_their_modes_say(rng, is_line):
    levels = []
    for _ in range(40):
        heights = map_heights(rng)
        measurement = replace(
            periodic_measurement(heights, shortest=0.625e-6), periodic=False, longest=10e-6
        )
        if is_line:
            line = replace(measurement, heights=heights[:, 0], size=(SIDE,))
            density = periodogram(line).density().within(0.625e-6, 10e-6)
            expected = SPECTRUM.profile_density(density.wavevector)
        else:
            density = periodogram(measurement).density().within(0.625e-6, 10e-6)
            expected = SPECTRUM.density(density.wavevector)
        # The level of the whole density, relative to that of the spectrum.
        level = np.average(density.value / expected, weights=density.modes) - 1
        levels.append(level * np.sqrt(np.sum(density.modes)))
    assert abs(np.mean(levels)) < 0.6
    assert 0.6 < np.std(levels) < 1.4
