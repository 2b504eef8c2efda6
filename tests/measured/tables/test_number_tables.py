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


def written(tmp_path, table, separator):
    """A file of rows of cells."""
    path = tmp_path / "text.txt"
    path.write_text("".join(f"{separator.join(row)}\n" for row in table))
    return path


@pytest.mark.parametrize("separator", [" ", ";", ",", "\t"])
@pytest.mark.parametrize("place", [0, 6, 11])
@pytest.mark.parametrize(
    "damage",
    [
        lambda row: ["#", *row[1:]],
        lambda row: ["#", *row],
        lambda row: [f"#{row[0]}", *row[1:]],
        lambda row: ["%", *row[1:]],
        lambda row: ["//", *row[1:]],
        lambda row: ["####", *row[1:]],
        lambda row: [*["***"] * 7, *row[7:]],
    ],
    ids=["comment for a number", "comment", "glued", "%", "//", "overflow", "stars"],
)
def test_a_row_of_a_map_is_never_dropped_as_a_comment(tmp_path, separator, place, damage):
    table = list(map(list, rows(12, 10)))
    table[place] = damage(table[place])
    with pytest.raises(ValueError, match=rf"text\.txt, line {place + 1}: .*nan"):
        number_tables(written(tmp_path, table, separator))


@pytest.mark.parametrize("row", [["***"] * 10, ["####"] * 10, ["-"] * 9, ["1.5"] * 9])
def test_a_row_of_a_map_without_its_numbers_is_an_error(tmp_path, row):
    table = list(map(list, rows(12, 10)))
    table[6] = row
    with pytest.raises(ValueError, match=r"text\.txt, line 7: .*nan"):
        number_tables(written(tmp_path, table, "\t"))


@pytest.mark.parametrize(
    "comment",
    [
        ["# the tip was changed here"],
        ["# line 7 of 12"],
        ["#"],
        ["# 7"],
        ["Channel of the retrace"],
    ],
)
def test_a_comment_of_words_may_stand_between_the_rows_of_a_map(tmp_path, comment):
    table = list(map(list, rows(12, 10)))
    expected = number_tables(written(tmp_path, table, "\t")).plain_text.splitlines()
    table.insert(6, comment)
    read = number_tables(written(tmp_path, table, "\t"))
    assert [line for line in read.plain_text.splitlines() if line not in comment] == expected


@pytest.mark.parametrize("first", [["#"], []])
def test_positions_may_stand_above_a_map_as_a_comment(tmp_path, first):
    positions = [*first, *(f"{0.39 * number:.2f}" for number in range(10))]
    table = [["#", *positions], *map(list, rows(12, 10))]
    assert number_tables(written(tmp_path, table, " ")).main_table.cells.shape == (12, 10)
