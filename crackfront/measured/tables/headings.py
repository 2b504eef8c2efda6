"""Headings of columns: their names, their units, and which of them a reader asked for."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass

from crackfront.measured.tables.number_cells import cells_between
from crackfront.surfaces.written_units import is_unit

_BRACKETS = re.compile(r"[\[(]([^\[\]()]*+(?:\([^()]*+\)[^\[\]()]*+)?+)[\])]")
"""A unit in brackets, which may have brackets in it: (um^2/(cycles/um))."""

_BEHIND_SIGN = re.compile(r"(?P<name>.*\w)(?:_|\s*,\s*)(?P<unit>[^\W\d]\S*)")
"""A unit behind a comma or an underscore: `Load, uN` and `force_uN`."""

_LONGEST = 300
"""Letters of the longest heading whose unit is looked for."""

_WITHOUT_UNIT = ("", "1", "-")
"""Units of pure numbers."""

_DIMENSIONS = ("m", "N", "s", "1/m", "m^2", "m^3", "m^4", "Pa", "J/m^2", "N/m")
"""SI units of what the columns of tables are."""

_LINE_OF_NAMES = re.compile(r"^columns?\s*:\s*", re.IGNORECASE)
_MARKUP = re.compile(r"</?su[bp]>")
_COMMENT_SIGNS = "#%! "
_IN_BRACKETS = re.compile(r"[\[(][^\[\]()]++[\])]")
_SEPARATORS = (";", "\t", ",", r"\s{2,}", r"\s+")


@dataclass(frozen=True, slots=True)
class Heading:
    """Heading of a column."""

    text: str
    """As it is written."""
    name: str
    """Without its unit."""
    unit: str
    """Empty if there is none."""

    @property
    def plain_name(self) -> str:
        """The name in lower case and with blanks for underscores."""
        return self.name.replace("_", " ").strip().lower()


def heading(text: str) -> Heading:
    """Name and unit of a column, as in `force (uN)`, `force / uN`, `force_uN` or `Load, uN`.

    Examples
    --------
    >>> heading("Contact radius [um]")
    Heading(text='Contact radius [um]', name='Contact radius', unit='um')
    """
    text = text.strip()
    name, unit = _name_and_unit(text) if len(text) <= _LONGEST else (text, "")
    return Heading(text, name.strip(), "" if unit.strip() in _WITHOUT_UNIT else unit.strip())


def _name_and_unit(text: str) -> tuple[str, str]:
    brackets = list(_BRACKETS.finditer(text))
    if brackets:
        # Of several brackets, as in `PSD (um^3) (one-sided)`, one has the unit.
        units = [
            bracket for bracket in brackets if len(brackets) > 1 and is_measured(bracket[1].strip())
        ]
        bracket = (units or brackets[-1:])[0]
        return text[: bracket.start()] + text[bracket.end() :], bracket[1]
    name, _, unit = map(str.strip, text.partition("/"))
    if unit and (re.search(r"\s/\s", text) or is_measured(unit)):
        return name, unit
    behind = _BEHIND_SIGN.fullmatch(text)
    if behind and is_measured(behind["unit"]):
        return behind["name"], behind["unit"]
    return text, ""


def is_measured(unit: str) -> bool:
    """Whether a text is a unit of a quantity that tables have."""
    return unit not in _WITHOUT_UNIT and any(is_unit(unit, dimension) for dimension in _DIMENSIONS)


def headings_above(
    lines: Sequence[str], n_column: int
) -> tuple[tuple[str, ...], tuple[Heading, ...]]:
    """Titles and headings in the lines above the rows of a table.

    Parameters
    ----------
    lines : sequence of str
        Lines above the rows, also comments; the last ones may have names, and units below them.
    n_column : int
        Cells of a row.

    Returns
    -------
    tuple of str, tuple of Heading
        Lines that are not headings, without signs of comments; a heading for each column, none
        if no line has one for each.
    """
    texts = [_MARKUP.sub("", line.strip().lstrip(_COMMENT_SIGNS)) for line in lines]
    texts = [line for line in texts if line.strip(" -=")]
    last = heading_cells(texts[-1], n_column) if texts else ()
    if len(texts) > 1 and last and are_units(last):
        names = heading_cells(texts[-2], n_column)
        below = headings_with_units(names or ("",) * n_column, last)
        return tuple(texts[: -2 if names else -1]), below
    return tuple(texts[:-1] if last else texts), tuple(map(heading, last))


def heading_cells(
    line: str, n_column: int, separators: Sequence[str] = _SEPARATORS
) -> tuple[str, ...]:
    """Cells of a line of headings, one for each column; none where it has another number of them.

    The separators are characters, or regular expressions of blanks, of which the first that fits
    counts.
    """
    line = _LINE_OF_NAMES.sub("", line)
    for separator in separators:
        names = line.strip().strip(";")
        split = (
            cells_between(names, separator) if len(separator) == 1 else re.split(separator, names)
        )
        cells = tuple(cell.strip().strip('"') for cell in split)
        if len(cells) == n_column and all(cells):
            return cells
    # Names and units between single blanks, as in x [um] z [nm].
    brackets = list(_IN_BRACKETS.finditer(line))
    if len(brackets) != n_column:
        return ()
    ends = [0, *(bracket.end() for bracket in brackets)]
    return tuple(line[start:end] for start, end in itertools.pairwise(ends))


def are_units(cells: Sequence[str]) -> bool:
    """Whether all cells of a line are units, in brackets or not, or say that there is none."""
    units = [cell.strip("[]() ") for cell in cells]
    return any(units) and all(cell in _WITHOUT_UNIT or is_measured(cell) for cell in units)


def headings_with_units(names: Sequence[str], units: Sequence[str]) -> tuple[Heading, ...]:
    """Headings whose units have a line of their own."""
    bare_units = (unit.strip("[]() ") for unit in units)
    return tuple(
        Heading(name.strip(), name.strip(), "" if unit in _WITHOUT_UNIT else unit)
        for name, unit in zip(names, bare_units, strict=True)
    )


def matching(headings: Sequence[Heading], pattern: str) -> list[int]:
    """Places of the columns whose whole name matches a regular expression, in any case."""
    return [
        place
        for place, column in enumerate(headings)
        if re.fullmatch(pattern, column.plain_name, re.IGNORECASE)
    ]


def listed(headings: Sequence[Heading]) -> str:
    """Headings for a message."""
    return ", ".join(repr(column.text) for column in headings) or "none"
