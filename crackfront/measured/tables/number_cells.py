"""Cells of a line, and which of them are numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

COMMENT = "#"
"""What a comment begins with."""

_NUMBER = re.compile(r"[-+]?(?:\d++[.,]?\d*+|[.,]\d++)(?:[eE][-+]?\d+)?")
"""A number with a decimal point or comma; possessive, so of linear cost."""

_WITHOUT_VALUE = re.compile(r"(?:nan|n/?a|null|bad|infinite|[-+]?inf(?:inity)?|-+)?", re.IGNORECASE)
"""A cell that says that the value is missing."""

_ROW = re.compile(
    r'(?:[\s\d.,;+\-eE"]++|\b(?:nan|n/?a|null|bad|inf(?:inite|inity)?)\b)*+', re.IGNORECASE
)
"""A line of nothing but numbers, separators and missing values; possessive, so of linear cost."""

QUOTED = re.compile(r'"[^"]*"')
"""A cell in quotes, whose separators do not count."""

_BETWEEN_BLANKS = re.compile(r'"[^"]*"|\S+')
"""A cell between blanks, which may contain blanks if it stands in quotes."""


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
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    if separator is None:
        cells = _BETWEEN_BLANKS.findall(line)
    else:
        cells, start = [], 0
        for part in QUOTED.sub(lambda quoted: "_" * len(quoted[0]), line).split(separator):
            end = start + len(part)
            cells.append(line[start:end])
            start = end + 1
    return [cell.strip().strip('"').strip() for cell in cells]


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


def is_row_of_numbers(line: str) -> bool:
    """Whether a line has nothing but numbers, separators and missing values."""
    return _ROW.fullmatch(line) is not None and any(map(str.isdigit, line))
