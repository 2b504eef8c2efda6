"""The figure of the law of k."""

from click.testing import CliRunner

from studies.__main__ import main
from tests.places import ROOT


def test_the_command_draws_the_law(tmp_path, monkeypatch):
    monkeypatch.chdir(ROOT)
    done = CliRunner().invoke(main, ["law", "figure", "--output", str(tmp_path / "figures")])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "figures/law.png").stat().st_size > 10_000
