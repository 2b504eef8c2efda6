"""Works of adhesion that change along a branch, as with the speed of the edge."""

import numpy as np
import pytest

from crackfront.core import jkr
from crackfront.core.units import Scales
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, W_APPR, W_RETR

SCALES = Scales(RADIUS, 1.0, MODULUS)


def changing(approach=0.0, retraction=0.0, *, n_row=360, steps=1000, without=None):
    """A loop whose works of adhesion rise by a part of themselves along each branch.

    The works change in so many steps, and the loop has noise of 0.2% of the largest force.
    """
    random = np.random.default_rng(0)
    turn = 1.5 * (6 * W_RETR) ** (1 / 3)
    time = np.floor(np.linspace(0, 1, n_row) * steps) / steps
    radius = np.concatenate(
        [
            np.linspace(1.6 * jkr.pull_off_radius(W_APPR), turn, n_row),
            np.linspace(turn, 1.1 * jkr.pull_off_radius(W_RETR), n_row),
        ]
    )
    work = np.concatenate([W_APPR * (1 + approach * time), W_RETR * (1 + retraction * time)])
    force = jkr.equilibrium_force(radius, work)
    force += 0.002 * np.max(force) * random.normal(size=force.size)
    columns = {
        "force": np.pad(force, 40) * SCALES.force,
        "radius": np.pad(radius, 40) * SCALES.lateral,
        "displacement": None,
    }
    if without == "radius":
        depth = jkr.equilibrium_penetration(radius, work)
        columns["displacement"] = np.pad(depth, 40, "linear_ramp", end_values=-1) * SCALES.vertical
        columns["radius"] = None
    return Recording(**columns)


@pytest.mark.parametrize("rise", [0.1, 0.3, -0.3])
@pytest.mark.parametrize("steps", [1000, 5])
def test_a_work_that_changes_in_retraction_does_not_change_the_modulus_or_w_appr(rise, steps):
    result = analyse_loop(changing(retraction=rise, steps=steps), Rig(RADIUS))
    assert result.contact_modulus.value == pytest.approx(MODULUS, rel=0.005)
    assert result.w_appr.value == pytest.approx(W_APPR, rel=0.02)
    verb = "rises" if rise > 0 else "falls"
    [remark] = [remark for remark in result.remarks if f"w_retr {verb} from" in remark]
    assert "along the window" in remark


def test_a_right_modulus_is_not_called_wrong_when_the_work_changes():
    for options in ({"retraction": 0.3}, {"retraction": -0.3}, {"approach": -0.3}):
        result = analyse_loop(changing(**options), Rig(RADIUS, MODULUS))
        assert not any("leave out --modulus" in remark for remark in result.remarks)
        work = "w_appr" if "approach" in options else "w_retr"
        verb = "rises" if sum(options.values()) > 0 else "falls"
        assert any(f"{work} {verb} from" in remark for remark in result.remarks)


def test_the_ends_of_a_trend_are_those_of_the_window():
    result = analyse_loop(changing(retraction=0.3), Rig(RADIUS, MODULUS))
    [remark] = [remark for remark in result.remarks if "w_retr rises from" in remark]
    first, last = (float(text.split()[0]) for text in remark.split("from ")[1].split(" to ")[:2])
    averaged = result.work_of_adhesion[result.in_window & (result.direction < 0)]
    assert first == pytest.approx(1e3 * np.mean(averaged[:20]), rel=0.03)
    assert last == pytest.approx(1e3 * np.mean(averaged[-20:]), rel=0.03)


def test_a_work_that_changes_is_also_named_without_a_radius():
    result = analyse_loop(changing(retraction=0.3, without="radius"), Rig(RADIUS, MODULUS))
    assert any("along the window" in remark for remark in result.remarks)


def test_a_wrong_modulus_is_still_named():
    result = analyse_loop(changing(), Rig(RADIUS, 1.5 * MODULUS))
    assert any("leave out --modulus" in remark for remark in result.remarks)


def test_constant_works_have_no_trend():
    for modulus in (None, MODULUS):
        remarks = analyse_loop(changing(), Rig(RADIUS, modulus)).remarks
        assert not any("along the window" in remark for remark in remarks)
