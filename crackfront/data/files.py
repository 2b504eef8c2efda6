"""Files: written whole or not at all, with their origin; read whole or refused."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Callable, Collection
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from crackfront.core.variables import Variable, variables
from crackfront.data.provenance import Provenance, utc_now

PACKED: dict[str, Any] = {"zlib": True, "shuffle": True, "complevel": 1}
"""How arrays are compressed."""

_SECONDS_TO_WRITE = 3600.0
"""Time after which a file that is not finished will not be."""

_UMASK = os.umask(0)
os.umask(_UMASK)
"""Permissions that new files of this process do not get."""


class UnreadableFileError(ValueError):
    """A file that is missing, truncated, or not what its reader needs."""


def labelled(variable: Variable, values: Any) -> tuple[tuple[str, ...], Any, dict[str, str]]:
    """A variable with its values, as xarray wants it."""
    return variable.dims, values, variable.attributes


def labelled_fields(record: Any, *along: str) -> dict[str, Any]:
    """Variables of a record, its fields made by `variable`; None is left out.

    The dimensions in `along` come before those that the fields state.
    """
    values = ((item, getattr(record, item.name)) for item in variables(type(record), *along))
    return {item.name: labelled(item, value) for item, value in values if value is not None}


def write_dataset(
    path: Path,
    dataset: xr.Dataset,
    origin: Provenance,
    fill: Callable[[Path], None] | None = None,
) -> None:
    """Write a dataset as netCDF with its origin, atomically; the folder is created.

    Where `fill` is given, it writes more into the file before that gets its name.
    """
    stamped = dataset.assign_attrs(asdict(origin), date=utc_now())
    encoding: dict[str, dict[str, Any]] = {
        str(name): {"_FillValue": None} | (PACKED if values.ndim > 1 else {})
        for name, values in stamped.variables.items()
        if np.issubdtype(values.dtype, np.floating)
    }

    def write(part: Path) -> None:
        stamped.to_netcdf(part, engine="netcdf4", encoding=encoding)
        if fill is not None:
            fill(part)

    replace_atomically(path, write)


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


def leftover_parts(folder: Path) -> list[Path]:
    """Files that writers began in a folder and did not finish within the last hour.

    Their age is that against a file which is created now, by the clock of the file system.
    """
    with tempfile.NamedTemporaryFile(prefix=".", suffix=".part", dir=folder) as new:
        now = Path(new.name).stat().st_mtime
        parts = [path for path in folder.glob(".*.part") if path.name != Path(new.name).name]
        return [path for path in parts if now - _changed(path) > _SECONDS_TO_WRITE]


def _changed(path: Path) -> float:
    """Moment of the last change of a file; never, where its writer has just renamed it."""
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return math.inf


def read_dataset(path: Path, names: Collection[str] | None = None) -> xr.Dataset:
    """Dataset of a netCDF file, in memory.

    Parameters
    ----------
    path : Path
        The file.
    names : collection of str, optional
        Variables to read beside the coordinates, those that are there; by default all.

    Raises
    ------
    UnreadableFileError
        If there is no such file or it is no complete netCDF file.
    """
    if not path.is_file():
        raise UnreadableFileError(f"{path} does not exist; check the name")
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
            others = [] if names is None else [name for name in dataset if name not in names]
            return dataset.drop_vars(others).load()
    except (OSError, RuntimeError, ValueError) as error:
        raise UnreadableFileError(
            f"{path} is no complete netCDF file; write it again, or name another"
        ) from error


def read_attributes(path: Path) -> dict[str, Any]:
    """What a file says of itself; refused as by :func:`read_dataset`."""
    return {str(name): value for name, value in read_dataset(path, ()).attrs.items()}
