"""Loops of one branch, one segment of a loop, and one loop of several."""

import numpy as np
import pytest

from crackfront import measured_loop
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.loop_choice import chosen_loop
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, TRUTH, W_APPR, W_RETR, loop

WHOLE = loop(0)
TURN = int(np.argmax(WHOLE.displacement))


def joined(*recordings):
    """Recordings one after the other."""
    names = [
        name
        for name in ("force", "radius", "displacement")
        if getattr(recordings[0], name) is not None
    ]
    columns = {name: np.concatenate([getattr(part, name) for part in recordings]) for name in names}
    return Recording(**{name: columns.get(name) for name in ("force", "radius", "displacement")})


@pytest.mark.parametrize("modulus", [None, MODULUS])
@pytest.mark.parametrize(
    ("rows", "name", "missing", "truth"),
    [(slice(0, TURN), "w_appr", "w_retr", W_APPR), (slice(TURN, None), "w_retr", "w_appr", W_RETR)],
)
def test_a_branch_alone_has_its_work_of_adhesion(rows, name, missing, truth, modulus):
    result = analyse_loop(WHOLE.rows(rows), Rig(RADIUS, modulus))
    estimate = getattr(result, name)
    assert estimate.value == pytest.approx(truth, rel=0.05)
    assert estimate.low <= truth <= estimate.high
    assert np.isnan(getattr(result, missing).value)
    assert np.isnan(result.hysteresis.value)
    assert f"{missing:18}unknown" in repr(result)
    branch = {"w_appr": "approach", "w_retr": "retraction"}[name]
    [averaged] = [line for line in repr(result).splitlines() if line.startswith("averaged over")]
    assert averaged.endswith(f": {np.sum(result.in_window)} rows of {branch}")
    assert any(f"{missing} and the hysteresis are unknown" in remark for remark in result.remarks)


def test_a_retraction_without_a_radius_is_evaluated():
    whole = loop(0, without="radius")
    result = analyse_loop(whole.rows(slice(TURN, None)), Rig(RADIUS, MODULUS, stiffness=1e3))
    assert result.w_retr.low <= W_RETR <= result.w_retr.high


@pytest.mark.parametrize(("segment", "name"), [("approach", "w_appr"), ("retract", "w_retr")])
def test_a_segment_of_a_whole_loop_uses_its_rows_out_of_contact(segment, name):
    result = analyse_loop(WHOLE, Rig(RADIUS, MODULUS, segment=segment))
    assert getattr(result, name).low <= TRUTH[name] <= getattr(result, name).high
    assert any("60 rows out of contact give a drift" in remark for remark in result.remarks)


def test_too_few_rows_of_a_branch_alone_are_an_error_on_this_branch():
    with pytest.raises(ValueError, match=r"retraction has no rows .*; \d+ are needed"):
        analyse_loop(WHOLE.rows(slice(TURN, None)), Rig(RADIUS, MODULUS, window=(1e-6, 2e-6)))


def test_a_segment_that_was_not_recorded_is_an_error_with_the_remedy():
    with pytest.raises(ValueError, match="segment approach; record them, or choose"):
        analyse_loop(WHOLE.rows(slice(TURN, None)), Rig(RADIUS, MODULUS, segment="approach"))


@pytest.mark.parametrize("without", [None, "displacement", "radius"])
def test_each_loop_of_a_file_is_the_loop_recorded_alone(without):
    parts = [loop(seed, without=without) for seed in range(2)]
    rig = Rig(RADIUS, MODULUS, stiffness=1e3 if without == "radius" else None)
    for number, part in enumerate(parts, 1):
        alone = analyse_loop(part, rig)
        chosen = analyse_loop(chosen_loop(joined(*parts), number), rig)
        assert chosen.w_retr.value == pytest.approx(alone.w_retr.value, rel=0.02)
        assert chosen.w_appr.value == pytest.approx(alone.w_appr.value, rel=0.02)


def test_radii_in_contact_alone_separate_loops_too():
    parts = [loop(seed, without="displacement") for seed in range(2)]
    whole = joined(*parts)
    seen = Recording(whole.force, np.where(whole.radius > 0, whole.radius, np.nan), None)
    first = chosen_loop(seen, 1)
    assert abs(first.force.size - parts[0].force.size) <= 25


@pytest.mark.parametrize("number", [None, 4])
def test_several_loops_need_a_number_that_exists(number):
    with pytest.raises(ValueError, match=r"contains 3 loops.*--loop"):
        chosen_loop(joined(WHOLE, WHOLE, WHOLE), number)


def test_a_single_loop_is_whole():
    assert chosen_loop(WHOLE, None) is WHOLE


@pytest.mark.parametrize("column", ["force", "displacement"])
def test_a_column_of_the_other_sign_is_inverted_or_named(column):
    names = ["force", "radius"] if column == "force" else ["force", "displacement"]
    columns = {name: getattr(WHOLE, name) for name in names}
    wrong = columns | {column: -columns[column]}
    sphere = {"radius": RADIUS, "contact_modulus": MODULUS}
    if column == "displacement":
        sphere["stiffness"] = 1e3
    with pytest.raises(ValueError, match=f"--invert {column}"):
        measured_loop(wrong, **sphere)
    inverted, expected = (
        measured_loop(wrong, **sphere, invert=column),
        measured_loop(columns, **sphere),
    )
    assert inverted.w_retr == expected.w_retr


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"segment": "pause"}, "must be 'approach' or 'retract'"),
        ({"invert": "radius"}, "must be 'force' or 'displacement'"),
        ({"invert": "displacement"}, "lacks; leave it out"),
        ({"loop_number": 2}, "lacks number 2"),
    ],
)
def test_choices_that_do_not_exist_are_errors_with_the_remedy(options, match):
    columns = {"force": WHOLE.force, "radius": WHOLE.radius}
    with pytest.raises(ValueError, match=match):
        measured_loop(columns, radius=RADIUS, contact_modulus=MODULUS, **options)


def test_every_row_in_contact_with_a_work_of_adhesion_belongs_to_a_branch():
    """The zero of the displacement moves when the steady rows are known, and rows gain a work."""
    for seed in (0, 2):
        whole = loop(seed, without="radius", preload=2.0, force_noise=0.005)
        result = analyse_loop(whole, Rig(RADIUS, MODULUS, stiffness=1e3))
        first, last = np.flatnonzero(result.direction)[[0, -1]]
        has_work = np.isfinite(result.work_of_adhesion[first : last + 1])
        assert np.all(result.direction[first : last + 1][has_work] != 0)
