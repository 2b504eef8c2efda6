"""Runs on a user's surface: what they refuse, and what their results say of themselves."""

import re

import numpy as np
import pytest

import crackfront as cf
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.surfaces.surface_adhesion import surface_adhesion


@pytest.fixture(scope="module")
def patches():
    """A chemical surface of side 2 with one wave along the front and four along its motion."""
    x, y = np.meshgrid(np.arange(32) / 32, np.arange(32) / 32, indexing="ij")
    values = 1 + 0.4 * np.cos(8 * np.pi * x) * np.cos(2 * np.pi * y)
    return cf.surface(values, side=2.0, kind="chemical", units="w_int")


def pulled(surface, spring):
    """Loop of a straight front over four periods of the surface, and back."""
    return cf.run_loop(cf.straight_front(surface, spring), loads=[0, 8, 0], step=0.1)


def test_a_front_shorter_than_ten_springs_says_that_its_hysteresis_is_too_large(patches):
    long, short = pulled(patches, 0.2), pulled(patches, 0.5)
    assert np.isfinite(long.hysteresis)
    assert "L_kappa" not in long.attrs["result"]
    sentence = "the front is 4 L_kappa long, below the 10 of the law of k: its hysteresis is too"
    assert sentence in short.attrs["result"]


def test_a_front_shorter_than_its_springs_is_refused(patches):
    with pytest.raises(ValueError, match=r"spring is 2\.5, longer than the front, 2, which is"):
        pulled(patches, 2.5)


@pytest.mark.parametrize("moved", [0.0, 5.5])
def test_heights_and_their_works_of_adhesion_are_pulled_at_the_places_of_the_surface(moved):
    heights = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=6, error=0.3, seed=1)
    heights = heights.assign_coords(x=heights.x + moved, y=heights.y - moved)
    works = surface_adhesion(heights).work_of_adhesion / WORK_OF_ADHESION
    works = heights.copy(data=works).rename("work_of_adhesion").assign_attrs(units="w_int")
    pulled_heights, pulled_works = (
        cf.run_loop(cf.straight_front(surface, 0.6), loads=[0, 1], step=0.5)
        for surface in (heights, works)
    )
    np.testing.assert_allclose(pulled_heights.y, heights.y, rtol=1e-12)
    np.testing.assert_allclose(pulled_heights.position, pulled_works.position, rtol=1e-9)


def test_a_sphere_is_pressed_on_the_centre_of_heights_wherever_their_coordinates_begin():
    heights = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, error=0.3, seed=1)
    moved = heights.assign_coords(x=heights.x + 2, y=heights.y - 1)
    loop, moved_loop = (
        cf.run_loop(surface, loads=[0, 1], error=0.3) for surface in (heights, moved)
    )
    np.testing.assert_allclose(loop.radius, moved_loop.radius, rtol=1e-9)


def test_an_error_is_refused_where_none_was_measured(patches):
    with pytest.raises(ValueError, match=r"error is 0.005, but the surface does not state the spe"):
        cf.run_loop(patches, error=0.005)
    with pytest.raises(ValueError, match=r"error is 0.3, but errors of straight fronts on a given"):
        cf.run_loop(cf.straight_front(patches, 0.2), loads=[0, 1], error=0.3)
    with pytest.raises(ValueError, match=r"error is 0.3, but the surface does not state the spect"):
        cf.find_instabilities(patches, error=0.3)


def test_sites_and_samples_are_those_that_are_given(patches):
    loads = [0, 0.5]
    pressed = {n: cf.run_loop(patches, loads=loads, sites=n, samples=n / 32) for n in (48, 96, 192)}
    assert [loop.sizes["angle"] for loop in pressed.values()] == [48, 96, 192]
    coarse, fine, finest = (float(loop.mean_radius[-1]) for loop in pressed.values())
    assert 0 < abs(fine - finest) < abs(coarse - finest)
    front = cf.straight_front(patches, 0.2)
    pulled = [cf.run_loop(front, loads=[0, 1], sites=n, samples=n / 32) for n in (32, 64)]
    assert [loop.sizes["y"] for loop in pulled] == [32, 64]
    usual = cf.run_loop(front, loads=[0, 1])
    np.testing.assert_array_equal(usual.position, pulled[0].position)


def test_too_few_sites_say_that_the_hysteresis_is_too_large_and_how_many_are_enough(rng):
    noise = np.fft.fft2(rng.standard_normal((48, 48)))
    frequency = np.fft.fftfreq(48)
    noise[np.hypot(frequency[:, None], frequency) > 1 / 8] = 0
    waves = np.fft.ifft2(noise).real
    values = 1 + 0.8 * (waves - waves.mean()) / waves.std()
    surface = cf.surface(values, side=4.8, kind="chemical", units="w_int")

    def run(sites):
        return cf.run_loop(front, loads=[0, 15, 0], step=0.1, sites=sites)

    front = cf.straight_front(surface, 1.0)
    coarse, usual = run(6), run(None)
    sentence = r"the front has 6 sites, 1\.\d per .* too large; use (\d+) or"
    [needed] = re.findall(sentence, coarse.attrs["result"])
    enough = run(int(needed))
    for numerics in (usual, enough):
        assert "sites" not in numerics.attrs["result"]
    assert enough.hysteresis == pytest.approx(float(usual.hysteresis), rel=0.1)
    assert coarse.hysteresis > 1.3 * usual.hysteresis
    pressed = cf.run_loop(surface, loads=[0, 1], sites=8)
    assert "the front has 8 sites, " in pressed.attrs["result"]
    assert "sites" not in cf.run_loop(surface, loads=[0, 1], sites=80).attrs["result"]
    plain = cf.surface(np.ones((48, 48)), side=4.8, kind="chemical", units="w_int")
    assert "sites" not in cf.run_loop(plain, loads=[0, 1], sites=8).attrs["result"]


@pytest.mark.parametrize("mean", [0.6, 1.0, 1.6])
def test_a_mean_that_is_not_w_int_is_told_since_the_line_has_the_stiffness_of_w_int(patches, mean):
    surface = patches.copy(data=mean * patches.values)
    told = f"the mean work of adhesion is {mean:.3g} w_int, but the line is as stiff as at w_int"
    for contact in (surface, cf.straight_front(surface, 0.2)):
        loop = cf.run_loop(contact, loads=[0, 0.5])
        assert (told in loop.attrs["result"]) == (mean != 1.0)
        assert loop.attrs["kind"] == "chemical"


@pytest.mark.parametrize(("spring", "first"), [(1e-9, 0.0), (1e-15, 0.0), (0.2, 2e6), (0.2, -2e6)])
def test_places_whose_digits_do_not_hold_the_forces_are_refused(patches, spring, first):
    front = cf.straight_front(patches, spring)
    with pytest.raises(ValueError, match=r"round-off of places .* by periods of the tile, 2, to"):
        cf.run_loop(front, loads=[first, first + 1], step=0.1)


def test_samples_that_miss_the_waves_of_a_surface_are_refused_and_as_many_as_it_says_are_not(
    patches,
):
    for contact, few in ((patches, 0.2), (cf.straight_front(patches, 0.2), 0.4)):
        with pytest.raises(ValueError, match=f"samples is {few} a pixel along a ray") as caught:
            cf.run_loop(contact, loads=[0, 1], samples=few)
        needed = float(re.findall(r"use (\S+) or more", str(caught.value))[0])
        assert cf.run_loop(contact, loads=[0, 1], samples=needed).attrs["status"] == "converged"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"error": 0.1, "sites": 40}, r"error is 0.1, which decides sites and samples; leave the"),
        ({"error": 0.1, "samples": 4}, r"error is 0.1, .*; leave these out, or the error"),
        ({"sites": 3}, "sites is 3; it must lie between 4 and"),
        ({"samples": 0}, r"samples is 0; it must be greater"),
    ],
)
def test_numerics_that_cannot_be_are_refused(patches, arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        cf.run_loop(patches, **arguments)
    with pytest.raises(TypeError, match=r"sites is 40.5; it must be a whole number"):
        cf.run_loop(patches, sites=40.5)


def test_a_front_that_moves_smoothly_loses_energy_by_its_load_steps_alone_and_says_so(patches):
    front, sums = cf.straight_front(patches, 0.3), []
    for step in (0.1, 0.05):
        loop = cf.run_loop(front, loads=[0, 8, 0], step=step, energy=True)
        sums.append(float(loop.dissipated_energy.sum()))
        assert loop.dissipated_energy.attrs["comment"].startswith("load steps add 1 of the sum")
    assert sums[0] == pytest.approx(2 * sums[1], rel=1e-3)


def test_a_pinned_front_says_which_part_of_its_energy_smaller_steps_would_lower(patches):
    front, left, parts = cf.straight_front(patches, 1.0), [], []
    for step in (0.2, 0.05):
        loop = cf.run_loop(front, loads=[0, 8, 0], step=step, energy=True)
        parts.append(float(loop.dissipated_energy.attrs["comment"].split()[3]))
        left.append(float(loop.dissipated_energy.sum()) * (1 - parts[-1]))
    assert parts[0] > parts[1] > 0
    assert left[0] == pytest.approx(left[1], rel=0.05)


def test_instabilities_of_a_straight_front_are_refused_with_the_reason(patches):
    with pytest.raises(ValueError, match="between first contact and pull-off, which a straight"):
        cf.find_instabilities(cf.straight_front(patches, 0.2))
