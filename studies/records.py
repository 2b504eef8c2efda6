"""Files of records: dataclasses whose fields say what they are in a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.core.variables import Variable, variables
from crackfront.simulate.labels import labelled, labelled_fields
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.storage import UnreadableFileError, read_dataset, write_dataset

Record = TypeVar("Record")


def write_record(path: Path, record: Any, origin: Provenance, **attributes: str | float) -> None:
    """Write a record to a netCDF file, one variable a field, and attributes of the file.

    Its fields were made by :func:`crackfront.core.variables.variable`.
    """
    write_dataset(path, xr.Dataset(labelled_fields(record), attrs=attributes), origin)


def write_records(
    path: Path, rows: Sequence[Any], along: str, origin: Provenance, **attributes: str | float
) -> None:
    """Write one record or more of one kind, as :func:`write_record`, along a dimension."""
    write_dataset(path, xr.Dataset(stacked(rows, along), attrs=attributes), origin)


def stacked(rows: Sequence[Any], along: str) -> dict[str, tuple[Any, ...]]:
    """Variables of one record or more of one kind, along a dimension that counts them."""
    items = variables(type(rows[0]), along)
    return {item.name: labelled(item, _column(item, rows)) for item in items}


def _column(variable: Variable, rows: Sequence[Any]) -> NDArray[Any]:
    """Values of a variable in all records."""
    return np.array([getattr(row, variable.name) for row in rows])


def read_record(path: Path, kind: type[Record]) -> Record:
    """Record of a kind that :func:`write_record` wrote; fields left out of it are None.

    UnreadableFileError if the file is missing, truncated, or of another kind of record.
    """
    columns = _columns(path, read_dataset(path), kind)
    return kind(**{name: values if values.ndim else values.item() for name, values in columns})


def read_records(path: Path, kind: type[Record], along: str) -> tuple[Record, ...]:
    """Records that :func:`write_records` wrote along a dimension; as :func:`read_record`."""
    dataset = read_dataset(path)
    columns = _columns(path, dataset, kind, along)
    values = {name: column.tolist() if column.ndim == 1 else column for name, column in columns}
    return tuple(
        kind(**{name: column[row] for name, column in values.items()})
        for row in range(dataset.sizes[along])
    )


def thinned(size: int, most: int) -> slice:
    """Slice that keeps equally spaced points, at most `most` of them.

    Examples
    --------
    >>> list(range(10))[thinned(10, 4)]
    [0, 3, 6, 9]
    """
    return slice(None, None, math.ceil(size / most))


def _columns(
    path: Path, dataset: xr.Dataset, kind: type[Any], *along: str
) -> list[tuple[str, NDArray[Any]]]:
    """Values of all variables of records of a kind."""
    dims = {name: values.dims for name, values in dataset.variables.items()}
    absent = {item.name for item in fields(kind) if item.default is None} - dims.keys()
    present = [item for item in variables(kind, *along) if item.name not in absent]
    wrong = [item.name for item in present if dims.get(item.name) != item.dims]
    if wrong:
        raise UnreadableFileError(
            f"{path} does not contain a {kind.__name__}: {', '.join(wrong)} is missing or of other "
            "dimensions; compute it again"
        )
    return [(item.name, np.asarray(dataset[item.name])) for item in present]
