"""Heights that no surface has: what is taken as missing, and which surfaces are left alone."""

import numpy as np
import pytest

from crackfront.measured.density.bands import analysed_scan
from crackfront.measured.prediction.surface_remarks import scan_remarks
from crackfront.measured.scan.outliers import outliers
from tests.measured.made import DETAIL, OVERVIEW, map_heights, read, refusal, write_al3d


def chosen(rng, heights, count):
    """Places of so many points."""
    return np.unravel_index(rng.choice(heights.size, count, replace=False), heights.shape)


@pytest.mark.parametrize(("value", "tilt"), [(-9999e-9, 0.0), (32767e-9, 5e-6), (0.0, 5e-6)])
def test_marks_for_missing_data_are_taken_as_missing_and_said(tmp_path, rng, heights, value, tilt):
    surface = heights + (5e-6 if value == 0 else 0) + tilt * np.linspace(0, 1, 128)[:, None]
    marked = surface.copy()
    marked[chosen(rng, heights, 20)] = value
    measurement = read(write_al3d(tmp_path / "marked.al3d", marked))
    whole = read(write_al3d(tmp_path / "whole.al3d", surface))
    assert measurement.missing == pytest.approx(20 / heights.size)
    assert np.std(measurement.heights - whole.heights) < 0.01 * np.std(whole.heights)
    [remark] = [
        item
        for item in scan_remarks([analysed_scan(measurement)])
        if item.severity == "reservation"
    ]
    assert "20 points at " in remark.sentence


def test_a_hole_of_marks_and_marks_at_both_ends_are_found(heights):
    marked = heights + 4e-5 * np.linspace(0, 1, 128)[:, None]
    marked[20:30, 40:60] = -9999e-9
    places, [sentence] = outliers(np.ma.array(marked))
    assert np.count_nonzero(places) == 200
    assert sentence.startswith("200 points at -10 um, far from all others")
    heights[3, ::20], heights[::20, 9] = 1e-3, -1e-3
    assert len(outliers(np.ma.array(heights))[1]) == 2


def test_too_many_marks_are_refused_by_their_number_and_value(tmp_path, rng, heights):
    heights[chosen(rng, heights, heights.size // 5)] = -9999e-9
    message = refusal(write_al3d(tmp_path / "marked.al3d", heights))
    assert "20% of the points are missing (3276 points at -10 um, far from all" in message


def test_spikes_beyond_what_neighbours_allow_are_taken_as_missing(rng, heights):
    places = chosen(rng, heights, 12)
    heights[places] += rng.choice([-1, 1], 12) * rng.uniform(2e-6, 5e-6, 12)
    mask, [sentence] = outliers(np.ma.array(heights))
    assert set(zip(*np.nonzero(mask), strict=True)) == set(zip(*places, strict=True))
    assert sentence.startswith("12 points, the farthest at ")


def test_marks_and_spikes_of_a_line_are_found(rng):
    line = np.cumsum(1e-8 * rng.standard_normal(1000))
    line[::97] = -9999e-9
    line[[50, 98, 193]] += 3e-6  # two of them beside a mark
    mask, sentences = outliers(np.ma.array(line))
    assert np.count_nonzero(mask) == 14
    assert len(sentences) == 2


x, y = np.indices((128, 128))


def pits(rng, heights):
    """Deep pits, two pixels wide."""
    for a, b in rng.uniform(0, 128, (40, 2)):
        heights = heights - 2e-6 * np.exp(-((x - a) ** 2 + (y - b) ** 2) / 3)
    return heights


def particles(rng, heights):
    """Particles of two by two pixels on a flat surface."""
    heights = 0.01 * heights
    for a, b in rng.integers(2, 125, (30, 2)):
        heights[a : a + 2, b : b + 2] += 5e-7
    return heights


@pytest.mark.parametrize(
    "surface",
    [
        lambda rng, heights: heights,
        pits,
        lambda rng, heights: np.maximum(pits(rng, heights), -1e-6),
        particles,
        lambda rng, heights: np.clip(heights, -2 * heights.std(), 1.5 * heights.std()),
        lambda rng, heights: np.round(heights, 8),
        lambda rng, heights: np.round(heights, 7),
        lambda rng, heights: heights - 3e-6 * ((x // 16 + y // 16) % 2),
        lambda rng, heights: 0.01 * heights + 5e-7 * (x > 64),
        lambda rng, heights: 0.01 * heights - 5e-7 * (x % 16 == 0),
        lambda rng, heights: 0.01 * heights - 5e-7 * ((x + y) % 17 == 0),
        lambda rng, heights: 1e-8 * np.exp(2 * heights / heights.std()),
        lambda rng, heights: 1e-8 * rng.standard_normal(heights.shape) + 1e-5 * x,
        lambda rng, heights: 1e-8 * rng.laplace(size=heights.shape),
        lambda rng, heights: 1.0 * (rng.uniform(size=heights.shape) < 0.3),
    ],
)
def test_pits_plateaus_steps_and_saturated_heights_are_a_surface(rng, surface):
    mask, sentences = outliers(np.ma.array(surface(rng, map_heights(rng))))
    assert not mask.any()
    assert not sentences


@pytest.mark.parametrize("path", [DETAIL, OVERVIEW])
def test_the_scans_that_are_shipped_have_no_outliers(path):
    assert not read(path).outliers
