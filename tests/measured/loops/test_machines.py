"""Soft machines, wrong moduli, and numbers of a rig that count as exact."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.rig import Rig
from tests.measured.loops.made import MODULUS, RADIUS, W_RETR, loop


def remarks(rig, **options):
    return analyse_loop(loop(0, **options), rig).remarks


def test_numbers_without_an_error_count_as_exact():
    for rig, text in (
        (Rig(RADIUS, MODULUS), "modulus and radius of the sphere"),
        (Rig(RADIUS), "radius of the sphere"),
        (Rig(RADIUS, MODULUS, radius_error=0.01), "No error of the modulus is given"),
    ):
        assert any(text in remark and "exact" in remark for remark in remarks(rig))
    stated_rig = Rig(RADIUS, MODULUS, modulus_error=0.02, radius_error=0.01)
    assert not any("exact" in remark for remark in remarks(stated_rig))


@pytest.mark.parametrize("stiffness", [0.5, 10.0])
def test_a_cantilever_far_softer_than_the_contact_is_named_with_the_work_of_its_pull_off(stiffness):
    rig = Rig(RADIUS, MODULUS, stiffness=stiffness)
    result = analyse_loop(loop(0, without="radius", stiffness=stiffness, force_noise=1e-4), rig)
    [remark] = [remark for remark in result.remarks if "far softer than the contact" in remark]
    assert "2 E' a" in remark
    work = result.pull_off_force.value / (1.5 * np.pi * RADIUS)
    assert work == pytest.approx(W_RETR, rel=0.05)
    assert f"{1e3 * work:.3g} mJ/m2" in remark


def test_a_stiff_machine_is_not_called_soft():
    rig = Rig(RADIUS, MODULUS, stiffness=1e3)
    assert not any("softer" in remark for remark in remarks(rig, without="radius"))


def test_rows_beyond_hertz_are_not_blamed_on_noise_if_the_modulus_is_too_large():
    rig = Rig(RADIUS, 1.5 * MODULUS, stiffness=1e3)
    whole = loop(0, preload=3.0, without="radius")
    with pytest.raises(ValueError, match="by more than the noise: a contact modulus of") as error:
        analyse_loop(whole, rig)
    assert "--modulus" in str(error.value)
    assert "2 F / (3 pi R)" in str(error.value)


def test_rows_beyond_hertz_by_noise_are_blamed_on_it():
    rig = Rig(RADIUS, MODULUS, stiffness=1.0)
    whole = loop(0, without="radius", stiffness=1e9)
    soft = replace(whole, displacement=whole.displacement + loop(0, force_noise=0.0).force / 1.0)
    with pytest.raises(ValueError, match="noise presses more") as error:
        analyse_loop(soft, rig)
    assert "2 F / (3 pi R)" in str(error.value)
