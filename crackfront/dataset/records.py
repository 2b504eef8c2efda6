"""Files of records: dataclasses whose fields say what they are in a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.dataset.files import UnreadableFileError, labelled, read_dataset, write_dataset
from crackfront.provenance import Provenance
from crackfront.records import Variable, variables

Record = TypeVar("Record")


def write_record(path: Path, record: Any, origin: Provenance, **attributes: str | float) -> None:
    """Write a record, one variable a field.

    Parameters
    ----------
    path : Path
        netCDF file.
    record : dataclass
        A record whose fields were made by :func:`crackfront.records.variable`.
    origin : Provenance
        Where it comes from.
    **attributes : str or float
        What else the file says of itself.
    """
    values = {
        item.name: labelled(item, getattr(record, item.name)) for item in variables(type(record))
    }
    write_dataset(path, xr.Dataset(values, attrs=attributes), origin)


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
        item.name: labelled(
            replace(item, dims=(along, *item.dims)),
            np.array([getattr(row, item.name) for row in rows]),
        )
        for item in variables(type(rows[0]))
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
    known = [replace(item, dims=(along, *item.dims)) for item in variables(kind)]
    columns = _columns(path, dataset, kind, known)
    return [
        {name: values[row].item() if values.ndim == 1 else values[row] for name, values in columns}
        for row in range(dataset.sizes[along])
    ]


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
