"""Rows of a table of samples, from a text or YAML: cells with their units, by their columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
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

_TWO_SIDES = re.compile(r"\d+,\d+")
"""Two sides of a scan, or one with a decimal comma."""

_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2},\d{3}")
"""A number whose comma may separate thousands as well as decimals."""


def sample_rows(path: Path) -> list[tuple[int, dict[str, Any]]]:
    """Rows of a table of samples.

    Parameters
    ----------
    path : Path
        YAML by its suffix, else a text with headings.

    Returns
    -------
    list of (int, dict)
        Line of every row, and its cells by the names of their columns; numbers have the units of
        their headings and decimal points.

    Raises
    ------
    ValueError
        If it is not such a table, or a number has two readings; it names the line.
    OSError
        If the file cannot be opened.
    """
    check_readable(path)
    return list(_yaml_rows(path) if path.suffix.lower() in _YAML else _table_rows(path))


def _table_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Line and content of every row of a text with headings."""
    table = table_of_texts(path)
    where = f"{path}, line {len(table.above) + 1}"
    columns = [_name_and_unit(each, where) for each in table.headings]
    names = [name for name, _ in columns if name]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise ValueError(f"{where}: two columns are called {twice!r}")
    rows = [
        {name: cell for (name, _), cell in zip(columns, cells, strict=True) if name and cell}
        for cells in table.cells.to_numpy()
    ]
    has_decimal_commas = table.separator != ","
    if has_decimal_commas:
        _check_decimal_signs(table, rows)
    units = dict(columns)
    for line, row in zip(table.lines, rows, strict=True):
        for name, cell in row.items():
            if name not in _NAMES and is_number(cell):
                number = cell.replace(",", ".") if has_decimal_commas else cell
                row[name] = number + units[name]
        yield line, row


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


def _name_and_unit(each: Heading, where: str) -> tuple[str, str]:
    """Name of an option and unit in a heading; the unit must not begin with a number."""
    if re.match(r"[-+.,]?\d", each.unit):
        raise ValueError(
            f"{where}: the unit of the column {each.name!r} is {each.unit!r}, which begins with a "
            "number; write a unit alone, as in mJ/m2, and the cells in it"
        )
    return re.sub(r"[\s-]+", "_", each.name.lower()), each.unit


def _yaml_rows(path: Path) -> Iterator[tuple[int, dict[str, Any]]]:
    """Line and content of every sample of a YAML file."""
    try:
        content = YAML(typ="rt").load(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is not a text in UTF-8; store it as UTF-8") from error
    except MarkedYAMLError as error:
        where = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        raise ValueError(f"{path}{where}: this is not YAML: {error.problem}; correct it") from error
    except (YAMLError, ValueError) as error:
        # A sign that YAML does not allow, or a date or a number that cannot be read.
        raise ValueError(f"{path} is not YAML: {str(error).splitlines()[0]}; correct it") from error
    rows = content.get("samples") if isinstance(content, dict) else content
    further = [name for name in content if name != "samples"] if isinstance(content, dict) else []
    if rows is not None and further:
        raise ValueError(f"{path} has {str(further[0])!r} next to samples; remove it")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise ValueError(
            f"{path} lacks a list of samples; write 'samples:' with '- sample: A' below"
        )
    for row in rows:
        line = row.lc.line + 1
        cells: dict[str, Any] = {}
        for key, value in row.items():
            if value is not None:
                name, unit = _name_and_unit(heading(str(key)), f"{path}, line {line}")
                if isinstance(value, list):
                    cells[name] = list(value)
                else:
                    cells[name] = f"{value}{unit}" if is_number(str(value)) else str(value)
        yield line, cells
