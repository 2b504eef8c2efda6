"""Two files compared variable by variable, as `crackfront compare` does."""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.core.variables import variable
from crackfront.data.comparison import comparison
from crackfront.data.provenance import provenance
from crackfront.data.records import write_record


@dataclass(frozen=True)
class Loop:
    approach: float = variable("work of adhesion", "1")
    radius: np.ndarray = variable("radius", "1", "state")
    force: np.ndarray = variable("force", "1", "state")


@pytest.fixture
def paths(tmp_path):
    loop = Loop(0.6, np.linspace(1.0, 2.0, 50), np.linspace(-1.0, 3.0, 50))
    changed = replace(loop, force=loop.force * (1 + 1e-6))
    shorter = replace(loop, radius=loop.radius[1:], force=loop.force[1:])
    names = {"one.nc": loop, "other.nc": changed, "short.nc": shorter}
    for name, record in names.items():
        write_record(tmp_path / name, record, provenance())
    return [str(tmp_path / name) for name in names]


def compared(*arguments):
    return CliRunner().invoke(main, ["compare", *arguments])


def test_data_are_compared_variable_by_variable(paths, tmp_path):
    found = comparison(tmp_path / "other.nc", tmp_path / "one.nc").by_variable()
    assert found.pop("force").largest == pytest.approx(1e-6, rel=1e-3)
    assert {item.largest for item in found.values()} == {0.0}
    assert all(item.in_bits for item in found.values())
    short = comparison(tmp_path / "short.nc", tmp_path / "one.nc").by_variable()
    assert short["radius"].largest == np.inf


def test_a_difference_is_told_and_ends_with_1_unless_it_is_tolerated(paths):
    one, other, short = paths
    result = compared(other, one)
    assert result.exit_code == 1
    assert "force                                1.0e-06" in result.output
    assert "not in both, of another shape, or not a number in one: " in compared(short, one).output
    folder = compared(str(Path(one).parent), one)
    assert (folder.exit_code, "is a folder, and" in folder.output) == (2, True)
    variables = json.loads(compared(short, one, "--json").stdout)["variables"]
    assert variables["radius"] is None
    assert variables["approach"] == 0.0
    result = compared(other, one, "--tolerance", "1e-5")
    assert result.exit_code == 0
    assert "agreement of 1 file in values, not in bits, within 1.0e-06" in result.output
