"""`crackfront samples`: a table of results and one figure of a series."""

import csv
import io

import pytest

from tests.commands import refused, run

SPHERE = ["--modulus", "0.7MPa", "--poisson", "0.5", "--work-of-adhesion", "63mJ/m2"]
TABLE = """\
sample,group,rms,roll_off,hurst,short_cutoff,radius,measured_hysteresis
A,polished,20nm,2um,0.8,20nm,1.25mm,2mJ/m2
B,rough,40nm,2um,0.8,20nm,1.25mm,
C,rough,20um,2um,0.8,20nm,1.25mm,
"""


@pytest.fixture
def table(tmp_path, monkeypatch):
    """A table of three samples, the last of which no theory applies to."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "series.csv"
    path.write_text(TABLE)
    return path


def test_a_series_has_a_row_for_each_sample_and_a_figure(table):
    result = run("samples", table, *SPHERE)
    assert result.exit_code == 4, result.output
    folder = table.parent / "results/samples"
    with (folder / "series.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["sample"] for row in rows] == ["A", "B", "C"]
    assert [row["group"] for row in rows] == ["polished", "rough", "rough"]
    assert 0 < float(rows[0]["hysteresis"]) < float(rows[1]["hysteresis"])
    assert float(rows[0]["measured_hysteresis"]) == pytest.approx(2e-3)
    assert (rows[2]["outcome"], rows[2]["hysteresis"]) == ("does not apply", "")
    assert {path.name for path in folder.iterdir()} == {"series.csv", "series.pdf", "series.png"}
    assert "A: hysteresis 2" in result.output
    assert "samples" in run("--help").output


def test_a_table_may_be_printed_and_the_figure_show_another_number(table):
    figure = table.parent / "pull-off.svg"
    printed = run("samples", table, *SPHERE, "--csv", "-", "--figure", figure, "--quantity", "e_el")
    rows = list(csv.DictReader(io.StringIO(printed.stdout)))
    assert [row["sample"] for row in rows] == ["A", "B", "C"]
    assert "figure: " in printed.stderr
    assert figure.stat().st_size > 1000
    assert not (table.parent / "results").exists()


def test_nothing_is_computed_for_a_table_with_a_bad_row(table, monkeypatch):
    monkeypatch.setattr("crackfront.measured.samples.sample_results.check_and_predict", None)
    table.write_text(TABLE.replace("40nm", "40"))
    told = refused("samples", table, *SPHERE)
    assert "series.csv, line 3: rms is '40', without a unit" in told
    assert not (table.parent / "results").exists()


def test_the_chosen_quantity_is_printed_or_why_it_is_missing(table):
    options = (*SPHERE, "--no-figure", "--quantity", "pull_off_force")
    first, _, last = run("samples", table, *options).stdout.splitlines()[:3]
    assert first.startswith("A: pull-off force ")
    assert "uN" in first
    assert last.startswith("C: does not apply: full conformity")
    options = (*SPHERE, "--no-figure", "--quantity", "e_el")
    assert run("samples", table, *options).stdout.splitlines()[2].startswith("C: e_el ")


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
