"""Densities of scans with missing points, held against those of the whole scans."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.measured.density.densities import gap_weight, periodogram
from crackfront.measured.density.gaps import restored_periodogram, surrogate_pairs
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.draws import RESTORATION_ERROR
from tests.commands import slow
from tests.measured.made import periodic_measurement, write_al3d

N_POINT, SIDE = 96, 9.6e-6
SPECTRUM = SelfAffineSpectrum(0.2e-6, SIDE / 8, 0.8, 1e-28)


def middle(rng):
    gaps = np.zeros((N_POINT, N_POINT), bool)
    gaps[34:62, 34:62] = True
    return gaps


def corner(rng):
    return np.roll(middle(rng), (-34, -34), (0, 1))


def band(rng):
    gaps = np.zeros((N_POINT, N_POINT), bool)
    gaps[:, 46:50] = True
    return gaps


def rows(rng):
    gaps = np.zeros((N_POINT, N_POINT), bool)
    gaps[:, rng.permutation(N_POINT)[:9]] = True
    return gaps


def points(rng):
    return rng.uniform(size=(N_POINT, N_POINT)) < 0.08


def patches(rng):
    gaps = np.zeros((N_POINT, N_POINT), bool)
    for x, y in rng.integers(0, N_POINT - 8, (12, 2)):
        gaps[x : x + 8, y : y + 8] = True
    return gaps


def whole_map(rng):
    """A map that is cut from a larger surface, as a measurement without gaps."""
    heights = gaussian_field(SPECTRUM, 2 * N_POINT, 2 * SIDE, rng)[:N_POINT, :N_POINT]
    measurement = periodic_measurement(heights, SIDE, 4 * SIDE / N_POINT)
    return replace(measurement, periodic=False, longest=SIDE / 2)


def read_map(folder, heights, gaps):
    """The measurement that is read from a file of a map with missing points."""
    holed = np.where(gaps, np.nan, heights)
    return read_measurements([write_al3d(folder / "holes.al3d", holed, SIDE)])[0]


def energy(waves, measurement):
    """What e_el is proportional to, over the wavelengths that may be trusted."""
    density = waves.density().within(measurement.shortest, measurement.longest)
    return float(np.sum(density.value * density.wavevector**3))


@pytest.mark.parametrize("gaps_of", [middle, corner, rows, *map(slow, (band, points, patches))])
def test_the_density_of_a_map_with_gaps_is_that_of_the_whole_map(gaps_of, rng, tmp_path):
    given_back, filled = [], []
    for _ in range(4):
        whole, gaps = whole_map(rng), gaps_of(rng)
        expected = energy(periodogram(whole), whole)
        measurement = read_map(tmp_path, whole.heights, gaps)
        np.testing.assert_array_equal(measurement.gaps, gaps)
        filled.append(np.log(energy(periodogram(measurement), whole) / expected))
        restored = restored_periodogram(measurement, surrogate_pairs(measurement))
        given_back.append(np.log(energy(restored, whole) / expected))
    error = np.std(given_back, ddof=1) / np.sqrt(len(given_back))
    # By as much as intervals allow for.
    allowed = RESTORATION_ERROR * gap_weight(measurement)
    assert abs(np.mean(given_back)) < allowed + 4 * error
    if gaps_of is not corner:  # Where the window has no weight nothing is lost.
        assert abs(np.mean(given_back)) < 0.5 * abs(np.mean(filled))


def test_a_line_with_gaps_has_the_density_of_the_whole_line(rng):
    deviations = []
    for _ in range(8):
        heights = whole_map(rng).heights[:, 0]
        whole = replace(whole_map(rng), heights=heights, size=(SIDE,))
        gaps = np.zeros(N_POINT, bool)
        gaps[44:52] = True
        line = np.interp(np.arange(N_POINT), np.flatnonzero(~gaps), heights[~gaps])
        with_gaps = replace(whole, heights=line, gaps=gaps)
        pairs = surrogate_pairs(with_gaps)
        restored = restored_periodogram(with_gaps, pairs)
        dependence = periodogram(with_gaps).dependence * (1 + 1 / len(pairs))
        assert restored.dependence == pytest.approx(dependence)
        deviations.append(
            [np.log(energy(density, whole)) for density in (restored, periodogram(with_gaps))]
            - np.log(energy(periodogram(whole), whole))
        )
    given_back, filled = np.mean(deviations, axis=0)
    error = np.std(deviations, axis=0, ddof=1)[0] / np.sqrt(len(deviations))
    assert abs(given_back) < 4 * error
    assert filled < given_back
