"""Labelled arrays from reduced units to SI and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
    converted = _converted(
        data,
        lambda part: _in_si(reduced_unit(str(part.name)), scales),
        lambda unit: unit.scale(scales),
    )
    return converted.assign_attrs(sphere_attributes(scales))


def stated_scales(data: xr.DataArray | xr.Dataset) -> units.Scales | None:
    """The sphere for which data were converted to SI units; None if they are in reduced units.

    ValueError if they are in other units and do not state a sphere.
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

    def change(part: xr.DataArray) -> tuple[float, str]:
        unit = reduced_unit(str(part.name))
        scale, si_unit = _in_si(unit, scales)
        return _unit_value(part, si_unit) / scale, unit

    reduced = _converted(data, change, lambda unit: 1.0 / unit.scale(scales))
    attributes = {
        name: value for name, value in reduced.attrs.items() if not name.startswith(CONVERTED_FOR)
    }
    return reduced.drop_attrs(deep=False).assign_attrs(attributes)


def _converted(
    data: Labelled,
    change: Callable[[xr.DataArray], tuple[float, str]],
    attribute_factor: Callable[[ReducedUnit], float],
) -> Labelled:
    """Copy of data in other units.

    `change` returns the factor by which the values of a variable are multiplied, and their new
    unit; `attribute_factor` returns the factor of an attribute that has a reduced unit.
    """
    dataset: xr.Dataset = as_dataset(data)
    parts = {}
    for name in dataset.variables:
        part = dataset[name]
        factor, unit = change(part)
        # Counts and texts lack a scale, and keep their types.
        values = part.values if factor == 1.0 else part.values * factor
        attributes = _converted_attributes(part.attrs, attribute_factor)
        parts[name] = (part.dims, values, attributes | unit_attributes(unit))
    attributes = _converted_attributes(dataset.attrs, attribute_factor)
    converted = xr.Dataset(parts, attrs=attributes).set_coords(list(dataset.coords))
    if isinstance(data, xr.DataArray):
        return converted[data.name]
    return converted


def _converted_attributes(
    attributes: Mapping[Any, Any], factor: Callable[[ReducedUnit], float]
) -> dict[Any, Any]:
    """Attributes in other units, without the reduced unit of a variable."""
    converted = {name: value for name, value in attributes.items() if name != "reduced_unit"}
    for name, unit in ATTRIBUTE_UNITS.items():
        if name in converted:
            converted[name] = converted[name] * factor(unit)
    return converted


def _in_si(unit: str, scales: units.Scales) -> tuple[float, str]:
    """Value of a reduced unit in SI, and its unit there; a unit that is not reduced stays."""
    if isinstance(unit, ReducedUnit):
        return unit.scale(scales), unit.si
    return 1.0, unit


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
