"""Heights of a measured map on a periodic tile of square pixels."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import scipy
from scipy.fft import fftfreq, irfft2, rfft2

from crackfront.core.arrays import Array
from crackfront.measured.scan.reading import Measurement

_SQUARE_TOLERANCE = 1e-6
"""Relative difference of the sides of square pixels."""


def tile_heights(measurement: Measurement) -> tuple[Array, float]:
    """Heights of the tile of a map, and its pixel (Units: m); ValueError if it is a line."""
    if measurement.is_line:
        raise ValueError(
            f"{measurement.path} is a line scan, not a map; use its spectrum, as "
            "crackfront predict --simulate does"
        )
    square = _with_square_pixels(measurement)
    sides, tile = np.array(square.size), square.heights
    if not measurement.periodic:
        # Mirror images on all sides, so that scan and tile have the same centre.
        halves = [(count // 2, count - count // 2) for count in tile.shape]
        sides, tile = 2 * sides, np.pad(tile, halves, "symmetric")
    n_x, n_y = tile.shape
    # The order of operations decides whether waves of exactly the shortest wavelength are inside.
    along = 2 * np.pi * (np.rint(n_x * fftfreq(n_x)) / sides[0])
    across = 2 * np.pi / sides[1] * np.arange(n_y // 2 + 1)
    trusted = np.sqrt(along[:, None] ** 2 + across**2) <= 2 * np.pi / measurement.shortest
    return np.asarray(irfft2(rfft2(tile) * trusted, tile.shape)), float(sides[0] / n_x)


def _with_square_pixels(measurement: Measurement) -> Measurement:
    """The map on square pixels with the smaller of its two pixel sizes."""
    pixel = min(measurement.pixels)
    if max(measurement.pixels) <= pixel * (1 + _SQUARE_TOLERANCE):
        return measurement
    centres = [
        (np.arange(count) + 0.5) * width
        for count, width in zip(measurement.heights.shape, measurement.pixels, strict=True)
    ]
    counts = [math.floor(side / pixel * (1 + _SQUARE_TOLERANCE)) for side in measurement.size]
    square_centres = [(np.arange(count) + 0.5) * pixel for count in counts]
    spline = scipy.interpolate.RectBivariateSpline(*centres, measurement.heights)
    sides = tuple(count * pixel for count in counts)
    return replace(measurement, size=sides, heights=np.asarray(spline(*square_centres)))
