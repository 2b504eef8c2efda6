"""Surfaces as labelled arrays: heights, or the work of adhesion itself, on a periodic tile."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.records import LATERAL, Variable
from crackfront.data.files import labelled
from crackfront.data.tiles import tile_samples
from crackfront.simulate.si_units import SURFACES, refuse_other_units
from crackfront.simulate.simulation import FieldKind

Array = NDArray[np.float64]

_AXES = tuple(
    Variable(name, (name,), LATERAL, f"{name}, the apex of the sphere at 0") for name in "xy"
)


def surface_array(
    kind: FieldKind, values: Array, pixel: float, **attributes: str | float
) -> xr.DataArray:
    """Surface of a periodic tile, the apex of the sphere at its centre.

    Parameters
    ----------
    kind : {"roughness", "chemical"}
        Whether the values are heights or works of adhesion.
    values : (n_x, n_y) array
        Heights (Units: reduced vertical length) or works of adhesion. (Units: w_int)
    pixel : float
        Grid spacing. (Units: reduced lateral length)
    **attributes : str or float
        What else the array says of itself.
    """
    item = SURFACES[kind]
    axes = {
        axis.name: labelled(axis, pixel * (np.arange(count) - count / 2))
        for axis, count in zip(_AXES, values.shape, strict=True)
    }
    return xr.DataArray(values, axes, item.dims, name=item.name, attrs=item.attributes | attributes)


def surface_kind(surface: xr.DataArray) -> FieldKind:
    """What the values of a surface are, by its name.

    Parameters
    ----------
    surface : xarray.DataArray
        A surface.

    Raises
    ------
    ValueError
        If the name is none of a surface.
    """
    for kind, item in SURFACES.items():
        if surface.name == item.name:
            return kind
    names = " or ".join(item.name for item in SURFACES.values())
    raise ValueError(
        f"the surface is named {surface.name!r}; say what its values are by the name {names}, as "
        "in surface.rename('height')"
    )


def surface_adhesion(surface: xr.DataArray) -> AdhesionMap:
    """Work of adhesion of a surface in reduced units.

    Parameters
    ----------
    surface : xarray.DataArray
        `height(x, y)` or `work_of_adhesion(x, y)` on a periodic tile.

    Raises
    ------
    ValueError
        If name, dimensions, units or values are not those of a surface in reduced units, or its
        energy of full conformity is not below w_int.
    """
    kind = surface_kind(surface)
    if set(surface.dims) != {"x", "y"}:
        raise ValueError(
            f"{surface.name} has the dimensions ({', '.join(map(str, surface.dims))}); a tile must "
            "have x and y"
        )
    refuse_other_units(surface)
    samples, pixel = tile_samples(surface)
    bad = np.argwhere(~np.isfinite(samples))
    if bad.size:
        raise ValueError(
            f"{surface.name} is {samples[tuple(bad[0])]} at x index {bad[0, 0]}, y index "
            f"{bad[0, 1]} ({len(bad)} such values); replace them by finite values"
        )
    if kind == "roughness":
        return rough_adhesion(samples, pixel)
    return chemical_adhesion(samples - 1.0, pixel)
