"""Conditions of the theory, what is said of each, and what would meet it."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.measured.prediction.conditions import (
    ASSUMED_RANGE,
    condition_remarks,
    theory_verdict,
)
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import measured_surface
from crackfront.surfaces.written_units import si_value
from tests.measured.made import SCENE, write_smooth


def conditions(surface, scales=SCENE, attraction_range=None):
    """Remarks on the conditions of the theory by their names."""
    reach = ASSUMED_RANGE if attraction_range is None else attraction_range
    return {remark.concerns: remark for remark in condition_remarks(surface, scales, reach)}


def test_conditions_say_by_how_much_they_hold(surface, prediction):
    remarks = conditions(surface)
    contact = prediction.contact_radius
    margins = {
        "full conformity": SCENE.work_of_adhesion / prediction.e_el.value,
        "small slopes": 0.3 / surface.measures[2].rms.value,
        "contact small against the sphere": 0.3 * SCENE.radius / contact,
        "roughness fine against the contact": contact / surface.measures[1].longest,
        "attraction nearly everywhere": remarks["attraction nearly everywhere"].comparison.doubtful
        / prediction.negative_share,
    }
    for name, margin in margins.items():
        assert remarks[name].comparison.margin == pytest.approx(margin)
    severities = {
        name: remark_text.severity
        for name, remark_text in remarks.items()
        if remark_text.severity != "holds"
    }
    assert severities == {"small slopes": "reservation"}
    assert "rms slope of 0.59, in doubt above 0.3; linear" in remarks["small slopes"].sentence


def test_the_range_of_attraction_is_held_against_sphere_and_roughness(surface):
    w, modulus = SCENE.work_of_adhesion, SCENE.contact_modulus
    for reach in (0.5e-9, 2e-9):
        remarks = conditions(surface, SCENE, reach)
        tabor = (SCENE.radius * w**2 / (modulus**2 * reach**3)) ** (1 / 3)
        assert remarks["attraction short against the sphere"].comparison.value == pytest.approx(
            tabor
        )
        zone = remarks["attraction short against the roughness"].comparison.value
        assert zone == pytest.approx(np.pi / 4 * modulus * reach**2 / w)
    for reach, is_assumed in ((None, True), (1e-9, False)):
        notes = theory_verdict(surface, SCENE, reach).with_severity("note")
        assert any("assumed to be 0.5 nm" in note.sentence for note in notes) == is_assumed


@pytest.mark.parametrize(
    ("scales", "reach", "failing"),
    [
        (replace(SCENE, contact_modulus=1e9), None, "full conformity"),
        (replace(SCENE, contact_modulus=3e6), None, "attraction nearly everywhere"),
        (replace(SCENE, contact_modulus=1e-3), None, "contact small against the sphere"),
        (replace(SCENE, radius=5e-9), None, "roughness fine against the contact"),
        (SCENE, 2e-6, "attraction short against the sphere"),
        (SCENE, 2e-6, "attraction short against the roughness"),
    ],
)
def test_what_would_meet_a_failing_condition_meets_it(surface, scales, reach, failing):
    verdict = theory_verdict(surface, scales, reach)
    assert verdict.outcome == "does not apply"
    [remark] = [
        remark_text
        for remark_text in verdict.with_severity("fails")
        if remark_text.concerns == failing
    ]
    changes = {"modulus": "contact_modulus", "a radius": "radius", "w_int": "work_of_adhesion"}
    units = {"modulus": "Pa", "a radius": "m", "w_int": "J/m^2"}
    tried = 0
    for part in remark.remedies:
        for word, name in changes.items():
            if word in part and "roughness" not in part:
                number = part.split("above " if "above" in part else "below ")[1].split(", not")[0]
                value = si_value(number, units[word], name=word)
                wanted = value * (1.02 if "above" in part else 0.98)
                changed = conditions(surface, replace(scales, **{name: wanted}), reach)[failing]
                assert changed.severity != "fails", part
                tried += 1
    assert tried


def test_a_surface_in_no_doubt_has_no_reservation(tmp_path):
    smooth = measured_surface(read_measurements([write_smooth(tmp_path / "smooth.al3d")]))
    verdict = theory_verdict(smooth, SCENE)
    assert len(verdict.with_severity("holds")) == 8
    assert verdict.with_severity("fails", "undecided", "reservation") == ()
    assert verdict.outcome == "applies"
