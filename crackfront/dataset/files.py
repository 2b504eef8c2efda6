"""Files: written whole or not at all, with their origin; read whole or refused."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from crackfront.provenance import Provenance, utc_now
from crackfront.records import Variable


class UnreadableFileError(ValueError):
    """A file that is missing, truncated, or not what its reader needs."""


def labelled(variable: Variable, values: Any) -> tuple[tuple[str, ...], Any, dict[str, str]]:
    """A variable with its values, as xarray wants it."""
    return variable.dims, values, variable.attributes


def write_dataset(path: Path, dataset: xr.Dataset, origin: Provenance) -> None:
    """Write a dataset as netCDF with its origin, atomically.

    Parameters
    ----------
    path : Path
        File; its folder is created.
    dataset : xarray.Dataset
        What to write.
    origin : Provenance
        Where it comes from.
    """
    stamped = dataset.assign_attrs(asdict(origin), date=utc_now())
    encoding: dict[str, dict[str, Any]] = {
        str(name): {"_FillValue": None}
        for name, values in stamped.variables.items()
        if np.issubdtype(values.dtype, np.floating)
    }
    for name, values in stamped.variables.items():
        if values.ndim > 1 and str(name) in encoding:
            encoding[str(name)] |= {"zlib": True, "shuffle": True, "complevel": 1}
    replace_atomically(
        path,
        lambda part: stamped.to_netcdf(part, engine="netcdf4", encoding=encoding),
    )


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically."""
    replace_atomically(path, lambda part: part.write_text(text, encoding="utf-8"))


def replace_atomically(path: Path, write: Callable[[Path], Any]) -> None:
    """Let a function write a file beside the final one, and rename it once it is on disk."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # A name of its own: after a killed controller two writers of one file do happen.
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=".part", dir=path.parent)
    os.close(handle)
    part = Path(name)
    try:
        write(part)
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        part.chmod(0o666 & ~_UMASK)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def read_dataset(path: Path) -> xr.Dataset:
    """Dataset of a file, in memory.

    Raises
    ------
    UnreadableFileError
        If there is no such file or it is no complete netCDF file.
    """
    if not path.is_file():
        raise UnreadableFileError(f"{path} does not exist; check the name")
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
            return dataset.load()
    except (OSError, RuntimeError, ValueError) as error:
        raise UnreadableFileError(
            f"{path} is no complete netCDF file; remove it or write it again"
        ) from error


def read_attributes(path: Path) -> dict[str, Any]:
    """What a file says of itself.

    Raises
    ------
    UnreadableFileError
        If there is no such file or it is no complete netCDF file.
    """
    return {str(name): value for name, value in read_dataset(path).attrs.items()}


def _umask() -> int:
    """Permissions that new files of this process do not get."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


_UMASK = _umask()
