"""Texts of heights: a matrix, or points on a line or a grid."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from crackfront.measured.scan.grids_reader import Grid, GridsReader
from crackfront.measured.scan.library import errors_as_sentences, in_metres, library_part
from crackfront.measured.scan.points import (
    HeadKind,
    are_points,
    check_no_positions,
    point_columns,
    read_points,
)
from crackfront.measured.scan.psd_recognition import check_no_spectrum
from crackfront.measured.scan.sides import length_unit
from crackfront.measured.tables.headings import Heading
from crackfront.measured.tables.number_tables import NumberTables
from crackfront.surfaces.written_units import is_unit

_HEADS: dict[str, HeadKind] = {
    "X;Y;valid": "hfm",
    "Scan Parameters": "dektak",
    "#": "comments",
}
"""First line of a text of points, and the function of the library that reads this head."""

_MATRIX_SIGNATURE = "aISO"
"""First line of a text in SDF, which the library reads as it is."""


def is_plain_text(text: NumberTables) -> bool:
    """Whether a text is read here, and not by a reader of the library."""
    first = text.tables[0]
    return not (first.above and first.above[0].startswith(_MATRIX_SIGNATURE))


def text_reader(path: Path, text: NumberTables) -> Any:
    """Reader of a text, of points or of a matrix of heights."""
    table = text.main_table
    first_line = (text.head or [""])[0]
    kind = next((name for begin, name in _HEADS.items() if first_line.startswith(begin)), None)
    headings: tuple[Heading, ...] = ()
    if kind in (None, "comments"):
        check_no_spectrum(path, text)
        if places := point_columns(path, table.headings):
            table = table.with_columns(places)
        headings = table.headings
    if kind == "dektak" or are_points(table):
        head = _stated_head(path, text, kind)
        if head is not None:
            text.check_single_table()
            unit, factor, info = head
            if unit is None:
                unit, factor = _stated_units(path, headings)
            points = read_points(table, kind)
            grid = Grid("default", points.heights * (factor or 1.0), points.size)
            return GridsReader("xyz", [grid], unit, info)
    for matrix in text.tables:
        check_no_positions(matrix)
    with errors_as_sentences(path, "text"):
        return library_part("IO").AscReader(io.StringIO(text.plain_text))


def _stated_head(
    path: Path, text: NumberTables, kind: HeadKind | None
) -> tuple[str | None, float | None, dict[str, Any]] | None:
    """Unit of points, factor of their heights and information; None if the head is of a matrix."""
    if kind is None:
        return None, None, {}
    library_part("IO").readers  # noqa: B018  # Its modules for texts import each other.
    read_head = getattr(library_part("IO.XYZ"), f"read_text_header_{kind}")
    head = io.StringIO("".join(f"{line}\n" for line in text.head))
    try:
        with errors_as_sentences(path, kind):
            *_, unit, factor, info = read_head(head, None, None)
    except ValueError as error:
        # The library says so where a head has the sides of a matrix.
        if isinstance(error.__cause__, library_part("Exceptions").FileFormatMismatch):
            return None
        raise
    return unit, factor, info


def _stated_units(path: Path, headings: Sequence[Heading]) -> tuple[str | None, float]:
    """Unit of the places of points, and the unit of their heights in it, by the headings.

    The unit is None where no column has one; ValueError where some have none, or places several.
    """
    lengths = [heading.unit for heading in headings if _is_length(heading.unit)]
    if not lengths:
        return None, 1.0
    units = [length_unit("", unit) for unit in lengths]
    if len(units) < len(headings) or len(set(units[:-1])) > 1:
        shown = ", ".join(
            f"{heading.name} ({heading.unit})" if heading.unit else heading.name
            for heading in headings
        )
        raise ValueError(
            f"{path}: its columns are {shown}; name the columns of the points x, y and z, each "
            "with its unit of length and x and y in the same, as in x (um),y (um),z (nm), which "
            "options do not replace"
        )
    place, height = units[0], units[-1]
    return place, in_metres(height, 1.0)[0] / in_metres(place, 1.0)[0]


def _is_length(unit: str) -> bool:
    """Whether a text is the name of a unit of length."""
    return unit != "" and not unit[0].isdigit() and is_unit(unit, "m")
