"""Surfaces from arrays of a user, in reduced or SI units."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from pydantic import InstanceOf, SkipValidation

from crackfront.core.adhesion import FieldKind
from crackfront.core.arrays import Array
from crackfront.core.bounds import NUMBER, Range, check_within
from crackfront.core.units import WORK_OF_ADHESION, Scales
from crackfront.core.variables import LATERAL, VERTICAL
from crackfront.simulate.labels import stated_unit
from crackfront.surfaces.scales import in_si
from crackfront.surfaces.surface_adhesion import (
    check_mean,
    check_real,
    surface_adhesion,
)
from crackfront.surfaces.surface_array import UNEQUAL, spacing, surface_array
from crackfront.surfaces.written_units import is_unit, unit_value
from crackfront.validation import checked_call

_SIDES = Range(1e-9, 1.0)
"""Sides of tiles that a sphere is pressed on. (Units: m)"""

_REDUCED: dict[FieldKind, dict[str, float]] = {
    "roughness": {"reduced": 1.0},
    "chemical": {"reduced": 1 / WORK_OF_ADHESION, "w_int": 1.0},
}
"""Units that need no sphere, by the kind of the values, in the unit of a surface."""

_SI: dict[FieldKind, str] = {"roughness": "m", "chemical": "J/m^2"}
"""Unit of SI, by the kind of the values."""


@checked_call
def surface(
    values: SkipValidation[ArrayLike],
    side: float | str,
    *,
    kind: FieldKind = "roughness",
    units: str | None = None,
    sphere: InstanceOf[Scales] | None = None,
) -> xr.DataArray:
    """A surface from an array of heights or of works of adhesion.

    The axes of heights matter a little: the crack is a front along `y`, with the contact at smaller
    `x`. If a map is turned by 90 degrees, w_appr and w_retr change by 0.005 w_int rms, or by 0.012
    if its lengths along both axes differ by a factor of four.

    Parameters
    ----------
    values : (n_x, n_y) array
        Heights, positive at peaks, or works of adhesion on a periodic tile of square pixels. A
        DataArray is read by its dimensions x and y and the units that it states.
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
    >>> from crackfront import Scales
    >>> pdms = Scales(radius="1mm", work_of_adhesion="50mJ/m2", contact_modulus="1MPa")
    >>> ripples = surface(20 * wave, side="100um", units="nm", sphere=pdms)
    >>> patches = surface(1 + 0.2 * wave, side=4.0, kind="chemical", units="w_int")
    """
    if isinstance(values, xr.DataArray):
        values, units = _stated(values, units)
    samples = _samples(values)
    length = _reduced_side(side, sphere)
    if isinstance(values, xr.DataArray):
        _check_side(values, side, sphere)
    unit = units or ("reduced" if sphere is None else _SI[kind])
    array = surface_array(kind, _unit(kind, unit, sphere) * samples, length / len(samples))
    if kind == "chemical":
        mean = "" if unit in _REDUCED[kind] else f"{float(np.mean(samples)):.4g} {unit}"
        check_mean(array.values, unit, mean)
    surface_adhesion(array)
    return array


def _samples(values: ArrayLike) -> Array:
    """Values of a tile, NaN where they are masked."""
    check_real(values)
    try:
        samples: Array = np.ma.array(values, dtype=float).filled(np.nan)
    except (TypeError, ValueError) as error:
        raise TypeError(f"the values are not an array of numbers: {error}") from error
    if samples.ndim != 2 or min(samples.shape) < 2:
        raise ValueError(f"the values have the shape {samples.shape}; a tile must be (x, y)")
    return samples


def _reduced_side(side: float | str, sphere: Scales | None) -> float:
    """Side of a tile in reduced lateral lengths."""
    if sphere is None:
        if isinstance(side, str):
            raise TypeError(f"side is {side!r}, which needs the sphere; give it, or a number")
        check_within("side", side, NUMBER)
        return side
    metres = in_si("side", side, "m")
    check_within("side", metres, _SIDES, "m")
    return metres / sphere.lateral


def _unit(kind: FieldKind, unit: str, sphere: Scales | None) -> float:
    """Value of a unit in the unit of a surface, reduced vertical lengths or w_int."""
    if unit in _REDUCED[kind]:
        return _REDUCED[kind][unit]
    if sphere is None:
        raise ValueError(
            f"units is {unit!r}, which needs the sphere; give it, or values whose units are "
            f"{' or '.join(_REDUCED[kind])}"
        )
    scale = sphere.vertical if kind == "roughness" else sphere.work_of_adhesion
    return unit_value(unit, _SI[kind]) / scale


def _stated(values: xr.DataArray, units: str | None) -> tuple[xr.DataArray, str | None]:
    """Values over (x, y), and their units, which the array may state.

    ValueError if it states other units than the argument.
    """
    if {*values.dims} == {"x", "y"}:
        values = values.transpose("x", "y")
    stated_units = stated_unit(values.attrs)
    if stated_units in (None, "", "1"):
        return values, units
    # Surfaces in reduced units say so by the names of their units.
    stated_units = "reduced" if stated_units == VERTICAL else str(stated_units)
    if units not in (None, stated_units):
        raise ValueError(
            f"units is {units!r}, but the array states {stated_units!r}; leave units out, or drop "
            "the attribute"
        )
    return values, stated_units


def _check_side(values: xr.DataArray, side: float | str, sphere: Scales | None) -> None:
    """Raise ValueError if coordinates of an array span another side, or pixels are not square."""
    if "x" not in values.dims:
        return
    side_along_x = float(side) if sphere is None else in_si("side", side, "m")
    for name in ("x", "y"):
        if name not in values.coords or name not in values.dims or values.sizes[name] < 2:
            continue
        unit = str(stated_unit(values[name].attrs) or "1")
        factor = _length_unit(unit, sphere, has_plain_side=not isinstance(side, str))
        if factor is None:
            continue
        span = values.sizes[name] * spacing(_upwards(values, name), name)
        # Pixels are square, so that the side along x determines the side along y.
        expected = side_along_x * values.sizes[name] / values.sizes["x"]
        if abs(factor * span / expected - 1) > UNEQUAL:
            raise _unequal_side(side, name, span, unit)


def _upwards(values: xr.DataArray, name: str) -> xr.DataArray:
    """Values with increasing y; pictures count their rows downwards."""
    if name == "y" and values.y[0] > values.y[-1]:
        return values.isel(y=slice(None, None, -1))
    return values


def _unequal_side(side: float | str, name: str, span: float, unit: str) -> ValueError:
    """Error of a coordinate that spans another length than the side calls for."""
    length = f"{span:.6g}" if unit == "1" else f"{span:.6g} {unit}"
    if name == "x":
        problem, remedy = f"spans {length}", "this side"
    else:
        problem = f"spans {length}, where a side of {side} along x makes pixels square"
        remedy = "values on square pixels"
    return ValueError(
        f"side is {side}, but the coordinate {name} of the array {problem}; give {remedy}, or the "
        "values alone"
    )


def _length_unit(unit: str, sphere: Scales | None, *, has_plain_side: bool) -> float | None:
    """Value of the unit of a coordinate in the unit of the side; None if it is not a length."""
    if sphere is None or (unit == "1" and has_plain_side):
        return 1.0
    if unit in ("reduced", LATERAL):
        return sphere.lateral
    return unit_value(unit, "m") if is_unit(unit, "m") else None
