"""Whether the theory applies, and what would make it apply."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.data.written_units import si_value
from crackfront.topography.measures import measured_surface
from crackfront.topography.reading import read_measurements
from crackfront.topography.verdict import verdict
from tests.topography.made import SCENE, write_smooth


def conditions(surface, scales=SCENE, attraction_range=None):
    """Conditions of a verdict by their names."""
    found = verdict(surface, scales, attraction_range).conditions
    return {item.name: item for item in found}


def test_conditions_say_by_how_much_they_hold(surface, prediction):
    found = conditions(surface)
    contact = prediction.contact_radius
    margins = {
        "full conformity": SCENE.work_of_adhesion / prediction.e_el.value,
        "small slopes": 0.3 / surface.measures[2].rms.value,
        "contact small against the sphere": 0.3 * SCENE.radius / contact,
        "roughness fine against the contact": contact / surface.measures[1].longest,
        "attraction nearly everywhere": found["attraction nearly everywhere"].doubtful
        / prediction.negative_share,
    }
    for name, margin in margins.items():
        assert found[name].margin == pytest.approx(margin)
    standings = {name: item.standing for name, item in found.items() if item.standing != "holds"}
    assert standings == {"small slopes": "in doubt"}


def test_the_range_of_attraction_is_held_against_sphere_and_roughness(surface):
    w, modulus = SCENE.work_of_adhesion, SCENE.contact_modulus
    for reach in (0.5e-9, 2e-9):
        found = conditions(surface, SCENE, reach)
        tabor = (SCENE.radius * w**2 / (modulus**2 * reach**3)) ** (1 / 3)
        assert found["attraction short against the sphere"].value == pytest.approx(tabor)
        zone = found["attraction short against the roughness"].value
        assert zone == pytest.approx(np.pi / 4 * modulus * reach**2 / w)
    assert "0.5 nm" in verdict(surface, SCENE).assumption
    assert verdict(surface, SCENE, 1e-9).assumption == ""


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
    found = verdict(surface, scales, reach)
    assert found.outcome == "does not apply"
    [remedy] = [text for text in found.remedies if text.startswith(failing)]
    changes = {"modulus": "contact_modulus", "a radius": "radius", "w_int": "work_of_adhesion"}
    units = {"modulus": "Pa", "a radius": "m", "w_int": "J/m^2"}
    tried = 0
    for part in remedy.split(": ")[1].split(", or "):
        for word, name in changes.items():
            if word in part and "roughness" not in part:
                number = part.split("above " if "above" in part else "below ")[1].split(", not")[0]
                value = si_value(number, units[word], what=word)
                wanted = value * (1.02 if "above" in part else 0.98)
                other = conditions(surface, replace(scales, **{name: wanted}), reach)[failing]
                assert other.standing != "fails", part
                tried += 1
    assert tried


def test_all_failing_conditions_and_all_doubts_are_told(surface):
    found = verdict(surface, replace(SCENE, contact_modulus=1e3), 1e-3)
    failing = [item.name for item in found.conditions if item.standing == "fails"]
    assert len(failing) > 1
    assert len(found.remedies) == len(failing)
    slopes = [text for text in found.reservations if text.startswith("small slopes")]
    assert len(slopes) == 1


def test_a_surface_in_no_doubt_has_no_reservation(tmp_path):
    smooth = measured_surface(read_measurements([write_smooth(tmp_path / "smooth.al3d")]))
    found = verdict(smooth, SCENE)
    assert [item.standing for item in found.conditions] == ["holds"] * 8
    assert found.reservations == ()
    assert found.outcome == "applies"
