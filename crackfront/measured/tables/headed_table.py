"""Tables below a line of headings, whose cells may be any text: of loops and of samples."""

from __future__ import annotations

import csv
import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from crackfront.measured.tables.encodings import decoded
from crackfront.measured.tables.headings import (
    Heading,
    are_units,
    heading,
    heading_cells,
    headings_with_units,
)
from crackfront.measured.tables.number_cells import (
    COMMENT,
    cells_between,
    commented_row_error,
    is_commented_row,
    is_number,
    is_without_value,
)
from crackfront.measured.tables.parsed_table import Table
from crackfront.measured.tables.separators import fitting_separator, separator_of_headings

_BLANKS = (r"\s{2,}", r"\s+")
"""Blanks between headings, which may have single blanks in them."""

_SEPARATOR_LINE = re.compile(r'"?sep=([\t;,])"?\s*', re.IGNORECASE)
"""First line by which a file tells Excel its separator."""

_MOST_LINES_ABOVE = 1000
"""Lines among which the first row of numbers is looked for."""


def table_of_numbers(path: Path) -> Table:
    """The table of a text whose first row with two numbers stands below its headings.

    Lines above the headings are left out; units may stand in a line below the names.

    Parameters
    ----------
    path : Path
        Text of any encoding, with cells between tabs, semicolons, commas or blanks.

    Returns
    -------
    Table
        Of columns of numbers and of texts.

    Raises
    ------
    ValueError
        If the file is not a text or lacks such a row, a row has more cells than headings or alone
        fewer, a comment is a row of numbers, or a quote is not closed.
    OSError
        If the file cannot be opened.
    """
    lines = _text_lines(path)
    filled = [number for number, line in enumerate(lines) if line.strip()]
    separator, place = _layout(path, [lines[number] for number in filled])
    first = filled[place]
    n_column = len(cells_between(lines[first], separator))
    names = _names(lines[filled[place - 1]], separator, n_column) if place else []
    headings = tuple(map(heading, names))
    if place > 1 and names and are_units(names):
        units = names
        names = _names(lines[filled[place - 2]], separator, len(units))
        if len(names) == len(units):
            headings = headings_with_units(names, units)
    rows = list(_rows(path, lines, first, separator))
    _check_rows(path, rows, separator, len(headings))
    return _table(path, rows, separator, headings)


def table_of_texts(path: Path) -> Table:
    """The table of a text whose first line that is not a comment has the headings.

    A first line `sep=;`, as for Excel, states the separator.

    Parameters
    ----------
    path : Path
        Text of any encoding, with cells between tabs, semicolons or commas.

    Returns
    -------
    Table
        Of columns of texts.

    Raises
    ------
    ValueError
        If the file is not a text, a row has more cells than there are headings, or a quote is not
        closed.
    OSError
        If the file cannot be opened.
    """
    lines = _text_lines(path)
    stated = _SEPARATOR_LINE.fullmatch(lines[0])
    start = 1 if stated else 0
    comments = itertools.takewhile(
        lambda line: not line.strip() or line[0] == COMMENT, lines[start:]
    )
    above = (*lines[:start], *comments)
    first = len(above)
    if first == len(lines):
        return _table(path, iter(()), ",", ())
    separator = stated[1] if stated else separator_of_headings(lines[first])
    rows = _rows(path, lines, first, separator)
    _, names = next(rows)
    return replace(_table(path, rows, separator, tuple(map(heading, names))), above=above)


def _text_lines(path: Path) -> list[str]:
    text = decoded(path)
    if text is None:
        raise ValueError(f"{path} is not a text; export the table as CSV")
    return text.split("\n")


def _table(
    path: Path,
    numbered_rows: Iterable[tuple[int, list[str]]],
    separator: str | None,
    headings: tuple[Heading, ...],
) -> Table:
    """Rows below the headings, without comments and empty ones, filled up with empty cells."""
    import pandas

    width = len(headings)
    rows, numbers = [], []
    for number, cells in numbered_rows:
        if not any(cells) or cells[0].startswith(COMMENT):
            continue
        if any(cells[width:]):
            sign = "blanks" if separator is None else repr(separator)
            raise ValueError(
                f"{path}, line {number}: the row has {len(cells)} cells and there are "
                f"{width} headings; write a heading for every column, and quotes around cells that "
                f"contain {sign}"
            )
        rows.append((cells + [""] * width)[:width])
        numbers.append(number)
    frame = pandas.DataFrame(rows, columns=range(width), dtype=object)
    return Table(path, (), (), headings, frame, tuple(numbers), separator)


def _check_rows(
    path: Path, rows: Iterable[tuple[int, list[str]]], separator: str | None, width: int
) -> None:
    """Raise at a comment that is a row of numbers, and at a single row with too few cells.

    Several such rows, and the last one, have empty cells at their end.
    """
    width_above, short_row = width, None
    for number, cells in rows:
        if cells and cells[0].startswith(COMMENT) and is_commented_row(cells, width, separator):
            raise commented_row_error(path, number, cells)
        if not any(map(is_number, cells)):
            continue
        if short_row is not None and len(cells) >= width:
            line, n_cell = short_row
            raise ValueError(
                f"{path}, line {line}: the row has {n_cell} cells and there are {width} headings; "
                "write nan where a value is missing"
            )
        is_short = len(cells) < width <= width_above
        short_row = (number, len(cells)) if is_short else None
        width_above = len(cells)


def _rows(
    path: Path, lines: Sequence[str], first: int, separator: str | None
) -> Iterator[tuple[int, list[str]]]:
    """Number of the last line of every row, from 1, and its cells; cells in quotes may have two."""
    if separator is None:
        yield from enumerate((cells_between(line, None) for line in lines[first:]), first + 1)
        return
    reader = csv.reader(
        (f"{line}\n" for line in lines[first:]), delimiter=separator, skipinitialspace=True
    )
    try:
        for cells in reader:
            yield first + reader.line_num, [cell.strip() for cell in cells]
    except csv.Error as error:
        raise ValueError(
            f"{path}, line {first + reader.line_num}: {error}; close the quote in this line or "
            "above it"
        ) from error


def _layout(path: Path, lines: Sequence[str]) -> tuple[str | None, int]:
    """Separator of a table, None for blanks, and the place of its first row of numbers."""

    def fits(separator: str) -> bool:
        place = _first_row(lines, separator)
        # A decimal comma is not a separator: both cells of 1,5 would be numbers.
        return place is not None and (
            separator != "," or _has_names(*_row_and_names(lines, place, separator))
        )

    separator = fitting_separator(fits)
    place = _first_row(lines, separator)
    if place is None:
        raise ValueError(
            f"{path} lacks a line with two numbers or more below a line of headings; write one "
            "heading for each column, as in Force (uN),Contact radius (um), and semicolons between "
            "cells with decimal commas"
        )
    return separator, place


def _first_row(lines: Sequence[str], separator: str | None) -> int | None:
    """Place of the first row of numbers between separators."""
    for place in range(min(len(lines), _MOST_LINES_ABOVE)):
        if _is_row(*_row_and_names(lines, place, separator)):
            return place
    return None


def _row_and_names(
    lines: Sequence[str], place: int, separator: str | None
) -> tuple[list[str], list[str]]:
    """Cells of a line, and of the line above it."""
    cells = cells_between(lines[place], separator)
    return cells, _names(lines[place - 1], separator, len(cells)) if place else []


def _names(line: str, separator: str | None, n_column: int) -> list[str]:
    """Names in a line above rows of so many cells."""
    line = line.strip().lstrip("#% ")
    if separator is None and (names := heading_cells(line, n_column, _BLANKS)):
        return list(names)
    return cells_between(line, separator)


def _is_row(cells: Sequence[str], names: Sequence[str]) -> bool:
    """Whether cells are two numbers or more, or below headings a number next to empty cells."""
    n_filled = sum(cell != "" for cell in cells)
    n_value = sum(is_number(cell) or (cell != "" and is_without_value(cell)) for cell in cells)
    has_headings = _has_names(cells, names) and not any(map(is_number, names))
    if n_value < n_filled:
        return n_value >= 2 and has_headings
    if has_headings and len(cells) > 1:
        return n_value >= 1
    return n_value >= 2


def _has_names(cells: Sequence[str], names: Sequence[str]) -> bool:
    """Whether there is a heading for each cell but an empty one behind a closing separator."""
    return len(names) == len(cells) or (not cells[-1] and len(names) == len(cells) - 1)
