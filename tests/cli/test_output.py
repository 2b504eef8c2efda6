"""Output: no command depends on who reads it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.commands import slow, stored
from tests.places import ROOT

TEST = str(ROOT / "config/test.yaml")


def command(*arguments):
    """A command in a process of its own."""
    return [sys.executable, "-m", "crackfront", *map(str, arguments)]


@pytest.mark.slow
def test_a_sweep_is_computed_although_nobody_reads_its_lines(tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    told = command("simulate", TEST, "--output", tmp_path)
    done = subprocess.run(told, stdout=writer, stderr=writer, timeout=600, check=False)
    os.close(writer)
    assert done.returncode == 0
    assert len(stored(tmp_path)) == 8
    assert {path.name for path in (tmp_path / "shards").glob("*.nc")} == {"flat.nc", "rough.nc"}


@pytest.mark.parametrize("closing", [slow(">&-"), slow(">&- 2>&-"), "<&- >&- 2>&-"])
def test_a_closed_output_becomes_no_file_that_is_written(tmp_path, closing):
    (tmp_path / "text").write_text("content")
    told = ["bash", "-c", f'exec "$@" {closing}', "bash", *command("checksums", tmp_path)]
    assert subprocess.run(told, timeout=600, check=False).returncode == 0
    assert (tmp_path / "SHA256SUMS").read_text().endswith("  text\n")
    assert len((tmp_path / "SHA256SUMS").read_text().splitlines()) == 1


def test_an_answer_that_does_not_fit_on_a_disk_is_no_success():
    with Path("/dev/full").open("w") as full:
        told = command("law", "--w-rms", 0.4, "--g", 10)
        done = subprocess.run(told, stdout=full, timeout=600, check=False)
    assert done.returncode != 0
