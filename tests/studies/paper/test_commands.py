"""`python -m studies paper`: its figures from their configurations to the gallery."""

from pathlib import Path
from types import SimpleNamespace

from click.testing import CliRunner

from studies.__main__ import main
from studies.numbers import stored
from studies.paper.figure import Check
from tests.studies.paper.made import CONFIGURATIONS


def run(*arguments):
    return CliRunner().invoke(main, ["paper", *map(str, arguments)])


def test_commands_compute_draw_check_and_keep_a_figure(tmp_path, monkeypatch):
    output = tmp_path / "figures"
    computed = run("figure", CONFIGURATIONS / "main-1d.yaml", "--output", output)
    assert computed.exit_code == 0, computed.output
    data = output / "quick" / "main-1d.nc"
    assert run("draw", data).exit_code == 0
    assert data.with_suffix(".pdf").stat().st_size > 1000
    assert run("check", "--output", output).exit_code == 0
    assert "4 of 4 agree, 0 differ" in (output / "checks.md").read_text()
    monkeypatch.chdir(tmp_path)
    assert run("gallery", "--output", output).exit_code == 0
    kept = stored("paper").tables["main-1d"]
    assert "![Main Fig. 1d" in kept.text
    assert Path("docs/experiments/figures/main-1d.png").stat().st_size > 1000


def test_what_fails_stands_in_the_last_lines_and_first_in_the_file(tmp_path, monkeypatch):
    path = tmp_path / "quick" / "main-1d.nc"
    path.parent.mkdir()
    path.touch()
    failing = Check("k is 3", "3", "2", passed=False)
    shown = SimpleNamespace(title="Fig. 1", checks=lambda _: (failing,))
    monkeypatch.setattr("studies.paper.commands._figure_and_record", lambda _: (shown, None))
    last = run("check", "--output", tmp_path).stdout.splitlines()[-1]
    assert last == "FAIL: Fig. 1 (quick): k is 3: 3 expected, 2 found"
    lines = (tmp_path / "checks.md").read_text().splitlines()
    assert "0 of 1 agree" in lines[2]
    assert lines[4] == f"- {last}"


def test_the_figure_of_a_sweep_that_was_not_run_says_how_to_run_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").symlink_to(CONFIGURATIONS.parent)
    result = run("figure", "config/figures/si-5.yaml")
    assert result.exit_code == 2
    assert "run the sweep first: make SWEEP=config/default.yaml" in result.output
