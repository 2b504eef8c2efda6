"""Attributes of variables in files and datasets, by the CF conventions."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.core.variables import Variable, variables

_UDUNITS = re.compile(r"1|(byte|rad|s|m|N|Pa|J)(\^?-?\d)?( (/ )?m(\^?-?\d)?)?")
"""Units that UDUNITS reads, which the CF conventions require."""


def unit_attributes(unit: str) -> dict[str, str]:
    """Attributes for a unit: `units`, and `reduced_unit` where the numbers are multiples of one.

    Examples
    --------
    >>> unit_attributes("J / m^2"), unit_attributes("w_int")
    ({'units': 'J / m^2'}, {'units': '1', 'reduced_unit': 'w_int'})
    """
    if _UDUNITS.fullmatch(unit):
        return {"units": str(unit)}
    return {"units": "1", "reduced_unit": str(unit)}


def stated_unit(attributes: Mapping[Any, Any]) -> Any:
    """The unit that attributes state, a reduced one where there is one; None without any."""
    unit = attributes.get("units")
    if unit == "1":
        unit = attributes.get("reduced_unit", unit)
    return str(unit) if isinstance(unit, str) else unit


def label(variable: Variable, flags: Sequence[str] = ()) -> dict[str, Any]:
    """Attributes of a variable; flags are the words that its values 0, 1, ... mean."""
    places = np.arange(len(flags), dtype=np.int8)
    meanings = {"flag_values": places, "flag_meanings": " ".join(flags)} if flags else {}
    return variable.attributes | unit_attributes(variable.units) | meanings


def flag_words(values: xr.DataArray) -> NDArray[np.str_]:
    """The words that the values of a variable with flags mean."""
    return np.array(values.attrs["flag_meanings"].split())[values.values]


def labelled(variable: Variable, values: Any) -> tuple[tuple[str, ...], Any, dict[str, Any]]:
    """A variable with its values, as xarray wants it."""
    return variable.dims, values, label(variable)


def labelled_fields(record: Any, *along: str) -> dict[str, Any]:
    """Variables of a record, its fields made by `variable`; None is left out.

    The dimensions in `along` come before those that the fields state.
    """
    values = ((item, getattr(record, item.name)) for item in variables(type(record), *along))
    return {item.name: labelled(item, value) for item, value in values if value is not None}
