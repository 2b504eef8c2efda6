"""Surfaces as labelled arrays: made from values, read from files, and the spacing of their grid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array
from crackfront.core.bounds import NUMBER, check_within
from crackfront.core.variables import LATERAL, Variable
from crackfront.core.words import counted
from crackfront.simulate.labels import label, labelled
from crackfront.simulate.storage import UnreadableFileError, read_dataset
from crackfront.surfaces.labelled import SURFACES

_AXES = tuple(
    Variable(name, (name,), LATERAL, f"{name}, the apex of the sphere at 0") for name in "xy"
)
"""Coordinates of a surface."""

UNEQUAL = 1e-6
"""Relative difference of two lengths of a grid beyond which they are not equal."""

_REAL = "fiu"
"""Kinds of types of numpy that are real numbers."""

_COPIES = 6
"""Memory of a surface in use over its values: as numbers of double precision, as splines."""


def surface_array(
    kind: FieldKind, values: Array, pixel: float, **attributes: str | float | Array
) -> xr.DataArray:
    """Surface of a periodic tile, the apex of the sphere at its centre.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        Whether the values are heights or works of adhesion.
    values : (n_x, n_y) array
        Heights (Units: reduced vertical length) or works of adhesion (Units: w_int).
    pixel : float
        Spacing of the grid. (Units: reduced lateral length)
    **attributes
        What else the array says about itself.

    Returns
    -------
    xarray.DataArray
        `height(x, y)` or `work_of_adhesion(x, y)`.
    """
    item = SURFACES[kind]
    axes = {
        axis.name: labelled(axis, pixel * (np.arange(count) - count / 2))
        for axis, count in zip(_AXES, values.shape, strict=True)
    }
    return xr.DataArray(values, axes, item.dims, name=item.name, attrs=label(item) | attributes)


def surface_kind(surface: xr.DataArray) -> FieldKind:
    """Kind of the values of a surface, by its name.

    ValueError if no surface has that name.
    """
    kinds = {item.name: kind for kind, item in SURFACES.items()}
    if surface.name not in kinds:
        raise ValueError(
            f"the surface is named {surface.name!r}; say what its values are by the name "
            f"{' or '.join(kinds)}, as in surface.rename('height')"
        )
    return kinds[str(surface.name)]


def read_field(path: Path) -> xr.DataArray:
    """Surface in a netCDF file, `height(x, y)` or `work_of_adhesion(x, y)`.

    ValueError if the file is missing or truncated, or does not have exactly one surface, of real
    numbers.
    """
    dataset = read_dataset(path, copies=_COPIES)
    names = [item.name for item in SURFACES.values() if item.name in dataset]
    if not names:
        raise UnreadableFileError(
            f"{path} lacks a surface (it has: {', '.join(map(str, dataset.data_vars))}); name its "
            f"variable {' or '.join(item.name for item in SURFACES.values())}"
        )
    if len(names) > 1:
        raise ValueError(f"{path} has both {' and '.join(names)}; keep one in the file")
    surface = dataset[names[0]]
    for name, part in {surface.name: surface, **surface.coords}.items():
        if part.dtype.kind not in _REAL:
            raise UnreadableFileError(f"{path}: {name} is {part.dtype}; it must be real numbers")
    return surface


def tile_values(surface: xr.DataArray) -> tuple[Array, float]:
    """Values (n_x, n_y) of a tile and the spacing of its grid; ValueError if it is not uniform."""
    pixels = [spacing(surface, name) for name in ("x", "y")]
    if abs(pixels[1] / pixels[0] - 1) > UNEQUAL:
        raise ValueError(
            f"the spacing is {pixels[0]:.6g} in x and {pixels[1]:.6g} in y; they must be equal"
        )
    return np.ascontiguousarray(surface.transpose("x", "y"), dtype=float), pixels[0]


def spacing(surface: xr.DataArray, name: str) -> float:
    """Uniform spacing of a coordinate; ValueError if it has none."""
    if name not in surface.coords or surface.sizes[name] < 2:
        raise ValueError(
            f"{surface.name} has {counted(surface.sizes[name], 'point')} along {name} and "
            f"{'a' if name in surface.coords else 'no'} coordinate {name}; give 2 or more with "
            "their positions"
        )
    # Places of 1e308 are infinitely far from each other.
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(np.asarray(surface[name], dtype=float))
        mean = float(np.mean(steps))
    if not (0 < mean < np.inf and np.max(np.abs(steps - mean)) <= UNEQUAL * mean):
        raise ValueError(
            f"{name} advances by {np.min(steps):.6g} to {np.max(steps):.6g}; it must "
            "increase in equal steps"
        )
    check_within(f"spacing of {name}", mean, NUMBER)
    return mean
