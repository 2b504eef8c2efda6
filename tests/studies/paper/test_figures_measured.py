"""CSV files of measured points: read whole, or refused with the number of the line."""

import numpy as np
import pytest
from pydantic_core import PydanticCustomError

from studies.paper.measured import Quantity, read_measured

LENGTH = Quantity("length", {"m": 1.0, "um": 1e-6}, positive=True)
LOAD = Quantity("load", {"N": 1.0, "mN": 1e-3})


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "points.csv"
    path.write_bytes(text.encode(encoding))
    return path


def test_columns_come_in_si_units_whatever_their_order_and_notes(tmp_path):
    path = written(tmp_path, "# by hand\nload (mN),branch,length (um)\n-2,in,3\n\n4, out ,5\n")
    table = read_measured(path, (LENGTH, LOAD), words=("branch",))
    np.testing.assert_allclose(table.numbers, [[3e-6, 5e-6], [-2e-3, 4e-3]])
    assert table.words.tolist() == [["in", "out"]]
    assert table.lines.tolist() == [3, 5]


def test_a_file_of_a_spreadsheet_with_a_byte_order_mark_is_read(tmp_path):
    path = written(tmp_path, "length (m)\r\n1\r\n2\r\n", encoding="utf-8-sig")
    assert read_measured(path, (LENGTH,)).numbers.tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("load (N)\n1\n", "line 1: column length is missing; the header has load"),
        ("length (m),length (m)\n1,1\n", "line 1: column length stands twice; remove one"),
        ("length (inch)\n1\n", "line 1: length is in inch; write length .unit. with one of m, um"),
        ("length\n1\n", "line 1: length has no unit"),
        ("length (m)\n1\nx\n", "line 3: length is 'x'; it must be a positive number"),
        ("length (m)\n0\n", "line 2: length is '0'; it must be a positive number"),
        ("length (m)\ninf\n", "line 2: length is 'inf'; it must be a positive number"),
        ("length (m)\n1,2\n", "line 2 has 2 values for 1 columns; complete it"),
        ("length (m)\n", "has a header but no rows"),
        ("", "is empty; it needs a header and rows"),
    ],
)
def test_a_wrong_file_is_refused_with_its_line(tmp_path, text, sentence):
    with pytest.raises(PydanticCustomError, match=sentence):
        read_measured(written(tmp_path, text), (LENGTH,))


def test_a_file_that_is_no_text_or_missing_is_refused(tmp_path):
    with pytest.raises(PydanticCustomError, match="is no UTF-8 text; save it as UTF-8"):
        read_measured(written(tmp_path, "length (µm)\n1\n", encoding="latin-1"), (LENGTH,))
    with pytest.raises(PydanticCustomError, match="cannot be read: No such file"):
        read_measured(tmp_path / "none.csv", (LENGTH,))
