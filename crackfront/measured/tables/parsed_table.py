"""A table: headings, cells as texts, and columns of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crackfront.core.arrays import Array
from crackfront.measured.tables.headings import Heading
from crackfront.measured.tables.number_cells import decimal_sign, is_number, is_without_value

if TYPE_CHECKING:
    from pandas import DataFrame, Series


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Rows of a text, with what stands above them."""

    path: Path
    above: tuple[str, ...] = field(repr=False)
    """Lines between the rows of the table before and these, with points as decimals."""
    titles: tuple[str, ...]
    """Those that are not headings, without signs of comments and without empty ones."""
    headings: tuple[Heading, ...]
    """One for each column; none if the text has none."""
    cells: DataFrame = field(repr=False)
    """Texts, with columns from 0. Shape (n_row, n_column)."""
    lines: tuple[int, ...] = field(repr=False)
    """Numbers of the lines of the rows in the file, from 1."""
    separator: str | None = None
    """What stands between cells: a tab, a semicolon, a comma, or None for blanks."""

    @property
    def n_column(self) -> int:
        """Number of cells in a row."""
        return int(self.cells.shape[1])

    def with_columns(self, places: Sequence[int]) -> Table:
        """The table with some of its columns, in another order."""
        cells = self.cells[list(places)].set_axis(range(len(places)), axis="columns")
        return replace(self, headings=tuple(self.headings[n] for n in places), cells=cells)

    def numbers(self, places: Sequence[int]) -> list[Array]:
        """Numbers of some columns.

        Parameters
        ----------
        places : sequence of int
            The columns, from 0.

        Returns
        -------
        list of (n_row,) array
            NaN in cells without a value.

        Raises
        ------
        ValueError
            If a cell is not a number, or the columns have two decimal signs; it names the line.
        """
        texts = [self.cells[place] for place in places]
        if any(column.str.contains(",", regex=False).any() for column in texts):
            self._check_decimal_signs(texts)
            texts = [column.str.replace(",", ".", regex=False) for column in texts]
        return [self._column(place, column) for place, column in zip(places, texts, strict=True)]

    def _check_decimal_signs(self, columns: Sequence[Series]) -> None:
        """Raise if numbers of some columns have two decimal signs."""
        rows = zip(self.lines, zip(*columns, strict=True), strict=True)
        decimal_sign(self.path, ((line, filter(is_number, cells)) for line, cells in rows))

    def _column(self, place: int, column: Series) -> Array:
        """Numbers of a column of texts with decimal points."""
        import pandas

        values = pandas.to_numeric(column, errors="coerce").to_numpy(float)
        for row in np.flatnonzero(np.isnan(values)):
            cell = column.iat[row]
            if not is_without_value(cell):
                raise ValueError(
                    f"{self.path}, line {self.lines[row]}: {cell[:40]!r} in column {place + 1} is "
                    "not a number; correct or remove the row"
                )
        return np.where(np.isfinite(values), values, np.nan)
