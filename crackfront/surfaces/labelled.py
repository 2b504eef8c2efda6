"""Names and reduced units of surfaces, cycles, instabilities and tables of sweeps."""

from __future__ import annotations

import xarray as xr

from crackfront.analysis.table import JumpRow, SweepAxes
from crackfront.core.adhesion import FieldKind
from crackfront.core.cycle.instabilities import Instabilities
from crackfront.core.cycle.jumps import Jumps
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.sphere import ContactState, sphere
from crackfront.core.spectrum import Spectrum
from crackfront.core.variables import (
    ADHESION,
    ENERGY,
    LATERAL,
    STEP,
    VERTICAL,
    Variable,
    variables,
)
from crackfront.simulate.labels import stated_unit
from crackfront.surfaces.scales import CONVERTED_FOR, attributes_sphere

SURFACES: dict[FieldKind, Variable] = {
    "roughness": Variable("height", ("x", "y"), VERTICAL, "height, positive at peaks"),
    "chemical": Variable("work_of_adhesion", ("x", "y"), ADHESION, "local work of adhesion"),
}
"""Variables of surfaces, by the kind of their values."""

_RECORDS = (ContactState, CycleRecord, Instabilities, Jumps, SweepAxes, JumpRow)
"""Records whose fields are variables of what the library returns."""

_UNITS = {
    item.name: item.units
    for item in (
        *SURFACES.values(),
        *sphere(1).variables,
        *(item for record in _RECORDS for item in variables(record)),
    )
} | {"x": LATERAL, "y": LATERAL, STEP: "1"}
"""Reduced units of variables, by name."""

_ATTRIBUTE_LENGTHS = (*Spectrum.length_names(), "travel", "spacing", "tile_side")

ATTRIBUTE_UNITS = dict.fromkeys(_ATTRIBUTE_LENGTHS, LATERAL) | {
    "end_penetration": VERTICAL,
    "pull_off_energy": ENERGY,
}
"""Reduced units of attributes, by name; in data in SI units they are in SI units too."""

_ONLY_STRAIGHT = "spring_", "pinning_", "position", "mean_position"
"""Beginnings of names that only loops of straight fronts have."""


def reduced_unit(name: str) -> str:
    """Reduced unit of a variable; ValueError if no surface, cycle or table has it."""
    if name in _UNITS:
        return _UNITS[name]
    if name.startswith(_ONLY_STRAIGHT):
        raise ValueError(
            f"{name} is of a straight front, which touches no sphere; its loops stay in the "
            "units of their tile"
        )
    surfaces = " and ".join(item.name for item in SURFACES.values())
    raise ValueError(
        f"{name} is not a variable of a surface or a cycle; drop or rename it (the names of "
        f"surfaces are {surfaces})"
    )


def check_units(data: xr.DataArray | xr.Dataset) -> None:
    """Raise ValueError if a variable is unknown or not in reduced units; places need no units."""
    dataset = as_dataset(data)
    if attributes_sphere(data.attrs, CONVERTED_FOR) is not None:
        raise ValueError("the data are in SI units; in_reduced_units(data, sphere) converts them")
    for name, part in dataset.variables.items():
        unit, needed = stated_unit(part.attrs), reduced_unit(str(name))
        short = "reduced" if needed in (LATERAL, VERTICAL) else needed
        is_place = name in ("x", "y") and unit in (None, "", "1")
        if unit not in (needed, short) and not is_place:
            problem = "states no units" if unit is None else f"has the units {unit!r}"
            raise ValueError(
                f"{name} {problem}; the attribute units must be '{short}': set it, "
                "or convert other units by in_reduced_units"
            )


def as_dataset(data: xr.DataArray | xr.Dataset) -> xr.Dataset:
    """A dataset, or the dataset of an array; ValueError if an array lacks a name."""
    if isinstance(data, xr.Dataset):
        return data
    if data.name is None:
        raise ValueError(
            "the array lacks a name; give it one that says what its values are, as in "
            "surface.rename('height')"
        )
    return data.to_dataset()
