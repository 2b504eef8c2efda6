"""Files of records: dataclasses whose fields say what they are in a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from crackfront.dataset.files import UnreadableFileError, labelled, read_dataset, write_dataset
from crackfront.provenance import Provenance
from crackfront.records import variables

Record = TypeVar("Record")


def write_record(path: Path, record: Any, origin: Provenance, **attributes: str) -> None:
    """Write a record, one variable a field.

    Parameters
    ----------
    path : Path
        netCDF file.
    record : dataclass
        A record whose fields were made by :func:`crackfront.records.variable`.
    origin : Provenance
        Where it comes from.
    **attributes : str
        What else the file says of itself.
    """
    values = {
        item.name: labelled(item, getattr(record, item.name)) for item in variables(type(record))
    }
    write_dataset(path, xr.Dataset(values, attrs=attributes), origin)


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
    dataset = read_dataset(path)
    known = variables(kind)
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
    return kind(
        **{
            item.name: values if item.dims else values.item()
            for item in known
            for values in (np.asarray(dataset[item.name]),)
        }
    )
