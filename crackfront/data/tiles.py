"""Labelled values on a uniform grid, as plain arrays."""

from __future__ import annotations

import numpy as np
import xarray as xr

from crackfront.core.arrays import Array
from crackfront.data.bounds import ADHESION, NUMBER, refuse_outside

TOLERANCE = 1e-6
"""Largest deviation from equal spacing, relative to it."""


def tile_samples(values: xr.DataArray) -> tuple[Array, float]:
    """Values of a tile, first axis x, and their spacing.

    Parameters
    ----------
    values : xarray.DataArray
        Values of the dimensions x and y, in any order, with their coordinates.

    Raises
    ------
    ValueError
        If a coordinate is missing or not uniform, or the two spacings differ.
    """
    pixels = [_spacing(values, name) for name in ("x", "y")]
    if abs(pixels[1] / pixels[0] - 1) > TOLERANCE:
        raise ValueError(
            f"the spacing is {pixels[0]:.6g} in x and {pixels[1]:.6g} in y; they must be equal"
        )
    return np.ascontiguousarray(values.transpose("x", "y"), dtype=float), pixels[0]


def _spacing(values: xr.DataArray, name: str) -> float:
    """Uniform spacing of a coordinate."""
    if name not in values.coords or values.sizes[name] < 2:
        raise ValueError(
            f"{values.name} has {values.sizes[name]} point(s) along {name} and "
            f"{'a' if name in values.coords else 'no'} coordinate {name}; give 2 or more with "
            "their positions"
        )
    # Places of 1e308 are infinitely far from each other.
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(np.asarray(values[name], dtype=float))
        mean = float(np.mean(steps))
    if not (0 < mean < np.inf and np.max(np.abs(steps - mean)) <= TOLERANCE * mean):
        raise ValueError(
            f"{name} advances by {np.min(steps):.6g} to {np.max(steps):.6g}; it must "
            "increase in equal steps"
        )
    refuse_outside(f"spacing of {name}", mean, NUMBER)
    return mean


def refuse_extreme(name: str, values: Array, unit: float = 1.0) -> None:
    """Raise if a value is finite, but so large that no surface has it; NaN is left to others."""
    beyond = (values < ADHESION.least * unit) | (values > ADHESION.most * unit)
    beyond &= np.isfinite(values)
    if np.any(beyond):
        place = tuple(map(int, np.unravel_index(np.argmax(beyond), beyond.shape)))
        bounds = f"{ADHESION.least:g} and {ADHESION.most:g}"
        raise ValueError(
            f"{name} is {float(values[place]) / unit:g} at index {', '.join(map(str, place))} "
            f"({np.count_nonzero(beyond)} such values); it must lie between {bounds}"
        )
