"""Labelled arrays from reduced units to SI and back, by the names of their variables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, fields
from numbers import Real
from typing import Any, TypeVar

import xarray as xr

from crackfront.analysis.table import SweepAxes, SweepRow
from crackfront.core import units
from crackfront.core.adhesion import FieldKind
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState, sphere
from crackfront.core.spectrum import Spectrum
from crackfront.core.variables import (
    ADHESION,
    ENERGY,
    FORCE,
    LATERAL,
    VERTICAL,
    Variable,
    variables,
)
from crackfront.data.arguments import refuse_other_type
from crackfront.data.written_units import si_value, unit_value
from crackfront.simulate.instabilities import Instabilities

Labelled = TypeVar("Labelled", xr.DataArray, xr.Dataset)


class Scales(units.Scales):
    """What one reduced unit is in SI: a sphere, and what it touches.

    Parameters
    ----------
    radius : float or str
        Radius R of the sphere; a number of metres, or a text with a unit, as '1.25mm'.
        (Units: m)
    work_of_adhesion : float or str
        Intrinsic work of adhesion w_int, as '63mJ/m2'. (Units: J / m^2)
    contact_modulus : float or str
        Contact modulus E' = E / (1 - nu^2), as '0.93MPa'. (Units: Pa)

    Raises
    ------
    ValueError
        If a parameter is not positive and finite, or a text is no such quantity.
    TypeError
        If a parameter is neither a number nor a text.

    Examples
    --------
    >>> sphere = Scales(radius="1.25mm", work_of_adhesion="63mJ/m2", contact_modulus=0.7e6 / 0.75)
    >>> f"{sphere.lateral * 1e6:.1f} um, {sphere.vertical * 1e6:.2f} um"
    '62.9 um, 3.16 um'
    """

    __slots__ = ()

    def __init__(
        self,
        radius: float | str,
        work_of_adhesion: float | str,
        contact_modulus: float | str,
    ) -> None:
        super().__init__(
            _in_si("radius", radius, "m"),
            _in_si("work_of_adhesion", work_of_adhesion, "J/m^2"),
            _in_si("contact_modulus", contact_modulus, "Pa"),
        )


def _in_si(name: str, given: float | str, unit: str) -> float:
    """Value of a parameter of :class:`Scales` in SI."""
    if isinstance(given, str):
        return si_value(given, unit, what=name)
    refuse_other_type(name, given, Real, f"a number of {unit}, or a text with a unit")
    return float(given)


def refuse_no_scales(sphere: object) -> None:
    """Raise TypeError if an argument is no sphere."""
    refuse_other_type(
        "sphere",
        sphere,
        units.Scales,
        "crackfront.Scales(radius, work_of_adhesion, contact_modulus)",
    )


_Change = Callable[[str, xr.DataArray], tuple[float, str]]
"""From a variable and its name to the factor of its values, and the units that they then have."""

SURFACES: dict[FieldKind, Variable] = {
    "roughness": Variable("height", ("x", "y"), VERTICAL, "height, positive at peaks"),
    "chemical": Variable("work_of_adhesion", ("x", "y"), ADHESION, "local work of adhesion"),
}
"""What a surface is called, by what its values are."""

_AREA = f"({LATERAL})^2"
_SI = {LATERAL: "m", VERTICAL: "m", FORCE: "N", ADHESION: "J / m^2", ENERGY: "J", _AREA: "m^2"}

_KINDS = (ContactState, CycleRecord, Instabilities, SweepAxes, SweepRow)
_REDUCED = {
    item.name: item.units
    for item in (
        *SURFACES.values(),
        *sphere(1).variables,
        *(item for kind in _KINDS for item in variables(kind)),
    )
} | {"x": LATERAL, "y": LATERAL}
"""Reduced units of everything that may be converted."""

_ATTRIBUTES = dict.fromkeys(Spectrum.length_names(), LATERAL) | {
    "end_penetration": VERTICAL,
    "pull_off_energy": ENERGY,
    "travel": LATERAL,
}
"""Reduced units of attributes; they have those of the array that they belong to."""


_SPHERE = "sphere_"
"""How the names of attributes begin that say which sphere an array was converted for."""


def in_si_units(data: Labelled, scales: units.Scales) -> Labelled:
    """A copy of a surface or cycle in SI units, whose attributes say for which sphere.

    Arguments as of :func:`in_reduced_units`.
    """
    refuse_no_scales(scales)
    refuse_other_units(data)

    def physical(name: str, part: xr.DataArray) -> tuple[float, str]:
        return _scale(scales, _units(name)), _SI.get(_units(name), _units(name))

    found = _converted(data, physical, lambda units: _scale(scales, units))
    return found.assign_attrs({_SPHERE + name: part for name, part in asdict(scales).items()})


def stated_scales(data: xr.DataArray | xr.Dataset) -> units.Scales | None:
    """The sphere for which data were converted to SI units; None where they are in reduced ones.

    Raises
    ------
    ValueError
        If they are neither in reduced units, nor say for which sphere they were converted.
    """
    names = [item.name for item in fields(units.Scales)]
    if not all(_SPHERE + name in data.attrs for name in names):
        refuse_other_units(data)
        return None
    return units.Scales(*(float(data.attrs[_SPHERE + name]) for name in names))


def in_reduced_units(data: Labelled, scales: units.Scales) -> Labelled:
    """The same surface or cycle in reduced units.

    Parameters
    ----------
    data : xarray.DataArray or xarray.Dataset
        What is in SI units, or in multiples of them as nm; every variable says so in `units`.
        Attributes that are lengths must be in metres.
    scales : Scales
        The sphere: what one reduced unit is in SI.

    Returns
    -------
    xarray.DataArray or xarray.Dataset
        A copy.

    Raises
    ------
    ValueError
        If a variable is unknown, or its units are not those of its quantity.

    Examples
    --------
    >>> scales = Scales(radius=1e-3, work_of_adhesion=50e-3, contact_modulus=1e6)
    >>> import numpy as np
    >>> nanometres = xr.DataArray([1.0, 2.0], dims="x", name="height", attrs={"units": "nm"})
    >>> reduced = in_reduced_units(nanometres, scales)
    >>> bool(np.allclose(reduced * scales.vertical, [1e-9, 2e-9]))
    True
    """
    refuse_no_scales(scales)

    def reduced(name: str, part: xr.DataArray) -> tuple[float, str]:
        return _si_value(name, part) / _scale(scales, _units(name)), _units(name)

    found = _converted(data, reduced, lambda units: 1 / _scale(scales, units))
    kept = {name: part for name, part in found.attrs.items() if not name.startswith(_SPHERE)}
    return found.drop_attrs(deep=False).assign_attrs(kept)


def refuse_other_units(data: xr.DataArray | xr.Dataset) -> None:
    """Raise ValueError if a variable is unknown or not in reduced units."""
    for name, part in _parts(_dataset(data)).items():
        if (given := part.attrs.get("units")) != _units(name):
            raise ValueError(
                f"{name} has the units {given!r}; the attribute units must be {_units(name)!r}: "
                "set it, or convert other units by in_reduced_units"
            )


def _converted(data: Labelled, change: _Change, scale: Callable[[str], float]) -> Labelled:
    """Copy of which every variable is multiplied by its factor."""
    dataset = _dataset(data)
    parts = {}
    for name, part in _parts(dataset).items():
        factor, units = change(name, part)
        # Counts and texts have no scale, and keep their types.
        values = part.values if factor == 1.0 else part.values * factor
        parts[name] = (part.dims, values, _attributes(part, scale) | {"units": units})
    coordinates = {name: parts[str(name)] for name in dataset.coords}
    variables = {name: parts[str(name)] for name in dataset.data_vars}
    found = xr.Dataset(variables, coordinates, _attributes(dataset, scale))
    if isinstance(data, xr.DataArray):
        return found[data.name]
    return found


def _attributes(part: xr.DataArray | xr.Dataset, scale: Callable[[str], float]) -> dict[str, Any]:
    """Attributes, those that are lengths or energies converted."""
    return {
        str(name): value * scale(_ATTRIBUTES[str(name)]) if name in _ATTRIBUTES else value
        for name, value in part.attrs.items()
    }


def _dataset(data: xr.DataArray | xr.Dataset) -> xr.Dataset:
    """Data as a dataset."""
    if isinstance(data, xr.Dataset):
        return data
    refuse_other_type("data", data, xr.DataArray, "an xarray.DataArray or xarray.Dataset")
    if data.name is None:
        raise ValueError(
            "the array has no name; name it by what its values are, as in surface.rename('height')"
        )
    return data.to_dataset()


def _parts(dataset: xr.Dataset) -> dict[str, xr.DataArray]:
    """Variables and coordinates by their names."""
    return {str(name): dataset[name] for name in dataset.variables}


def _units(name: str) -> str:
    """Reduced units of a variable."""
    if name not in _REDUCED:
        raise ValueError(
            f"{name} is no variable of a surface or of a cycle; drop or rename it (the names of "
            f"surfaces are {' and '.join(item.name for item in SURFACES.values())})"
        )
    return _REDUCED[name]


def _scale(scales: units.Scales, unit: str) -> float:
    """What a reduced unit is in SI; 1 for what has no scale."""
    known = {
        LATERAL: scales.lateral,
        VERTICAL: scales.vertical,
        FORCE: scales.force,
        ADHESION: scales.work_of_adhesion,
        ENERGY: scales.force * scales.vertical,
        _AREA: scales.lateral**2,
    }
    return known.get(unit, 1.0)


def _si_value(name: str, part: xr.DataArray) -> float:
    """The units of a variable in SI."""
    needed, given = _SI.get(_units(name), _units(name)), part.attrs.get("units")
    if given == needed:
        return 1.0
    try:
        return unit_value(str(given), needed)
    except ValueError as error:
        raise ValueError(
            f"{name} has the units {given!r}, which cannot be converted to {needed}; set its "
            "attribute units"
        ) from error
