"""Files of what the library returned: a surface or a loop, saved and loaded."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from crackfront.core.arguments import check_type
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import read_dataset, write_dataset
from crackfront.surfaces.labelled import SURFACES, as_dataset
from crackfront.validation import PathName, checked_call

_STORABLE = (str, bool, int, float, np.generic, np.ndarray, list, tuple)
"""Types of attributes that netCDF can store, truth values as numbers."""


@checked_call
def save_result(result: xr.DataArray | xr.Dataset, path: PathName) -> None:
    """Save a surface or a loop as netCDF with checksums of its arrays, atomically.

    Reading an array that was damaged later raises an error. Files by `to_netcdf` of xarray can be
    read as well, but have no checksums.

    Parameters
    ----------
    result : xarray.DataArray or xarray.Dataset
        What a function of the library returned.
    path : str or Path
        The file; it is replaced if it is there.

    Raises
    ------
    ValueError
        If the array lacks a name.
    TypeError
        If the result is of another type, or netCDF cannot store an attribute.
    OSError
        If the file cannot be written.
    """
    dataset = as_dataset(result).copy()
    dataset.attrs = _storable(dataset.attrs)
    for part in dataset.variables.values():
        part.attrs = _storable(part.attrs)
    # netCDF would expand ~ to the home folder, other functions would not.
    write_dataset(path.expanduser(), dataset, provenance())


def _storable(attributes: Mapping[Any, Any]) -> dict[Any, Any]:
    """Attributes as netCDF stores them, truth values as 0 or 1; TypeError if it cannot."""
    storable = {}
    for name, value in attributes.items():
        check_type(f"attribute {name}", value, _STORABLE, "numbers or a text, or drop it")
        storable[name] = int(value) if isinstance(value, bool | np.bool_) else value
    return storable


@checked_call
def load_result(path: PathName) -> xr.DataArray | xr.Dataset:
    """What :func:`save_result` saved: a surface as an array, anything else as a dataset.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    xarray.DataArray or xarray.Dataset
        With the names, units and attributes that were saved.

    Raises
    ------
    ValueError
        If the file is missing, damaged, or not netCDF.
    TypeError
        If an argument is of another type.
    """
    dataset = read_dataset(path.expanduser())
    for item in SURFACES.values():
        if [*dataset] == [item.name]:
            return dataset[item.name]
    return dataset
