"""Tables that studies measure: commands print them as Markdown and store them as CSV files."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas

from crackfront.analysis.estimate import Estimate
from crackfront.simulate.storage import write_text

TABLES = Path("docs/reference/tables")
"""Folder of the stored tables, with a folder for each study and a CSV file for each table."""


@dataclass(frozen=True, slots=True)
class Table:
    """Named columns, and rows of cells with the digits that they are shown with.

    ValueError if two columns have the same name, or a row has more or fewer cells than columns.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    """What the columns mean, or what follows from the rows."""

    def __post_init__(self) -> None:
        """Raise an error for columns that pandas would rename, and for rows of another length."""
        if len(set(self.columns)) < len(self.columns):
            raise ValueError(f"two columns have the same name: {', '.join(self.columns)}")
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"{len(row)} cells in {len(self.columns)} columns: {row}")

    def markdown(self) -> str:
        """Table in Markdown.

        Examples
        --------
        >>> print(make_table("scene | time / s", [["flat", "3"], "h08 | 4"]).markdown())
        | scene | time / s |
        | --- | --- |
        | flat | 3 |
        | h08 | 4 |
        """
        lines = [self.columns, ["---"] * len(self.columns), *self.rows]
        return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)

    def text(self) -> str:
        """Table in Markdown above its note."""
        return "\n\n".join(filter(None, (self.markdown(), self.note)))

    def csv(self) -> str:
        """Content of its CSV file."""
        frame = pandas.DataFrame(self.rows, columns=list(self.columns))
        return frame.to_csv(index=False, lineterminator="\n")

    def records(self) -> list[dict[str, str]]:
        """Cells of each row by the names of their columns."""
        return [dict(zip(self.columns, cells, strict=True)) for cells in self.rows]

    def cell(self, row: str, column: str) -> str:
        """Cell of a column, in the row that begins with some cells, as ``h08 | 4``."""
        if column not in self.columns:
            columns = ", ".join(self.columns)
            raise ValueError(f"the table lacks a column {column!r}; it has {columns}")
        first_cells = tuple(row.split(" | "))
        for cells in self.rows:
            if cells[: len(first_cells)] == first_cells:
                return cells[self.columns.index(column)]
        raise ValueError(f"no row of the table begins with {row!r}")


def make_table(header: str, rows: Iterable[str | Sequence[str]], note: str = "") -> Table:
    """Table; the header has a bar between columns, and so has a row that is one text."""
    cells = (row.split(" | ") if isinstance(row, str) else row for row in rows)
    return Table(tuple(header.split(" | ")), tuple(map(tuple, cells)), note)


def table_path(study: str, name: str) -> Path:
    """File of a table of a study.

    Examples
    --------
    >>> str(table_path("accuracy", "Settings, flat-0.16"))
    'docs/reference/tables/accuracy/settings-flat-0.16.csv'
    """
    return TABLES / study / f"{re.sub(r'[^a-z0-9.]+', '-', name.lower())}.csv"


def read_table(path: Path, note: str = "") -> Table:
    """Table of a CSV file, with the digits that the file has."""
    frame = pandas.read_csv(path, dtype=str, keep_default_na=False)
    return Table(tuple(frame.columns), tuple(frame.itertuples(index=False, name=None)), note)


def write_table(path: Path, table: Table) -> None:
    """Write a table to a CSV file."""
    write_text(path, table.csv())


def interval_header(column: str) -> str:
    """Header of a column and of both ends of its interval.

    Examples
    --------
    >>> interval_header("k")
    'k | k low | k high'
    """
    return f"{column} | {column} low | {column} high"


def interval_cells(estimate: Estimate[float]) -> tuple[str, ...]:
    """Cells of :func:`interval_header`, two digits each; a number that is not known is empty."""
    numbers = (estimate.value, estimate.low, estimate.high)
    return tuple(f"{number:.2f}" if math.isfinite(number) else "" for number in numbers)
