"""A measured map as a surface to press on: mirrored to a periodic tile."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import scipy
from scipy.fft import fftfreq, irfft2, rfft2

from crackfront.core.arrays import Array
from crackfront.core.units import Scales
from crackfront.measured.density.bands import Scan
from crackfront.measured.prediction.conditions import zero_load_radius
from crackfront.measured.prediction.remarks import remark_text
from crackfront.measured.prediction.surface_remarks import scan_remarks
from crackfront.measured.scan.reading import Measurement
from crackfront.surfaces.written_units import prefixed

if TYPE_CHECKING:
    from xarray import DataArray

_EQUAL = 1e-6
"""Relative difference up to which pixels count as square."""


def scan_surface(scan: Scan, sphere: Scales) -> DataArray:
    """The very map as a surface to press on, on a periodic tile with the scan in its middle.

    It is `height(x, y)` in reduced units of the sphere; its attributes say what was done and why.
    The scan is mirrored at its edges, which leaves no steps there, on a tile of twice its sides;
    waves shorter than can be trusted are taken away. The apex of the sphere is the centre of the
    scan. A map with oblong pixels is interpolated by cubic splines on square ones, and one that is
    periodic is a tile as it stands. ValueError if the measurement is a line.
    """
    # A prediction needs the radius below, and no field.
    from crackfront.surfaces.surface_array import surface_array

    measurement = scan.trusted_measurement
    notes = scan_remarks([scan], zero_load_radius(sphere))
    heights, pixel = tile_heights(measurement)
    return surface_array(
        "roughness",
        heights / sphere.vertical,
        pixel / sphere.lateral,
        source=f"{measurement.path}, {measurement.format}, checksum {measurement.checksum}",
        levelling=f"{measurement.levelling} was subtracted: form and tilt are no roughness",
        tile="the scan itself, as its file states that it is periodic"
        if measurement.periodic
        else "the scan mirrored at its edges, with twice its sides",
        waves=f"those shorter than {prefixed('m', measurement.shortest)} were removed, as they "
        "cannot be trusted",
        notes=" ".join(map(remark_text, notes)),
    )


def tile_heights(measurement: Measurement) -> tuple[Array, float]:
    """Heights of the tile of a map, and its pixel (Units: m); ValueError if it is a line."""
    if measurement.is_line:
        raise ValueError(
            f"{measurement.path} is a line scan, which is no field; use its spectrum, as "
            "crackfront predict --simulate does"
        )
    square = _with_square_pixels(measurement)
    sides, tile = np.array(square.size), square.heights
    if not measurement.periodic:
        # Mirror images on all sides: the centre of the scan is that of the tile.
        halves = [(count // 2, count - count // 2) for count in tile.shape]
        sides, tile = 2 * sides, np.pad(tile, halves, "symmetric")
    n_x, n_y = tile.shape
    # In this order of operations, which decides on waves of exactly the shortest wavelength.
    along = 2 * np.pi * (np.rint(n_x * fftfreq(n_x)) / sides[0])
    across = 2 * np.pi / sides[1] * np.arange(n_y // 2 + 1)
    kept = np.sqrt(along[:, None] ** 2 + across**2) <= 2 * np.pi / measurement.shortest
    return np.asarray(irfft2(rfft2(tile) * kept, tile.shape)), float(sides[0] / n_x)


def _with_square_pixels(measurement: Measurement) -> Measurement:
    """The map on square pixels, the finer of the two that it has."""
    pixel = min(measurement.pixels)
    if max(measurement.pixels) <= pixel * (1 + _EQUAL):
        return measurement
    places = [
        (np.arange(count) + 0.5) * width
        for count, width in zip(measurement.heights.shape, measurement.pixels, strict=True)
    ]
    counts = [math.floor(side / pixel * (1 + _EQUAL)) for side in measurement.size]
    wanted = [(np.arange(count) + 0.5) * pixel for count in counts]
    spline = scipy.interpolate.RectBivariateSpline(*places, measurement.heights)
    sides = tuple(count * pixel for count in counts)
    return replace(measurement, size=sides, heights=np.asarray(spline(*wanted)))
