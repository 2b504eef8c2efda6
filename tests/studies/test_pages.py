"""What studies store, and the pages that show it."""

from pathlib import Path

import pytest

from studies.__main__ import STUDIES
from studies.numbers import Number, Stored, Table, store, stored
from studies.pages import renewed
from tests.places import ROOT

PAGE = "<!-- law: limit -->\nold\n<!-- end -->\nAfter <!-- speed: ratio -->7<!-- end --> times\n"
ORIGIN = {"command": "studies law", "commit": "1a2b3c4d5e", "machine": "EPYC", "date": "2026-11-28"}


def known(table):
    """Stored table of one study and number of another."""
    number = Number(8.0, 0.5, command="studies speed", commit="9f8e7d6c5b", date="2026-11-27")
    return {
        "law": Stored(tables={"limit": Table(table, **ORIGIN)}),
        "speed": Stored(numbers={"ratio": number}),
    }


def test_a_page_has_its_blocks_and_one_last_line_that_says_where_they_were_measured():
    text = renewed(PAGE, known("| 3 |"))
    assert "-->\n\n| 3 |\n\n<!--" in text
    assert "After <!-- speed: ratio -->8.00 ± 0.50<!-- end --> times" in text
    assert "`studies law` (commit 1a2b3c4, EPYC, 2026-11-28)" in text.splitlines()[-2]
    assert text.count("Numbers of this page") == 1
    assert renewed(text, known("| 3 |")) == text


def test_a_block_may_be_a_cell_of_a_table():
    table = "| a | b |\n| --- | --- |\n| 1 | 2 |\n| 1 | 3 |"
    cell = "k is <!-- law: limit / 1 | 3 / 2 -->0<!-- end -->\n"
    assert renewed(cell, known(table)).startswith(cell.replace(">0<", ">3<"))
    with pytest.raises(ValueError, match="no row of the table begins with '4'"):
        renewed(cell.replace("1 | 3", "4"), known(table))


def test_what_is_stored_is_read_again_and_leaves_the_rest(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    origin = {"command": "a", "git_commit": "b", "processor": "EPYC", "date": "2026-11-28"}
    store("law", numbers={"k": Number(3.7, 0.1)}, tables={"limit": "| 3 |"}, data=origin)
    store("law", numbers={"k": Number(3.8, 0.1)}, canaries={"fit, k": Number(3.7, 0.1)})
    study = stored("law")
    assert (study.numbers["k"].value, study.canaries["fit, k"].value) == (3.8, 3.7)
    assert (study.tables["limit"].text, study.tables["limit"].commit) == ("| 3 |", "b")
    assert study.numbers["k"].date[:2] == "20"


def test_the_pages_hold_what_is_stored(monkeypatch):
    monkeypatch.chdir(ROOT)
    studies = {name: stored(name) for name in STUDIES}
    pages = {path: path.read_text() for path in Path("docs").rglob("*.md")}
    assert [path for path, text in pages.items() if renewed(text, studies) != text] == []
    shown = " ".join(pages.values())
    tables = {(study, name) for study, known in studies.items() for name in known.tables}
    assert {
        (study, name) for study, name in tables if f"<!-- {study}: {name}" not in shown
    } == set()
