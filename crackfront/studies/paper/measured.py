"""Measured points from CSV files: read whole, or refused with the number of the line."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_HEADER = re.compile(r"^(?P<name>[^()]*?)\s*(\((?P<unit>[^()]*)\))?$")


@dataclass(frozen=True, slots=True)
class Quantity:
    """A column of numbers.

    Attributes
    ----------
    name : str
        Its name in the header, which the unit follows in brackets: `force (mN)`.
    units : mapping
        Units that are understood, each with the factor that leads to SI.
    positive : bool
        Whether only positive numbers have a meaning.
    """

    name: str
    units: Mapping[str, float]
    positive: bool = False


class MeasuredFileError(ValueError):
    """What is wrong with a file of measured points, with the number of the line."""


@dataclass(frozen=True, slots=True)
class MeasuredTable:
    """Rows of a file.

    Attributes
    ----------
    lines : (n_row,) int array
        Number of each row's line in the file.
    numbers : (n_quantity, n_row) array
        Values in SI units, in the order of the quantities.
    words : (n_word, n_row) array of str
        Columns of words, in the order in which they were asked for.
    """

    lines: NDArray[np.int64]
    numbers: Array
    words: NDArray[np.str_]


def read_measured(
    path: Path, quantities: Sequence[Quantity], words: Sequence[str] = ()
) -> MeasuredTable:
    """Columns of a CSV file; empty lines, those that begin with # and other columns are left out.

    Parameters
    ----------
    path : Path
        CSV file with a header.
    quantities : sequence of Quantity
        Columns of numbers.
    words : sequence of str, optional
        Columns of words.

    Raises
    ------
    MeasuredFileError
        If the file cannot be read, a column is missing or stands twice, a unit is missing or not
        understood, a value is missing or no finite number, or there is no row.
    """
    rows = _rows(path)
    place, header = next(rows, (1, []))
    if not header:
        raise MeasuredFileError(f"{path} is empty; it needs a header and rows")
    columns = [_column(f"{path}, line {place}", header, item) for item in quantities]
    named = [(_position(f"{path}, line {place}", header, name), name) for name in words]
    lines, numbers, texts = [], [], []
    for number, row in rows:
        where = f"{path}, line {number}"
        if len(row) != len(header):
            raise MeasuredFileError(
                f"{where} has {len(row)} values for {len(header)} columns; complete it"
            )
        numbers.append([_number(where, row[index], item, si) for index, item, si in columns])
        texts.append([row[index].strip() for index, _ in named])
        lines.append(number)
    if not lines:
        raise MeasuredFileError(f"{path} has a header but no rows; add the points")
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
        raise MeasuredFileError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MeasuredFileError(f"{path} is no UTF-8 text; save it as UTF-8") from error
    except csv.Error as error:
        raise MeasuredFileError(f"{path}, line {reader.line_num}: {error}") from error


def _position(where: str, header: list[str], name: str) -> int:
    """Place of a column in the header."""
    names = [_parts(item)[0] for item in header]
    if names.count(name) != 1:
        what = "stands twice; remove one" if name in names else "is missing"
        raise MeasuredFileError(f"{where}: column {name} {what}; the header has {', '.join(names)}")
    return names.index(name)


def _column(where: str, header: list[str], item: Quantity) -> tuple[int, Quantity, float]:
    """Place of a column of numbers, and the factor that leads to SI."""
    index = _position(where, header, item.name)
    unit, known = _parts(header[index])[1], ", ".join(item.units)
    if unit not in item.units:
        what = f"is in {unit}" if unit else "has no unit"
        raise MeasuredFileError(
            f"{where}: {item.name} {what}; write {item.name} (unit) with one of {known}"
        )
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
        raise MeasuredFileError(f"{where}: {item.name} is {text.strip()!r}; it must be {must}")
    return value * factor
