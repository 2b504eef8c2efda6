"""Files of what the library returned: a surface or a loop, saved and loaded."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from crackfront.core.arguments import refuse_other_type
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import read_dataset, write_dataset
from crackfront.surfaces.si_units import SURFACES, as_dataset


def save_result(result: xr.DataArray | xr.Dataset, path: str | Path) -> None:
    """Save a surface or a loop as netCDF with checksums of its arrays, atomically.

    An array that is damaged later is refused wherever it is read. What `to_netcdf` of xarray writes
    can be read as well, but has no checksums.

    Parameters
    ----------
    result : xarray.DataArray or xarray.Dataset
        What a function of the library returned.
    path : str or Path
        The file; it is replaced if it is there.

    Raises
    ------
    ValueError
        If the array has no name.
    TypeError
        If the result is of another type, or netCDF cannot hold an attribute.
    OSError
        If the file cannot be written.
    """
    refuse_other_type("path", path, (str, PathLike), "the path of a file")
    dataset = as_dataset(result, "result", "a surface or a loop").copy()
    dataset.attrs = _storable(dataset.attrs)
    for part in dataset.variables.values():
        part.attrs = _storable(part.attrs)
    # The library of netCDF would take ~ for the home folder, and nothing else here.
    write_dataset(Path(path).expanduser(), dataset, provenance())


def _storable(attributes: Mapping[Any, Any]) -> dict[Any, Any]:
    """Attributes as netCDF holds them: truth as 0 or 1; TypeError if it cannot hold one."""
    known = (str, bool, int, float, np.generic, np.ndarray, list, tuple)
    for name, value in attributes.items():
        refuse_other_type(f"attribute {name}", value, known, "numbers or a text, or drop it")
    truths = {key: int(one) for key, one in attributes.items() if isinstance(one, bool | np.bool_)}
    return {**attributes, **truths}


def load_result(path: str | Path) -> xr.DataArray | xr.Dataset:
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
        If the file is missing, damaged, or no netCDF.
    TypeError
        If an argument is of another type.
    """
    refuse_other_type("path", path, (str, PathLike), "the path of a file")
    dataset = read_dataset(Path(path).expanduser())
    single = [one.name for one in SURFACES.values() if [*dataset] == [one.name]]
    return dataset[single[0]] if single else dataset
