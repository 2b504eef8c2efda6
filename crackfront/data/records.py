"""Files of records: dataclasses whose fields say what they are in a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.core.records import Variable, variables
from crackfront.data.files import (
    UnreadableFileError,
    labelled,
    labelled_fields,
    read_dataset,
    write_dataset,
)
from crackfront.data.provenance import Provenance

Record = TypeVar("Record")


def write_record(path: Path, record: Any, origin: Provenance, **attributes: str | float) -> None:
    """Write a record, one variable a field.

    Parameters
    ----------
    path : Path
        netCDF file.
    record : dataclass
        A record whose fields were made by :func:`crackfront.core.records.variable`.
    origin : Provenance
        Where it comes from.
    **attributes : str or float
        What else the file says of itself.
    """
    write_dataset(path, xr.Dataset(labelled_fields(record), attrs=attributes), origin)


def write_records(
    path: Path, rows: Sequence[Any], along: str, origin: Provenance, **attributes: str | float
) -> None:
    """Write records of one kind, along a dimension that counts them.

    Parameters
    ----------
    path : Path
        netCDF file.
    rows : sequence of dataclass
        One record or more.
    along : str
        Name of the dimension.
    origin : Provenance
        Where they come from.
    **attributes : str or float
        What else the file says of itself.
    """
    write_dataset(path, xr.Dataset(stacked(rows, along), attrs=attributes), origin)


def stacked(rows: Sequence[Any], along: str) -> dict[str, tuple[Any, ...]]:
    """Variables of records of one kind, along a dimension that counts them.

    Parameters
    ----------
    rows : sequence of dataclass
        One record or more.
    along : str
        Name of the dimension.
    """
    return {
        item.name: labelled(item, np.array([getattr(row, item.name) for row in rows]))
        for item in variables(type(rows[0]), along)
    }


def unstacked(path: Path, dataset: xr.Dataset, kind: type[Any], along: str) -> list[dict[str, Any]]:
    """Fields of the records that :func:`stacked` made variables of.

    Parameters
    ----------
    path : Path
        Where the dataset comes from.
    dataset : xarray.Dataset
        The variables.
    kind : type
        Dataclass of the records.
    along : str
        Name of the dimension that counts them.

    Raises
    ------
    UnreadableFileError
        If a variable is missing or has other dimensions.
    """
    columns = _columns(path, dataset, kind, variables(kind, along))
    return [
        {name: values[row].item() if values.ndim == 1 else values[row] for name, values in columns}
        for row in range(dataset.sizes[along])
    ]


def read_records(path: Path, kind: type[Record], along: str) -> tuple[Record, ...]:
    """Records that :func:`write_records` wrote.

    Parameters
    ----------
    path : Path
        netCDF file.
    kind : type
        Their dataclass.
    along : str
        Dimension along which they stand.

    Raises
    ------
    UnreadableFileError
        If the file is missing, truncated, or holds no such records.
    """
    return tuple(kind(**row) for row in unstacked(path, read_dataset(path), kind, along))


def read_record(path: Path, kind: type[Record]) -> Record:
    """Record that :func:`write_record` wrote.

    Parameters
    ----------
    path : Path
        netCDF file.
    kind : type
        Its dataclass.

    Raises
    ------
    UnreadableFileError
        If the file is missing, truncated, or holds no such record.
    """
    columns = _columns(path, read_dataset(path), kind, variables(kind))
    return kind(**{name: values if values.ndim else values.item() for name, values in columns})


def largest_differences(one: Path, other: Path) -> dict[str, float]:
    """How much two files of one kind of record differ.

    Parameters
    ----------
    one, other : Path
        netCDF files.

    Returns
    -------
    dict of float
        Of every variable of both the largest difference, relative to the largest magnitude in the
        second; of texts 0 or 1. Infinite where the shapes disagree.

    Raises
    ------
    UnreadableFileError
        If a file is missing or truncated, or the variables are not the same.
    """
    first, second = read_dataset(one), read_dataset(other)
    unequal = set(first.variables) ^ set(second.variables)
    if unequal:
        raise UnreadableFileError(
            f"{one} and {other} are not of one kind: only one of them has "
            f"{', '.join(sorted(map(str, unequal)))}"
        )
    return {
        str(name): _difference(np.asarray(first[name]), np.asarray(second[name]))
        for name in first.variables
    }


def _difference(one: NDArray[Any], other: NDArray[Any]) -> float:
    """Largest difference of two arrays, relative to the second."""
    if one.shape != other.shape:
        return math.inf
    if not np.issubdtype(other.dtype, np.number):
        return float(np.any(one != other))
    if np.array_equal(one, other, equal_nan=True):
        return 0.0
    scale = float(np.nanmax(np.abs(other))) or 1.0
    return float(np.max(np.nan_to_num(np.abs(one - other), nan=math.inf))) / scale


def _columns(
    path: Path, dataset: xr.Dataset, kind: type[Any], known: Sequence[Variable]
) -> list[tuple[str, NDArray[Any]]]:
    """Values of all variables of a record."""
    wrong = [
        item.name
        for item in known
        if item.name not in dataset or dataset[item.name].dims != item.dims
    ]
    if wrong:
        raise UnreadableFileError(
            f"{path} holds no {kind.__name__}: {', '.join(wrong)} is missing or of other "
            "dimensions; compute it again"
        )
    return [(item.name, np.asarray(dataset[item.name])) for item in known]
