"""What studies store, the gallery, and the pages that quote it."""

from pathlib import Path

import pandas as pd
import pytest
from click.testing import CliRunner

from studies.__main__ import STUDIES, main
from studies.numbers import Number, Stored, StoredFigure, StoredTable, checks_path, store, stored
from studies.paper.gallery import GALLERY, gallery_page
from studies.quotes import QUOTED, Quote
from studies.tables import TABLES, Table, make_table, table_path
from tests.places import ROOT

CHECKS = make_table(
    "kind | claim | expected | found | result | reason | remark | source",
    [
        "statement | radius | 1 | 1 | agrees |  | exact | ",
        "statement | k | 3 | 2 | differs as the law of k says | 2 |  | ",
        "expectation | tau | 1.3 | 1.1 | cannot be decided | too few |  | theory",
    ],
)
ORIGIN = {"command": "studies law", "commit": "1a2b3c4d5e", "machine": "EPYC", "date": "2026-11-28"}
FIGURE = StoredFigure(
    title="Fig. 1d: a sphere",
    picture="main-1d.png",
    scale="quick",
    cpu_seconds=3.0,
    checks=CHECKS,
    **(ORIGIN | {"command": "make figures"}),
)
LIMIT = make_table("s | branch | k", ["1 | 1 | 2.10", "1 | 2 | 3.0"], "Of infinite contacts.")


def quoted_content():
    """Stored tables of two studies, and a number."""
    number = Number(8.0, 0.5, command="studies speed", commit="9f8e7d6c5b", date="2026-11-27")
    return {
        "law": Stored(tables={"limit": StoredTable(LIMIT, **ORIGIN)}),
        "paper": Stored(figures={"main-1d": FIGURE}),
        "speed": Stored(numbers={"ratio": number}),
    }


def test_the_gallery_begins_with_the_counts_and_the_checks_that_do_not_agree():
    text = gallery_page({"main-1d": FIGURE})
    link = "](../reference/tables/paper/checks-main-1d.csv)"
    places = [
        "1 of 2 agree, 1 differ as the law of k says",
        "0 of 1 met, 0 not met, 1 cannot be decided",
        f"{link} | k | 3 | 2 | differs as the law of k says: 2 |",
        f"{link} | tau | 1.3 | 1.1 | cannot be decided at quick scale: too few |",
        "## Fig. 1d",
        "![main-1d](figures/main-1d.png)",
        "*1 of 3 [",
        "scale quick, 3 s",
        "`make figures` (commit 1a2b3c4, EPYC, 2026-11-28)",
    ]
    assert sorted(places, key=text.index) == places
    assert "radius" not in text


@pytest.mark.parametrize(
    ("place", "shown"),
    [
        ("{speed: ratio}", "8.00 ± 0.50"),
        ("{speed: ratio -> .1f}", "8.0"),
        ("{speed: ratio -> .0f ± .1f}", "8 ± 0.5"),
        ("{law: limit / 1 | 2 / k}", "3.0"),
        ("{paper: main-1d / statement | radius / result}", "agrees"),
    ],
)
def test_a_quote_is_a_number_in_a_form_or_a_cell(place, shown, tmp_path):
    page = tmp_path / "page.md"
    studies = quoted_content()
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
        ("{law: limit}", "the study law has not measured 'limit'"),
        ("{law: limit / 4 / k}", "no row of the table begins with '4'"),
        ("{law: limit / 1 / g}", "the table lacks a column 'g'; it has s, branch, k"),
    ],
)
def test_a_quote_of_what_was_not_measured_names_it(place, message):
    with pytest.raises(ValueError, match=message):
        Quote(Path("page.md"), place).text(quoted_content())


def test_what_is_stored_is_read_again_and_leaves_the_rest(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    origin = {"command": "a", "git_commit": "b", "processor": "EPYC", "date": "2026-11-28"}
    figures = {"main-1d": FIGURE}
    store("law", numbers={"k": Number(3.7, 0.1)}, tables={"limit": LIMIT}, data=origin)
    store("law", numbers={"k": Number(3.8, 0.1)}, canaries={"fit, k": Number(3.7, 0.1)})
    store("law", figures=figures, data=origin)
    study = stored("law")
    assert (study.numbers["k"].value, study.canaries["fit, k"].value) == (3.8, 3.7)
    assert study.tables["limit"].table == LIMIT
    assert (study.tables["limit"].command, study.tables["limit"].commit) == ("a", "b")
    assert study.figures["main-1d"].checks == CHECKS
    assert study.figures["main-1d"].commit == "b"
    assert study.numbers["k"].date[:2] == "20"


def test_a_stored_table_is_a_file_of_numbers_for_pandas(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    table = make_table("scene | k, low | bias", ["flat, coarse | 1.70 | +0.1", ["h08", "1.9", ""]])
    store("law", tables={"Settings, flat-0.04": table})
    frame = pd.read_csv("docs/reference/tables/law/settings-flat-0.04.csv")
    assert frame["scene"].tolist() == ["flat, coarse", "h08"]
    assert frame["k, low"].tolist() == [1.7, 1.9]
    assert frame["bias"].isna().tolist() == [False, True]


@pytest.mark.parametrize(
    ("columns", "row", "message"),
    [
        (("k", "k"), ("1", "2"), "two columns have the same name"),
        (("k", "g"), ("1",), "1 cells in 2 columns"),
    ],
)
def test_a_table_that_a_file_would_change_is_an_error(columns, row, message):
    with pytest.raises(ValueError, match=message):
        Table(columns, (row,))


@pytest.mark.parametrize("study", STUDIES)
def test_every_file_of_tables_is_that_of_a_stored_table_with_its_origin(study, monkeypatch):
    monkeypatch.chdir(ROOT)
    record = stored(study)
    tables = {table_path(study, name): entry.table for name, entry in record.tables.items()}
    tables |= {checks_path(study, name): figure.checks for name, figure in record.figures.items()}
    assert set((TABLES / study).iterdir()) == set(tables)
    for entry in (*record.tables.values(), *record.figures.values()):
        assert all((entry.command, entry.commit, entry.machine, entry.date))
    for path, table in tables.items():
        frame = pd.read_csv(path)
        assert (tuple(frame.columns), len(frame)) == (table.columns, len(table.rows))
        assert path.read_text() == table.csv()
        assert "**" not in path.read_text()


def test_the_list_of_tables_and_the_gallery_link_to_every_file(monkeypatch):
    monkeypatch.chdir(ROOT)
    pages = (TABLES / "README.md").read_text() + GALLERY.read_text()
    files = [str(path.relative_to(TABLES)) for path in TABLES.rglob("*.csv")]
    assert len(files) > 50
    assert [file for file in files if f"{file})" not in pages] == []


def test_the_command_changes_nothing_where_all_pages_are_current(monkeypatch):
    monkeypatch.chdir(ROOT)
    before = GALLERY.stat().st_mtime_ns
    assert CliRunner().invoke(main, ["pages"]).output == ""
    assert GALLERY.stat().st_mtime_ns == before


def test_the_command_writes_the_gallery_and_names_pages_to_edit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    store("law", numbers={"k": Number(3.7)})
    store("paper", figures={"main-1d": FIGURE})
    Path("page.md").write_text("k is 3.6")
    QUOTED.write_text("page.md: ['k is {law: k}']")
    first = CliRunner().invoke(main, ["pages"]).output.splitlines()
    assert first[0] == f"page: {GALLERY}"
    assert "page.md" in first[-1]
    assert "k is 3.7" in first[-1]
    Path("page.md").write_text("k is 3.7")
    assert CliRunner().invoke(main, ["pages"]).output == ""
