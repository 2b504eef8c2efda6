"""Densities of scans with missing points, held against those of the whole scans."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.density.densities import periodogram, unevenness, weight_of_gaps
from crackfront.measured.density.gaps import restored_periodogram, surrogate_pairs
from crackfront.measured.prediction.surface_remarks import scan_remarks
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.draws import RESTORATION_ERROR
from crackfront.measured.spectrum.joining import joint_spectrum
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


KINDS = (middle, corner, band, rows, points, patches)


def whole_map(rng):
    """A map that is cut from a larger surface, as a measurement without gaps."""
    heights = gaussian_field(SPECTRUM, 2 * N_POINT, 2 * SIDE, rng)[:N_POINT, :N_POINT]
    given = periodic_measurement(heights, SIDE, 4 * SIDE / N_POINT)
    return replace(given, periodic=False, longest=SIDE / 2)


def read_map(folder, heights, gaps):
    """The measurement that is read from a file of a map with missing points."""
    holed = np.where(gaps, np.nan, heights)
    return read_measurements([write_al3d(folder / "holes.al3d", holed, SIDE)])[0]


def energy(waves, given):
    """What e_el is proportional to, over the wavelengths that may be trusted."""
    density = waves.density().within(given.shortest, given.longest)
    return float(np.sum(density.value * density.wavevector**3))


@pytest.mark.parametrize("gaps_of", KINDS)
def test_the_density_of_a_map_with_gaps_is_that_of_the_whole_map(gaps_of, rng, tmp_path):
    given_back, filled = [], []
    for _ in range(4):
        whole, gaps = whole_map(rng), gaps_of(rng)
        known = energy(periodogram(whole), whole)
        found = read_map(tmp_path, whole.heights, gaps)
        np.testing.assert_array_equal(found.gaps, gaps)
        filled.append(np.log(energy(periodogram(found), whole) / known))
        restored = restored_periodogram(found, surrogate_pairs(found))
        given_back.append(np.log(energy(restored, whole) / known))
    error = np.std(given_back, ddof=1) / np.sqrt(len(given_back))
    # By as much as intervals allow for.
    allowed = RESTORATION_ERROR * weight_of_gaps(found)
    assert abs(np.mean(given_back)) < allowed + 4 * error
    if gaps_of is not corner:  # Where the window has no weight nothing is lost.
        assert abs(np.mean(given_back)) < 0.5 * abs(np.mean(filled))


def test_a_line_with_gaps_has_the_density_of_the_whole_line(rng):
    apart = []
    for _ in range(8):
        heights = whole_map(rng).heights[:, 0]
        whole = replace(whole_map(rng), heights=heights, size=(SIDE,))
        gaps = np.zeros(N_POINT, bool)
        gaps[44:52] = True
        line = np.interp(np.arange(N_POINT), np.flatnonzero(~gaps), heights[~gaps])
        found = replace(whole, heights=line, gaps=gaps)
        pairs = surrogate_pairs(found)
        restored = restored_periodogram(found, pairs)
        dependence = periodogram(found).dependence * (1 + 1 / len(pairs))
        assert restored.dependence == pytest.approx(dependence)
        apart.append(
            [np.log(energy(one, whole)) for one in (restored, periodogram(found))]
            - np.log(energy(periodogram(whole), whole))
        )
    given_back, filled = np.mean(apart, axis=0)
    error = np.std(apart, axis=0, ddof=1)[0] / np.sqrt(len(apart))
    assert abs(given_back) < 4 * error
    assert filled < given_back


def test_a_hole_in_the_middle_keeps_the_truth_in_the_interval(rng, tmp_path):
    whole = whole_map(rng)
    found = analysed_scan(read_map(tmp_path, whole.heights, middle(rng)))
    hidden, known = (
        joint_spectrum([one], numbers=(1,)).draws.mean_square(0.5)
        for one in (found, analysed_scan(whole))
    )
    assert hidden.low < SPECTRUM.mean_square(0.5) < hidden.high
    assert hidden.low < known.value < hidden.high
    [sentence] = [one.sentence for one in scan_remarks([found])]
    assert "8.51% of the points were missing" in sentence
    assert f"{found.missing_weight:.1%} by the weight of the window" in sentence


def test_gaps_are_weighed_by_the_window(rng):
    whole = whole_map(rng)
    weights = {one: weight_of_gaps(replace(whole, gaps=one(rng))) for one in KINDS}
    assert weight_of_gaps(whole) == 0
    assert weights[corner] < 0.02 < 0.4 < weights[middle]
    half = np.zeros((N_POINT, N_POINT), bool)
    half[1:48] = half[49:] = True  # All but the two rows about which the window is even.
    assert weight_of_gaps(replace(whole, gaps=half)) < 1
    assert weight_of_gaps(replace(whole, gaps=np.ones_like(half))) == pytest.approx(1)
    # Of a periodic map, which needs no window, all points weigh the same.
    assert weight_of_gaps(replace(whole, gaps=middle(rng), periodic=True)) == pytest.approx(
        np.mean(middle(rng))
    )


def test_a_hole_makes_no_surface_uneven(rng, tmp_path):
    added = []
    for _ in range(6):
        whole = whole_map(rng)
        holed = read_map(tmp_path, whole.heights, middle(rng))
        added.append(unevenness(holed) - unevenness(whole))
    assert np.mean(added) < 0.05


def test_a_scan_without_gaps_needs_no_surrogates(rng):
    whole = whole_map(rng)
    assert surrogate_pairs(whole) == ()
    np.testing.assert_array_equal(restored_periodogram(whole, ()).power, periodogram(whole).power)
