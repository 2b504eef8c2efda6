"""Reading a text takes a time in proportion to its length, whatever it contains."""

import time
from contextlib import suppress

import numpy as np
import pytest

from crackfront.measured.options import ReadingOptions
from crackfront.measured.samples.sample import SampleOptions
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.tables.headed_table import table_of_texts
from crackfront.measured.tables.number_tables import number_tables

LONG = 40_000
"""Letters of the long part of a text; quadratic cost would take half a minute or longer."""


def seconds(function):
    begin = time.process_time()
    with suppress(ValueError):
        function()
    return time.process_time() - begin


@pytest.mark.parametrize(
    "text",
    [
        "1 2\n" + "1" * LONG + "x 3\n",
        "# " + "word " * LONG + "\n1 2\n3 4\n",
        "# x (um" + " " * LONG + "y) " + "z (um)\n1 2\n3 4\n",
        "x" + " " * LONG + "y,z\n1,2\n3,4\n",
        "a_" * LONG + " b,z\n1,2\n3,4\n",
        "# " + "a = 1,5 " * LONG + "\n1 2\n3 4\n",
        '"1","2"\n' + '"' * LONG + '\n"3","4"\n',
    ],
    ids=["digits", "words", "bracket", "blanks", "underscores", "numbers", "quotes"],
)
def test_a_long_line_costs_no_more_than_its_length(tmp_path, text):
    path = tmp_path / "text.csv"
    path.write_text(text)
    assert seconds(lambda: number_tables(path)) < 5
    assert seconds(lambda: table_of_texts(path)) < 5


def test_many_blanks_between_the_files_of_a_sample_cost_no_more_than_their_length():
    scans = "a.txt" + " " * LONG + "b" + " |  c.txt "
    assert seconds(lambda: SampleOptions(scans=scans)) < 5
    assert SampleOptions(scans=scans).scans[1:] == ("c.txt",)


@pytest.mark.parametrize("separator", [",", "\t", ";", " "])
@pytest.mark.parametrize("missing", ["nan", "NaN", "---", "-", "n/a", "null", "BAD"])
def test_a_map_has_gaps_where_a_cell_says_that_its_value_is_missing(
    tmp_path, noise, separator, missing
):
    cells = np.char.mod("%.6f", 1e6 * noise)
    cells[3, 5] = cells[7, 0] = missing
    path = tmp_path / "map.csv"
    path.write_text("\n".join(map(separator.join, cells)))
    [scan] = read_measurements([path], ReadingOptions(unit="um", size=(10, 10)))
    assert np.argwhere(scan.gaps.T).tolist() == [[3, 5], [7, 0]]


def test_a_row_without_any_value_is_a_row_and_a_rule_below_headings_is_none(tmp_path):
    path = tmp_path / "points.txt"
    path.write_text("x z\n--- ---\n0 1\n1 2\n--- ---\n3 4\n")
    [table] = number_tables(path).tables
    assert table.lines == (3, 4, 5, 6)
    assert table.cells.iloc[2].tolist() == ["nan", "nan"]
