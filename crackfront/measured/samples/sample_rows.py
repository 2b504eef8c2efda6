"""Rows of a table of samples, from a text or YAML: cells with their units, by their columns."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from crackfront.measured.scan.scan_files import check_readable
from crackfront.measured.tables.headed_table import table_of_texts
from crackfront.measured.tables.headings import Heading, heading
from crackfront.measured.tables.number_cells import decimal_sign, is_number
from crackfront.measured.tables.parsed_table import Table

_YAML = {".yaml", ".yml"}

_NAMES = ("sample", "group")
"""Columns whose cells are names, also where they look like numbers."""

_MOST_VALUES = 1000
"""Values in a list of a sample, as of its scans."""

_TWO_SIDES = re.compile(r"\d+,\d+")
"""Two sides of a scan, or one with a decimal comma."""

_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2},\d{3}")
"""A number whose comma may separate thousands as well as decimals."""


@dataclass(frozen=True, slots=True)
class SampleRow:
    """What a table says of a sample."""

    line: int
    """Number of its line in the file, from 1."""
    options: Mapping[str, Any]
    """Cells by the names of options; numbers have the units of their headings and points."""
    further: Mapping[str, str]
    """Cells of other columns as they are, by their headings."""


def sample_rows(path: Path, names: Collection[str]) -> list[SampleRow]:
    """Rows of a table of samples.

    Parameters
    ----------
    path : Path
        YAML by its suffix, else a text with headings.
    names : collection of str
        Options, which are the columns that are read.

    Returns
    -------
    list of SampleRow
        In the order of the table, without empty cells.

    Raises
    ------
    ValueError
        If it is not such a table, or a number has two readings; it names the line.
    OSError
        If the file cannot be opened.
    """
    check_readable(path)
    rows = _yaml_rows if path.suffix.lower() in _YAML else _table_rows
    return list(rows(path, names))


def _table_rows(path: Path, names: Collection[str]) -> Iterator[SampleRow]:
    """Line and content of every row of a text with headings."""
    table = table_of_texts(path)
    location = f"{path}, line {len(table.above) + 1}"
    columns = [_name_and_unit(column, names, location) for column in table.headings]
    counts = Counter(name for name, _ in columns if name)
    for name, count in counts.items():
        if count > 1:
            raise ValueError(f"{location}: two columns are called {name!r}; rename one of them")
    cells_of_rows = [
        {name: cell for (name, _), cell in zip(columns, cells, strict=True) if name and cell}
        for cells in table.cells.to_numpy()
    ]
    rows = [
        {name: _with_hyphen(cell) for name, cell in cells.items() if name in names}
        for cells in cells_of_rows
    ]
    has_decimal_commas = table.separator != ","
    if has_decimal_commas:
        _check_decimal_signs(table, rows)
    units = dict(columns)
    for line, row, cells in zip(table.lines, rows, cells_of_rows, strict=True):
        for name, cell in row.items():
            if name not in _NAMES and is_number(cell):
                number = cell.replace(",", ".") if has_decimal_commas else cell
                row[name] = number + units[name]
        further = {name: cell for name, cell in cells.items() if name not in names}
        yield SampleRow(line, row, further)


def _with_hyphen(cell: str) -> str:
    """A number with a hyphen for the minus sign of word processors; other cells as they are."""
    number = cell.replace("\u2212", "-")
    return number if is_number(number) else cell


def _check_decimal_signs(table: Table, rows: Sequence[dict[str, str]]) -> None:
    """Raise if numbers have two decimal signs, or commas that may all separate thousands."""
    numbers = list(_numbers(table, rows))
    decimal_sign(table.path, ((line, [cell]) for line, _, cell in numbers))
    with_comma = [number for number in numbers if "," in number[-1]]
    if with_comma and all(_THOUSANDS.fullmatch(cell) for *_, cell in with_comma):
        line, name, cell = with_comma[0]
        raise ValueError(
            f"{table.path}, line {line}: {name} is {cell!r}, whose comma may separate thousands or "
            f"decimals; write {cell.replace(',', '')!r}, or '{cell}0' if it separates decimals"
        )


def _numbers(table: Table, rows: Sequence[dict[str, str]]) -> Iterator[tuple[int, str, str]]:
    """Line, name of the column and cell of all numbers, without names and sides."""
    for line, row in zip(table.lines, rows, strict=True):
        size = row.get("size", "")
        if _TWO_SIDES.fullmatch(size):
            raise ValueError(
                f"{table.path}, line {line}: size is {size!r}, one side or two; write "
                f"{size.replace(',', ', ')!r} for two sides, or {size.replace(',', '.')!r} for one"
            )
        for name, cell in row.items():
            if name not in (*_NAMES, "size") and is_number(cell):
                yield line, name, cell


def _name_and_unit(column: Heading, names: Collection[str], location: str) -> tuple[str, str]:
    """Name of an option and unit in a heading, or any other heading as it is.

    The unit must not begin with a number.
    """
    name = re.sub(r"[\s-]+", "_", column.name.lower())
    if name not in names:
        return column.text, ""
    if re.match(r"[-+.,]?\d", column.unit):
        raise ValueError(
            f"{location}: the unit of the column {column.name!r} is {column.unit!r}, which begins "
            "with a number; write a unit alone, as in mJ/m2, and the cells in it"
        )
    return name, column.unit


def _yaml_samples(path: Path) -> list[Any]:
    """Mappings of a YAML file with their lines; ValueError if it is not a list of samples."""
    try:
        content = YAML(typ="rt").load(path.read_text(encoding="utf-8"))
    except RecursionError as error:
        raise ValueError(
            f"{path} is nested too deeply; write a list of samples with one value or one list for "
            "each name"
        ) from error
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is not a text in UTF-8; store it as UTF-8") from error
    except MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        raise ValueError(f"{path}{line}: this is not YAML: {error.problem}; correct it") from error
    except (YAMLError, ValueError) as error:
        # A sign that YAML does not allow, or a date or a number that cannot be read.
        raise ValueError(f"{path} is not YAML: {str(error).splitlines()[0]}; correct it") from error
    rows = content
    further_keys: list[Any] = []
    if isinstance(content, dict):
        rows = content.get("samples")
        further_keys = [key for key in content if key != "samples"]
    if rows is not None and further_keys:
        raise ValueError(f"{path} has {str(further_keys[0])!r} next to samples; remove it")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise ValueError(
            f"{path} lacks a list of samples; write 'samples:' with '- sample: A' below"
        )
    return rows


def _yaml_rows(path: Path, names: Collection[str]) -> Iterator[SampleRow]:
    """Line and content of every sample of a YAML file."""
    for row in _yaml_samples(path):
        line = row.lc.line + 1
        location = f"{path}, line {line}"
        options: dict[str, Any] = {}
        further: dict[str, str] = {}
        for key, value in row.items():
            if value is None:
                continue
            name, unit = _name_and_unit(heading(str(key)), names, location)
            if not _is_flat(value):
                raise ValueError(
                    f"{location}: {name} is a value of many parts; write one value, or a list"
                )
            if name not in names:
                further[name] = str(value)
            elif isinstance(value, list):
                options[name] = list(value)
            else:
                options[name] = f"{value}{unit}" if is_number(str(value)) else str(value)
        yield SampleRow(line, options, further)


def _is_flat(value: Any, depth: int = 3) -> bool:
    """Whether a value is single, or lists of lists, which anchors could repeat without end."""
    if isinstance(value, dict):
        return False
    if not isinstance(value, list):
        return True
    return depth > 0 and len(value) <= _MOST_VALUES and all(_is_flat(v, depth - 1) for v in value)
