"""Heights that no surface has: marks for missing data, and spikes against all neighbours."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.measured.scan.levelling import PointMask
from crackfront.surfaces.written_units import prefixed

Heights = np.ma.MaskedArray[Any, Any]

_FEWEST_MARKS = 2
"""Points of exactly one height that are marks; a single one may be a spike."""

_GAP = 0.5
"""Distance of a mark from the heights of the surface, over their span."""

_WORTH_A_FIT = 0.02
"""The same before a tilt is subtracted; below it no tilt is fitted and nothing is a mark."""

_FEWEST_LEVELS = 50
"""Distinct heights of a surface that was measured; patterns and steps that were made have fewer."""

_SPIKE = 30.0
"""Height of a spike over the nearest neighbour in height, in rms differences of neighbours."""

_SHARP = 4.0
"""The same over the interquartile range of the neighbours, which is large at a resolved peak."""

_RMS_OF_QUANTILE = 1.0 / 1.645
"""Standard deviation of a normal distribution over the 90% quantile of its modulus."""

_MOST_SAMPLES = 100_000
"""Differences that the rms difference of neighbours is found from."""


def outliers(heights: Heights) -> tuple[PointMask, tuple[str, ...]]:
    """Points that are marks or spikes, and a sentence on each kind (Units: m)."""
    is_outlier, sentences = np.zeros(heights.shape, dtype=bool), []
    for value, places in _marks(heights):
        is_outlier |= places
        sentences.append(
            f"{np.count_nonzero(places)} points at {prefixed('m', value)}, far from all others, "
            "are taken for marks of missing data"
        )
    spikes = _spikes(np.ma.array(heights, mask=np.ma.getmaskarray(heights) | is_outlier))
    if spikes.any():
        spike_heights = np.ma.getdata(heights)[spikes]
        farthest = float(
            spike_heights[np.argmax(np.abs(spike_heights - np.median(heights.compressed())))]
        )
        several = len(spike_heights) > 1
        sentences.append(
            f"{len(spike_heights)} point{'s' * several}, {'the farthest ' * several}at "
            f"{prefixed('m', farthest)}, {'are' if several else 'is'} {_SPIKE:g} times the usual "
            f"step or more from all neighbours, and taken as missing"
        )
    return is_outlier | spikes, tuple(sentences)


def _marks(heights: Heights) -> list[tuple[float, PointMask]]:
    """Heights that mark missing data, at either end, and the points that have them."""
    data, is_present = np.ma.getdata(heights), ~np.ma.getmaskarray(heights)
    marks: list[tuple[float, PointMask]] = []
    is_settled = False
    while not is_settled and is_present.any():
        is_settled = True
        for value in (
            data.min(where=is_present, initial=np.inf),
            data.max(where=is_present, initial=-np.inf),
        ):
            places = is_present & (data == value)
            if np.count_nonzero(places) >= _FEWEST_MARKS and _is_mark(
                data, is_present, places, value
            ):
                marks.append((float(value), places))
                is_present = is_present & ~places
                is_settled = False
    return marks


def _is_mark(data: NDArray[Any], is_present: PointMask, places: PointMask, value: float) -> bool:
    """Whether the points of one height lie far from all others, which are a surface."""
    is_rest = is_present & ~places
    low, high = data.min(where=is_rest, initial=np.inf), data.max(where=is_rest, initial=-np.inf)
    if not max(low - value, value - high) > _WORTH_A_FIT * (high - low) > 0:
        return False
    # A tilt of the sample is not roughness.
    pixels_of_rest = _with_ones(np.nonzero(is_rest))
    stride = max(1, len(pixels_of_rest) // _MOST_SAMPLES)
    plane = np.linalg.lstsq(pixels_of_rest[::stride], data[is_rest][::stride])[0]
    rest = data[is_rest] - pixels_of_rest @ plane
    marks = data[places] - _with_ones(np.nonzero(places)) @ plane
    gap = max(rest.min() - marks.max(), marks.min() - rest.max())
    return bool(gap > _GAP * np.ptp(rest) and len(np.unique(data[is_rest])) >= _FEWEST_LEVELS)


def _with_ones(indices: tuple[NDArray[np.int64], ...]) -> NDArray[Any]:
    """Columns of a plane: ones, and the indices of pixels in each direction."""
    return np.column_stack([np.ones(indices[0].size), *indices])


def _spikes(heights: Heights) -> PointMask:
    """Points whose height is far from the heights of all neighbours."""
    data, is_present = np.ma.getdata(heights), ~np.ma.getmaskarray(heights)
    is_spike = np.zeros(data.shape, dtype=bool)
    steps = np.abs(np.diff(data, axis=0))
    is_pair = is_present[1:] & is_present[:-1]
    usual = _usual_step(steps, is_pair)
    large = (steps > _SPIKE * usual) & is_pair
    if not large.any():
        return is_spike
    # Candidates have a large step, and no small one, to a neighbour along the first axis.
    candidate = np.zeros(data.shape, dtype=bool)
    candidate[1:] |= large
    candidate[:-1] |= large
    candidate[1:] &= large | ~is_pair
    candidate[:-1] &= large | ~is_pair
    places = np.nonzero(candidate & is_present)
    if not places[0].size:
        return is_spike
    neighbours = _neighbours(np.where(is_present, data, np.nan), places)
    distances = np.abs(neighbours - data[places])
    least = np.min(distances, axis=0, where=np.isfinite(distances), initial=np.inf)
    spread = np.diff(np.nanquantile(neighbours, [0.25, 0.75], axis=0), axis=0)[0]
    is_spike[places] = np.isfinite(least) & (least > np.maximum(_SPIKE * usual, _SHARP * spread))
    return is_spike


def _usual_step(steps: NDArray[Any], is_pair: PointMask) -> float:
    """Rms difference of neighbours that are both present, or the least if most are equal."""
    stride = max(1, steps.size // _MOST_SAMPLES)
    sample = steps[::stride][is_pair[::stride]]
    usual = _RMS_OF_QUANTILE * float(np.quantile(sample, 0.9)) if sample.size else 0.0
    return usual or float(np.min(steps[is_pair & (steps > 0)], initial=np.inf))


def _neighbours(data: NDArray[Any], places: tuple[NDArray[np.int64], ...]) -> NDArray[Any]:
    """Heights around some points, NaN outside, (n_neighbour, n): 8 on a map, 4 on a line."""
    reach = 1 if data.ndim > 1 else 2
    around = np.pad(data, reach, constant_values=np.nan)
    shifts = itertools.product(range(2 * reach + 1), repeat=data.ndim)
    return np.array(
        [
            around[tuple(index + step for index, step in zip(places, shift, strict=True))]
            for shift in shifts
            if any(step != reach for step in shift)
        ]
    )
