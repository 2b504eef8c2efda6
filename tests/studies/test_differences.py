"""Numbers of two runs: which are compared, with which error, and which differ."""

import math
import re
import shutil

import pytest
from click.testing import CliRunner

from studies.__main__ import main
from studies.differences import changes, differences_text, numbers
from studies.pages import Part, keep_parts

TABLE = """Scale paper, 3 s of one core.

| claim | expected | found | remark |
| --- | --- | --- | --- |
| k of all | 3.00 ± 0.50 | 2.22 (2.20 to 2.24) | 12 spectra |
| lowest force | -2.1 ± 0.002 N | -2.1004 N | |
| events | > 0 | 254 from 3e-09 | |
"""
TIMES = (
    "| scene | CPU s | error | peak MB |\n| --- | --- | --- | --- |\n| flat | 3 | 0.1 ± 0.02 | 7 |"
)


def part(text, machine="EPYC"):
    return Part(text, "studies law", "1a2b3c4d5e", machine, [], "")


def test_numbers_have_the_error_of_their_cell_or_of_their_claim():
    found = {(one.place, one.value): one.error for one in numbers(TABLE)}
    assert found["k of all, found", 2.22] == pytest.approx(0.02)
    assert found["lowest force, found", -2.1004] == 0.002
    assert math.isnan(found["events, found", 254.0])
    assert math.isnan(found["events, found", 3e-9])
    assert not any("remark" in place for place, _ in found)


def test_times_and_memory_are_not_compared():
    assert [one.value for one in numbers(TIMES)] == [0.1]
    assert [*numbers("Scale paper, 3 s of one core.")] == []
    fastest = "| scene | g | 1% |\n| --- | --- | --- |\n| flat | 0.5 | 0.2 s (0.9%), 461 times |"
    assert [one.value for one in numbers(fastest)] == [0.5]


def test_a_number_differs_beyond_its_error():
    other = TABLE.replace("2.22", "2.25").replace("-2.1004", "-2.1005").replace("254", "255")
    moved = {one.here.place: one for one in changes(TABLE, other) if not one.is_equal}
    assert moved["k of all, found"].in_errors == pytest.approx(1.5)
    assert moved["lowest force, found"].in_errors == pytest.approx(0.05)
    assert moved["events, found"].relative == pytest.approx(1 / 255)
    text = differences_text({"law": {"k": part(TABLE)}}, {"law": {"k": part(other, "Xeon")}})
    row, beyond = text.splitlines()[2], text.splitlines()[-1]
    assert row == "| k | EPYC, 1a2b3c4 | Xeon, 1a2b3c4 | 7 | 4 | 1.5 | 1 | 0.0039 |"
    assert beyond == "- k, k of all, found: 2.22 and 2.25, 1.5 times the error"


def test_without_width_any_change_is_beyond_the_error():
    [same] = changes("1.5 (1.5 to 1.5)", "1.5 (1.5 to 1.5)")
    [other] = changes("1.5 (1.5 to 1.5)", "1.6 (1.6 to 1.6)")
    assert (same.in_errors, other.in_errors) == (0, math.inf)


def test_round_off_is_equal():
    [change] = changes("3e-15", "1e-14")
    assert change.is_equal
    [change] = changes("3e-11", "1e-10")
    assert change.relative == pytest.approx(0.7)


def test_tables_of_other_rows_are_not_compared_number_by_number():
    with pytest.raises(ValueError, match="not the same rows"):
        changes(TABLE, TABLE.replace("lowest force", "force"))
    other = {"law": {"k": part(TABLE.replace("lowest force", "force"))}}
    assert "- k: the two texts" in differences_text({"law": {"k": part(TABLE)}}, other)


def test_a_folder_without_parts_is_refused_and_that_of_a_clone_is_compared(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["differences", str(tmp_path)])
    assert done.exit_code
    assert "has no numbers in docs/reference/parts" in done.output
    keep_parts("law", {"k": "k is 2.0 ± 0.1"}, "studies.pages")
    (tmp_path / "other").mkdir()
    shutil.copytree("docs", "other/docs")
    done = CliRunner().invoke(main, ["differences", "other", "--machine", "another"])
    assert done.exit_code == 0, done.output
    assert re.search(r"\| k \| .* \| another, .* \| 1 \| 1 \| 0 \| 0 \| 0 \|", done.output)
