"""Measured points from CSV files: read whole, or refused with the number of the line.

Two kinds of file are known: forces with contact radii, and spectral densities of profiles.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crackfront.data.section import refusal
from studies.paper.force import FEWEST_POINTS

Array = NDArray[np.float64]

_HEADER = re.compile(r"^(?P<name>[^()]*?)\s*(\((?P<unit>[^()]*)\))?$")


@dataclass(frozen=True, slots=True)
class Quantity:
    """A column of numbers: `name (unit)` in the header, with units that lead to SI by a factor."""

    name: str
    units: Mapping[str, float]
    positive: bool = False


@dataclass(frozen=True, slots=True)
class MeasuredTable:
    """Rows of a file: their lines, (n_row,), and a row a column that was asked for, in SI units."""

    lines: NDArray[np.int64]
    numbers: Array
    words: NDArray[np.str_]


def read_measured(
    path: Path, quantities: Sequence[Quantity], words: Sequence[str] = ()
) -> MeasuredTable:
    """Columns of a CSV file; empty lines, those that begin with # and other columns are left out.

    Raises
    ------
    PydanticCustomError
        If the file cannot be read, a column is missing or stands twice, a unit is missing or not
        understood, a value is missing or no finite number, or there is no row.
    """
    rows = _rows(path)
    place, header = next(rows, (1, []))
    if not header:
        raise refusal(f"{path} is empty; it needs a header and rows")
    top = f"{path}, line {place}"
    columns = [_column(top, header, item) for item in quantities]
    places = [_position(top, header, name) for name in words]
    lines, numbers, texts = [], [], []
    for number, row in rows:
        where = f"{path}, line {number}"
        if len(row) != len(header):
            raise refusal(f"{where} has {len(row)} values for {len(header)} columns; complete it")
        numbers.append([_number(where, row[index], item, si) for index, item, si in columns])
        texts.append([row[index].strip() for index in places])
        lines.append(number)
    if not lines:
        raise refusal(f"{path} has a header but no rows; add the points")
    return MeasuredTable(np.array(lines), np.array(numbers).T, np.array(texts, dtype=str).T)


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Rows of a file with the numbers of their lines."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            for row in reader:
                if any(row) and not row[0].lstrip().startswith("#"):
                    yield reader.line_num, row
    except OSError as error:
        raise refusal(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise refusal(f"{path} is no UTF-8 text; save it as UTF-8") from error
    except csv.Error as error:
        raise refusal(f"{path}, line {reader.line_num}: {error}") from error


def _position(where: str, header: list[str], name: str) -> int:
    """Place of a column in the header."""
    names = [_parts(item)[0] for item in header]
    if names.count(name) != 1:
        what = "stands twice; remove one" if name in names else "is missing"
        raise refusal(f"{where}: column {name} {what}; the header has {', '.join(names)}")
    return names.index(name)


def _column(where: str, header: list[str], item: Quantity) -> tuple[int, Quantity, float]:
    """Place of a column of numbers, and the factor that leads to SI."""
    index = _position(where, header, item.name)
    unit, known = _parts(header[index])[1], ", ".join(item.units)
    if unit not in item.units:
        what = f"is in {unit}" if unit else "has no unit"
        raise refusal(f"{where}: {item.name} {what}; write {item.name} (unit) with one of {known}")
    return index, item, item.units[unit]


def _parts(title: str) -> tuple[str, str]:
    """Name and unit of a column."""
    match = _HEADER.match(title.strip())
    return (match["name"], match["unit"] or "") if match else (title, "")


def _number(where: str, text: str, item: Quantity, factor: float) -> float:
    """A finite number in SI units."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or (item.positive and value <= 0):
        must = "a positive number" if item.positive else "a finite number"
        raise refusal(f"{where}: {item.name} is {text.strip()!r}; it must be {must}")
    return value * factor


_BRANCHES = {"approach": 1, "retraction": -1}

_FORCE = Quantity("force", {"N": 1.0, "mN": 1e-3, "uN": 1e-6})
_RADIUS = Quantity("radius", {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}, positive=True)


@dataclass(frozen=True, slots=True)
class ForceRadius:
    """Forces (N), contact radii (m), and +1 in approach, -1 in retraction, of (n_point,) each."""

    force: Array
    radius: Array
    direction: NDArray[np.int64]


def read_force_radius(path: Path | None) -> ForceRadius:
    """Points from a CSV file with the columns force (mN), radius (um) and branch, as measured.

    The units are N, mN or uN, and m, mm, um or nm; the branch is approach or retraction. Without a
    file there are no points.

    Raises
    ------
    PydanticCustomError
        If it cannot be read or holds no such columns; if a branch is unknown, an approach follows
        a retraction, the approach has fewer than three points, or ends at no larger force than it
        begins. The sentence names the line.
    """
    if path is None:
        return ForceRadius(np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))
    table = read_measured(path, (_FORCE, _RADIUS), words=("branch",))
    for line, name in zip(table.lines, table.words[0], strict=True):
        if name not in _BRANCHES:
            raise refusal(
                f"{path}, line {line}: branch is {str(name)!r}; it must be {' or '.join(_BRANCHES)}"
            )
    direction = np.array([_BRANCHES[name] for name in table.words[0]])
    force, radius = table.numbers
    back = np.flatnonzero(np.diff(direction) > 0)
    if back.size:
        raise refusal(
            f"{path}, line {table.lines[back[0] + 1]}: an approach follows the retraction; the "
            "rows must be one approach and then its retraction"
        )
    approach = force[direction > 0]
    last = table.lines[max(approach.size - 1, 0)]
    if approach.size < FEWEST_POINTS:
        raise refusal(
            f"{path}, line {last}: the approach has {approach.size} points; the fit needs "
            f"{FEWEST_POINTS}"
        )
    if approach[-1] <= approach[0]:
        raise refusal(
            f"{path}, line {last}: the approach ends at {approach[-1]:g} N and begins at "
            f"{approach[0]:g} N; its force must grow, so put the rows in the order of measurement"
        )
    return ForceRadius(force, radius, direction)


_WAVEVECTOR = Quantity("q", {"1/m": 1.0, "1/um": 1e6, "1/nm": 1e9}, positive=True)
_DENSITY = Quantity("C1D", {"m^3": 1.0, "um^3": 1e-18, "nm^3": 1e-27}, positive=True)


@dataclass(frozen=True, slots=True)
class ProfileDensity:
    """Increasing wavevectors (1 / m) and C_1D (m^3) of profiles, of (n_point,) each."""

    wavevector: Array
    density: Array


def read_profile_density(path: Path | None) -> ProfileDensity:
    """Profile density from a CSV file with the columns q (1/m) and C1D (m^3).

    The units are 1/m, 1/um or 1/nm, and m^3, um^3 or nm^3. The mean square height is the integral
    of C1D over q > 0, divided by pi. Without a file there are no points.

    Raises
    ------
    PydanticCustomError
        If it cannot be read, holds no such columns, units or numbers, has a single row, or if the
        wavevectors do not increase. The sentence names the line.
    """
    if path is None:
        return ProfileDensity(np.empty(0), np.empty(0))
    table = read_measured(path, (_WAVEVECTOR, _DENSITY))
    wavevector, density = table.numbers
    wrong = np.flatnonzero(np.diff(wavevector) <= 0)
    if wrong.size:
        before, here = wavevector[wrong[0] : wrong[0] + 2]
        raise refusal(
            f"{path}, line {table.lines[wrong[0] + 1]}: q is {here:g} 1/m after {before:g} 1/m; "
            "wavevectors must increase"
        )
    if wavevector.size < 2:
        raise refusal(f"{path}, line {table.lines[0]} is the only row; a density needs two or more")
    return ProfileDensity(wavevector, density)
