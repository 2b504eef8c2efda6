"""The scans that the repository ships."""

from pathlib import Path

import pytest

from crackfront.measured.scan.reading import read_measurements
from studies.accuracy import scans

SHIPPED = tuple(sorted((Path(__file__).parents[3] / "examples/scans").glob("*.al3d")))


def test_the_shipped_scans_are_those_that_their_command_writes(tmp_path):
    scans.write_scans(tmp_path)
    made = read_measurements(sorted(tmp_path.glob("*.al3d")))
    for scan, shipped in zip(made, read_measurements(SHIPPED), strict=True):
        assert scan.path.name == shipped.path.name
        assert scan.size == shipped.size
        assert scan.heights == pytest.approx(shipped.heights, abs=1e-12)
