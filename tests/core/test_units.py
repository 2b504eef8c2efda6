import math
import re

import pytest

from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION, ReducedUnit, Scales

NANODIAMOND = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / (1 - 0.5**2))


@pytest.mark.parametrize(
    ("name", "value", "digit"),
    [("lateral", 62.9e-6, 0.05e-6), ("vertical", 3.16e-6, 0.005e-6), ("force", 0.247e-3, 5e-7)],
)
def test_nanodiamond_contact_has_the_published_scales(name, value, digit):
    assert getattr(NANODIAMOND, name) == pytest.approx(value, abs=digit)


@pytest.mark.parametrize("name", ["lateral", "vertical", "force", "energy_per_area"])
def test_a_scene_that_is_given_in_reduced_units_is_left_as_it_is(name):
    reduced = Scales(radius=1.0, work_of_adhesion=WORK_OF_ADHESION, contact_modulus=CONTACT_MODULUS)
    assert getattr(reduced, name) == pytest.approx(1.0, rel=1e-14)


def test_the_scales_give_back_the_constants_of_the_scene():
    unit = NANODIAMOND
    assert unit.lateral**2 / unit.vertical == pytest.approx(1.25e-3, rel=1e-14)
    assert unit.energy_per_area * WORK_OF_ADHESION == pytest.approx(63e-3, rel=1e-14)
    modulus = unit.force / (unit.lateral * unit.vertical) * CONTACT_MODULUS
    assert modulus == pytest.approx(0.7e6 / 0.75, rel=1e-14)
    by_area = unit.energy_per_area * unit.lateral**2
    assert unit.force * unit.vertical == pytest.approx(by_area, rel=1e-14)


@pytest.mark.parametrize("name", ["radius", "work_of_adhesion", "contact_modulus"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_a_scene_without_positive_finite_parameters_is_refused(name, value):
    scene = {"radius": 1.0, "work_of_adhesion": 1.0, "contact_modulus": 1.0, name: value}
    with pytest.raises(ValueError, match=f"{name} is {value}; it must be positive and finite"):
        Scales(**scene)


def value_of(formula):
    """Value of a formula of w_int, R and E' for the contact of the nanodiamond."""
    python = re.sub(r"(\d+)E'(\^2)?", lambda match: f"({match[1]}*E{match[2] or ''})", formula)
    python = re.sub(r"(?<=[\w)])\s*(times)?\s+(?=[\w(])", "*", python.replace("^", "**"))
    constants = {"pi": math.pi, "w_int": 63e-3, "R": 1.25e-3, "E": NANODIAMOND.contact_modulus}
    return eval(python, constants)


@pytest.mark.parametrize("unit", ReducedUnit)
def test_the_text_of_a_unit_is_the_formula_of_its_scale(unit):
    formula = re.sub(r"reduced \w+ length, ", "", unit.value)
    assert value_of(formula) == pytest.approx(unit.scale(NANODIAMOND), rel=1e-14)
