"""What stands between the cells of a text: a tab, a semicolon, a comma or blanks."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Sequence

from crackfront.measured.tables.number_cells import QUOTED, cells_between

_COMMA_AND_BLANK = re.compile(r",(?=\s|$)|(?<=\s),")


def fitting_separator(fits: Callable[[str], bool]) -> str | None:
    """The first of tab, semicolon and comma that fits a table; None for blanks.

    Commas are last, because they may be decimal signs between tabs or semicolons.
    """
    return next(filter(fits, "\t;,"), None)


def separator_of_numbers(rows: Sequence[str]) -> str | None:
    """Semicolon or comma between the numbers of most rows; None for blanks.

    Tabs are blanks here, because several may stand between two columns.

    Examples
    --------
    >>> separator_of_numbers(["1.5,2.5", "3.5,4.5"])
    ','
    >>> separator_of_numbers(["1,5;2,5", "3,5;4,5"])
    ';'
    >>> separator_of_numbers(["1,5 2,5", "3,5 4,5"]) is None
    True
    """

    def fits(separator: str) -> bool:
        if separator == "\t" or (separator == "," and _have_decimal_commas(rows)):
            return False
        return _are_most(_are_numbers(cells_between(row, separator)) for row in rows)

    return fitting_separator(fits)


def separator_of_headings(line: str) -> str:
    """Tab, semicolon or comma, whichever a line of headings contains most often."""
    return max("\t;,", key=QUOTED.sub("", line).count)


def _are_numbers(cells: Sequence[str]) -> bool:
    """Whether a row of numbers has several cells, and blanks do not separate numbers in them."""
    return len(cells) > 1 and all(len(cell.split()) < 2 for cell in cells)


def _have_decimal_commas(rows: Sequence[str]) -> bool:
    """Whether the commas in rows of numbers are decimal signs."""
    unquoted = [QUOTED.sub("", row).strip() for row in rows]
    if _are_most("." in row for row in rows):
        return False
    if _are_most(len(row.split()) > 1 for row in unquoted):
        # A comma next to a blank separates, and any others are decimal signs, as in 1,5, 2,5.
        return any("," in _COMMA_AND_BLANK.sub(" ", row) for row in unquoted)
    # One comma a line: two columns of whole numbers, or decimals of one column.
    is_pair = _are_most(row.count(",") == 1 for row in unquoted)
    return is_pair and not _is_monotonic([row.partition(",")[0] for row in unquoted])


def _are_most(conditions: Iterable[bool]) -> bool:
    values = list(conditions)
    return 2 * sum(values) > len(values)


def _is_monotonic(cells: Sequence[str]) -> bool:
    """Whether whole numbers ascend or descend all along."""
    try:
        steps = [int(after) - int(before) for before, after in itertools.pairwise(cells)]
    except ValueError:
        return True
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)
