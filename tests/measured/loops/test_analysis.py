"""Measured loops: works of adhesion within their intervals, the modulus and the machine."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront import measured_loop
from crackfront.core import jkr
from crackfront.core.units import Scales
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.recording import Recording
from crackfront.measured.loops.rig import Rig
from tests.commands import slow
from tests.measured.loops.made import MODULUS, RADIUS, TRUTH, W_APPR, W_RETR, in_contact, loop


@pytest.mark.parametrize(
    ("made", "modulus"),
    [
        ({}, None),
        ({"drift": 0.05}, MODULUS),
        ({"force_noise": 0.01, "radius_noise": 0.01}, None),
        ({"retraction": 0.6}, MODULUS),
        ({"stiffness": 100.0}, MODULUS),
    ],
)
def test_intervals_hold_the_truth_of_loops_with_noise_drift_and_partial_retraction(made, modulus):
    """In 90% of 12 loops and three works or more: 95% are claimed."""
    held = []
    for seed in range(12):
        result = analyse_loop(loop(seed, **made), Rig(RADIUS, modulus))
        for name, truth in TRUTH.items():
            estimate = getattr(result, name)
            held.append(estimate.low <= truth <= estimate.high)
            assert estimate.value == pytest.approx(truth, rel=0.1)
    assert np.mean(held) >= 0.9


def test_the_modulus_and_the_stiffness_of_the_machine_are_found():
    results = [analyse_loop(loop(seed, stiffness=500.0), Rig(RADIUS)) for seed in range(12)]
    for name, truth in (("fitted_modulus", MODULUS), ("stiffness", 500.0)):
        estimates = [getattr(result, name) for result in results]
        assert np.mean([result.low <= truth <= result.high for result in estimates]) >= 0.8
        assert np.median([result.value for result in estimates]) == pytest.approx(truth, rel=0.02)


def test_a_soft_machine_that_is_taken_as_stiff_is_told_or_refused():
    soft = loop(0, without="force", stiffness=500.0)
    told = "The machine is taken as infinitely stiff; give --stiffness"
    assert any(told in remark for remark in analyse_loop(soft, Rig(RADIUS, MODULUS)).remarks)
    result = analyse_loop(soft, Rig(RADIUS, MODULUS, stiffness=500.0))
    assert not any(told in remark for remark in result.remarks)
    softer = loop(0, without="force", stiffness=100.0)
    with pytest.raises(ValueError, match="is not positive; give --stiffness if the machine"):
        analyse_loop(softer, Rig(RADIUS, MODULUS))


@pytest.mark.parametrize(
    ("made", "preload"),
    [
        ({"without": "radius", "preload": 2.0, "drift": 0.3}, 1e3),
        slow({"without": "radius", "preload": 3.0, "force_noise": 2e-4, "stiffness": 300}, 300.0),
        slow({"without": "radius", "preload": 1.2, "force_noise": 0.02}, 1e3),
        slow({"without": "radius", "n_away": 3000}, 1e3),
        slow({"without": "radius", "n_away": 8, "force_noise": 0.001}, 1e3),
        slow({"without": "radius", "drift": 0.5, "force_noise": 0.005}, 1e3),
        slow({"without": "radius", "n_away": 100, "wave": 0.01}, 1e3),
        ({"without": "force", "stiffness": 300.0, "preload": 3.0}, 300.0),
    ],
)
def test_two_columns_hold_the_truth_at_any_preload_and_drift(made, preload):
    held, pulled = [], []
    for seed in range(3):
        result = analyse_loop(loop(seed, **made), Rig(RADIUS, MODULUS, stiffness=preload))
        for name, truth in TRUTH.items():
            estimate = getattr(result, name)
            held.append(estimate.low <= truth <= estimate.high)
        pulled.append(result.pull_off_force)
    assert np.mean(held) >= 0.85
    # The table ends at 1.6 times the radius of pull-off, after the largest pull.
    pull = -jkr.pull_off_force(W_RETR) * Scales(RADIUS, 1.0, MODULUS).force
    # A wave of 1% of the largest force is 8% of this pull, and no interval contains it.
    assert np.mean([item.value for item in pulled]) == pytest.approx(pull, rel=0.12)
    assert "wave" in made or np.mean([item.low <= pull <= item.high for item in pulled]) >= 2 / 3


@pytest.mark.parametrize("n_row", [100, 3000])
def test_the_pull_off_force_is_not_that_of_the_lowest_noise(n_row):
    whole = loop(0, n_row=n_row, force_noise=0.02)
    pull = analyse_loop(whole, Rig(RADIUS, MODULUS)).pull_off_force
    clean = -np.min(loop(0, n_row=n_row, force_noise=0.0).force)
    assert pull.low < clean < pull.high
    assert clean * 1.05 < -np.min(whole.force)


@pytest.mark.parametrize(("factor", "is_told"), [(1, False), (1e3, True), (1e-3, True)])
def test_a_force_in_a_wrong_unit_is_told_also_with_a_fitted_modulus(factor, is_told):
    recording = loop(0)
    scaled = replace(recording, force=factor * recording.force)
    result = analyse_loop(scaled, Rig(RADIUS))
    assert result.w_retr.value == pytest.approx(factor * W_RETR, rel=0.1)
    assert is_told == any("check the unit of the column" in text for text in result.remarks)


@pytest.mark.parametrize(
    ("made", "rig", "remark"),
    [
        ({}, {"stiffness": 200.0}, "stiffness of the machine does not enter"),
        ({"without": "radius"}, {"contact_modulus": 3 * MODULUS}, "pulls with up to"),
        ({"retraction": 0.3}, {}, "No force pulls in the retraction"),
    ],
)
def test_what_contradicts_itself_is_said(made, rig, remark):
    sphere = {"radius": RADIUS, "contact_modulus": MODULUS} | rig
    assert any(remark in text for text in analyse_loop(loop(0, **made), Rig(**sphere)).remarks)


@pytest.mark.parametrize(
    ("made", "rig", "sentence"),
    [
        ({}, {"modulus_error": 0.1, "contact_modulus": None}, "no modulus is given"),
        ({}, {"window": (9e-5, 5e-5)}, "window is 90 um to 50 um; give a smaller and a larger"),
        (
            {},
            {"window": (3e-4, 4e-4)},
            "have no rows at contact radii within the window; .*um",
        ),
        (
            {"preload": 5.0, "force_noise": 0.01, "without": "radius"},
            {},
            "press less, average rows",
        ),
        (
            {"preload": 3.0, "without": "radius"},
            {"contact_modulus": 1.5 * MODULUS, "stiffness": 1e3},
            "33% of the rows in contact have no work of adhesion",
        ),
    ],
)
def test_what_gives_no_works_is_refused(made, rig, sentence):
    sphere = {"radius": RADIUS, "contact_modulus": MODULUS} | rig
    with pytest.raises(ValueError, match=sentence):
        analyse_loop(loop(0, **made), Rig(**sphere))


def test_the_energy_lost_is_the_hysteresis_times_the_area_that_was_swept():
    result = analyse_loop(loop(0), Rig(RADIUS, MODULUS))
    assert result.lost_energy == pytest.approx(W_RETR - W_APPR, rel=0.1)


def test_a_loop_that_begins_in_contact_has_no_lost_energy_and_says_so():
    whole = loop(0)
    first = int(np.flatnonzero(whole.radius > 0)[5])
    cut = Recording(*(item[first:] for item in (whole.force, whole.radius, whole.displacement)))
    result = analyse_loop(cut, Rig(RADIUS, MODULUS))
    assert np.isnan(result.lost_energy)
    assert any("the approach does not begin out of contact" in item for item in result.remarks)


def test_an_unclosed_loop_has_no_lost_energy_and_says_so():
    result = analyse_loop(loop(0, retraction=0.6), Rig(RADIUS, MODULUS))
    assert np.isnan(result.lost_energy)
    assert any("energy lost is not known" in remark for remark in result.remarks)
    assert any("Its drift is unknown" in remark for remark in result.remarks)


def test_errors_of_modulus_and_radius_widen_the_intervals():
    result = analyse_loop(loop(0), Rig(RADIUS, MODULUS))
    for unsure in (
        Rig(RADIUS, MODULUS, modulus_error=0.05),
        Rig(RADIUS, MODULUS, radius_error=0.05),
    ):
        wider = analyse_loop(loop(0), unsure)
        assert wider.w_retr.value == pytest.approx(result.w_retr.value)
        assert wider.w_retr.high - wider.w_retr.low > 2 * (result.w_retr.high - result.w_retr.low)


def test_a_loop_that_turns_twice_is_refused():
    whole = loop(0)
    twice = Recording(
        *(np.tile(column, 2) for column in (whole.force, whole.radius, whole.displacement))
    )
    with pytest.raises(ValueError, match="turns more than once"):
        analyse_loop(twice, Rig(RADIUS, MODULUS))


def test_a_loop_without_noise_is_that_of_its_works():
    """Exact zeros out of contact leave no covariance of the force's zero."""
    result = analyse_loop(loop(0, force_noise=0.0, radius_noise=0.0), Rig(RADIUS, MODULUS))
    assert result.w_appr.value == pytest.approx(W_APPR, rel=1e-9)
    assert result.w_retr.value == pytest.approx(W_RETR, rel=1e-9)


def test_the_force_may_rise_after_its_least_value_in_retraction():
    """At a fixed displacement a contact is lost beyond the largest pulling force."""
    radius = np.concatenate([np.linspace(35e-6, 90e-6, 60), np.linspace(90e-6, 30e-6, 60)])
    work = np.repeat([W_APPR, W_RETR], 60)
    force = 4 / 3 * MODULUS * radius**3 / RADIUS
    force -= np.sqrt(8 * np.pi * MODULUS * work * radius**3)
    assert np.ptp(force[np.argmin(force) :]) > 0.2 * np.ptp(force)
    rig = {"radius": RADIUS, "contact_modulus": MODULUS}
    result = measured_loop({"force": force, "radius": radius}, **rig)
    assert result.hysteresis.value == pytest.approx(W_RETR - W_APPR, rel=1e-6)


def test_what_cannot_be_of_a_loop_is_said():
    columns = in_contact(force_noise=0.0, radius_noise=0.0)
    rig = {"radius": RADIUS, "contact_modulus": MODULUS}
    back = {name: column[::-1] for name, column in columns.items()}
    assert any("negative" in remark for remark in measured_loop(back, **rig).remarks)
    with pytest.raises(ValueError, match=r"the contact radius reaches .* on a sphere of 1\.25 mm"):
        measured_loop({**columns, "radius": 1e6 * columns["radius"]}, **rig)
