"""Tables of loops: their columns in SI units."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.loops.loop_columns import Places, column_places, unused_displacement
from crackfront.measured.loops.recording import UNITS, Recording
from crackfront.measured.tables.headed_table import table_of_numbers
from crackfront.measured.tables.headings import Heading, listed
from crackfront.measured.tables.number_cells import is_number, is_without_value
from crackfront.measured.tables.parsed_table import Table
from crackfront.surfaces.written_units import is_unit, unit_value


def read_recording(path: Path, names: Mapping[str, str], units: Mapping[str, str]) -> Recording:
    """Read the columns of a loop from a table.

    Parameters
    ----------
    path : Path
        Text with a line of headings: separated by tabs, semicolons, commas or spaces, with decimal
        points or commas, in any encoding that scans may have; lines before the headings are
        skipped.
    names : mapping
        Headings of columns that have other names than usual: of `force`, `radius`, `displacement`.
    units : mapping
        Units of columns whose headings have none.

    Returns
    -------
    Recording
        What the table has of the three columns.

    Raises
    ------
    ValueError
        If there are no two such columns, or a unit or a number cannot be read.
    OSError
        If the file cannot be opened.
    """
    table = _table(path)
    blocks = column_places(table, names)
    used = blocks[0]
    for name in units:
        if name not in used:
            raise ValueError(
                f"--{name}-unit is {units[name]}, and {path} lacks a column of {name}; its "
                f"headings are {listed(table.headings)}"
            )
    parts = [_columns(table, places, units) for places in blocks]
    columns = parts[0] if len(parts) == 1 else _joined(*parts)
    # A column without a number is as good as none.
    columns = {name: column for name, column in columns.items() if np.any(np.isfinite(column))}
    if len(columns) < 2:
        read = ", ".join(f"{table.headings[used[name]].text!r} is the {name}" for name in columns)
        raise ValueError(
            f"a loop needs two of {', '.join(UNITS)}, and {path} has {len(columns)}"
            f"{': ' if read else ''}{read}; its headings are {listed(table.headings)}, so name "
            f"its columns, as in {_example(table, used)}"
        )
    return Recording(
        **{name: columns.get(name) for name in UNITS},
        headings={name: table.headings[used[name]].text for name in columns},
        remarks=_remarks(table, used, len(blocks)),
    )


def _example(table: Table, places: Places) -> str:
    """Option that names a missing column: an unused one whose unit fits, or any."""
    used = [table.headings[place] for place in places.values()]
    for name in ("force", "displacement"):
        for heading in table.headings:
            fits = bool(heading.unit) and is_unit(heading.unit, UNITS[name])
            if name not in places and heading not in used and fits:
                return f"--{name} {heading.text!r}"
    return "--force 'Load (mN)'"


def _table(path: Path) -> Table:
    """The table of a file, without lines between its rows that are words, as headings again."""
    table = table_of_numbers(path)
    is_row = table.cells.map(is_number).any(axis="columns")
    is_row = (is_row | table.cells.map(is_without_value).all(axis="columns")).to_numpy(bool)
    lines = tuple(itertools.compress(table.lines, is_row))
    return replace(table, cells=table.cells[is_row].reset_index(drop=True), lines=lines)


def _columns(table: Table, places: Places, units: Mapping[str, str]) -> dict[str, Array]:
    """Columns of a loop, or of one of its branches, in SI units."""
    numbers = table.numbers(list(places.values()))
    return {
        name: _in_si(table, name, table.headings[place], values, units.get(name))
        for (name, place), values in zip(places.items(), numbers, strict=True)
    }


def _joined(approach: dict[str, Array], retraction: dict[str, Array]) -> dict[str, Array]:
    """Approach and retraction that stood side by side, one after the other in time."""
    first, second = (_recorded(part) for part in (approach, retraction))
    path = np.nan_to_num(second.get("displacement", second.get("radius", second["force"])))
    # The retraction may be written against the time, at the displacements of the approach.
    step = -1 if np.mean(path[: path.size // 3]) < np.mean(path[-path.size // 3 :]) else 1
    return {name: np.concatenate([first[name], second[name][::step]]) for name in first}


def _recorded(columns: dict[str, Array]) -> dict[str, Array]:
    """Columns without the rows in which all of them are empty."""
    is_recorded = np.any(np.isfinite([*columns.values()]), axis=0)
    return {name: column[is_recorded] for name, column in columns.items()}


def _remarks(table: Table, places: Places, n_block: int) -> tuple[str, ...]:
    """Sentences on columns that stand side by side, and on a displacement that was chosen."""
    remarks = []
    if n_block == 2:
        remarks.append(
            "Approach and retraction stand side by side in the table and were put one below the "
            "other."
        )
    unused = unused_displacement(table, places) if "displacement" in places else ""
    if unused:
        used = table.headings[places["displacement"]].text
        remarks.append(
            f"The displacement is the column {used!r}, not {unused!r}; --displacement {unused!r} "
            "chooses that one."
        )
    return tuple(remarks)


def _in_si(table: Table, name: str, heading: Heading, values: Array, option: str | None) -> Array:
    """A column in SI units, by the unit in its heading or in an option."""
    unit = option or heading.unit
    if not unit:
        symbol = "mN" if name == "force" else "um^2" if _is_area(name, heading, "") else "um"
        raise ValueError(
            f"{table.path}: the column {heading.text!r} lacks a unit; give one, as in "
            f"--{name}-unit {symbol}"
        )
    try:
        column = _converted(name, heading, values, unit)
    except ValueError as error:
        raise ValueError(f"{table.path}: column {heading.text!r}, {name}: {error}") from error
    if heading.unit and not np.array_equal(
        _converted(name, heading, values, heading.unit), column, equal_nan=True
    ):
        raise ValueError(
            f"{table.path}: the column {heading.text!r} has the unit {heading.unit}, and "
            f"--{name}-unit is {unit}; leave that out, or correct the heading"
        )
    return column


def _converted(name: str, heading: Heading, values: Array, unit: str) -> Array:
    """Values in SI units; radii also from contact areas or diameters, by heading and unit."""
    if _is_area(name, heading, unit):
        return np.sqrt(np.maximum(values * unit_value(unit, "m^2"), 0.0) / np.pi)
    column = values * unit_value(unit, UNITS[name])
    is_diameter = re.search("diameter|durchmesser", heading.plain_name)
    return column / 2 if name == "radius" and is_diameter else column


def _is_area(name: str, heading: Heading, unit: str) -> bool:
    """Whether a column of radii has areas, by its heading or, if this is not clear, its unit."""
    column_name = heading.plain_name
    if name != "radius" or re.search("radius|diameter|durchmesser", column_name):
        return False
    return bool(re.search("area|fläche|flaeche", column_name)) or is_unit(unit, "m^2")
