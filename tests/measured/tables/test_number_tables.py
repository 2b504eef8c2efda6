"""Rows of numbers: where values are missing, and at what cost."""

import numpy as np
import pytest

from crackfront.measured.tables.number_tables import number_tables


def rows(n_row, n_column):
    """Cells of a matrix with a missing value in every row."""
    cells = np.char.mod("%.6f", np.random.default_rng(0).standard_normal((n_row, n_column)))
    cells = cells.astype(object)
    cells[np.arange(n_row), np.arange(n_row) % n_column] = "nan"
    return cells


@pytest.mark.parametrize("separator", [" ", ";", ",", "\t"])
@pytest.mark.parametrize("missing", ["nan", "BAD", "infinite"])
def test_a_value_may_be_missing_in_every_row(tmp_path, separator, missing):
    path = tmp_path / "map.txt"
    text = "\n".join(separator.join(row) for row in rows(12, 6))
    path.write_text(text.replace("nan", missing))
    table = number_tables(path).main_table
    assert table.cells.shape == (12, 6)
    assert np.count_nonzero(np.isnan(table.numbers(range(6)))) == 12


def test_a_number_of_points_above_the_rows_is_not_one_of_them(tmp_path):
    path = tmp_path / "psd.txt"
    path.write_text("3\n1 2\n3 4\n5 6\n")
    assert number_tables(path).main_table.cells.shape == (3, 2)
