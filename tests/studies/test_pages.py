"""What studies store, and the pages that show or quote it."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from studies.__main__ import STUDIES, main
from studies.numbers import Number, Stored, StoredFigure, Table, store, stored
from studies.quotes import QUOTED, Quote
from studies.table_pages import GALLERY, TABLES, written_pages
from tests.places import ROOT

CHECKS = """\
| claim | expected | found | result | remark |
| --- | --- | --- | --- | --- |
| radius | 1 | 1 | agrees | exact |
| k | 3 | 2 | differs as the law of k says: 2 |  |"""
ORIGIN = {"command": "studies law", "commit": "1a2b3c4d5e", "machine": "EPYC", "date": "2026-11-28"}


def quoted_texts(text):
    """Stored tables of two studies, and a number."""
    number = Number(8.0, 0.5, command="studies speed", commit="9f8e7d6c5b", date="2026-11-27")
    law, counts = Table(text, **ORIGIN), Table("3 of 3 agree", **ORIGIN)
    figure = StoredFigure(
        title="Fig. 1d: a sphere",
        picture="main-1d.png",
        scale="quick",
        cpu_seconds=3.0,
        checks=CHECKS,
        **(ORIGIN | {"command": "make figures"}),
    )
    return {
        "law": Stored(tables={"limit": law}),
        "paper": Stored(tables={"counts": counts}, figures={"main-1d": figure}),
        "speed": Stored(numbers={"ratio": number}),
    }


def test_each_study_with_tables_has_a_page_whose_last_line_says_where_they_were_measured():
    pages = written_pages(quoted_texts("# k\n\n| 3 |"))
    assert set(pages) == {TABLES / "law.md", TABLES / "paper.md", GALLERY}
    lines = pages[TABLES / "law.md"].splitlines()
    assert [line for line in lines if line.startswith("#")][1:] == ["## Limit", "## k"]
    assert "| 3 |" in lines
    assert "`python -m studies law` (commit 1a2b3c4, EPYC, 2026-11-28)" in lines[-1]


def test_each_table_of_a_page_has_its_command_below_its_heading():
    tables = {name: Table("| 3 |", **(ORIGIN | {"command": name})) for name in ("make a", "make b")}
    page = written_pages({"law": Stored(tables=tables)})[TABLES / "law.md"]
    assert "## Make a\n\nBy `make a`:" in page
    assert "## Make b\n\nBy `make b`:" in page


def test_the_gallery_begins_with_the_counts_and_the_checks_that_do_not_agree():
    text = written_pages(quoted_texts("| 3 |"))[GALLERY]
    differing = "](tables/paper.md#checks-main-1d) | k | 3 | 2 | differs as the law of k says: 2 |"
    picture = "![main-1d](figures/main-1d.png)"
    cost = "scale quick, 3 s"
    places = ["3 of 3 agree", differing, "## Fig. 1d", picture, "*1 of 2 [", cost, "1a2b3c4"]
    assert sorted(places, key=text.index) == places
    assert "radius" not in text


def test_all_checks_of_a_figure_are_on_the_page_of_tables():
    lines = written_pages(quoted_texts("| 3 |"))[TABLES / "paper.md"].splitlines()
    assert lines.index("## Checks, main-1d") < lines.index("| radius | 1 | 1 | agrees | exact |")
    assert "![main-1d](figures/main-1d.png)" not in lines


@pytest.mark.parametrize(
    ("place", "shown"),
    [
        ("{speed: ratio}", "8.00 ± 0.50"),
        ("{speed: ratio -> .1f}", "8.0"),
        ("{speed: ratio -> .0f ± .1f}", "8 ± 0.5"),
        ("{law: limit / 1 | 3 / 2}", "3"),
        ("{paper: main-1d / radius / 4}", "agrees"),
        ("{law: limit}", "| a | b |\n| --- | --- |\n| 1 | 2 |\n| **1** | 3 |"),
    ],
)
def test_a_quote_is_a_number_in_a_form_or_a_cell_or_a_table(place, shown, tmp_path):
    page = tmp_path / "page.md"
    studies = quoted_texts("| a | b |\n| --- | --- |\n| 1 | 2 |\n| **1** | 3 |")
    quote = Quote(page, f"it is {place} times")
    assert quote.text(studies) == f"it is {shown} times"
    page.write_text(f"So it\nis {shown} times as large.")
    assert quote.is_shown(studies)
    page.write_text("So it is 9 times as large.")
    assert not quote.is_shown(studies)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("{speed: size}", "the study speed has not measured 'size'"),
        ("{power: ratio}", "the study power has not measured 'ratio'"),
        ("{law: limit / 4 / 2}", "no row of the table begins with '4'"),
    ],
)
def test_a_quote_of_what_was_not_measured_names_it(place, message):
    with pytest.raises(ValueError, match=message):
        Quote(Path("page.md"), place).text(quoted_texts("| 3 |"))


def test_what_is_stored_is_read_again_and_leaves_the_rest(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    origin = {"command": "a", "git_commit": "b", "processor": "EPYC", "date": "2026-11-28"}
    store("law", numbers={"k": Number(3.7, 0.1)}, tables={"limit": "| 3 |"}, data=origin)
    store("law", numbers={"k": Number(3.8, 0.1)}, canaries={"fit, k": Number(3.7, 0.1)})
    study = stored("law")
    assert (study.numbers["k"].value, study.canaries["fit, k"].value) == (3.8, 3.7)
    assert (study.tables["limit"].text, study.tables["limit"].commit) == ("| 3 |", "b")
    assert study.numbers["k"].date[:2] == "20"


def test_the_written_pages_show_what_is_stored(monkeypatch):
    monkeypatch.chdir(ROOT)
    pages = written_pages({name: stored(name) for name in STUDIES})
    assert [path for path, text in pages.items() if path.read_text() != text] == []


def test_the_command_writes_the_pages_of_tables_and_names_pages_to_edit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    store("law", tables={"limit": "| 3 |"}, numbers={"k": Number(3.7)})
    Path("page.md").write_text("k is 3.6")
    QUOTED.write_text("page.md: ['k is {law: k}']")
    first = CliRunner().invoke(main, ["pages"]).output.splitlines()
    assert first[0] == f"page: {TABLES / 'law.md'}"
    assert "page.md" in first[-1]
    assert "k is 3.7" in first[-1]
    Path("page.md").write_text("k is 3.7")
    assert CliRunner().invoke(main, ["pages"]).output == ""
