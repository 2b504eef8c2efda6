"""Rows of numbers in a text, with or without headings: of maps, points and spectral densities."""

from __future__ import annotations

import collections
import csv
import itertools
import re
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from crackfront.measured.tables.encodings import decoded
from crackfront.measured.tables.headings import headings_above
from crackfront.measured.tables.number_cells import decimal_sign, is_number, splitter
from crackfront.measured.tables.parsed_table import Table

if TYPE_CHECKING:
    from pandas import DataFrame

_WITHOUT_VALUE = {"bad", "infinite"}
"""Words for a missing value that Python does not read as a number."""

_WORD = re.compile("|".join(_WITHOUT_VALUE), re.IGNORECASE)

_NUMBER_OF_NAME = re.compile(
    r"(?:^|[^\d\s])\s*[:=：]\s*([-+]?\d+(?:[.,]\d+)+(?:[eE][-+]?\d+)?)(?![.,:/\-]?\d)"
)
"""A number with a decimal sign that a line above the rows gives to a name."""

_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[.,]\d{3})+")
"""A number whose decimal sign may as well separate thousands."""

_FEWEST_COLUMNS = 5
"""Columns from which a first column, or row, of consecutive numbers counts the others."""

_FEWEST_ROWS = 8
"""Rows from which this is so."""

_MOST_COLUMNS = 8
"""Columns of the widest table whose headings are read; wider ones are maps."""

_ADVICE = "export the scan again, or write nan where a value is missing"

_Rows = list[tuple[int, list[str]]]
"""Rows of numbers: their lines, from 0, and their cells."""


@dataclass(frozen=True, slots=True)
class NumberTables:
    """Tables of numbers in a text, one below the other."""

    tables: tuple[Table, ...]
    """All cells are numbers, with decimal points, or nan."""
    below: tuple[str, ...]
    """Lines below the last table."""

    @property
    def n_column(self) -> int:
        """Number of columns that most rows have."""
        counts = collections.Counter[int]()
        for table in self.tables:
            counts[table.n_column] += len(table.cells)
        [(n_column, _)] = counts.most_common(1)
        return n_column

    @property
    def main_table(self) -> Table:
        """The first table with the number of columns that most rows have."""
        return next(table for table in self.tables if table.n_column == self.n_column)

    @property
    def head(self) -> list[str]:
        """Lines above the main table."""
        before = self.tables[: self.tables.index(self.main_table)]
        return [*_plain_lines(before), *self.main_table.above]

    @property
    def plain_text(self) -> str:
        """The whole text with blanks between cells, points as decimals, and nan for no value."""
        return "\n".join([*_plain_lines(self.tables), *self.below, ""])

    def check_single_table(self) -> None:
        """Raise if another table follows the main one."""
        place = self.tables.index(self.main_table) + 1
        for table in self.tables[place : place + 1]:
            texts = [line.strip() for line in table.above]
            row = next(row for row, text in enumerate(texts) if text.lstrip("#"))
            raise ValueError(
                f"{table.path}, line {table.lines[0] - len(texts) + row}: {texts[row][:40]!r} "
                "stands between points; export one scan into one file"
            )


def _plain_lines(tables: Sequence[Table]) -> list[str]:
    lines: list[str] = []
    for table in tables:
        lines += [*table.above, *map(" ".join, table.cells.to_numpy())]
    return lines


def number_tables(path: Path) -> NumberTables | None:
    """Tables of numbers in a text of any encoding, separator and decimal sign.

    The numbers of rows and columns next to a matrix are left out.

    Parameters
    ----------
    path : Path
        Any file.

    Returns
    -------
    NumberTables or None
        None if the file is not a text, or lacks a row of numbers.

    Raises
    ------
    ValueError
        If a row is damaged, or numbers have two decimal signs; it names the line. Or if a quote is
        not closed.
    OSError
        If the file cannot be opened.
    """
    text = decoded(path)
    if text is None:
        return None
    lines = text.split("\n")
    split = splitter(lines)
    try:
        table = [split(line) for line in lines]
    except csv.Error as error:
        raise ValueError(f"{path}: {error}; close all quotes, or leave them out") from error
    is_row = [_is_row_of_numbers(cells) for cells in table]
    if not any(is_row):
        return None
    numbers = ((place + 1, cells) for place, cells in enumerate(table) if is_row[place])
    sign = decimal_sign(path, numbers)
    _check_rows(path, lines, table, is_row)
    tables, start = [], 0
    for rows in _blocks(lines, table, is_row):
        first, last = rows[0][0], rows[-1][0]
        above = [
            _with_point(path, start + number, line, sign)
            for number, line in enumerate(lines[start:first])
        ]
        tables.append(_table(path, above, rows))
        start = last + 1
    below = (_with_point(path, start + n, line, sign) for n, line in enumerate(lines[start:]))
    return NumberTables(tuple(tables), tuple(below))


def _is_row_of_numbers(cells: Sequence[str]) -> bool:
    """Whether cells are numbers, or without a value."""
    return any(cells) and all(not cell or _is_value(cell) for cell in cells)


def _is_value(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return is_number(cell) or cell.lower() in _WITHOUT_VALUE
    return True


def _blocks(
    lines: Sequence[str], table: Sequence[list[str]], is_row: Sequence[bool]
) -> Iterator[_Rows]:
    """Rows without a text between them.

    Single numbers above wider rows, such as a count of points, do not belong to these.
    """
    rows: _Rows = []
    for place, cells in enumerate(table):
        if is_row[place]:
            if rows and len(rows[-1][1]) == 1 < len(cells):
                rows = []
            rows.append((place, cells))
        elif rows and lines[place].strip().lstrip("#"):
            yield rows
            rows = []
    if rows:
        yield rows


def _table(path: Path, above: Sequence[str], rows: _Rows) -> Table:
    """A table of rows, without numbers that only count its rows and columns."""
    import pandas

    texts = [_plain_cells(cells) for _, cells in rows]
    cells = _without_counts(pandas.DataFrame(texts, dtype=object))
    places = [place + 1 for place, _ in rows][len(rows) - len(cells) :]
    n_column = cells.shape[1]
    titles, headings = headings_above(above, n_column) if n_column <= _MOST_COLUMNS else ((), ())
    return Table(path, tuple(above), titles, headings, cells, tuple(places))


def _plain_cells(cells: list[str]) -> list[str]:
    """Cells with points as decimals and nan for no value."""
    joined = " ".join(cells)
    if "," not in joined and all(cells) and not _WORD.search(joined):
        return cells
    return [
        "nan" if not cell or cell.lower() in _WITHOUT_VALUE else cell.replace(",", ".")
        for cell in cells
    ]


def _with_point(path: Path, place: int, line: str, sign: str | None) -> str:
    """A line above rows with points as decimals; its numbers must not have two readings."""
    named = _NUMBER_OF_NAME.search(line)
    if named is None:
        return line
    text = named[1]
    n_comma, n_point = text.count(","), text.count(".")
    may_be_thousands = _THOUSANDS.fullmatch(text) is not None
    if not n_comma and (n_point > 1 or sign != "," or not may_be_thousands):
        return line  # A number as every reader understands it, a date or a version.
    if n_comma == 1 and not n_point and (sign == "," or (sign is None and not may_be_thousands)):
        start, end = named.span(1)
        return line[:start] + text.replace(",", ".") + line[end:]
    wrong = "the rows have points" if sign == "." else "it has two readings"
    raise ValueError(
        f"{path}, line {place + 1}: the number is {text!r}, and {wrong}; write the head and the "
        "rows with points, as in 20.9"
    )


def _check_rows(
    path: Path, lines: Sequence[str], table: Sequence[Sequence[str]], is_row: Sequence[bool]
) -> None:
    """Raise at the first line that is meant as a row of numbers and is not one."""
    width = statistics.mode(map(len, itertools.compress(table, is_row)))
    first = list(is_row).index(True)
    before = 0
    for number, (line, cells) in enumerate(zip(lines, table, strict=True)):
        where = f"{path}, line {number + 1}:"
        if is_row[number]:
            if before > 1 and len(cells) != before:
                raise ValueError(
                    f"{where} the row has {len(cells)} numbers and the row above has {before}; "
                    f"{_ADVICE}"
                )
            before = len(cells)
        elif line.strip():
            before = 0
            wrong = _wrong_cell(cells, width if number < first else None)
            if wrong is not None:
                raise ValueError(
                    f"{where} number {wrong + 1} of the row is {cells[wrong]!r}, which is not a "
                    f"number; {_ADVICE}"
                )


def _wrong_cell(cells: Sequence[str], width: int | None) -> int | None:
    """Place of what is not a number in a row; None if the line is a text, comment or heading."""
    wrong = [place for place, cell in enumerate(cells) if cell and not _is_value(cell)]
    if not wrong or cells[0].startswith("#") or 2 * len(wrong) > len(cells):
        return None
    if width is not None:
        has_words = any(any(map(str.isalpha, cells[place])) for place in wrong)
        if len(cells) != width or (has_words and 4 * len(wrong) > len(cells)):
            return None
    return wrong[0]


def _without_counts(cells: DataFrame) -> DataFrame:
    """A matrix without a column, and a row, that count its rows and columns."""
    if cells.shape[1] < _FEWEST_COLUMNS or cells.shape[0] < _FEWEST_ROWS:
        return cells
    top, firsts = list(cells.iloc[0]), list(cells[0])
    if _are_counts(top) or (_are_counts(top[1:]) and _are_counts(firsts[1:])):
        cells, firsts = cells.iloc[1:], firsts[1:]
    if _are_counts(firsts):
        cells = cells.iloc[:, 1:]
    return cells.set_axis(range(cells.shape[1]), axis="columns").reset_index(drop=True)


def _are_counts(cells: Sequence[str]) -> bool:
    """Whether cells are consecutive whole numbers from 0 or 1."""
    return any(
        all(cell == str(number) for number, cell in enumerate(cells, start)) for start in (0, 1)
    )
