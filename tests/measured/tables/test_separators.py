"""What separates the cells of tables, with and without headings."""

import pytest

from crackfront.measured.tables.headed_table import table_of_numbers
from crackfront.measured.tables.number_tables import number_tables


@pytest.mark.parametrize(
    ("text", "cells"),
    [
        ("1,5;2,5\n3,5;4,5\n", [["1.5", "2.5"], ["3.5", "4.5"]]),
        ("1,5 2,5\n3,5 4,5\n", [["1.5", "2.5"], ["3.5", "4.5"]]),
        ("1,5, 2,5\n3,5, 4,5\n", [["1.5", "2.5"], ["3.5", "4.5"]]),
        ("1,5\t2,5\n3,5\t4,5\n", [["1.5", "2.5"], ["3.5", "4.5"]]),
        ('"1,5"\t"2,5"\n"3,5"\t"4,5"\n', [["1.5", "2.5"], ["3.5", "4.5"]]),
        ('"1,5" "2,5"\n"3,5" "4,5"\n', [["1.5", "2.5"], ["3.5", "4.5"]]),
        ("1 ,2 ,3\n4 ,5 ,6\n", [["1", "2", "3"], ["4", "5", "6"]]),
        (" 1.5, 2.5\n-3.5,-4.5\n", [["1.5", "2.5"], ["-3.5", "-4.5"]]),
        ("1,5\n3,7\n2,9\n", [["1.5"], ["3.7"], ["2.9"]]),
        ("1,5\n2,7\n3,9\n", [["1", "5"], ["2", "7"], ["3", "9"]]),
        ("1.5 2.5;\n3.5 4.5;\n", [["1.5", "2.5"], ["3.5", "4.5"]]),
        ("1.5;2.5;;\n3.5;;;\n", [["1.5", "2.5"], ["3.5", "nan"]]),
        ("1\t\t2\n3\t\t4\n", [["1", "2"], ["3", "4"]]),
    ],
)
def test_rows_of_numbers_show_their_separator(tmp_path, text, cells):
    path = tmp_path / "rows.txt"
    path.write_text(text)
    [table] = number_tables(path).tables
    assert table.cells.to_numpy().tolist() == cells


@pytest.mark.parametrize(
    ("text", "cells"),
    [
        ("F;R;Note\n1,5;2,5;a, b\n", ["1,5", "2,5", "a, b"]),
        ("F\tR\tNote\n1,5\t2,5\ta; b, c\n", ["1,5", "2,5", "a; b, c"]),
        ("F, R, Note\n1.5, 2.5, a; b\n", ["1.5", "2.5", "a; b"]),
        ("F R Note\n1,5 2,5 a;b\n", ["1,5", "2,5", "a;b"]),
        ("F,R\n1,5\n", ["1", "5"]),
        ('"F R", "Note"\n1, "2,5"\n', ["1", "2,5"]),
        (30 * "Range;0;10\n" + "F,R\n1.5,2.5\n", ["1.5", "2.5"]),
    ],
)
def test_headings_show_the_separator_of_rows_with_texts(tmp_path, text, cells):
    path = tmp_path / "rows.txt"
    path.write_text(text)
    table = table_of_numbers(path)
    assert table.cells.to_numpy().tolist() == [cells]
    assert table.n_column == len(table.headings)


@pytest.mark.parametrize("text", ["1,2\n,\n3,4\n", "1;2\n;\n3;4\n", '"1","2"\n""\n"3","4"\n'])
def test_a_row_of_separators_is_an_error_with_its_line(tmp_path, text):
    path = tmp_path / "rows.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"rows\.txt, line 2: .*nan"):
        number_tables(path)


def test_lines_of_separators_may_stand_above_rows(tmp_path):
    path = tmp_path / "rows.txt"
    path.write_text("Title;\n;\n1;2\n3;4\n")
    assert number_tables(path).main_table.cells.shape == (2, 2)
