"""Files of fields: surfaces on a periodic tile."""

from __future__ import annotations

from pathlib import Path

from crackfront.core.adhesion import AdhesionMap
from crackfront.data.files import UnreadableFileError, read_dataset
from crackfront.simulate.given import surface_adhesion
from crackfront.simulate.si_units import SURFACES

_REAL = "fiu"
"""Kinds of types of numpy that are real numbers."""

_COPIES = 6
"""Memory of a field in use over that of its values: as numbers of double precision, as splines."""


def read_field(path: Path) -> AdhesionMap:
    """Work of adhesion of a surface in a file, as of `surface_adhesion`.

    Parameters
    ----------
    path : Path
        netCDF file with `height(x, y)` or `work_of_adhesion(x, y)`.

    Raises
    ------
    ValueError
        If the file is missing or truncated, or its content is no surface.
    """
    dataset = read_dataset(path, copies=_COPIES)
    names = [item.name for item in SURFACES.values() if item.name in dataset]
    if not names:
        raise UnreadableFileError(
            f"{path}: the file has no surface (it has: {', '.join(map(str, dataset.data_vars))}); "
            f"name its variable {' or '.join(item.name for item in SURFACES.values())}"
        )
    values = dataset[names[-1]]
    for name, part in {values.name: values, **values.coords}.items():
        if part.dtype.kind not in _REAL:
            raise UnreadableFileError(f"{path}: {name} is {part.dtype}; it must be real numbers")
    try:
        return surface_adhesion(values)
    except ValueError as error:
        raise UnreadableFileError(f"{path}: {error}") from error
