"""Rows of numbers in a text, with or without headings: of maps, points and spectral densities."""

from __future__ import annotations

import collections
import itertools
import re
import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from crackfront.measured.tables.encodings import decoded
from crackfront.measured.tables.headings import headings_above
from crackfront.measured.tables.number_cells import (
    COMMENT,
    cells_between,
    commented_cells,
    commented_row_error,
    decimal_sign,
    is_commented_row,
    is_number,
    is_row_of_numbers,
    is_without_value,
)
from crackfront.measured.tables.parsed_table import Table
from crackfront.measured.tables.separators import separator_of_numbers

if TYPE_CHECKING:
    from pandas import DataFrame

_NUMBER_OF_NAME = re.compile(
    r"(?:^|[^\d\s])\s*[:=：]\s*([-+]?\d+(?:[.,]\d+)+(?:[eE][-+]?\d+)?)(?![.,:/\-]?\d)"
)
"""A number with a decimal sign that a line above the rows gives to a name."""

_THOUSANDS = re.compile(r"[-+]?\d{1,3}(?:[.,]\d{3})+")
"""A number whose decimal sign may as well separate thousands."""

_SIGN_AND_BLANK = re.compile(r"[,;](?=\s|$)")

_ENOUGH_ROWS = 1000
"""Rows by which the separator is chosen."""

_FEWEST_COLUMNS = 5
"""Columns from which a first column, or row, of consecutive numbers counts the others."""

_FEWEST_ROWS = 8
"""Rows from which this is so."""

_MOST_COLUMNS = 8
"""Columns of the widest table whose headings are read; wider ones are maps."""

_ADVICE = "export the scan again, or write nan where a value is missing"

_UNEVEN = 0.1
"""Departure of steps from their mean, over it, that positions above a matrix may have."""

_RULE = re.compile(r"-*|n/?a|null", re.IGNORECASE)
"""Missing values that alone may be a rule below headings, or a word."""

_Kind = Literal["text", "numbers", "written numbers"]
"""A line is a text, or a row as Python reads numbers, or a row with other signs for them."""


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
        If a row is damaged or begins as a comment, or numbers have two decimal signs; it names the
        line.
    OSError
        If the file cannot be opened.
    """
    text = decoded(path)
    if text is None:
        return None
    lines = text.split("\n")
    table = _split(lines)
    kinds = _kinds(table)
    if set(kinds) == {"text"}:
        return None
    sign = _decimal_sign(path, table, kinds)
    _check_rows(path, lines, table, kinds)
    tables, start = [], 0
    for places in _blocks(lines, table, kinds):
        above = [
            _with_point(path, start + number, line, sign)
            for number, line in enumerate(lines[start : places[0]])
        ]
        rows = [
            table[place] if kinds[place] == "numbers" else _plain_cells(table[place])
            for place in places
        ]
        tables.append(_table(path, above, places, rows))
        start = places[-1] + 1
    below = (_with_point(path, start + n, line, sign) for n, line in enumerate(lines[start:]))
    return NumberTables(tuple(tables), tuple(below))


def _split(lines: Sequence[str]) -> list[list[str]]:
    """Cells of every line, without the empty ones behind the last column."""
    rows = list(itertools.islice(filter(is_row_of_numbers, lines), _ENOUGH_ROWS))
    separator = separator_of_numbers(rows)
    if separator is None:
        # Blanks may follow other separators, as in 1,5, 2,5 and 1 2 3;
        return [cells_between(_SIGN_AND_BLANK.sub(" ", line), None) for line in lines]
    n_column = max(_n_filled(cells_between(row, separator)) for row in rows)
    table = []
    for line in lines:
        cells = cells_between(line, separator)
        n_filled = _n_filled(cells)
        table.append(cells[: max(n_column, n_filled)] if n_filled else [])
    return table


def _n_filled(cells: Sequence[str]) -> int:
    """Number of cells up to the last one that is not empty."""
    n_cell = len(cells)
    while n_cell and not cells[n_cell - 1]:
        n_cell -= 1
    return n_cell


def _kinds(table: Sequence[Sequence[str]]) -> list[_Kind]:
    """Kind of every line by its cells."""
    kinds: list[_Kind] = []
    for place, cells in enumerate(table):
        kind: _Kind = "text"
        if all(map(_is_float, cells)):
            kind = "numbers" if cells else "text"
        elif all(not cell or _is_value(cell) for cell in cells):
            is_below_row = place > 0 and kinds[-1] != "text"
            is_as_wide = is_below_row and 1 < len(cells) == len(table[place - 1])
            is_in_map = is_below_row and len(cells) > _MOST_COLUMNS
            if is_as_wide or is_in_map or not all(map(_RULE.fullmatch, cells)):
                kind = "written numbers"
        kinds.append(kind)
    return kinds


def _is_float(cell: str) -> bool:
    """Whether Python reads a cell as a number, or as nan or inf."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _is_value(cell: str) -> bool:
    return _is_float(cell) or is_number(cell) or is_without_value(cell)


def _decimal_sign(path: Path, table: Sequence[list[str]], kinds: Sequence[_Kind]) -> str | None:
    """Decimal sign of the rows, None if all numbers are whole; see :func:`decimal_sign`."""
    rows = [place for place, kind in enumerate(kinds) if kind != "text"]
    if any("," in cell for place in rows if kinds[place] != "numbers" for cell in table[place]):
        return decimal_sign(path, ((place + 1, table[place]) for place in rows))
    return "." if any("." in cell for place in rows for cell in table[place]) else None


def _blocks(
    lines: Sequence[str], table: Sequence[list[str]], kinds: Sequence[_Kind]
) -> Iterator[list[int]]:
    """Places of rows without a text between them.

    Single numbers above wider rows, such as a count of points, do not belong to these.
    """
    places: list[int] = []
    for place, kind in enumerate(kinds):
        if kind != "text":
            if places and len(table[places[-1]]) == 1 < len(table[place]):
                places = []
            places.append(place)
        elif places and lines[place].strip().lstrip("#"):
            yield places
            places = []
    if places:
        yield places


def _table(
    path: Path, above: Sequence[str], places: Sequence[int], rows: Sequence[list[str]]
) -> Table:
    """A table of rows, without numbers that only count its rows and columns."""
    import pandas

    cells = _without_counts(pandas.DataFrame(rows, dtype=object))
    numbers = [place + 1 for place in places[len(places) - len(cells) :]]
    n_column = cells.shape[1]
    titles, headings = headings_above(above, n_column) if n_column <= _MOST_COLUMNS else ((), ())
    return Table(path, tuple(above), titles, headings, cells, tuple(numbers))


def _plain_cells(cells: Sequence[str]) -> list[str]:
    """Cells with points as decimals and nan for no value."""
    return [
        "nan" if is_without_value(cell) and not _is_float(cell) else cell.replace(",", ".")
        for cell in cells
    ]


def _with_point(path: Path, place: int, line: str, sign: str | None) -> str:
    """A line above rows with points as decimals; its numbers must not have two readings."""
    match = _NUMBER_OF_NAME.search(line)
    if match is None:
        return line
    number = match[1]
    n_comma, n_point = number.count(","), number.count(".")
    may_be_thousands = _THOUSANDS.fullmatch(number) is not None
    if n_comma == 0:
        is_date_or_version = n_point > 1
        if is_date_or_version or sign != "," or not may_be_thousands:
            return line
    elif n_comma == 1 and n_point == 0:
        is_decimal_comma = sign == "," or (sign is None and not may_be_thousands)
        if is_decimal_comma:
            start, end = match.span(1)
            return line[:start] + number.replace(",", ".") + line[end:]
    problem = "the rows have points" if sign == "." else "it has two readings"
    raise ValueError(
        f"{path}, line {place + 1}: the number is {number!r}, and {problem}; write the head and "
        "the rows with points, as in 20.9"
    )


def _check_rows(
    path: Path, lines: Sequence[str], table: Sequence[Sequence[str]], kinds: Sequence[_Kind]
) -> None:
    """Raise at the first line that is meant as a row of numbers and is not one."""
    widths = [len(cells) for cells, kind in zip(table, kinds, strict=True) if kind != "text"]
    width = statistics.mode(widths)
    first = next(place for place, kind in enumerate(kinds) if kind != "text")
    width_above = 0
    for place, kind in enumerate(kinds):
        cells = table[place]
        if kind != "text":
            if width_above > 1 and len(cells) != width_above:
                raise ValueError(
                    f"{path}, line {place + 1}: the row has {len(cells)} numbers and the row above "
                    f"has {width_above}; {_ADVICE}"
                )
            width_above = len(cells)
        elif lines[place].strip():
            width_above = 0
            is_head = place < first
            if not cells and is_head:
                continue
            if not cells:
                raise ValueError(
                    f"{path}, line {place + 1}: all cells of the row are empty; write nan where a "
                    "value is missing, or remove the line"
                )
            if cells[0].startswith(COMMENT):
                _check_comment(path, place, cells, width, is_head=is_head)
            elif (wrong := _wrong_cell(cells, width, is_head=is_head)) is not None:
                raise ValueError(
                    f"{path}, line {place + 1}: number {wrong + 1} of the row is {cells[wrong]!r}, "
                    f"which is not a number; {_ADVICE}"
                )


def _wrong_cell(cells: Sequence[str], width: int, *, is_head: bool) -> int | None:
    """Place of what is not a number in a row; None if the line is a text or a heading."""
    wrong = [place for place, cell in enumerate(cells) if cell and not _is_value(cell)]
    if not wrong:
        return None
    has_words = any(_has_letter(cells[place]) for place in wrong)
    if 2 * len(wrong) > len(cells):
        has_numbers = any(map(is_number, cells))
        is_row = has_numbers and not has_words if is_head else has_numbers or not has_words
        return wrong[0] if is_row and len(cells) == width > _MOST_COLUMNS else None
    if is_head and (len(cells) != width or (has_words and 4 * len(wrong) > len(cells))):
        return None
    return wrong[0]


def _check_comment(
    path: Path, place: int, cells: Sequence[str], width: int, *, is_head: bool
) -> None:
    """Raise if a comment is a row of numbers; above a matrix it may be one of equal steps."""
    numbers = commented_cells(cells)
    if width <= _MOST_COLUMNS:
        is_row = not is_head and is_commented_row(cells, width, None)
    else:
        is_row = width - 1 <= len(numbers) <= width
        is_row = is_row and all(_is_value(cell) or not _has_letter(cell) for cell in numbers)
        if is_head:
            is_row = is_row and any(map(is_number, numbers)) and not _has_equal_steps(numbers)
    if is_row:
        raise commented_row_error(path, place + 1, cells)


def _has_letter(cell: str) -> bool:
    return any(map(str.isalpha, cell))


def _has_equal_steps(cells: Sequence[str]) -> bool:
    """Whether numbers ascend or descend by about equal steps, as positions do."""
    if not all(map(_is_float, cells)):
        return False
    steps = np.diff(np.array(cells, dtype=float))
    return bool(np.all(np.abs(steps - np.mean(steps)) < _UNEVEN * np.abs(np.mean(steps))))


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
