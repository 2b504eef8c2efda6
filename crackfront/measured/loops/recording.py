"""Columns of a recorded loop: force, contact radius and displacement from a table, in SI units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.tables.headed_table import table_of_numbers
from crackfront.measured.tables.headings import Heading, listed, matching
from crackfront.measured.tables.parsed_table import Table
from crackfront.surfaces.written_units import is_unit, unit_value

UNITS = {"force": "N", "radius": "m", "displacement": "m"}
"""The columns of a loop and their SI units."""

_NAMES = {
    "force": r"(normal |measured )?(force|load)|f|fn|p",
    "radius": r"(contact )?(radius|diameter|area)|a",
    "displacement": r"(stage |measured )?(displacement|penetration|indentation|depth)|delta|δ|d",
}
"""What headings call the columns."""


@dataclass(frozen=True, slots=True)
class Recording:
    """Columns of a loop, row by row in the order of time.

    Attributes
    ----------
    force : (n_row,) array or None
        Normal force, positive where it pushes. (Units: N)
    radius : (n_row,) array or None
        Contact radius; 0 or NaN out of contact. (Units: m)
    displacement : (n_row,) array or None
        Displacement of the sphere's mount towards the surface. (Units: m)
    """

    force: Array | None
    radius: Array | None
    displacement: Array | None

    def __post_init__(self) -> None:
        names = [name for name in UNITS if getattr(self, name) is not None]
        columns = [getattr(self, name) for name in names]
        if len(columns) < 2:
            raise ValueError(
                f"a loop needs two of {', '.join(UNITS)}, and has {' and '.join(names) or 'none'}; "
                "give another one"
            )
        if len({column.shape for column in columns}) > 1 or columns[0].ndim != 1:
            raise ValueError(
                "the columns of a loop are not of one length; give a value for each row"
            )


def read_recording(path: Path, named: Mapping[str, str], units: Mapping[str, str]) -> Recording:
    """Read the columns of a loop from a table.

    Parameters
    ----------
    path : Path
        Text with a line of headings: separated by tabs, semicolons, commas or spaces, with decimal
        points or commas, in any encoding that scans may have; lines before the headings are
        skipped.
    named : mapping
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
    table = table_of_numbers(path)
    places = _places(table, named)
    columns: dict[str, Array | None] = dict.fromkeys(UNITS)
    for (name, place), values in zip(
        places.items(), table.numbers(list(places.values())), strict=True
    ):
        column = _in_si(table, name, table.headings[place], values, units.get(name))
        # A column without a number is as good as none.
        columns[name] = column if np.any(np.isfinite(column)) else None
    n_column = sum(column is not None for column in columns.values())
    if n_column < 2:
        raise ValueError(
            f"a loop needs two of {', '.join(UNITS)}, and {path} has {n_column}; its headings are "
            f"{listed(table.headings)}, so name its columns, as in --force 'Load (mN)'"
        )
    return Recording(**columns)


def _places(table: Table, named: Mapping[str, str]) -> dict[str, int]:
    """Places of the columns of force, radius and displacement that a table has."""
    headings = table.headings
    requested = {name: text.strip().lower() for name, text in named.items()}
    written = [{heading.text.lower(), heading.plain_name} for heading in headings]
    places = {}
    for name, pattern in _NAMES.items():
        if name in requested:
            candidates = [n for n, names in enumerate(written) if requested[name] in names]
            if not candidates:
                raise ValueError(
                    f"{table.path} lacks a column {named[name]!r}; its headings are "
                    f"{listed(headings)}"
                )
        else:
            candidates = [
                n for n in matching(headings, pattern) if not written[n] & {*requested.values()}
            ]
        # An area next to the radius has the same values again.
        radii = [n for n in candidates if headings[n].plain_name.endswith("radius")]
        candidates = radii if len(radii) == 1 else candidates
        if len(candidates) > 1:
            option = "contact-radius" if name == "radius" else name
            both = ", ".join(repr(headings[n].text) for n in candidates)
            raise ValueError(
                f"{table.path} has {len(candidates)} columns of {name}: {both}; name one by "
                f"--{option}"
            )
        if candidates:
            [places[name]] = candidates
    return places


def _in_si(table: Table, name: str, heading: Heading, values: Array, option: str | None) -> Array:
    """A column in SI units, by the unit in its heading or in an option."""
    unit = option or heading.unit
    if not unit:
        symbol = "mN" if name == "force" else "um^2" if _is_area(name, heading, "") else "um"
        raise ValueError(
            f"{table.path}: the column {heading.text!r} lacks a unit; give one, as in "
            f"--{name}-unit {symbol}"
        )
    column = _converted(name, heading, values, unit)
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
    return column / 2 if name == "radius" and "diameter" in heading.plain_name else column


def _is_area(name: str, heading: Heading, unit: str) -> bool:
    """Whether a column of radii has areas, by its heading or, if this is not clear, its unit."""
    named = heading.plain_name
    if name != "radius" or re.search("radius|diameter", named):
        return False
    return "area" in named or is_unit(unit, "m^2")
