"""The mark that the tip of an instrument leaves: peaks that are rounder than valleys.

A tip touches a surface where it is highest below it, so that what it records is nowhere more curved
downwards than the tip itself, and has sharp valleys where it changes from one peak to the next. Its
density falls as that of another surface does: it is the curvatures that tell.
"""

from __future__ import annotations

import math

import numpy as np

from crackfront.topography.levelling import Array
from crackfront.topography.reading import Measurement

_TAIL = 0.01
"""Part of the curvatures in either of the tails that are compared."""

_ASYMMETRY, _SYMMETRY = 0.1, 0.05
"""Asymmetry of curvatures by which a tip is seen, and that which ends its mark."""

_ERROR, _SIGMA = 1.7, 5.0
"""Standard error of an asymmetry times the root of its number, and how many of it are a mark."""

_SHARE = 8
"""Lags in a side of the scan."""

_WAVE = 3.0
"""Wave of which a tip takes a fifth away, in lags at which its mark ends: tips of radii over two
decades take 8% to 33% of it from surfaces with Hurst exponents from 0.4 to 1."""

_MOST = 200_000
"""Curvatures of a lag that are enough."""


def tip_wavelength(measurement: Measurement) -> float:
    """Wavelength below which a tip takes more than a fifth of the density away; 0 if none is seen.

    (Units: m)
    """
    axes = range(measurement.heights.ndim)
    return max(
        _marked(np.moveaxis(measurement.heights, axis, 0)) * pixel
        for axis, pixel in zip(axes, measurement.pixels, strict=True)
    )


def _marked(heights: Array) -> float:
    """Wavelength of :func:`tip_wavelength` along the first axis, in points."""
    lags = np.unique(np.geomspace(1, max(len(heights) // _SHARE, 1), 12).astype(int))
    thinned = heights[..., :: max(1, heights.size // _MOST)] if heights.ndim > 1 else heights
    found = np.array([_asymmetry(thinned, int(lag)) for lag in lags])
    least = max(_ASYMMETRY, _SIGMA * _ERROR / math.sqrt(thinned.size))
    strongest = int(np.argmax(found))
    ended = np.flatnonzero(found[strongest:] <= _SYMMETRY)
    if found[strongest] < least or not ended.size:
        return 0.0
    end = strongest + int(ended[0])
    part = (found[end - 1] - _SYMMETRY) / (found[end - 1] - found[end])
    return _WAVE * float(lags[end - 1] * (lags[end] / lags[end - 1]) ** part)


def _asymmetry(heights: Array, lag: int) -> float:
    """How much further curvatures reach upwards than downwards, relative to how far they do."""
    curvatures = heights[2 * lag :] - 2 * heights[lag:-lag] + heights[: -2 * lag]
    low, middle, high = np.quantile(curvatures, (_TAIL, 0.5, 1 - _TAIL))
    return float((low + high - 2 * middle) / max(high - low, 1e-300))
