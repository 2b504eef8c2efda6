"""Grids in netCDF files that state their units in `units`, unlike the library's convention."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from crackfront.core.arguments import regular_file
from crackfront.measured.scan.grids_reader import Grid
from crackfront.measured.scan.points import even_line
from crackfront.measured.scan.scan_files import check_points
from crackfront.surfaces.written_units import unit_value

_BEGINS = (b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF")
"""First bytes of netCDF files."""

_SUFFIXES = {".nc", ".nc4", ".cdf", ".netcdf"}
"""Suffixes of files that may have coordinates with units; others go to the library."""


def is_netcdf(path: Path) -> bool:
    """Whether a file is netCDF; OSError if it cannot be opened, ValueError if it is a pipe."""
    with regular_file(path).open("rb") as file:
        return file.read(4) in _BEGINS


def netcdf_grids(path: Path) -> list[Grid]:
    """Grids of a netCDF file with units; none where it follows the library's convention.

    ValueError, of one sentence, where coordinates are not evenly spaced or have no unit of length,
    or where the file claims more points than fit in memory.
    """
    if path.suffix.lower() not in _SUFFIXES or not is_netcdf(path):
        return []
    import netCDF4

    try:
        dataset = netCDF4.Dataset(path)
    except OSError:
        return []  # Damaged; the library says how.
    with dataset:
        if _is_conventional(dataset):
            return []
        names = [name for name in dataset.variables if _is_grid(dataset, name)]
        # A compressed file of some kilobytes may claim more than fits in memory.
        if names:
            check_points(path, [sum(int(dataset[name].size) for name in names)])
        return [_grid(path, dataset, name) for name in names]


def _is_grid(dataset: Any, name: str) -> bool:
    """Whether a variable has a unit and one or two dimensions, each with its coordinates."""
    variable = dataset[name]
    return (
        name not in dataset.dimensions
        and 0 < len(variable.dimensions) < 3
        and np.issubdtype(variable.dtype, np.number)
        and all(
            dimension in dataset.variables and dataset[dimension].dimensions == (dimension,)
            for dimension in variable.dimensions
        )
        and _unit(variable) is not None
    )


def _is_conventional(dataset: Any) -> bool:
    """Whether the library reads all that a file says: x, y and heights with one `unit`."""
    variables = dataset.variables
    if "heights" not in variables or dataset.data_model.startswith("NETCDF4"):
        return False
    read = [variables[name] for name in ("x", "y", "heights") if name in variables]
    units = {getattr(variable, "unit", None) for variable in read}
    return len(units) == 1 and not (
        variables["heights"].dimensions == ("y", "x")
        or any(hasattr(variable, "units") for variable in read)
    )


def _unit(variable: Any) -> str | None:
    """Unit that a variable states."""
    unit = getattr(variable, "units", None) or getattr(variable, "unit", None) or ""
    return str(unit).strip() or None


def _grid(path: Path, dataset: Any, name: str) -> Grid:
    """A variable on its coordinates."""
    variable = dataset.variables[name]
    values: np.ma.MaskedArray[Any, Any] = np.ma.masked_invalid(
        np.ma.asarray(variable[...], dtype=float)
    )
    if "mask" in dataset.variables and dataset["mask"].shape == values.shape:
        values = np.ma.masked_where(np.ma.filled(dataset["mask"][...], 1) != 0, values)
    size = []
    for axis, dimension in enumerate(variable.dimensions):
        coordinate = dataset.variables[dimension]
        unit = _unit(coordinate)
        try:
            factor = unit_value(unit or "", "m")
        except ValueError as error:
            problem = f"states {dimension} in {unit}" if unit else f"states no unit of {dimension}"
            raise ValueError(
                f"{path} {problem}, and {name} in {_unit(variable)}; write both in units of length"
            ) from error
        places = np.asarray(np.ma.filled(coordinate[...], np.nan), dtype=float)
        if hasattr(coordinate, "length"):
            size.append(factor * float(coordinate.length))
        else:
            size.append(factor * even_line(path, places, places).size[0])
        if places[0] > places[-1]:
            values = np.flip(values, axis)
    if [dimension[:1].lower() for dimension in variable.dimensions] == ["y", "x"]:
        values, size = values.T, size[::-1]
    unit = _unit(variable)
    try:
        return Grid(name, values * unit_value(unit or "", "m"), tuple(size))
    except ValueError:
        return Grid(name, values, tuple(size), unit)
