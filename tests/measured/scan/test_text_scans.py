"""Texts: one encoding, one separator and one sign for decimals, whatever program wrote them."""

import numpy as np
import pytest

from tests.measured.made import HEAD, read, refusal, write_text

PLAIN = {"unit": "um", "size": "20"}


@pytest.fixture
def plain(tmp_path, noise):
    """Heights of a matrix as every reader knows it, and its text."""
    path = write_text(tmp_path / "plain.txt", noise)
    return read(path), path.read_text()


def agrees(path, text, expected, encoding="utf-8", **options):
    """Whether a text is read as the scan that is expected."""
    path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
    measurement = read(path, **options)
    assert measurement.size == pytest.approx(expected.size)
    np.testing.assert_array_equal(measurement.heights, expected.heights)


@pytest.mark.parametrize(
    "encoding",
    [
        *("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"),
        *("latin-1", "cp1252", "cp850", "cp437", "mac-roman"),
    ],
)
def test_a_text_is_read_in_the_encoding_that_it_has(tmp_path, plain, encoding):
    expected, text = plain
    german = text.replace("Width", "Breite").replace("um", "µm")
    agrees(tmp_path / "scan.txt", german, expected, encoding)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("um", "\u03bcm"),
        lambda text: text.replace("um", "Âµm"),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text + "\x1a",
        lambda text: text.replace("Main", "Main\u2028").replace("Width", "Breite"),
        lambda text: text.replace("Height", "Höhe").replace("Width", "Breite").encode("latin-1"),
    ],
)
def test_line_ends_and_letters_of_other_systems_change_nothing(tmp_path, plain, change):
    expected, text = plain
    agrees(tmp_path / "scan.txt", change(text), expected)


def separated(rows, separator, decimal="."):
    """Rows with another separator, and another sign for decimals."""
    return rows.replace(".", decimal).replace(" ", separator)


def quoted(rows, separator):
    """Rows whose cells stand in quotation marks."""
    lines = (separator.join(f'"{cell}"' for cell in line.split()) for line in rows.splitlines())
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    "change",
    [
        lambda rows: separated(rows, ";"),
        lambda rows: separated(rows, ";").replace("\n", ";\n"),
        lambda rows: separated(rows, ";", ","),
        lambda rows: separated(rows, " ; "),
        lambda rows: separated(rows, ","),
        lambda rows: separated(rows, ", "),
        lambda rows: separated(rows, ", ", ","),
        lambda rows: separated(rows, "\t", ","),
        lambda rows: rows.replace("\n", "\t\n"),
        lambda rows: quoted(rows, ","),
        lambda rows: quoted(rows.replace(".", ","), ","),
        lambda rows: quoted(rows.replace(".", ","), ";"),
    ],
)
def test_rows_are_read_with_any_separator_and_sign_for_decimals(tmp_path, plain, change):
    expected, text = plain
    agrees(tmp_path / "scan.csv", HEAD + change(text.removeprefix(HEAD)), expected)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda head, rows: head.replace("20 um", "20,9 um") + rows, 2),
        (lambda head, rows: head.replace("Height: 20 um", "Height: 20,9 um") + rows, 3),
        (lambda head, rows: head.replace("20 um", "1,024.5 nm") + rows, 2),
        (lambda head, rows: head.replace("20 um", "20.000 um") + rows.replace(".", ","), 2),
        (lambda head, rows: head + rows.replace(".", ",", 1), 5),
        (
            lambda head, rows: (
                head + rows.replace("\n", ";\n").replace(" ", ";").replace(".", ",", 9)
            ),
            5,
        ),
    ],
)
def test_two_signs_for_decimals_are_refused_with_the_line(tmp_path, plain, change, line):
    path = tmp_path / "scan.txt"
    path.write_text(change(HEAD, plain[1].removeprefix(HEAD)))
    assert f"scan.txt, line {line}:" in refusal(path)


def test_a_head_with_the_sign_of_the_rows_gives_the_sides(tmp_path, plain):
    rows = plain[1].removeprefix(HEAD)
    path = tmp_path / "scan.txt"
    path.write_text(HEAD.replace("20 um", "20,9 um") + rows.replace(".", ","))
    assert read(path).size == pytest.approx((20.9e-6, 20.9e-6))
    path.write_text(HEAD.replace("20 um", "20.9 um") + rows.replace(".", ","))
    assert read(path).size == pytest.approx((20.9e-6, 20.9e-6))
    dated = "# Date: 17.05.2024 12:34:56,7\n# Version: 2.65.1\n"
    path.write_text(dated + HEAD + rows)
    assert read(path).size == pytest.approx((20e-6, 20e-6))


def counted(rows, start=0, separator=" "):
    """Rows that begin with their number."""
    lines = enumerate(rows.splitlines(), start)
    return "".join(f"{number}{separator}{line}\n" for number, line in lines)


@pytest.mark.parametrize(
    "change",
    [
        counted,
        lambda rows: counted(rows, 1),
        lambda rows: (
            "," + ",".join(map(str, range(48))) + "\n" + counted(rows.replace(" ", ","), 0, ",")
        ),
        lambda rows: " ".join(map(str, range(48))) + "\n" + rows,
        lambda rows: " ".join(f"c{number}" for number in range(48)) + "\n" + rows,
    ],
)
def test_numbers_of_rows_and_columns_are_no_heights(tmp_path, plain, change):
    expected, text = plain
    agrees(tmp_path / "scan.txt", change(text.removeprefix(HEAD)), expected, **PLAIN)


def test_positions_beside_a_matrix_are_refused(tmp_path, plain):
    rows = plain[1].removeprefix(HEAD).splitlines()
    path = tmp_path / "scan.txt"
    path.write_text("".join(f"{0.4 * number:.4g} {row}\n" for number, row in enumerate(rows)))
    assert "the first column is equally spaced, 0.4 to 18.8, as positions" in refusal(path, **PLAIN)


def test_a_head_that_contradicts_the_rows_is_refused_by_both_numbers(tmp_path, plain):
    head = "# File Format = ASCII\n# x-pixels = 64\n# y-pixels = 64\n# z-unit = um\n"
    path = tmp_path / "scan.txt"
    path.write_text(head + plain[1].removeprefix(HEAD))
    assert "it has 48 rows, and its head says 64" in refusal(path)
    path.write_text(plain[1].replace("units: um", "units: V"))
    assert "all of its channels lack a unit of length" in refusal(path)
