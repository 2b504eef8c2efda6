"""Surfaces of a user: the meaning of their values, and refusals of impossible ones."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from crackfront.core.adhesion import AdhesionMap, FieldKind, refuse_unknown_kind, rough_adhesion
from crackfront.core.arguments import refuse_no_numbers, refuse_other_type
from crackfront.core.arrays import Array
from crackfront.core.bounds import ADHESION as VALUES
from crackfront.core.bounds import NUMBER, Range, refuse_outside
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, LATERAL, VERTICAL, Variable
from crackfront.core.words import counted
from crackfront.simulate.labels import label, labelled, stated_unit
from crackfront.simulate.storage import UnreadableFileError, read_dataset
from crackfront.surfaces.si_units import (
    SURFACES,
    Scales,
    in_si,
    refuse_no_scales,
    refuse_other_units,
)
from crackfront.surfaces.written_units import is_unit, unit_value


def surface(
    values: ArrayLike,
    side: float | str,
    *,
    kind: FieldKind = "roughness",
    units: str | None = None,
    sphere: Scales | None = None,
) -> xr.DataArray:
    """A surface from an array of heights or of works of adhesion.

    Parameters
    ----------
    values : (n_x, n_y) array
        Heights, positive at peaks, or works of adhesion on a periodic tile of square pixels. Of a
        DataArray the dimensions x and y, and the units that it states, count.
    side : float or str
        Side of the tile along x: a number (Units: reduced lateral length; with a sphere m), or with
        a sphere a text with a unit, as '120um'.
    kind : {"roughness", "chemical"}, optional
        Whether the values are heights or works of adhesion.
    units : str, optional
        Units of the values: 'reduced', which is the default; for works of adhesion 'w_int', where
        they are relative to that; with a sphere a unit of SI as 'nm' or 'mJ/m2', by default m or
        J/m^2.
    sphere : Scales, optional
        What a reduced unit is.

    Returns
    -------
    xarray.DataArray
        `height(x, y)` or `work_of_adhesion(x, y)` as of `crackfront.random_surface`, which
        `crackfront.run_loop` takes, and saved by `crackfront.save_result`, `crackfront cycle`.

    Raises
    ------
    ValueError
        If a unit or side cannot be used, the array states other ones, values are missing or
        masked, the tile is not periodic, or its mean work of adhesion is below half of w_int or
        above twice that.
    TypeError
        If an argument is of another type.

    Examples
    --------
    >>> wave = np.cos(2 * np.pi * np.arange(64) / 8)[:, None].repeat(64, axis=1)
    >>> surface(0.01 * wave, side=4.0).name
    'height'
    >>> pdms = Scales(radius="1mm", work_of_adhesion="50mJ/m2", contact_modulus="1MPa")
    >>> ripples = surface(20 * wave, side="100um", units="nm", sphere=pdms)
    >>> patches = surface(1 + 0.2 * wave, side=4.0, kind="chemical", units="w_int")
    """
    refuse_unknown_kind(kind)
    refuse_other_type("units", units, (str, type(None)), "the name of a unit")
    if isinstance(values, xr.DataArray):
        values, units = _stated(values, units)
    _refuse_complex(values)
    try:
        # What is masked is refused as NaN is.
        samples: Array = np.ma.array(values, dtype=float).filled(np.nan)
    except (TypeError, ValueError) as error:
        raise TypeError(f"the values are no array of numbers: {error}") from error
    if samples.ndim != 2 or min(samples.shape) < 2:
        raise ValueError(f"the values have the shape {samples.shape}; a tile must be (x, y)")
    scale = 1.0
    if sphere is None:
        refuse_no_numbers(side=side)
        refuse_outside("side", float(side), NUMBER)
        if isinstance(values, xr.DataArray):
            _refuse_other_side(values, side, None)
    else:
        refuse_no_scales(sphere)
        metres = in_si("side", side, "m")
        refuse_outside("side", metres, _SIDES, "m")
        if isinstance(values, xr.DataArray):
            _refuse_other_side(values, side, sphere)
        side, scale = metres / sphere.lateral, sphere.vertical
    unit, known = "m", {"reduced": 1.0}
    if kind == "chemical":
        unit, known = "J/m^2", {"reduced": 1 / WORK_OF_ADHESION, "w_int": 1.0}
        scale = 1.0 if sphere is None else sphere.work_of_adhesion
    given = units or ("reduced" if sphere is None else unit)
    if given not in known and sphere is None:
        raise ValueError(
            f"units is {units!r}, which needs the sphere; give it, or values whose units are "
            f"{' or '.join(known)}"
        )
    factor = known[given] if given in known else unit_value(given, unit) / scale
    found = surface_array(kind, factor * samples, float(side) / len(samples))
    if kind == "chemical":
        stated = "" if given in known else f"{float(np.mean(samples)):.4g} {given}"
        _refuse_strange_mean(found.values, given, stated)
    surface_adhesion(found)
    return found


_SIDES = Range(1e-9, 1.0)
"""Sides of tiles that a sphere is pressed on. (Units: m)"""


def _stated(values: xr.DataArray, units: str | None) -> tuple[xr.DataArray, str | None]:
    """Values over (x, y) and their units, by what an array says of itself.

    ValueError if it states other units than are given.
    """
    if {*values.dims} == {"x", "y"}:
        values = values.transpose("x", "y")
    stated = stated_unit(values.attrs)
    # Surfaces in reduced units say so by the names of their units.
    stated = "reduced" if stated == VERTICAL else stated
    if stated not in (None, "", "1"):
        if units not in (None, stated):
            raise ValueError(
                f"units is {units!r}, but the array states {stated!r}; leave units out, or drop "
                "the attribute"
            )
        units = str(stated)
    return values, units


def _refuse_other_side(values: xr.DataArray, side: float | str, sphere: Scales | None) -> None:
    """Raise if coordinates of an array span another side than is given, or are not of a tile."""
    wanted = float(side) if sphere is None else in_si("side", side, "m")
    for name in ("x", "y"):
        along_dimension = name in values.coords and {"x", name} <= {*values.dims}
        if not along_dimension or values.sizes[name] < 2:
            continue
        if name == "y" and values.y[0] > values.y[-1]:
            # As in pictures, whose rows are counted downwards.
            values = values.isel(y=slice(None, None, -1))
        unit = str(stated_unit(values[name].attrs) or "1")
        if sphere is None or (unit == "1" and not isinstance(side, str)):
            factor = 1.0
        elif unit in ("reduced", LATERAL):
            factor = sphere.lateral
        elif is_unit(unit, "m"):
            factor = unit_value(unit, "m")
        else:
            continue
        spans = values.sizes[name] * _spacing(values, name)
        # Pixels are square: the side is that along x.
        along = wanted * values.sizes[name] / values.sizes["x"]
        if abs(factor * spans / along - 1) > _UNEQUAL:
            other = "" if name == "x" else f", where a side of {side} along x makes pixels square"
            raise ValueError(
                f"side is {side}, but the coordinate {name} of the array spans "
                f"{spans:.6g}{'' if unit == '1' else f' {unit}'}{other}; give "
                f"{'this side' if name == 'x' else 'values on square pixels'}, or the values alone"
            )


def _refuse_complex(values: object) -> None:
    """Raise TypeError if an array has imaginary parts, which a surface has not."""
    if isinstance(values, (np.ndarray, xr.DataArray)) and values.dtype.kind == "c":
        raise TypeError("the values are complex numbers; give real ones, as in values.real")


def _refuse_strange_mean(values: Array, units: str, stated: str = "") -> None:
    """Raise if works of adhesion (Units: w_int) have no mean around w_int.

    `units` are as given, `stated` is the mean in units of SI.
    """
    mean = float(np.mean(values))
    if not math.isfinite(mean) or 0.5 <= mean <= 2:
        return
    cause = "check the values, or take their mean for w_int"
    if stated:
        raise ValueError(
            f"the mean work of adhesion is {stated}, {mean:.4g} of that of the sphere; it must lie "
            "between 0.5 and 2: check the units, or the work of adhesion of the sphere"
        )
    if units != "w_int" and 0.5 <= mean * WORK_OF_ADHESION <= 2:
        cause = "were they in units of w_int? Then set units to 'w_int'"
    elif units == "w_int" and 0.5 <= mean / WORK_OF_ADHESION <= 2:
        cause = "were they in reduced units, in which w_int is 1/pi? Then set units to 'reduced'"
    elif abs(mean) < 0.1:
        cause = "were they deviations from it? Then add w_int"
    in_units = "units of w_int" if units == "w_int" else "reduced units"
    raise ValueError(
        f"the mean work of adhesion is {mean:.4g} w_int, with values in {in_units}; it must lie "
        f"between 0.5 and 2: {cause}"
    )


def surface_kind(surface: xr.DataArray) -> FieldKind:
    """Kind of the values of a surface, by its name; ValueError if no surface has that name.

    TypeError if it is no array with labels at all.
    """
    wanted = "an xarray.DataArray height(x, y), as surface, random_surface and read_scan make it"
    refuse_other_type("surface", surface, xr.DataArray, wanted)
    kinds = {item.name: kind for kind, item in SURFACES.items()}
    if surface.name not in kinds:
        raise ValueError(
            f"the surface is named {surface.name!r}; say what its values are by the name "
            f"{' or '.join(kinds)}, as in surface.rename('height')"
        )
    return kinds[str(surface.name)]


def surface_adhesion(surface: xr.DataArray) -> AdhesionMap:
    """Work of adhesion, in reduced units, of `height(x, y)` or `work_of_adhesion(x, y)` of a tile.

    ValueError if name, dimensions, units or values are not those of a surface in reduced units,
    heights jump from one edge of the tile to the other, or the energy of full conformity is not
    below w_int.
    """
    kind = surface_kind(surface)
    if {*surface.dims} != {"x", "y"}:
        raise ValueError(
            f"{surface.name} has the dimensions ({', '.join(map(str, surface.dims))}); a tile must "
            "have x and y"
        )
    refuse_other_units(surface if kind == "roughness" else surface.coords.to_dataset())
    _refuse_complex(surface)
    samples, pixel = _tile_values(surface)
    known = {"reduced": 1.0, "1": 1.0, ADHESION: WORK_OF_ADHESION}
    unit, units = 1.0, str(stated_unit(surface.attrs) or "reduced")
    if kind == "chemical":
        if units not in known:
            raise ValueError(
                f"{surface.name} has the units {units!r}; they must be 'reduced' or '{ADHESION}': "
                "set them, or convert other units by in_reduced_units"
            )
        unit, samples = WORK_OF_ADHESION, known[units] * samples
    bad = np.argwhere(~np.isfinite(samples))
    if bad.size:
        raise ValueError(
            f"{surface.name} is {samples[tuple(bad[0])]} at x index {bad[0, 0]}, y index "
            f"{bad[0, 1]} ({counted(len(bad), 'such value')}); write finite values"
        )
    _refuse_extreme(SURFACES[kind].name, samples, unit)
    corner = float(surface["x"][0]), float(surface["y"][0])
    if kind == "roughness":
        if not surface.attrs.get("periodic"):
            _refuse_seam(samples)
        return replace(rough_adhesion(samples, pixel), corner=corner)
    _refuse_strange_mean(samples / unit, "w_int" if units == ADHESION else "reduced")
    rms = float(np.std(samples)) / unit
    return AdhesionMap(samples, pixel, rms**2 / 4, rms, corner)


_AXES = tuple(
    Variable(name, (name,), LATERAL, f"{name}, the apex of the sphere at 0") for name in "xy"
)


def surface_array(
    kind: FieldKind, values: Array, pixel: float, **attributes: str | float | Array
) -> xr.DataArray:
    """Surface of a periodic tile, the apex of the sphere at its centre.

    The values (n_x, n_y) are heights (Units: reduced vertical length) or works of adhesion (Units:
    w_int), the pixel is the grid spacing (Units: reduced lateral length). The attributes are what
    else the array says of itself.
    """
    item = SURFACES[kind]
    axes = {
        axis.name: labelled(axis, pixel * (np.arange(count) - count / 2))
        for axis, count in zip(_AXES, values.shape, strict=True)
    }
    return xr.DataArray(values, axes, item.dims, name=item.name, attrs=label(item) | attributes)


_SEAM = 2.0
"""Rms step of heights from one edge of a tile to the other over the largest one inside, from which
on the tile is not periodic: on one that is, the edges are lines like all others."""


def _refuse_seam(heights: Array) -> None:
    """Raise if heights do not go on from one edge of a tile to the other."""
    for axis, name in enumerate("xy"):
        steps = np.diff(heights, axis=axis, append=np.take(heights, [0], axis=axis))
        *inside, seam = np.sqrt(np.mean(steps**2, axis=1 - axis))
        if seam > _SEAM * max(inside):
            raise ValueError(
                f"the heights jump by {seam:.3g} from one end of {name} to the other, where those "
                f"of neighbouring points differ by up to {max(inside):.3g}: the tile is not "
                "periodic. Level the map and mirror or window it, as read_scan does; an edge that "
                "is meant is said by the attribute periodic=1"
            )


_REAL = "fiu"
"""Kinds of types of numpy that are real numbers."""

_COPIES = 6
"""Memory of a field in use over that of its values: as numbers of double precision, as splines."""


def read_field(path: Path) -> xr.DataArray:
    """Surface in a netCDF file, `height(x, y)` or `work_of_adhesion(x, y)`.

    ValueError if the file is missing or truncated, or holds no surface of real numbers, or both.
    """
    dataset = read_dataset(path, copies=_COPIES)
    names = [item.name for item in SURFACES.values() if item.name in dataset]
    if not names:
        raise UnreadableFileError(
            f"{path} has no surface (it has: {', '.join(map(str, dataset.data_vars))}); name its "
            f"variable {' or '.join(item.name for item in SURFACES.values())}"
        )
    if len(names) > 1:
        raise ValueError(f"{path} has both {' and '.join(names)}; keep one in the file")
    values = dataset[names[0]]
    for name, part in {values.name: values, **values.coords}.items():
        if part.dtype.kind not in _REAL:
            raise UnreadableFileError(f"{path}: {name} is {part.dtype}; it must be real numbers")
    return values


_UNEQUAL = 1e-6
"""Largest deviation from equal spacing, relative to it."""


def _tile_values(values: xr.DataArray) -> tuple[Array, float]:
    """Values of a tile, first axis x, and their spacing, which must be one in x and y."""
    pixels = [_spacing(values, name) for name in ("x", "y")]
    if abs(pixels[1] / pixels[0] - 1) > _UNEQUAL:
        raise ValueError(
            f"the spacing is {pixels[0]:.6g} in x and {pixels[1]:.6g} in y; they must be equal"
        )
    return np.ascontiguousarray(values.transpose("x", "y"), dtype=float), pixels[0]


def _spacing(values: xr.DataArray, name: str) -> float:
    """Uniform spacing of a coordinate."""
    if name not in values.coords or values.sizes[name] < 2:
        raise ValueError(
            f"{values.name} has {counted(values.sizes[name], 'point')} along {name} and "
            f"{'a' if name in values.coords else 'no'} coordinate {name}; give 2 or more with "
            "their positions"
        )
    # Places of 1e308 are infinitely far from each other.
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(np.asarray(values[name], dtype=float))
        mean = float(np.mean(steps))
    if not (0 < mean < np.inf and np.max(np.abs(steps - mean)) <= _UNEQUAL * mean):
        raise ValueError(
            f"{name} advances by {np.min(steps):.6g} to {np.max(steps):.6g}; it must "
            "increase in equal steps"
        )
    refuse_outside(f"spacing of {name}", mean, NUMBER)
    return mean


def _refuse_extreme(name: str, values: Array, unit: float = 1.0) -> None:
    """Raise if a finite value is so large that no surface has it."""
    beyond = np.argwhere((values < VALUES.least * unit) | (values > VALUES.most * unit))
    if beyond.size:
        place = tuple(beyond[0].tolist())
        bounds = f"{VALUES.least:g} and {VALUES.most:g}"
        raise ValueError(
            f"{name} is {float(values[place]) / unit:g} at index {', '.join(map(str, place))} "
            f"({counted(len(beyond), 'such value')}); it must lie between {bounds}"
        )
