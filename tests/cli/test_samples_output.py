"""What `crackfront samples` prints and writes of each sample."""

import csv

import pytest

from tests.cli.test_samples import SPHERE, TABLE
from tests.commands import run


@pytest.fixture
def table(tmp_path, monkeypatch):
    """A table of three samples, the last of which no theory applies to."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "series.csv"
    path.write_text(TABLE)
    return path


def test_the_chosen_quantity_is_printed_and_why_there_is_none(table):
    options = (*SPHERE, "--no-figure", "--quantity", "pull_off_force")
    first, _, last = run("samples", table, *options).stdout.splitlines()[:3]
    assert first.startswith("A: pull-off force ")
    assert "uN" in first
    assert last.startswith("C: does not apply: full conformity")


def test_e_el_is_printed_where_the_theory_does_not_apply_too(table):
    options = (*SPHERE, "--no-figure", "--quantity", "e_el")
    assert run("samples", table, *options).stdout.splitlines()[2].startswith("C: e_el ")


def test_a_file_that_cannot_be_read_says_why(table):
    (table.parent / "bad.txt").write_text("no scan\n")
    table.write_text("sample,scans,radius\nbad,bad.txt,1mm\n")
    result = run("samples", table, *SPHERE, "--no-figure")
    assert result.stdout.startswith("bad: invalid: ")
    assert "bad.txt" in result.stdout.splitlines()[0]


def test_a_text_stays_a_text_in_a_spreadsheet(table):
    names = ["=cmd|' /C calc'!A0", "@x", "+x", "-x"]
    rows = "".join(
        f'"{name}",polished,20nm,2um,0.8,20nm,1.25mm,-1mJ/m2,{name},-3\n' for name in names
    )
    table.write_text(f"{TABLE.splitlines()[0]},=note,batch\n{rows}")
    result = run("samples", table, *SPHERE, "--no-figure")
    assert "copied to the results without being used: =note, batch" in result.stderr
    with (table.parent / "results/samples/series.csv").open(newline="") as file:
        written = list(csv.DictReader(file))
    assert [row["sample"] for row in written] == [f"'{name}" for name in names]
    assert [row["'=note"] for row in written] == [f"'{name}" for name in names]
    assert {row["batch"] for row in written} == {"-3"}
    assert {float(row["measured_hysteresis"]) for row in written} == {-1e-3}
