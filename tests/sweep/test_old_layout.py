"""Results of earlier versions, whose curves were in tar files."""

import pytest

from tests.commands import run
from tests.sweep.conftest import TEST


@pytest.mark.parametrize("command", ["plan", "simulate", "aggregate"])
def test_a_folder_of_an_earlier_version_is_rejected_and_stays_as_it_is(command, tmp_path):
    curves = tmp_path / "curves"
    curves.mkdir()
    (curves / "flat.1.tar").write_bytes(b"earlier")
    ended = run(command, TEST, "--output", tmp_path)
    assert ended.exit_code == 2
    assert "new folder" in ended.output
    assert [path.name for path in tmp_path.rglob("*.*")] == ["flat.1.tar"]
