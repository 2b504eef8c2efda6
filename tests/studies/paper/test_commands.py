"""`python -m studies paper`: its figures from their configurations to the gallery."""

from pathlib import Path
from types import SimpleNamespace

from click.testing import CliRunner

from studies.__main__ import main
from studies.numbers import stored
from studies.paper.checks import Check
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
    assert "4 of 4 agree, 0 differ" in (output / "checks.md").read_text().splitlines()[2]
    monkeypatch.chdir(tmp_path)
    assert run("gallery", "--output", output).exit_code == 0
    kept = stored("paper").figures["main-1d"]
    assert (kept.title[:12], kept.picture, kept.scale) == ("Main Fig. 1d", "main-1d.png", "quick")
    assert [row["result"] for row in kept.checks.records()] == ["agrees"] * 4
    assert Path("docs/experiments/figures/main-1d.png").stat().st_size > 1000


def with_checks(monkeypatch, folder, *checks):
    """Folder with data of one figure, whose checks are replaced."""
    path = folder / "quick" / "main-1d.nc"
    path.parent.mkdir()
    path.touch()
    shown = SimpleNamespace(title="Fig. 1", checks=lambda _: checks)
    monkeypatch.setattr("studies.paper.commands._figure_and_record", lambda _: (shown, None))


def test_counts_and_what_fails_stand_first_in_the_file_and_last_in_the_output(
    tmp_path, monkeypatch
):
    with_checks(monkeypatch, tmp_path, Check("k is 3", "3", "2", passed=False))
    last = run("check", "--output", tmp_path).stdout.splitlines()[-2:]
    assert "0 of 1 agree" in last[0]
    assert last[1] == "- FAIL: Fig. 1 (quick): k is 3: 3 expected, 2 found"
    assert (tmp_path / "checks.md").read_text().splitlines()[2:4] == last


def test_expectations_and_what_is_undecided_do_not_fail_and_are_counted_by_themselves(
    tmp_path, monkeypatch
):
    checks = (
        Check("k is 3", "3", "3", passed=True),
        Check("onset", "in order", "-", passed=False, undecided="too few surfaces"),
        Check("tau", "1.28", "1.1", passed=False, expectation="Theory of depinning."),
    )
    with_checks(monkeypatch, tmp_path, *checks)
    counts = run("check", "--output", tmp_path).stdout.splitlines()[1:]
    assert len(counts) == 2
    assert "1 of 2 agree" in counts[0]
    assert "1 cannot be decided" in counts[0]
    assert "0 of 1 met, 1 not met" in counts[1]
    text = (tmp_path / "checks.md").read_text()
    assert "FAIL" not in text
    assert "| cannot be decided | too few surfaces |" in text
    assert "| Theory of depinning. |" in text


def test_the_figure_of_a_sweep_that_was_not_run_says_how_to_run_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").symlink_to(CONFIGURATIONS.parent)
    result = run("figure", "config/figures/si-5.yaml")
    assert result.exit_code == 2
    assert "run the sweep first: make SWEEP=config/default.yaml" in result.output
