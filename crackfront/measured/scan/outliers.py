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

_APART = 0.5
"""Distance of a mark from all other heights, in the span of those."""

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
    found, sentences = np.zeros(heights.shape, dtype=bool), []
    for value, places in _marks(heights):
        found |= places
        sentences.append(
            f"{np.count_nonzero(places)} points at {prefixed('m', value)}, far from all others, "
            "are taken for marks of missing data"
        )
    spikes = _spikes(np.ma.array(heights, mask=np.ma.getmaskarray(heights) | found))
    if spikes.any():
        known = np.ma.getdata(heights)[spikes]
        farthest = float(known[np.argmax(np.abs(known - np.median(heights.compressed())))])
        several = len(known) > 1
        sentences.append(
            f"{len(known)} point{'s' * several}, {'the farthest ' * several}at "
            f"{prefixed('m', farthest)}, {'are' if several else 'is'} {_SPIKE:g} times the usual "
            f"step or more from all neighbours, and taken as missing"
        )
    return found | spikes, tuple(sentences)


def _marks(heights: Heights) -> list[tuple[float, PointMask]]:
    """Heights that mark missing data, at either end, and the points that have them."""
    data, known = np.ma.getdata(heights), ~np.ma.getmaskarray(heights)
    found: list[tuple[float, PointMask]] = []
    is_settled = False
    while not is_settled and known.any():
        is_settled = True
        for value in (
            data.min(where=known, initial=np.inf),
            data.max(where=known, initial=-np.inf),
        ):
            places = known & (data == value)
            if np.count_nonzero(places) >= _FEWEST_MARKS and _is_apart(data, known, places, value):
                found.append((float(value), places))
                known = known & ~places
                is_settled = False
    return found


def _is_apart(data: NDArray[Any], known: PointMask, places: PointMask, value: float) -> bool:
    """Whether points of one height lie apart from all others, which are a surface."""
    others = known & ~places
    low, high = data.min(where=others, initial=np.inf), data.max(where=others, initial=-np.inf)
    if not max(low - value, value - high) > _WORTH_A_FIT * (high - low) > 0:
        return False
    # A tilt of the sample is no height of its surface.
    at = [np.nonzero(chosen) for chosen in (others, places)]
    columns = [np.column_stack([np.ones(one[0].size), *one]) for one in at]
    every = max(1, len(columns[0]) // _MOST_SAMPLES)
    plane = np.linalg.lstsq(columns[0][::every], data[others][::every])[0]
    rest, marks = (data[one] - column @ plane for one, column in zip(at, columns, strict=True))
    gap = max(rest.min() - marks.max(), marks.min() - rest.max())
    return bool(gap > _APART * np.ptp(rest) and len(np.unique(data[others])) >= _FEWEST_LEVELS)


def _spikes(heights: Heights) -> PointMask:
    """Points whose height is far from that of every neighbour."""
    data, known = np.ma.getdata(heights), ~np.ma.getmaskarray(heights)
    found = np.zeros(data.shape, dtype=bool)
    steps = np.abs(np.diff(data, axis=0))
    both = known[1:] & known[:-1]
    sample = steps[:: max(1, steps.size // _MOST_SAMPLES)]
    sample = sample[both[:: max(1, steps.size // _MOST_SAMPLES)]]
    usual = _RMS_OF_QUANTILE * float(np.quantile(sample, 0.9)) if sample.size else 0.0
    usual = usual or float(np.min(steps[both & (steps > 0)], initial=np.inf))
    large = (steps > _SPIKE * usual) & both
    if not large.any():
        return found
    near = np.zeros(data.shape, dtype=bool)
    near[1:] |= large
    near[:-1] |= large
    near[1:] &= large | ~both
    near[:-1] &= large | ~both
    places = np.nonzero(near & known)
    if not places[0].size:
        return found
    reach = 1 if data.ndim > 1 else 2
    around = np.pad(np.where(known, data, np.nan), reach, constant_values=np.nan)
    shifts = itertools.product(range(2 * reach + 1), repeat=data.ndim)
    others = np.array(
        [
            around[tuple(at + step for at, step in zip(places, shift, strict=True))]
            for shift in shifts
            if any(step != reach for step in shift)
        ]
    )
    apart = np.abs(others - data[places])
    least = np.min(apart, axis=0, where=np.isfinite(apart), initial=np.inf)
    spread = np.diff(np.nanquantile(others, [0.25, 0.75], axis=0), axis=0)[0]
    found[places] = np.isfinite(least) & (least > np.maximum(_SPIKE * usual, _SHARP * spread))
    return found
