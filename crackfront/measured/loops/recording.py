"""Columns of a recorded loop: force, contact radius and displacement from a table, in SI units."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.scan.text import decoded
from crackfront.surfaces.written_units import is_unit, unit_value

UNITS = {"force": "N", "radius": "m", "displacement": "m"}
"""The columns of a loop and their SI units."""

_HEADS = {
    "force": r"(normal |measured )?(force|load)|f|fn|p",
    "radius": r"(contact )?(radius|diameter|area)|a",
    "displacement": r"(stage |measured )?(displacement|penetration|indentation|depth)|delta|δ|d",
}
"""What the head of a column is called, in lower case and without its unit."""

_HEAD = re.compile(r"(?P<name>.*?)\s*(?:[\[(](?P<bracket>[^])]+)[])]|/\s*(?P<slash>\S+))?\s*")
"""A name and its unit: `force (mN)`, `force [mN]`, `force / mN`."""

_SEPARATORS = ("\t", ";", ",")

_MOST_HEADS = 1000
"""Lines among which the first one of numbers is looked for."""


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
        known = [getattr(self, name) for name in UNITS if getattr(self, name) is not None]
        if len(known) < 2:
            raise ValueError(
                f"a loop needs two of {', '.join(UNITS)}, and has {len(known)}; name its columns, "
                "as in --force 'Load (mN)'"
            )
        if len({column.shape for column in known}) > 1 or known[0].ndim != 1:
            raise ValueError(
                "the columns of a loop are not of one length; give a value for each row"
            )


def read_recording(path: Path, named: Mapping[str, str], units: Mapping[str, str]) -> Recording:
    """Read the columns of a loop from a table.

    Parameters
    ----------
    path : Path
        Text with a line of heads: separated by tabs, semicolons, commas or spaces, with decimal
        points or commas, in any encoding that scans may have; lines before the heads are skipped.
    named : mapping
        Heads of columns where they are not called as usual: of `force`, `radius`, `displacement`.
    units : mapping
        Units of columns whose heads have none.

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
    text = decoded(path)
    if text is None:
        raise ValueError(f"{path} is no text; export the loop as a table, as CSV")
    lines = [line for line in text.split("\n") if line.strip()]
    separator, first = _layout(path, lines)
    width = len(_cells(lines[first], separator))
    heads = _heads(lines[first - 1], separator, width) if first > 0 else []
    below: Sequence[str] = ()
    if first > 1 and heads and all(_is_unit(head) for head in heads):
        # A line of units stands below that of the names.
        below, heads = heads, _heads(lines[first - 2], separator, width)
    chosen = dict(_chosen(path, heads, named))
    table = _numbers(path, lines[first:], separator, len(heads), list(chosen.values()))
    columns: dict[str, Array | None] = dict.fromkeys(UNITS)
    for name, place in chosen.items():
        head = heads[place]
        written = _unit(head) or (below[place].strip("[]() ") if below else "")
        unit = units.get(name) or written
        if not unit:
            symbol = "mN" if name == "force" else "um^2" if _is_area(name, head, "") else "um"
            raise ValueError(
                f"{path}: the column {head!r} has no unit; give one, as in --{name}-unit {symbol}"
            )
        found = _in_si(table[place], name, head, unit)
        if written and not np.array_equal(
            _in_si(table[place], name, head, written), found, equal_nan=True
        ):
            raise ValueError(
                f"{path}: the column {head!r} has the unit {written}, and --{name}-unit is {unit}; "
                "leave that out, or correct the heading"
            )
        # A column without a number is as good as none.
        columns[name] = found if np.any(np.isfinite(found)) else None
    return Recording(**columns)


def _in_si(values: Array, name: str, head: str, unit: str) -> Array:
    """A column in SI units; radii also from contact areas or diameters, by head and unit."""
    if _is_area(name, head, unit):
        return np.sqrt(np.maximum(values * unit_value(unit, "m^2"), 0.0) / np.pi)
    found = values * unit_value(unit, UNITS[name])
    return found / 2 if name == "radius" and "diameter" in _name(head) else found


def _is_area(name: str, head: str, unit: str) -> bool:
    """Whether a column of radii has areas, by its head, or by its unit where the head says none."""
    named = _name(head)
    if name != "radius" or "radius" in named or "diameter" in named:
        return False
    return "area" in named or is_unit(unit, "m^2")


def _layout(path: Path, lines: Sequence[str]) -> tuple[str | None, int]:
    """Separator of a table, None for spaces, and its first line of numbers."""
    for separator in (*_SEPARATORS, None):
        for number, line in enumerate(lines[:_MOST_HEADS]):
            cells = _cells(line, separator)
            heads = _heads(lines[number - 1], separator, len(cells)) if number else []
            if not _is_row(cells, heads):
                continue
            # A decimal comma is no separator: both cells of 1,5 would be numbers.
            if separator != "," or _are_headed(cells, heads):
                return separator, number
            break
    raise ValueError(
        f"{path} has no line with two numbers or more below a line of headings; write one heading "
        "for each column, as in Force (uN),Contact radius (um), and semicolons between cells with "
        "decimal commas"
    )


def _is_row(cells: Sequence[str], heads: Sequence[str]) -> bool:
    """Whether cells are a row of a table: two numbers, or below heads one beside empty cells."""
    count = sum(map(_is_number, cells))
    has_heads = _are_headed(cells, heads) and not any(map(_is_number, heads))
    is_all = count == sum(map(bool, cells))
    fewest = 1 if is_all and has_heads and len(cells) > 1 else 2
    return count >= fewest and (is_all or has_heads)


def _are_headed(cells: Sequence[str], heads: Sequence[str]) -> bool:
    """Whether there is a head for each cell; a last empty one may be that of a closing comma."""
    return len(heads) == len(cells) or (not cells[-1] and len(heads) == len(cells) - 1)


def _heads(line: str, separator: str | None, width: int) -> list[str]:
    """Heads of so many columns; those of columns of spaces may have single spaces in them."""
    line = line.lstrip("#% ")
    found = _cells(line, separator)
    apart = re.split(r"\s{2,}", line.strip())
    return apart if separator is None and len(found) != width == len(apart) else found


def _cells(line: str, separator: str | None) -> list[str]:
    """Cells of a line, without blanks and quotes around them."""
    return [cell.strip().strip('"') for cell in line.split(separator)]


def _is_number(cell: str) -> bool:
    """Whether a cell is a number, with a decimal point or comma, or says that there is none."""
    return (
        re.fullmatch(r"[-+]?(\d+[.,]?\d*|[.,]\d+)([eE][-+]?\d+)?|nan|NaN|NA|N/A|-+", cell)
        is not None
    )


def _is_unit(head: str) -> bool:
    """Whether a cell of a line of heads is a unit of force, of length or of time, or says none."""
    text = head.strip("[]() ")
    return text in ("", "-", "1") or any(is_unit(text, unit) for unit in ("N", "m", "m^2", "s"))


def _unit(head: str) -> str:
    """Unit in a head, empty where it has none."""
    found = _HEAD.fullmatch(head)
    return (found["bracket"] or found["slash"] or "").strip() if found else ""


def _name(head: str) -> str:
    """Name in a head, in lower case."""
    found = _HEAD.fullmatch(head)
    return (found["name"] if found else head).replace("_", " ").strip().lower()


def _chosen(
    path: Path, heads: Sequence[str], named: Mapping[str, str]
) -> Iterator[tuple[str, int]]:
    """Columns of force, radius and displacement among the heads of a table."""
    listed = ", ".join(map(repr, heads)) or "none"
    taken = {head.strip().lower() for head in named.values()}
    for name, pattern in _HEADS.items():
        if name in named:
            wanted = named[name].strip().lower()
            places = [i for i, head in enumerate(heads) if wanted in (head.lower(), _name(head))]
            if not places:
                raise ValueError(f"{path} has no column {named[name]!r}; its heads are {listed}")
        else:
            places = [
                i
                for i, head in enumerate(heads)
                if re.fullmatch(pattern, _name(head)) and not taken & {head.lower(), _name(head)}
            ]
        # A radius beside its area is the same again.
        named_so = [i for i in places if name == "radius" and _name(heads[i]).endswith(name)]
        places = named_so if len(named_so) == 1 else places
        if len(places) > 1:
            option = "contact-radius" if name == "radius" else name
            both = ", ".join(repr(heads[i]) for i in places)
            raise ValueError(
                f"{path} has {len(places)} columns of {name}: {both}; name one by --{option}"
            )
        if places:
            yield name, places[0]


def _numbers(
    path: Path, lines: Sequence[str], separator: str | None, width: int, places: Sequence[int]
) -> dict[int, Array]:
    """Numbers of some columns of a table by their places, NaN in empty cells."""
    import pandas

    text = "\n".join(lines)
    # Where a comma separates no cells it is a decimal one; its numbers are converted one by one.
    has_comma = separator != "," and "," in text
    try:
        table = pandas.read_csv(
            io.StringIO(text),
            sep=separator or r"\s+",
            dtype=str if has_comma else None,
            header=None,
            names=range(width + 1),
            na_values=["-", "--", "---"],
            index_col=False,
        )
    except pandas.errors.ParserError as error:
        raise ValueError(f"{path} is no table: {str(error).strip()}") from error
    more = np.flatnonzero(table[width].notna())
    if more.size:
        raise ValueError(
            f"{path}: row {more[0] + 1} of the numbers has more cells than there are heads; write "
            "a head for every column, and commas between cells alone"
        )
    found = {}
    if has_comma:
        texts = [table[place].str.strip() for place in places]
        if all(any(one.str.contains(sign, regex=False).any() for one in texts) for sign in ".,"):
            raise ValueError(
                f"{path} has numbers with decimal points and with decimal commas; write one of them"
            )
    for place in places:
        column = table[place]
        if not pandas.api.types.is_numeric_dtype(column):
            column = column.str.strip().replace("", None)
            numbers = pandas.to_numeric(column.str.replace(",", "."), errors="coerce")
        else:
            numbers = column
        bad = np.flatnonzero(numbers.isna() & column.notna())
        if bad.size:
            raise ValueError(
                f"{path}: {column[bad[0]]!r} in row {bad[0] + 1} of the numbers, column "
                f"{place + 1}, is no number; mend or remove the row"
            )
        values = numbers.to_numpy(float)
        found[place] = np.where(np.isfinite(values), values, np.nan)
    return found
