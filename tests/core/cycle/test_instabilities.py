"""Branches resolved into single instabilities: exactness, patches, lengths."""

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq

from crackfront.core.adhesion import AdhesionMap, correlation_length
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.instabilities import (
    resolved_motion,
    shortest_instability,
    swept_clusters,
)
from crackfront.core.geometry.line import initial_front, line_field
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.solver.relax import Newton, relax
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION

TRAVEL = 0.004


def ring_field(amplitude, wavelength=0.1):
    """Rings, whose instabilities are those of a scalar equation."""
    radii = np.linspace(0.05, 2.4, 4701)
    rings = 1 + amplitude * np.sin(2 * np.pi * radii / wavelength)
    return polar_field(radii, rings * WORK_OF_ADHESION)


def rough_field(amplitude=0.4, n_angle=24):
    rng = np.random.default_rng(5)
    radii = 0.06 * np.arange(1, 46)
    noise = rng.standard_normal((radii.size, n_angle))
    return polar_field(radii, WORK_OF_ADHESION * (1 + amplitude * noise), "cubic")


def retraction(field, start=0.8, stop=0.2, precision=1e-6, tolerance=1e-9, travel=TRAVEL):
    count = field.products.shape[0]
    options = {"travel": travel, "precision": precision, "solver": Newton(tolerance)}
    front = relax(np.full(count, 0.06), start, 1, field, Newton(tolerance)).front
    return list(resolved_motion(field, front, start, [stop], -1, **options))


def test_the_steps_follow_each_other_and_end_where_one_large_step_does():
    field = rough_field()
    motions = retraction(field)
    for motion, following in itertools.pairwise(motions):
        assert following.start == motion.end
        np.testing.assert_array_equal(following.before, motion.after)
    direct = relax(motions[0].before, motions[-1].end, -1, field, Newton(1e-9)).front
    np.testing.assert_allclose(motions[-1].after, direct, atol=1e-6)


def test_rings_jump_where_their_running_minimum_does():
    field = ring_field(0.2)
    jumps = [motion for motion in retraction(field) if motion.unstable]
    radii = field.places
    balance = radii**2 - np.sqrt(8 * radii * field.products[0] / radii / WORK_OF_ADHESION / 3)
    # Coming from outside, a ring leaves a minimum of b when the load falls below it.
    inside = radii < jumps[0].before[0] + 0.01
    lowest = np.minimum.accumulate(balance[inside][::-1])
    rests = np.flatnonzero(np.diff(lowest) == 0)
    starts = lowest[rests[np.diff(rests, prepend=-9) > 1]]
    expected = starts[(starts < jumps[0].start + 1e-4) & (starts > 0.2)]
    np.testing.assert_allclose([jump.end for jump in jumps], expected, atol=1e-5)


def energies(motions, field, *, unstable):
    chosen = [motion for motion in motions if motion.unstable == unstable]
    return np.array(
        [dissipated_energy(motion.before, motion.after, motion.end, field) for motion in chosen]
    )


def test_instabilities_dissipate_and_smooth_steps_ever_less_the_finer_they_are():
    field = rough_field()
    coarse, fine = (retraction(field, travel=travel) for travel in (TRAVEL, TRAVEL / 8))
    assert np.all(energies(fine, field, unstable=True) > 0)
    lost = np.sum(energies(fine, field, unstable=True))
    assert np.sum(energies(coarse, field, unstable=False)) < 0.1 * lost
    assert np.sum(energies(fine, field, unstable=False)) < 0.02 * lost


def test_a_front_that_leaves_the_field_says_so():
    field = ring_field(0.1)
    front = relax(np.full(1, 0.06), 0.5, 1, field).front
    with pytest.raises(ValueError, match="left the sampled field outward"):
        list(resolved_motion(field, front, 0.5, [4.0], 1, travel=0.05, precision=1e-3))


def test_patches_are_told_apart_across_the_ends_of_the_array():
    before, after = np.full(12, 2.0), np.full(12, 2.0)
    after[[11, 0, 1]] = 1.9
    after[5] = 1.8
    clusters = swept_clusters(before, after, 0.05, sphere(12))
    arc = 2 * np.pi / 12
    assert [round(item.depth, 9) for item in clusters] == [0.1, 0.2]
    assert clusters[0].area == pytest.approx(3 * arc * (4 - 1.9**2) / 2)
    assert clusters[1].extent == pytest.approx(arc * 1.9)


def test_a_straight_front_on_a_wave_jumps_once_a_period_from_where_its_load_turns():
    # u - X = spring * amplitude * sin(q u): the load has a maximum where its slope is zero.
    wavelength, spring, amplitude, n_y = 64, 100.0, 0.3, 32
    q = 2 * np.pi / wavelength
    wave = 1 + amplitude * np.sin(q * np.arange(wavelength))
    adhesion = AdhesionMap(WORK_OF_ADHESION * np.repeat(wave[:, None], n_y, axis=1), 1.0, 0.0, 0.0)
    field = line_field(adhesion, spring, (0.0, 300.0))
    front = initial_front(field, adhesion, 100.0)
    solver = Newton(1e-11)
    front = relax(front, 100.0, 1, field, solver).front
    options = {"travel": 1.0, "precision": 1e-4, "solver": solver}
    motions = resolved_motion(field, front, 100.0, [200.0], 1, **options)
    jumps = [motion for motion in motions if motion.unstable]
    turn = -np.arccos(1 / (spring * amplitude * q)) / q
    load = turn - spring * amplitude * np.sin(q * turn)
    first = wavelength * np.ceil((100.0 - load) / wavelength)
    loads = np.arange(load + first, 200.0, wavelength)
    assert [jump.end for jump in jumps] == pytest.approx(loads, abs=1e-3)
    landed = brentq(lambda u: u - spring * amplitude * np.sin(q * u) - load, turn + 1, 100.0)
    for jump in jumps:
        (whole,) = swept_clusters(jump.before, jump.after, 1.0, field.geometry)
        assert whole.area == pytest.approx(n_y * (landed - turn), rel=1e-3)
        assert whole.extent == pytest.approx(n_y)


def test_the_shortest_instability_of_white_disorder_is_that_of_the_literature():
    white = SelfAffineSpectrum(short_cutoff=1.0, roll_off=1.0, hurst=1.0)
    length = correlation_length("chemical", white)
    assert shortest_instability(length, 1.0) == pytest.approx(0.12, abs=0.001)
    assert shortest_instability(length, 0.5) == pytest.approx(4 * shortest_instability(length, 1.0))
