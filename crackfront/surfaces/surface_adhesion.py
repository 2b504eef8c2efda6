"""Work of adhesion of a surface, and checks that it is possible."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import xarray as xr

from crackfront.core.adhesion import AdhesionMap, rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.bounds import ADHESION as VALUES
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION
from crackfront.core.words import counted
from crackfront.simulate.labels import stated_unit
from crackfront.surfaces.labelled import check_units
from crackfront.surfaces.surface_array import surface_kind, tile_values

_UNITS = {"reduced": 1.0, "1": 1.0, ADHESION: WORK_OF_ADHESION}
"""Units that works of adhesion of a surface may have, in reduced units."""

_SEAM = 2.0
"""Rms step of heights across the edge of a tile, over the largest rms step inside, from which on
the tile is not periodic.

In a periodic tile the edges are lines like all others.
"""

_LEAST_MEAN = 0.5
"""Least mean work of adhesion; less suggests a wrong unit. (Units: w_int)"""

_LARGEST_MEAN = 2.0
"""Largest mean work of adhesion; more suggests a wrong unit. (Units: w_int)"""


def surface_adhesion(surface: xr.DataArray) -> AdhesionMap:
    """Work of adhesion, in reduced units, of `height(x, y)` or `work_of_adhesion(x, y)` of a tile.

    ValueError if name, dimensions, units or values do not describe a surface in reduced units,
    heights jump from one edge of the tile to the other, or the energy of full conformity is not
    below w_int.
    """
    kind = surface_kind(surface)
    if {*surface.dims} != {"x", "y"}:
        raise ValueError(
            f"{surface.name} has the dimensions ({', '.join(map(str, surface.dims))}); a tile must "
            "have x and y"
        )
    check_units(surface if kind == "roughness" else surface.coords.to_dataset())
    check_real(surface)
    adhesion = _of_heights(surface) if kind == "roughness" else _of_works(surface)
    return replace(adhesion, corner=(float(surface["x"][0]), float(surface["y"][0])))


def _of_heights(surface: xr.DataArray) -> AdhesionMap:
    """Work of adhesion of heights, which must be finite and periodic."""
    heights, pixel = tile_values(surface)
    _check_values(str(surface.name), heights, 1.0)
    if not surface.attrs.get("periodic"):
        _check_seam(heights)
    return rough_adhesion(heights, pixel)


def _of_works(surface: xr.DataArray) -> AdhesionMap:
    """Works of adhesion of a map, with the e_el of roughness of the same rms."""
    values, pixel = tile_values(surface)
    unit = str(stated_unit(surface.attrs) or "reduced")
    if unit not in _UNITS:
        raise ValueError(
            f"{surface.name} has the units {unit!r}; they must be 'reduced' or '{ADHESION}': "
            "set them, or convert other units by in_reduced_units"
        )
    works = _UNITS[unit] * values
    _check_values(str(surface.name), works, WORK_OF_ADHESION)
    check_mean(works / WORK_OF_ADHESION, "w_int" if unit == ADHESION else "reduced")
    rms = float(np.std(works)) / WORK_OF_ADHESION
    return AdhesionMap(works, pixel, rms**2 / 4, rms)


def check_real(values: object) -> None:
    """Raise TypeError if an array has imaginary parts, which a surface does not have."""
    if isinstance(values, (np.ndarray, xr.DataArray)) and values.dtype.kind == "c":
        raise TypeError("the values are complex numbers; give real ones, as in values.real")


def check_mean(values: Array, units: str, mean_in_si: str = "") -> None:
    """Raise ValueError if the mean work of adhesion is far from w_int, with the likely cause.

    The values are in units of w_int; `units` are the units that the user named, `mean_in_si`
    is the mean in units of SI, if the user has these.
    """
    mean = float(np.mean(values))
    if not math.isfinite(mean) or _LEAST_MEAN <= mean <= _LARGEST_MEAN:
        return
    bounds = f"it must lie between {_LEAST_MEAN:g} and {_LARGEST_MEAN:g}"
    if mean_in_si:
        raise ValueError(
            f"the mean work of adhesion is {mean_in_si}, {mean:.4g} times the w_int of the "
            f"sphere; {bounds}: check the units, or the work of adhesion of the sphere"
        )
    cause = "check the values, or take their mean for w_int"
    if units != "w_int" and _LEAST_MEAN <= mean * WORK_OF_ADHESION <= _LARGEST_MEAN:
        cause = "were they in units of w_int? Then set units to 'w_int'"
    elif units == "w_int" and _LEAST_MEAN <= mean / WORK_OF_ADHESION <= _LARGEST_MEAN:
        cause = "were they in reduced units, in which w_int is 1/pi? Then set units to 'reduced'"
    elif abs(mean) < 0.1:
        cause = "were they deviations from it? Then add w_int"
    in_units = "units of w_int" if units == "w_int" else "reduced units"
    raise ValueError(
        f"the mean work of adhesion is {mean:.4g} w_int, with values in {in_units}; {bounds}: "
        f"{cause}"
    )


def _check_values(name: str, values: Array, unit: float) -> None:
    """Raise ValueError if a value is missing, infinite, or so large that no surface has it."""
    missing = np.argwhere(~np.isfinite(values))
    if missing.size:
        raise ValueError(
            f"{name} is {values[tuple(missing[0])]} at x index {missing[0, 0]}, y index "
            f"{missing[0, 1]} ({counted(len(missing), 'such value')}); write finite values"
        )
    beyond = np.argwhere((values < VALUES.least * unit) | (values > VALUES.most * unit))
    if beyond.size:
        index = tuple(beyond[0].tolist())
        bounds = f"{VALUES.least:g} and {VALUES.most:g}"
        raise ValueError(
            f"{name} is {float(values[index]) / unit:g} at index {', '.join(map(str, index))} "
            f"({counted(len(beyond), 'such value')}); it must lie between {bounds}"
        )


def _check_seam(heights: Array) -> None:
    """Raise ValueError if heights do not continue from one edge of a tile to the other."""
    for axis, name in enumerate("xy"):
        steps = np.diff(heights, axis=axis, append=np.take(heights, [0], axis=axis))
        *inside, seam = np.sqrt(np.mean(steps**2, axis=1 - axis))
        if seam > _SEAM * max(inside):
            raise ValueError(
                f"the heights jump by {seam:.3g} from one end of {name} to the other, while "
                f"neighbouring heights differ by up to {max(inside):.3g}: the tile is not "
                "periodic. Level the map and mirror or window it, as read_scan does; an edge that "
                "is meant is said by the attribute periodic=1"
            )
