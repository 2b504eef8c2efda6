"""Detectors, cameras and mounts at the end of their range."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, TRUTH, loop

WHOLE = loop(0)
RIG = Rig(RADIUS, MODULUS)
PULL = -np.min(loop(0, force_noise=0.0).force)


def check_works(result, names=TRUTH):
    """Works of adhesion are near the truth and within their intervals."""
    for name in names:
        estimate = getattr(result, name)
        assert estimate.value == pytest.approx(TRUTH[name], rel=0.05)
        assert estimate.low <= TRUTH[name] <= estimate.high


@pytest.mark.parametrize("without", ["displacement", "radius"])
@pytest.mark.parametrize("part", [0.95, 0.8, 0.6])
def test_a_clipped_pull_gives_a_lower_bound_and_the_works_of_the_other_rows(part, without):
    rig = replace(RIG, stiffness=1e3 if without == "radius" else None)
    whole = loop(0, without=without)
    result = analyse_loop(replace(whole, force=np.maximum(whole.force, -part * PULL)), rig)
    check_works(result)
    assert result.pull_off_force.value == pytest.approx(part * PULL, rel=0.02)
    assert result.pull_off_force.high == np.inf
    assert "at least" in repr(result)
    assert np.isnan(result.lost_energy)
    assert any("smallest force" in remark for remark in result.remarks)


def test_a_detector_that_pulls_do_not_reach_has_a_bound_of_no_pull():
    result = analyse_loop(replace(WHOLE, force=np.maximum(WHOLE.force, 0.0)), RIG)
    assert result.pull_off_force.value == pytest.approx(0.0, abs=0.02 * PULL)
    assert result.pull_off_force.high == np.inf


def test_counts_of_a_converter_around_the_limit_are_a_limit():
    step = np.max(WHOLE.force) / 4096
    jitter = np.random.default_rng(0).integers(-1, 2, WHOLE.force.size)
    counts = np.round(WHOLE.force / step)
    low = np.round(-0.8 * PULL / step)
    force = step * np.where(counts < low, low + jitter, counts)
    result = analyse_loop(replace(WHOLE, force=force), RIG)
    check_works(result)
    assert result.pull_off_force.high == np.inf


@pytest.mark.parametrize("column", ["force", "radius", "displacement"])
def test_a_limit_at_the_turn_is_named_and_its_rows_are_left_out(column):
    values = getattr(WHOLE, column)
    limited = np.minimum(values, np.quantile(values, 0.8))
    result = analyse_loop(replace(WHOLE, **{column: limited}), RIG)
    check_works(result)
    assert any(f"largest {column}" in remark for remark in result.remarks)


@pytest.mark.parametrize("step", [1 / 4096, 1 / 100])
def test_a_coarse_force_is_not_a_limited_one(step):
    force = np.round(WHOLE.force / np.max(WHOLE.force) / step) * step * np.max(WHOLE.force)
    result = analyse_loop(replace(WHOLE, force=force), RIG)
    assert np.isfinite(result.pull_off_force.high)
    assert not any("seems to end" in remark for remark in result.remarks)


def test_a_rest_at_the_turn_is_not_a_limit():
    turn = int(np.argmax(WHOLE.displacement))
    rest = np.repeat(
        np.arange(WHOLE.force.size), np.where(np.arange(WHOLE.force.size) == turn, 30, 1)
    )
    force = WHOLE.force[rest] * np.where(rest == turn, 1 - 1e-3 * np.arange(rest.size), 1)
    resting = replace(
        WHOLE, force=force, radius=WHOLE.radius[rest], displacement=WHOLE.displacement[rest]
    )
    assert not any("seems to end" in remark for remark in analyse_loop(resting, RIG).remarks)
