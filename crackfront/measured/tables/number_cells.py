"""Cells of a line: their separator, and which of them are numbers."""

from __future__ import annotations

import contextlib
import csv
import itertools
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

COMMENT = "#"
"""What a comment begins with."""

Splitter = Callable[[str], list[str]]
"""Splits a line into its cells."""

_NUMBER = re.compile(r"[-+]?(?:\d++[.,]?\d*+|[.,]\d++)(?:[eE][-+]?\d+)?")
"""A number with a decimal point or comma; possessive, so of linear cost."""

_WITHOUT_VALUE = re.compile(r"(?:nan|n/?a|null|bad|infinite|[-+]?inf(?:inity)?|-+)?", re.IGNORECASE)
"""A cell that says that the value is missing."""

_ROW = re.compile(
    r'(?:[\s\d.,;+\-eE"]++|\b(?:nan|n/?a|null|bad|inf(?:inite|inity)?)\b)*+', re.IGNORECASE
)
"""A line of nothing but numbers, separators and missing values; possessive, so of linear cost."""

_SAMPLE = 1000
"""Rows by which the separator is chosen."""

_BLANKS_OR_SIGNS = re.compile(r"[\s,;]+")
_COMMA_BEFORE_BLANK = re.compile(r",(?=\s|$)")
_QUOTED = re.compile(r'"([^"]*)"')
_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?|[-+]?\d+,")


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with a decimal point or a decimal comma."""
    return _NUMBER.fullmatch(cell) is not None


def is_without_value(cell: str) -> bool:
    """Whether a cell is empty, or says that the value is missing, as nan or -."""
    return _WITHOUT_VALUE.fullmatch(cell) is not None


def commented_cells(cells: Sequence[str]) -> list[str]:
    """Cells of a comment without its sign.

    Examples
    --------
    >>> commented_cells(["#", "1.5", "2"]), commented_cells(["#1.5", "2"])
    (['1.5', '2'], ['1.5', '2'])
    """
    first = cells[0].lstrip(f"{COMMENT} ")
    return [first, *cells[1:]] if first else list(cells[1:])


def is_commented_row(cells: Sequence[str], width: int, separator: str | None) -> bool:
    """Whether a comment amid rows is a row, of whose numbers the sign may replace the first.

    Parameters
    ----------
    cells : sequence of str
        Cells of the comment.
    width : int
        Cells of a row.
    separator : str or None
        What stands between cells; None for blanks, behind which a single number is a comment, as
        the number of a series.
    """
    numbers = commented_cells(cells)
    if not all(is_number(cell) or is_without_value(cell) for cell in numbers):
        return False
    if len(numbers) < 2:
        is_row = separator is not None and len(cells) == width
    else:
        is_row = width - 1 <= len(numbers) <= width
    return is_row and any(map(is_number, numbers))


def commented_row_error(path: Path, line: int, cells: Sequence[str]) -> ValueError:
    """Error at a row of numbers that begins as a comment."""
    return ValueError(
        f"{path}, line {line}: {' '.join(cells)[:40]!r} begins as a comment and continues as a row "
        f"of numbers; write the number or nan in place of {COMMENT}, or remove the line"
    )


def cells_between(line: str, separator: str | None) -> list[str]:
    """Cells of a line, without blanks and quotes around them.

    Parameters
    ----------
    line : str
        Cells in quotes may contain the separator.
    separator : str or None
        A single character; None for blanks.

    Examples
    --------
    >>> cells_between('"Load, uN", Radius', ",")
    ['Load, uN', 'Radius']
    """
    cells = line.split(separator)
    if separator is not None and '"' in line:
        cells = [line]
        if separator in without_quoted(line):
            # A cell that is too long for csv is not a number or a heading.
            with contextlib.suppress(csv.Error):
                cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    return [cell.strip().strip('"') for cell in cells]


def without_quoted(line: str) -> str:
    """A line without its cells in quotes, whose separators do not count."""
    return _QUOTED.sub("", line)


def decimal_sign(path: Path, numbers: Iterable[tuple[int, Iterable[str]]]) -> str | None:
    """Decimal sign of the numbers in a table.

    Parameters
    ----------
    path : Path
        The file, for messages.
    numbers : iterable
        Lines by their numbers, each with its cells that are numbers.

    Returns
    -------
    str or None
        A point, a comma, or None if all numbers are whole.

    Raises
    ------
    ValueError
        If numbers have both signs; it names the line of the rarer one.
    """
    first: dict[str, tuple[int, str]] = {}
    count = {",": 0, ".": 0}
    for line, cells in numbers:
        joined = " ".join(cells)
        for sign in ",.":
            if sign in joined:
                count[sign] += 1
                if sign not in first:
                    first[sign] = line, next(cell for cell in joined.split() if sign in cell)
    if len(first) < 2:
        return next(iter(first), None)
    rare, usual = sorted(count, key=count.__getitem__)
    line, cell = first[rare]
    raise ValueError(
        f"{path}, line {line}: {cell!r} is not a number with {usual!r} for decimals, as in line "
        f"{first[usual][0]}; the table has numbers with decimal points and with decimal commas, so "
        "write all of them alike"
    )


def splitter(lines: Iterable[str]) -> Splitter:
    """What splits the lines of a text into cells, by the separators in most rows of numbers."""
    rows = list(itertools.islice((line for line in lines if _looks_like_row(line)), _SAMPLE))

    def most(has: Callable[[str], object]) -> bool:
        return 2 * sum(map(bool, map(has, rows))) > len(rows)

    if most(lambda row: '"' in row):
        between = "".join(map(without_quoted, rows)).strip()
        separator = between[0] if between else " "
        return lambda line: [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
    if most(lambda row: ";" in row):
        return _split_at(";", rows)
    if not most(lambda row: "," in row):
        return str.split
    if not most(lambda row: len(row.split()) > 1):
        # One comma a line and no points: two columns of whole numbers, or decimals of one column.
        is_one_column = most(lambda row: row.count(",") == 1 and "." not in row)
        if is_one_column and not _is_monotonic([row.partition(",")[0] for row in rows]):
            return str.split
        return _split_at(",", rows)
    if most(_COMMA_BEFORE_BLANK.search):
        if any("," in _COMMA_BEFORE_BLANK.sub(" ", row) for row in rows):
            return lambda line: _COMMA_BEFORE_BLANK.sub(" ", line).split()
        return _split_at(",", rows)
    if most(lambda row: any(map(_DECIMAL_COMMA.fullmatch, row.split()))):
        return str.split
    return _split_at_any


def _looks_like_row(line: str) -> bool:
    return _ROW.fullmatch(line) is not None and any(map(str.isdigit, line))


def _split_at_any(line: str) -> list[str]:
    return [cell for cell in _BLANKS_OR_SIGNS.split(line) if cell]


def _split_at(separator: str, rows: Sequence[str]) -> Splitter:
    """What splits lines at a separator, without the columns that are empty in all of the rows."""
    split = [[cell.strip() for cell in row.split(separator)] for row in rows]
    if any(len(cell.split()) > 1 for cells in split for cell in cells):
        return _split_at_any
    width = max(map(len, split))
    n_empty = 0
    while n_empty < width and not any("".join(row[width - n_empty - 1 :]) for row in split):
        n_empty += 1

    def cells(line: str) -> list[str]:
        parts = list(map(str.strip, line.split(separator)))
        while parts and not parts[-1] and len(parts) > width - n_empty:
            parts.pop()
        return parts if any(parts) else []

    return cells


def _is_monotonic(cells: Sequence[str]) -> bool:
    """Whether whole numbers ascend or descend all along."""
    try:
        steps = [int(after) - int(before) for before, after in itertools.pairwise(cells)]
    except ValueError:
        return True
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)
