"""The scans that the repository ships."""

from pathlib import Path

import pytest

from crackfront.measured.scan.reading import read_measurements
from studies.accuracy import scans

SHIPPED = tuple(sorted((Path(__file__).parents[3] / "examples/scans").glob("*.al3d")))


def test_the_shipped_scans_are_those_that_their_command_writes(tmp_path):
    scans.write_scans(tmp_path)
    made = read_measurements(sorted(tmp_path.glob("*.al3d")))
    for one, other in zip(made, read_measurements(SHIPPED), strict=True):
        assert one.path.name == other.path.name
        assert one.size == other.size
        assert one.heights == pytest.approx(other.heights, abs=1e-12)
