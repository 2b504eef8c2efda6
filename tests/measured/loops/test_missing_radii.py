"""Rows in contact whose contact radius is missing, late or wrong."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, TRUTH, loop

WHOLE = loop(0)
ROWS = np.arange(WHOLE.radius.size)
TOUCHING = np.flatnonzero(WHOLE.radius > 0)
PULL = -np.min(loop(0, force_noise=0.0).force)
RIG = Rig(RADIUS, MODULUS)


def radii(*, seen=None, absent=np.nan):
    """Radii in some rows, an empty cell in others."""
    return np.where(seen, WHOLE.radius, absent)


@pytest.mark.parametrize("absent", [np.nan, 0.0])
@pytest.mark.parametrize(
    "seen",
    [
        pytest.param(ROWS % 8 == 0, id="every eighth frame"),
        pytest.param(TOUCHING[-1] - 1 >= ROWS, id="not the last frame"),
        pytest.param(TOUCHING[30] <= ROWS, id="a camera that starts late"),
        pytest.param(~np.isin(ROWS, TOUCHING[40:50]), id="a gap in the approach"),
    ],
)
def test_rows_without_a_radius_are_not_the_zero_of_the_force(seen, absent):
    result = analyse_loop(replace(WHOLE, radius=radii(seen=seen, absent=absent)), RIG)
    for name, truth in TRUTH.items():
        estimate = getattr(result, name)
        assert estimate.value == pytest.approx(truth, rel=0.05)
        assert estimate.low <= truth <= estimate.high
    assert result.pull_off_force.value == pytest.approx(PULL, rel=0.05)


def test_rows_that_are_not_the_zero_are_counted():
    whole = analyse_loop(WHOLE, RIG)
    assert any("60 rows out of contact" in remark for remark in whole.remarks)
    missing = analyse_loop(replace(WHOLE, radius=radii(seen=TOUCHING[3] <= ROWS)), RIG)
    assert any("60 rows out of contact" in remark for remark in missing.remarks)
    assert any("3 rows next to the contact" in remark for remark in missing.remarks)
    assert not any("next to the contact" in remark for remark in whole.remarks)


def test_a_radius_that_is_recorded_late_is_named_with_its_lag():
    late = np.concatenate([np.zeros(5), WHOLE.radius[:-5]])
    result = analyse_loop(replace(WHOLE, radius=late), RIG)
    [remark] = [remark for remark in result.remarks if "recorded late" in remark]
    assert "in 5 rows after the pull-off" in remark
    assert "5 rows after the jump" in remark
    assert not any("leave out --modulus" in remark for remark in result.remarks)
    assert result.pull_off_force.value == pytest.approx(PULL, rel=0.05)


def test_a_radius_that_is_recorded_early_is_named():
    early = np.concatenate([WHOLE.radius[5:], np.zeros(5)])
    result = analyse_loop(replace(WHOLE, radius=early), RIG)
    assert any("from 5 rows before the jump" in remark for remark in result.remarks)


def test_a_stray_radius_far_from_the_contact_is_not_a_contact():
    stray = WHOLE.radius.copy()
    stray[15] = 2e-5
    result = analyse_loop(replace(WHOLE, radius=stray), RIG)
    expected = analyse_loop(WHOLE, RIG)
    assert result.w_retr.value == pytest.approx(expected.w_retr.value, rel=1e-3)
    assert result.pull_off_force.value == pytest.approx(expected.pull_off_force.value, rel=1e-3)


def test_energy_is_lost_also_in_rows_without_a_radius():
    result = analyse_loop(replace(WHOLE, radius=radii(seen=ROWS % 8 == 0)), RIG)
    assert result.lost_energy == pytest.approx(analyse_loop(WHOLE, RIG).lost_energy, rel=0.05)


@pytest.mark.parametrize("noise", [-1e-6, 0.0])
@pytest.mark.parametrize(
    ("without", "modulus"), [("displacement", MODULUS), ("displacement", None), ("force", MODULUS)]
)
def test_radii_below_zero_are_rows_out_of_contact(without, modulus, noise):
    rig, recording = Rig(RADIUS, modulus), replace(WHOLE, **{without: None})
    absent = (WHOLE.radius == 0) | (TOUCHING[60] == ROWS)
    noisy = replace(recording, radius=np.where(absent, noise, WHOLE.radius))
    missing = replace(recording, radius=np.where(absent, np.nan, WHOLE.radius))
    assert analyse_loop(noisy, rig).w_appr == analyse_loop(missing, rig).w_appr
