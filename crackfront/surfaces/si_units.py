"""Labelled arrays from reduced units to SI and back, by the names of their variables."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, fields
from numbers import Real
from typing import Any, TypeVar

import xarray as xr

from crackfront.analysis.table import SweepAxes, SweepRow
from crackfront.core import units
from crackfront.core.adhesion import FieldKind
from crackfront.core.arguments import refuse_other_type
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState, sphere
from crackfront.core.spectrum import Spectrum
from crackfront.core.units import ReducedUnit
from crackfront.core.variables import (
    ADHESION,
    ENERGY,
    LATERAL,
    STEP,
    VERTICAL,
    Variable,
    variables,
)
from crackfront.simulate.labels import stated_unit, unit_attributes
from crackfront.surfaces.instabilities import Instabilities
from crackfront.surfaces.written_units import si_value, unit_value

Labelled = TypeVar("Labelled", xr.DataArray, xr.Dataset)


class Scales(units.Scales):
    """Values of the reduced units in SI, from a sphere and the surface it touches.

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
        self, radius: float | str, work_of_adhesion: float | str, contact_modulus: float | str
    ) -> None:
        super().__init__(
            in_si("radius", radius, "m"),
            in_si("work_of_adhesion", work_of_adhesion, "J/m^2"),
            in_si("contact_modulus", contact_modulus, "Pa"),
        )


def in_si(name: str, given: float | str, unit: str) -> float:
    """Value in SI of an argument that is a number or a text with a unit."""
    if isinstance(given, str):
        return si_value(given, unit, what=name)
    refuse_other_type(name, given, Real, f"a number of {unit}, or a text with a unit")
    return float(given)


def refuse_no_scales(sphere: object) -> None:
    """Raise TypeError if an argument is no sphere."""
    wanted = "crackfront.Scales(radius, work_of_adhesion, contact_modulus)"
    refuse_other_type("sphere", sphere, units.Scales, wanted)


SURFACES: dict[FieldKind, Variable] = {
    "roughness": Variable("height", ("x", "y"), VERTICAL, "height, positive at peaks"),
    "chemical": Variable("work_of_adhesion", ("x", "y"), ADHESION, "local work of adhesion"),
}
"""Variables of surfaces, by the kind of their values."""

_KINDS = (ContactState, CycleRecord, Instabilities, SweepAxes, SweepRow)
_REDUCED = {
    item.name: item.units
    for item in (
        *SURFACES.values(),
        *sphere(1).variables,
        *(item for kind in _KINDS for item in variables(kind)),
    )
} | {"x": LATERAL, "y": LATERAL, STEP: "1"}
"""Reduced units of everything that may be converted."""

_LENGTHS = (*Spectrum.length_names(), "travel", "spacing", "tile_side")
_ATTRIBUTES = dict.fromkeys(_LENGTHS, LATERAL)
_ATTRIBUTES |= {"end_penetration": VERTICAL, "pull_off_energy": ENERGY}
"""Reduced units of attributes; those of an array in SI units are in SI units, too."""

_SPHERE = "sphere_"
"""Prefix of the attributes that state the sphere of a conversion."""


_OF_SWEEP = "scale_"
"""Prefix of the attributes in which a table states the sphere of its configuration."""


def in_si_units(data: Labelled, scales: units.Scales | None = None) -> Labelled:
    """A copy of a surface, a cycle or the table of a sweep in SI units, which states the sphere.

    Parameters
    ----------
    data : xarray.DataArray or xarray.Dataset
        What is in reduced units.
    scales : Scales, optional
        The sphere; by default that of the configuration, which the table of a sweep states.

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
        scales = _attributes_scales(as_dataset(data), _OF_SWEEP)
        if scales is None:
            raise ValueError(
                "the data do not state a sphere, as tables of sweeps with a section scales do; "
                "name it: in_si_units(data, crackfront.Scales(radius, ...))"
            )
    refuse_no_scales(scales)
    refuse_other_units(data)
    found = _converted(data, lambda unit, _: _si(unit, scales))
    return found.assign_attrs({_SPHERE + name: part for name, part in asdict(scales).items()})


def stated_scales(data: xr.DataArray | xr.Dataset) -> units.Scales | None:
    """The sphere for which data were converted to SI units; None where they are in reduced ones.

    ValueError if they are in other units and do not say for which sphere they were converted.
    """
    found = _attributes_scales(data, _SPHERE)
    if found is None:
        refuse_other_units(data)
    return found


def _attributes_scales(data: xr.DataArray | xr.Dataset, prefix: str) -> units.Scales | None:
    """The sphere that attributes with a prefix state, if they do."""
    names = [prefix + item.name for item in fields(units.Scales)]
    if not all(name in data.attrs for name in names):
        return None
    return units.Scales(*(float(data.attrs[name]) for name in names))


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
        If a variable is unknown, its units are not those of its quantity, or the data state
        another sphere.
    TypeError
        If an argument is of another type.

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
    stated = _attributes_scales(data, _SPHERE)
    if stated is not None and not _are_equal(stated, scales):
        raise ValueError(
            f"the data were converted for another sphere, {_words(stated)}; give that one"
        )

    def reduced(unit: str, part: xr.DataArray | None) -> tuple[float, str]:
        scale, needed = _si(unit, scales)
        return (1.0 if part is None else _unit_value(part, needed)) / scale, unit

    found = _converted(data, reduced)
    kept = {name: part for name, part in found.attrs.items() if not name.startswith(_SPHERE)}
    return found.drop_attrs(deep=False).assign_attrs(kept)


def _are_equal(one: units.Scales, other: units.Scales) -> bool:
    """Whether two spheres are the same but for round-off."""
    pairs = zip(asdict(one).values(), asdict(other).values(), strict=True)
    return all(math.isclose(*pair, rel_tol=1e-9) for pair in pairs)


def refuse_other_units(data: xr.DataArray | xr.Dataset) -> None:
    """Raise ValueError if a variable is unknown or not in reduced units; places need no units."""
    dataset = as_dataset(data)
    if _attributes_scales(data, _SPHERE) is not None:
        raise ValueError("the data are in SI units; in_reduced_units(data, sphere) converts them")
    for name, part in dataset.variables.items():
        given, needed = stated_unit(part.attrs), _reduced_unit(str(name))
        plain = "reduced" if needed in (LATERAL, VERTICAL) else needed
        if given not in (needed, plain) and not (name in ("x", "y") and given in (None, "", "1")):
            stated = "states no units" if given is None else f"has the units {given!r}"
            raise ValueError(
                f"{name} {stated}; the attribute units must be '{plain}': set it, "
                "or convert other units by in_reduced_units"
            )


def as_dataset(
    data: xr.DataArray | xr.Dataset,
    name: str = "data",
    wanted: str = "an xarray.DataArray or xarray.Dataset",
) -> xr.Dataset:
    """A dataset, or that of an array; refused are arrays without a name, and other types."""
    if isinstance(data, xr.Dataset):
        return data
    refuse_other_type(name, data, xr.DataArray, wanted)
    if data.name is None:
        raise ValueError(
            "the array has no name; give it one that says what its values are, as in "
            "surface.rename('height')"
        )
    return data.to_dataset()


def _converted(
    data: Labelled, change: Callable[[str, xr.DataArray | None], tuple[float, str]]
) -> Labelled:
    """Copy with the factor and the new unit of each variable; None stands for attributes."""
    dataset: xr.Dataset = as_dataset(data)

    def attributes(part: xr.DataArray | xr.Dataset) -> dict[str, Any]:
        return {
            name: value * change(_ATTRIBUTES[name], None)[0] if name in _ATTRIBUTES else value
            for name, value in part.attrs.items()
            if name != "reduced_unit"
        }

    parts = {}
    for name in dataset.variables:
        part = dataset[name]
        factor, unit = change(_reduced_unit(str(name)), part)
        # Counts and texts have no scale, and keep their types.
        values = part.values if factor == 1.0 else part.values * factor
        parts[name] = (part.dims, values, attributes(part) | unit_attributes(unit))
    found = xr.Dataset(parts, attrs=attributes(dataset)).set_coords([*dataset.coords])
    if isinstance(data, xr.DataArray):
        return found[data.name]
    return found


_OF_FRONTS = "spring_", "pinning_", "position", "mean_position"
"""How names begin that only loops of straight fronts have."""


def _words(scales: units.Scales) -> str:
    """A sphere in words."""
    return ", ".join(f"{name} {value:g}" for name, value in asdict(scales).items())


def _reduced_unit(name: str) -> str:
    """Reduced units of a variable."""
    if name not in _REDUCED:
        if name.startswith(_OF_FRONTS):
            raise ValueError(
                f"{name} is of a straight front, which touches no sphere; its loops stay in the "
                "units of their tile"
            )
        raise ValueError(
            f"{name} is no variable of a surface or of a cycle; drop or rename it (the names of "
            f"surfaces are {' and '.join(item.name for item in SURFACES.values())})"
        )
    return _REDUCED[name]


def _si(unit: str, scales: units.Scales) -> tuple[float, str]:
    """What a unit is in SI, and the unit there; a unit that is no reduced one stays."""
    return (unit.scale(scales), unit.si) if isinstance(unit, ReducedUnit) else (1.0, unit)


def _unit_value(part: xr.DataArray, needed: str) -> float:
    """Value of the units of a variable in those that are needed."""
    if (given := stated_unit(part.attrs)) == needed:
        return 1.0
    if given == _reduced_unit(str(part.name)):
        raise ValueError(f"{part.name} is in reduced units already; nothing is to be converted")
    try:
        return unit_value(str(given), needed)
    except ValueError as error:
        raise ValueError(
            f"{part.name} has the units {given!r}, which cannot be converted to {needed}; set its "
            "attribute units"
        ) from error
