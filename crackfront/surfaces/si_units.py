"""Labelled arrays from reduced units to SI and back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any, TypeVar

import xarray as xr
from pydantic import InstanceOf

from crackfront.core import units
from crackfront.core.units import ReducedUnit
from crackfront.simulate.labels import stated_unit, unit_attributes
from crackfront.surfaces.labelled import (
    ATTRIBUTE_UNITS,
    as_dataset,
    check_units,
    reduced_unit,
)
from crackfront.surfaces.scales import (
    CONFIGURED,
    CONVERTED_FOR,
    are_equal,
    attributes_sphere,
    sphere_attributes,
)
from crackfront.surfaces.written_units import unit_value
from crackfront.validation import checked_call

Labelled = TypeVar("Labelled", xr.DataArray, xr.Dataset)


@checked_call
def in_si_units(data: Labelled, scales: InstanceOf[units.Scales] | None = None) -> Labelled:
    """A copy of a surface, a cycle or the table of a sweep in SI units, which states the sphere.

    Parameters
    ----------
    data : xarray.DataArray or xarray.Dataset
        What is in reduced units.
    scales : Scales, optional
        The sphere; by default the sphere of the configuration, which the table of a sweep states.

    Returns
    -------
    xarray.DataArray or xarray.Dataset
        A copy; `units` of every variable state the unit in SI.

    Raises
    ------
    ValueError
        If a variable is unknown or in other units, or neither `scales` nor the data say for which
        sphere.
    TypeError
        If an argument is of another type.
    """
    if scales is None:
        scales = attributes_sphere(as_dataset(data).attrs, CONFIGURED)
        if scales is None:
            raise ValueError(
                "the data do not state a sphere, as tables of sweeps with a section scales do; "
                "name it: in_si_units(data, crackfront.Scales(radius, ...))"
            )
    check_units(data)
    converted = _converted(data, lambda unit, _: _si(unit, scales))
    return converted.assign_attrs(sphere_attributes(scales))


def stated_scales(data: xr.DataArray | xr.Dataset) -> units.Scales | None:
    """The sphere for which data were converted to SI units; None if they are in reduced units.

    ValueError if they are in other units and do not say for which sphere they were converted.
    """
    sphere = attributes_sphere(data.attrs, CONVERTED_FOR)
    if sphere is None:
        check_units(data)
    return sphere


@checked_call
def in_reduced_units(data: Labelled, scales: InstanceOf[units.Scales]) -> Labelled:
    """The same surface or cycle in reduced units.

    Parameters
    ----------
    data : xarray.DataArray or xarray.Dataset
        What is in SI units, or in multiples of them as nm; every variable says so in `units`.
        Attributes that are lengths must be in metres.
    scales : Scales
        The sphere: what a reduced unit is in SI.

    Returns
    -------
    xarray.DataArray or xarray.Dataset
        A copy.

    Raises
    ------
    ValueError
        If a variable is unknown, its units do not measure its quantity, or the data state another
        sphere.
    TypeError
        If an argument is of another type.

    Examples
    --------
    >>> from crackfront import Scales
    >>> import numpy as np
    >>> scales = Scales(radius=1e-3, work_of_adhesion=50e-3, contact_modulus=1e6)
    >>> nanometres = xr.DataArray([1.0, 2.0], dims="x", name="height", attrs={"units": "nm"})
    >>> reduced = in_reduced_units(nanometres, scales)
    >>> bool(np.allclose(reduced * scales.vertical, [1e-9, 2e-9]))
    True
    """
    stated_sphere = attributes_sphere(data.attrs, CONVERTED_FOR)
    if stated_sphere is not None and not are_equal(stated_sphere, scales):
        sphere = ", ".join(f"{name} {value:g}" for name, value in asdict(stated_sphere).items())
        raise ValueError(f"the data were converted for another sphere, {sphere}; give that one")

    def change(unit: str, part: xr.DataArray | None) -> tuple[float, str]:
        scale, needed = _si(unit, scales)
        return (1.0 if part is None else _unit_value(part, needed)) / scale, unit

    reduced = _converted(data, change)
    attributes = {
        name: value for name, value in reduced.attrs.items() if not name.startswith(CONVERTED_FOR)
    }
    return reduced.drop_attrs(deep=False).assign_attrs(attributes)


def _converted(
    data: Labelled, change: Callable[[str, xr.DataArray | None], tuple[float, str]]
) -> Labelled:
    """Copy with other units; `change` gives the factor and the new unit of a reduced unit.

    It is called with the variable that has the unit, or with None for an attribute.
    """
    dataset: xr.Dataset = as_dataset(data)

    def attributes(part: xr.DataArray | xr.Dataset) -> dict[str, Any]:
        return {
            name: value * change(ATTRIBUTE_UNITS[name], None)[0]
            if name in ATTRIBUTE_UNITS
            else value
            for name, value in part.attrs.items()
            if name != "reduced_unit"
        }

    parts = {}
    for name in dataset.variables:
        part = dataset[name]
        factor, unit = change(reduced_unit(str(name)), part)
        # Counts and texts have no scale, and keep their types.
        values = part.values if factor == 1.0 else part.values * factor
        parts[name] = (part.dims, values, attributes(part) | unit_attributes(unit))
    converted = xr.Dataset(parts, attrs=attributes(dataset)).set_coords([*dataset.coords])
    if isinstance(data, xr.DataArray):
        return converted[data.name]
    return converted


def _si(unit: str, scales: units.Scales) -> tuple[float, str]:
    """Value of a reduced unit in SI, and the unit there; other units stay."""
    return (unit.scale(scales), unit.si) if isinstance(unit, ReducedUnit) else (1.0, unit)


def _unit_value(part: xr.DataArray, needed: str) -> float:
    """Value of the unit of a variable in the unit that is needed."""
    unit = stated_unit(part.attrs)
    if unit == needed:
        return 1.0
    if unit == reduced_unit(str(part.name)):
        raise ValueError(f"{part.name} is in reduced units already; nothing is to be converted")
    try:
        return unit_value(str(unit), needed)
    except ValueError as error:
        raise ValueError(
            f"{part.name} has the units {unit!r}, which cannot be converted to {needed}; set its "
            "attribute units"
        ) from error
