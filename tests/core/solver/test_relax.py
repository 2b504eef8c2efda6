import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.follow import Load, front_at
from crackfront.core.field.fields import tile_field
from crackfront.core.field.rays import front_adhesion, sampled_on_rays
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS, front_force, named_solver, relax
from crackfront.core.units import WORK_OF_ADHESION, Scales

TIGHT = 1e-13
"""Tolerance at which two fronts are compared; the fronts then agree to SAME."""
SAME = 1e-8

every_solver = pytest.mark.parametrize("solver", sorted(SOLVERS))


class Rays:
    """A random field together with the plain arrays that the checks use."""

    def __init__(
        self, seed, n_angle=24, amplitude=0.4, spacing=0.06, patch=0, start=None, largest=3.4
    ):
        rng = np.random.default_rng(seed)
        n_sample = int(largest / spacing)
        self.radii = np.cumsum(spacing * rng.uniform(0.5, 1.5, n_sample))
        if start is not None:
            self.radii += start - self.radii[0]
        noise = rng.standard_normal((n_sample, n_angle))
        if patch:
            noise = gaussian_filter(noise, patch, mode=("nearest", "wrap"))
        self.adhesion = WORK_OF_ADHESION * (1 + amplitude * noise / noise.std())
        self.field = polar_field(self.radii, self.adhesion)
        self.n_angle = n_angle

    def circle(self):
        return np.full(self.n_angle, self.radii[0])

    def force(self, front, penetration):
        """The equation of equilibrium, written down once more with numpy alone."""
        product = [
            np.interp(a, self.radii, self.radii * self.adhesion[:, ray])
            for ray, a in enumerate(front)
        ]
        ring = 3 / (8 * np.pi) * np.maximum(front**2 - penetration, 0) ** 2
        modes = np.fft.rfft(front)
        line = np.fft.irfft(np.arange(modes.size) * modes, front.size) / np.pi
        return np.array(product) - ring - line

    def residual(self, front, penetration, direction):
        """Largest force along the motion, relative to w_int per front length."""
        drive = direction * self.force(front, penetration) / front * np.pi
        if direction < 0:
            drive = drive[front > np.sqrt(max(penetration, 0.0))]
        return max(0.0, drive.max(initial=0.0))


@st.composite
def rays(draw):
    return Rays(
        seed=draw(st.integers(0, 2**32 - 1)),
        n_angle=draw(st.integers(8, 32) | st.sampled_from([65, 128, 131, 300])),
        amplitude=draw(st.sampled_from([0.05, 0.2, 0.4, 0.8])),
        spacing=draw(st.sampled_from([0.04, 0.08])),
        patch=draw(st.sampled_from([0, 1, 3])),
    )


def tight(front, penetration, direction, field, solver):
    return relax(front, penetration, direction, field, SOLVERS[solver](TIGHT))


def extent(outcome):
    """Front of an outcome for comparisons: nothing where contact is lost."""
    if outcome.status is Status.CONVERGED:
        return outcome.front
    assert outcome.status in (Status.LOST_CONTACT, Status.LEFT_FIELD_INWARD)
    return np.zeros_like(outcome.front)


def along(front, loads, direction, field, solver):
    """Fronts at a sequence of loads until contact is lost."""
    found = []
    for load in loads:
        outcome = tight(front, load, direction, field, solver)
        found.append(extent(outcome))
        if outcome.status is not Status.CONVERGED:
            break
        front = outcome.front
    return found


def noisy_tile(seed, n_point=24, pixel=0.12, amplitude=0.3):
    noise = np.random.default_rng(seed).standard_normal((n_point, n_point))
    return AdhesionMap(WORK_OF_ADHESION * (1 + amplitude * noise), pixel, 0.0, 0.0)


# --- exact answers: the smooth sphere


@every_solver
@pytest.mark.parametrize("n_angle", [1, 4, 5, 7, 8, 13, 31, 32])
def test_a_smooth_sphere_has_the_jkr_radius_for_any_number_of_sites(solver, n_angle):
    radii = 0.05 * np.arange(1, 51)
    field = polar_field(radii, np.full((50, n_angle), WORK_OF_ADHESION))
    for penetration, radius in [(0.0, (8 / 3) ** (1 / 3)), (1.0, 1.783484193282)]:
        outcome = relax(np.full(n_angle, 0.05), penetration, 1, field, SOLVERS[solver](1e-14))
        assert outcome.status is Status.CONVERGED
        assert np.allclose(outcome.front, radius, rtol=0, atol=2e-12)


@every_solver
@pytest.mark.parametrize("adhesion", [0.5, 0.9, 1.7])
def test_a_uniform_field_scales_the_contact_by_the_power_of_its_adhesion(solver, adhesion):
    field = polar_field(0.05 * np.arange(1, 61), np.full((60, 8), adhesion * WORK_OF_ADHESION))
    outcome = relax(np.full(8, 0.05), 0.0, 1, field, SOLVERS[solver](1e-14))
    assert np.allclose(outcome.front, (8 * adhesion / 3) ** (1 / 3), rtol=0, atol=2e-12)


@every_solver
@pytest.mark.parametrize("n_angle", [8, 9, 24, 25])
def test_a_distorted_front_on_a_uniform_field_becomes_a_circle(solver, n_angle):
    field = polar_field(0.05 * np.arange(1, 51), np.full((50, n_angle), WORK_OF_ADHESION))
    wave = 0.5 + 0.2 * np.cos(2 * np.pi * np.arange(n_angle) / n_angle)
    outcome = tight(wave, 0.3, 1, field, solver)
    assert np.allclose(outcome.front, jkr.equilibrium_radius(0.3), atol=1e-11)


# --- exact answers: axisymmetric disorder, a scalar equation


def first_stop(radii, products, start, penetration, direction):
    """First root of product - a G along the motion, segment by segment, by bisection."""

    def force(a):
        return np.interp(a, radii, products) - 3 / (8 * np.pi) * max(a * a - penetration, 0) ** 2

    knots = np.concatenate([[start], radii[direction * (radii - start) > 0][::direction]])
    for near, far in itertools.pairwise(knots):
        # Fine pieces: a receding front may stop between two samples that both drive it.
        places = np.linspace(near, far, 60)
        stopped = np.flatnonzero([direction * force(a) <= 0 for a in places])
        if stopped.size == 0:
            continue
        if stopped[0] == 0:
            return places[0]
        moving, resting = places[stopped[0] - 1], places[stopped[0]]
        for _ in range(80):
            middle = 0.5 * (moving + resting)
            if direction * force(middle) > 0:
                moving = middle
            else:
                resting = middle
        return 0.5 * (moving + resting)
    raise AssertionError("no stopping point")


@every_solver
@pytest.mark.parametrize("n_angle", [1, 8, 33])
@pytest.mark.parametrize("direction", [1, -1])
def test_rings_stop_the_front_at_the_first_root_of_the_scalar_equation(solver, direction, n_angle):
    radii = 0.02 * np.arange(1, 126)
    ring = WORK_OF_ADHESION * (1 + 0.2 * np.sin(2 * np.pi * radii / 0.17))
    field = polar_field(radii, np.repeat(ring[:, None], n_angle, axis=1))
    loads = np.linspace(-0.4, 1.0, 15)[::direction]
    position = 0.3 if direction > 0 else 2.4
    front = np.full(n_angle, position)
    for load in loads:
        outcome = tight(front, load, direction, field, solver)
        position = first_stop(radii, radii * ring, position, load, direction)
        assert outcome.status is Status.CONVERGED
        assert np.allclose(outcome.front, position, rtol=0, atol=1e-11)
        front = outcome.front


# --- no passing, and what follows from it


@every_solver
@given(case=rays(), data=st.data())
def test_any_start_between_the_first_circle_and_the_front_ends_in_the_same_front(
    solver, case, data
):
    from_contact = tight(case.circle(), 0.7, 1, case.field, solver).front
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    between = case.radii[0] + rng.random(case.n_angle) * (from_contact - case.radii[0])
    again = tight(between, 0.7, 1, case.field, solver).front
    assert np.allclose(again, from_contact, rtol=0, atol=SAME)


@every_solver
@pytest.mark.parametrize("penetration", [0.3, 0.005])
def test_a_circle_on_the_first_sample_that_nothing_drives_inward_rests_there(solver, penetration):
    # At 0.3 its edge is in compression, at 0.005 it would rather advance.
    case = Rays(0, start=0.1)
    found = relax(case.circle(), penetration, -1, case.field, SOLVERS[solver](TIGHT))
    assert found.status is Status.CONVERGED
    assert np.array_equal(found.front, case.circle())


@every_solver
@pytest.mark.parametrize("n_angle", [24, 300])
def test_sites_at_rest_on_the_first_sample_do_not_end_the_retraction_of_the_others(solver, n_angle):
    case = Rays(0, n_angle, amplitude=0.1, start=0.1)
    start = np.where(np.arange(n_angle) < n_angle // 2, case.radii[0], case.radii[-1])
    found = relax(start, 0.5, -1, case.field, SOLVERS[solver](TIGHT))
    assert found.status is Status.CONVERGED
    assert np.array_equal(found.front[: n_angle // 2], start[: n_angle // 2])
    assert np.all(found.front[n_angle // 2 :] < 2.0)
    assert case.residual(found.front, 0.5, -1) < 1e-12


@every_solver
def test_a_circle_on_the_first_sample_that_is_driven_inward_leaves(solver):
    case = Rays(0, start=0.1)
    found = relax(case.circle(), -1.0, -1, case.field, SOLVERS[solver](TIGHT))
    assert found.status is Status.LOST_CONTACT


@every_solver
@given(case=rays(), direction=st.sampled_from([1, -1]))
def test_a_front_in_equilibrium_stays_where_it_is(solver, case, direction):
    front = tight(
        case.circle() if direction > 0 else case.circle() + 2.2, 0.4, direction, case.field, solver
    )
    if front.status is Status.CONVERGED:
        again = tight(front.front, 0.4, direction, case.field, solver)
        assert np.allclose(again.front, front.front, rtol=0, atol=SAME)


def slow_front(case, start, penetration, direction, rng):
    """Chaotic relaxation in plain Python: single sites, random order, random parts of a step."""
    front = np.array(start)
    while True:
        residual = direction * case.force(front, penetration)
        if residual.max() < 1e-13:
            return front
        driven = np.flatnonzero(residual >= 1e-14)
        site = rng.choice(driven)
        a, force = front[site], residual[site]
        ahead = case.radii[direction * (case.radii - a) > 1e-15]
        target = ahead[0] if direction > 0 else ahead[-1]
        near, far = sorted((a, target))
        products = case.radii * case.adhesion[:, site]
        slope = np.diff(np.interp([near, far], case.radii, products))[0] / (far - near)
        hardest = far * max(far**2 - penetration, 0.0) * 3 / (2 * np.pi)
        stiffness = case.n_angle / 4 / np.pi + hardest - slope
        length = abs(target - a)
        step = min(force / stiffness, length) if stiffness > 0 else length
        # Whole steps mostly, so that it ends; else any part of what the force allows.
        part = 1.0 if rng.random() < 0.7 else rng.random()
        front[site] = target if part * step == length else a + direction * part * step


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("seed", "n_angle"), [(1, 8), (2, 9), (3, 16), (4, 17)])
def test_any_order_of_single_forward_moves_ends_in_the_same_front(direction, seed, n_angle):
    case = Rays(seed, n_angle=n_angle, amplitude=0.3, spacing=0.12)
    start = np.full(n_angle, 1.0 if direction > 0 else 2.0)
    penetration = 0.3 if direction > 0 else -0.1
    slow = slow_front(case, start, penetration, direction, np.random.default_rng(seed))
    for solver in SOLVERS:
        fast = tight(start, penetration, direction, case.field, solver)
        assert fast.status is Status.CONVERGED, solver
        assert np.abs(fast.front - start).max() > 0.1, solver
        assert np.allclose(fast.front, slow, rtol=0, atol=SAME), solver


@pytest.mark.parametrize("solver", sorted(set(SOLVERS) - {"reference"}))
@given(case=rays())
def test_every_other_solver_ends_in_the_front_of_the_reference(solver, case):
    loads = [0.0, 0.4, 0.8]
    for direction, start in ((1, case.circle()), (-1, case.circle() + 2.2)):
        found = along(start, loads[::direction], direction, case.field, solver)
        expected = along(start, loads[::direction], direction, case.field, "reference")
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert np.allclose(one, other, rtol=0, atol=SAME)


# --- what a state is


@every_solver
@given(case=rays(), direction=st.sampled_from([1, -1]), penetration=st.floats(-0.3, 1.0))
def test_the_residual_recomputed_with_numpy_is_the_stated_one_and_within_the_tolerance(
    solver, case, direction, penetration
):
    start = case.circle() if direction > 0 else case.circle() + 2.2
    for tolerance in (1e-2, 1e-4, 1e-8):
        outcome = relax(start, penetration, direction, case.field, SOLVERS[solver](tolerance))
        if outcome.status is Status.CONVERGED:
            left = case.residual(outcome.front, penetration, direction)
            assert left <= tolerance
            assert outcome.residual == pytest.approx(left, rel=1e-6, abs=1e-13)


@given(case=rays(), penetration=st.floats(-0.5, 1.5))
def test_the_force_is_the_equation_of_equilibrium(case, penetration):
    rng = np.random.default_rng(1)
    front = rng.uniform(0.3, 2.2, case.n_angle)
    expected = case.force(front, penetration)
    assert np.allclose(front_force(front, penetration, case.field), expected, atol=1e-12)


@every_solver
@given(case=rays(), direction=st.sampled_from([1, -1]), penetration=st.floats(-0.3, 1.0))
def test_no_site_moves_against_the_direction_of_motion(solver, case, direction, penetration):
    start = case.circle() + (0.0 if direction > 0 else 2.0)
    outcome = relax(start, penetration, direction, case.field, SOLVERS[solver]())
    assert np.all(direction * (outcome.front - start) >= 0)


@every_solver
@given(case=rays(), direction=st.sampled_from([1, -1]), penetration=st.floats(-0.3, 1.0))
def test_a_front_on_which_every_site_is_driven_ends_with_no_site_pushed_back(
    solver, case, direction, penetration
):
    # An edge in compression is held open by the sphere itself, so start outside of that.
    inner = max(case.radii[0], np.sqrt(max(penetration, 0.0)) + 1e-9)
    start = np.full(case.n_angle, inner if direction > 0 else 2.2)
    drive = direction * case.force(start, penetration)
    outcome = tight(start, penetration, direction, case.field, solver)
    if np.all(drive > 0) and outcome.status is Status.CONVERGED:
        left = direction * case.force(outcome.front, penetration)
        assert np.all(left > -1e-12)


@every_solver
def test_the_same_call_gives_the_same_bits_and_leaves_its_front_as_it_was(solver):
    case = Rays(4, n_angle=24)
    start = case.circle()
    first, again = (tight(start, 0.8, 1, case.field, solver) for _ in range(2))
    assert np.array_equal(start, case.circle())
    assert np.array_equal(first.front, again.front)
    assert (first.sweeps, first.residual) == (again.sweeps, again.residual)


@every_solver
def test_a_looser_tolerance_stops_behind_a_tighter_one(solver):
    case = Rays(6, n_angle=16)
    fronts = [
        relax(case.circle(), 0.6, 1, case.field, SOLVERS[solver](tolerance)).front
        for tolerance in (1e-2, 1e-5, 1e-8, 1e-12)
    ]
    for looser, tighter in itertools.pairwise(fronts):
        assert np.all(looser <= tighter + 1e-11)
    assert np.allclose(fronts[2], fronts[3], atol=1e-5)


# --- symmetries and units


@every_solver
@given(case=rays(), shift=st.integers(1, 299))
def test_relabelling_and_mirroring_the_rays_relabel_and_mirror_the_front(solver, case, shift):
    front = tight(case.circle(), 0.6, 1, case.field, solver).front
    rolled = polar_field(case.radii, np.roll(case.adhesion, shift, axis=1))
    mirrored = polar_field(case.radii, case.adhesion[:, ::-1])
    found = tight(case.circle(), 0.6, 1, rolled, solver).front
    assert np.allclose(found, np.roll(front, shift), rtol=0, atol=SAME)
    found = tight(case.circle(), 0.6, 1, mirrored, solver).front
    assert np.allclose(found, front[::-1], rtol=0, atol=SAME)


@every_solver
@pytest.mark.parametrize("n_angle", [16, 24])
def test_turning_or_mirroring_the_tile_turns_or_mirrors_the_front(solver, n_angle):
    tile = noisy_tile(3)
    values = tile.work_of_adhesion
    # About the apex, a grid point: the array is moved on by one row.
    tiles = values, np.roll(np.rot90(values), 1, axis=0), np.roll(values[:, ::-1], 1, axis=1)
    plain, turned, mirrored = (
        tight(np.full(n_angle, 0.05), 0.5, 1, tile_field(one, sphere(n_angle), 0.03, 2.6), solver)
        for one in (AdhesionMap(array, tile.pixel, 0.0, 0.0) for array in tiles)
    )
    assert np.ptp(plain.front) > 0.05
    assert np.allclose(turned.front, np.roll(plain.front, n_angle // 4), rtol=0, atol=SAME)
    assert np.allclose(mirrored.front, np.roll(plain.front[::-1], 1), rtol=0, atol=SAME)


@every_solver
def test_a_tile_and_its_samples_on_the_rays_give_the_same_front(solver):
    field = tile_field(noisy_tile(5), sphere(20), 0.04, 2.6)
    polar = sampled_on_rays(field)
    front = other = np.full(20, 0.04)
    for penetration, direction in [(0.2, 1), (0.8, 1), (0.5, -1), (-0.2, -1), (0.4, 1)]:
        one = tight(front, penetration, direction, field, solver)
        two = tight(other, penetration, direction, polar, solver)
        front, other = one.front, two.front
        assert one.status is two.status is Status.CONVERGED
        assert np.allclose(front, other, rtol=0, atol=SAME)


@every_solver
def test_finer_samples_of_a_smooth_tile_converge_to_one_front(solver):
    n_point = 96
    x = np.arange(n_point) / n_point
    wave = np.cos(2 * np.pi * (2 * x[:, None] + x[None, :])) + np.cos(4 * np.pi * x[None, :])
    adhesion = AdhesionMap(WORK_OF_ADHESION * (1 + 0.1 * wave), 1 / n_point, 0.0, 0.0)

    def front(spacing, interpolation):
        field = tile_field(adhesion, sphere(32), spacing, 2.6, interpolation)
        return tight(np.full(32, 0.5), 0.5, 1, field, solver).front

    spacings = np.array([0.02, 0.01, 0.005])
    exact = front(0.00125, "cubic")
    for interpolation, order, largest in [("linear", 2, 1e-3), ("cubic", 4, 1e-5)]:
        errors = [np.abs(front(spacing, interpolation) - exact).max() for spacing in spacings]
        observed = np.polyfit(np.log(spacings), np.log(errors), 1)[0]
        assert observed == pytest.approx(order, abs=0.5)
        assert errors[-1] < largest


@every_solver
def test_more_sites_on_a_smooth_weak_tile_converge_to_one_front(solver):
    n_point = 24
    x = 2.4 * np.arange(n_point) / n_point
    wave = np.cos(2 * np.pi * (x[:, None] + x[None, :]) / 2.4) + np.sin(np.pi * x[None, :] / 0.6)
    adhesion = AdhesionMap(WORK_OF_ADHESION * (1 + 0.05 * wave), 0.1, 0.0, 0.0)
    fronts = []
    for n_angle in (16, 32, 64):
        field = tile_field(adhesion, sphere(n_angle), 0.01, 2.6)
        front = relax(np.full(n_angle, 0.5), 0.5, 1, field, SOLVERS[solver](1e-11)).front
        fronts.append(front[:: n_angle // 16])
    assert np.ptp(fronts[0]) > 0.02
    coarse, fine = (np.abs(front - fronts[-1]).max() for front in fronts[:-1])
    # The front is smooth, so its Fourier series converges fast.
    assert fine < coarse / 10
    assert fine < 1e-4


@every_solver
def test_a_front_solves_the_equation_of_equilibrium_in_si(solver):
    case = Rays(8, n_angle=16, amplitude=0.3)
    unit = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)
    outcome = tight(case.circle(), 0.5, 1, case.field, solver)
    front = unit.lateral * outcome.front
    penetration = unit.vertical * 0.5
    adhesion = unit.energy_per_area * front_adhesion(outcome.front, case.field)
    stress = (front**2 / unit.radius - penetration) * unit.contact_modulus
    release = stress**2 / (np.pi * front) / (2 * unit.contact_modulus)
    modes = np.fft.rfft(front)
    line = np.fft.irfft(np.arange(modes.size) * modes, front.size)
    left = front * adhesion - front * release - unit.work_of_adhesion * line
    assert np.abs(left).max() < 1e-12 * unit.work_of_adhesion * front.max()
    assert stress.min() > 0


# --- traps


@every_solver
@given(case=rays(), start=st.floats(0.05, 0.8))
def test_raising_the_load_by_two_at_once_meets_no_spurious_root_in_compression(solver, case, start):
    front = np.full(case.n_angle, max(start, case.radii[0]))
    at_once = tight(front, 2.0, 1, case.field, solver)
    in_steps = along(front, np.linspace(0, 2, 11), 1, case.field, solver)
    assert at_once.front.min() >= np.sqrt(2.0)
    assert np.allclose(at_once.front, in_steps[-1], rtol=0, atol=SAME)


@every_solver
def test_a_front_stops_at_a_barrier_however_narrow_and_stays_there(solver):
    # One weak ring of a hundredth of the way, and smooth adhesion on both sides.
    radii = np.array([0.1, 1.199, 1.2, 1.201, 2.5])
    weak = np.array([1.0, 1.0, 0.3, 1.0, 1.0])
    field = polar_field(radii, WORK_OF_ADHESION * np.repeat(weak[:, None], 24, axis=1))
    outcome = tight(np.full(24, 0.1), 0.0, 1, field, solver)
    assert outcome.status is Status.CONVERGED
    assert np.all((outcome.front > 1.199) & (outcome.front < 1.2))


@every_solver
def test_one_weak_site_holds_back_its_neighbours(solver):
    adhesion = np.full((50, 16), WORK_OF_ADHESION)
    adhesion[:, 5] *= 0.4
    field = polar_field(0.05 * np.arange(1, 51), adhesion)
    front = tight(np.full(16, 0.05), 0.3, 1, field, solver).front
    assert np.argmin(front) == 5
    assert np.all(front < jkr.equilibrium_radius(0.3))
    assert np.allclose(front[4::-1], np.roll(front, -6)[:5], atol=SAME)


@every_solver
@pytest.mark.parametrize("seed", range(4))
def test_places_that_repel_do_not_break_the_front(solver, seed):
    case = Rays(seed, n_angle=16, amplitude=0.9)
    assert (case.adhesion < 0).sum() > 50
    front = np.full(16, 1.0)
    up = tight(front, 1.0, 1, case.field, solver)
    assert up.status is Status.CONVERGED
    assert case.residual(up.front, 1.0, 1) < 1e-12
    down = tight(up.front, 0.2, -1, case.field, solver)
    assert down.status is Status.CONVERGED
    assert case.residual(down.front, 0.2, -1) < 1e-12
    assert np.all(down.front >= np.sqrt(0.2))


@every_solver
def test_a_receding_front_does_not_open_an_edge_in_compression(solver):
    adhesion = np.full((50, 24), -0.1)
    field = polar_field(0.05 * np.arange(1, 51), adhesion)
    # Between two samples, and on one.
    for penetration in (0.83, 0.81):
        outcome = tight(np.full(24, 2.0), penetration, -1, field, solver)
        assert outcome.status is Status.CONVERGED
        assert np.allclose(outcome.front, np.sqrt(penetration), rtol=1e-13)


@every_solver
@pytest.mark.parametrize("penetration", [0.89, 0.9])
def test_sites_that_come_to_rest_in_compression_do_not_let_their_neighbours_overshoot(
    solver, penetration
):
    case = Rays(350, n_angle=24, amplitude=1.2, patch=3, largest=2.8)
    start = np.full(24, 2.2)
    assert np.all(case.force(start, penetration) < 0)
    front = tight(start, penetration, -1, case.field, solver)
    expected = tight(start, penetration, -1, case.field, "reference")
    held = front.front < np.sqrt(penetration) * (1 + 1e-12)
    assert 0 < held.sum() < 24
    # Driven inward all the way, no free site ends with a force outward.
    assert np.abs(case.force(front.front, penetration)[~held]).max() < 1e-12
    assert np.allclose(front.front, expected.front, rtol=0, atol=SAME)


@every_solver
@pytest.mark.parametrize("direction", [1, -1])
def test_uneven_radii_are_as_good_as_even_ones(solver, direction, rng):
    # The product of the coarse samples is linear, so extra samples on it change nothing.
    case = Rays(9, n_angle=24)
    extra = np.sort(np.concatenate([case.radii, rng.uniform(case.radii[0], case.radii[-1], 90)]))
    products = np.array(
        [np.interp(extra, case.radii, case.radii * ray) for ray in case.adhesion.T]
    ).T
    refined = polar_field(extra, products / extra[:, None])
    start = np.full(24, 0.5 if direction > 0 else 2.4)
    front = tight(start, 0.3, direction, case.field, solver).front
    same = tight(start, 0.3, direction, refined, solver).front
    assert np.allclose(front, same, rtol=0, atol=SAME)


@every_solver
def test_a_front_may_start_exactly_on_the_samples(solver):
    case = Rays(10, n_angle=24)
    for sample in (0, 3, 20):
        start = np.full(24, case.radii[sample])
        up = tight(start, 0.7, 1, case.field, solver)
        nudged = tight(start + 1e-12, 0.7, 1, case.field, solver)
        assert np.allclose(up.front, nudged.front, rtol=0, atol=SAME)
    start = np.full(24, case.radii[-1])
    down = tight(start, 0.2, -1, case.field, solver)
    nudged = tight(start - 1e-12, 0.2, -1, case.field, solver)
    assert np.allclose(down.front, nudged.front, rtol=0, atol=SAME)


# --- how a relaxation ends


@every_solver
@pytest.mark.parametrize(
    ("case", "start", "load", "direction", "status", "sentence"),
    [
        (Rays(11, 24, 0.1), 1.0, -2.0, -1, Status.LOST_CONTACT, "contact was lost"),
        # Below pull-off contact is lost even if the field has a hole.
        (Rays(12, 24, 0.05, start=0.5), 2.0, -1.5, -1, Status.LOST_CONTACT, "contact was lost"),
        (Rays(12, 24, 0.05, start=1.3), 2.0, -0.5, -1, Status.LEFT_FIELD_INWARD, "further inside"),
        (Rays(13, 24, largest=1.5), 0.1, 1.5, 1, Status.LEFT_FIELD_OUTWARD, "enlarge the field or"),
    ],
    ids=["below any equilibrium", "beside a hole", "inward", "outward"],
)
def test_a_front_that_finds_no_rest_says_how_it_ended(
    solver, case, start, load, direction, status, sentence
):
    front = np.maximum(np.full(24, start), case.radii[0])
    outcome = relax(front, load, direction, case.field, SOLVERS[solver]())
    assert outcome.status is status
    assert sentence in outcome.status.value


@every_solver
def test_the_step_limit_is_an_outcome_that_says_what_to_do(solver):
    case = Rays(14, n_angle=16)
    outcome = relax(case.circle(), 0.5, 1, case.field, SOLVERS[solver](max_sweeps=2))
    assert outcome.status is Status.STEP_LIMIT
    assert outcome.residual > 1e-8
    assert "raise max_sweeps or the tolerance" in outcome.status.value
    # What it reached so far is behind the front, so that it can go on from there.
    rest = tight(outcome.front, 0.5, 1, case.field, solver)
    whole = tight(case.circle(), 0.5, 1, case.field, solver)
    assert np.allclose(rest.front, whole.front, rtol=0, atol=SAME)


@every_solver
@pytest.mark.parametrize("n_angle", [23, 25])
def test_a_front_of_another_number_of_sites_is_refused(solver, n_angle):
    case = Rays(15, n_angle=24)
    with pytest.raises(ValueError, match=rf"front has shape \({n_angle},\); the field has 24 rays"):
        front_at(case.field, np.full(n_angle, 0.5), Load(0.0, 1), SOLVERS[solver]())


@every_solver
@pytest.mark.parametrize("tolerance", [0.0, -1e-8, float("nan"), 1e-16])
def test_a_tolerance_that_round_off_cannot_reach_is_refused(solver, tolerance):
    case = Rays(15)
    with pytest.raises(ValueError, match=rf"tolerance {tolerance} is below the round-off"):
        front_at(case.field, case.circle(), Load(0.0, 1), SOLVERS[solver](tolerance))


def test_an_unknown_solver_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match=r"solver is 'fastest'; choose one of .*reference"):
        named_solver("fastest", 1e-8)


@every_solver
@pytest.mark.parametrize("direction", [1, -1])
def test_a_field_that_is_too_steep_for_the_tolerance_stops_the_front_with_a_sentence(
    solver, direction
):
    found = []
    for width, share in itertools.product([1e-7, 1e-8, 1e-9], [0.2, 0.5, 0.7]):
        # Over one digit of the radius the force changes by more than the tolerance.
        radii = np.array([0.05, 1.5, 1.5 + width, 2.8])
        steps = np.repeat([[1.0], [1.0], [0.3], [0.3]], 24, axis=1)
        field = polar_field(radii, WORK_OF_ADHESION * steps)
        load = float(jkr.equilibrium_penetration(1.5, 1 - 0.7 * share))
        start = np.full(24, 0.1 if direction > 0 else 2.5)
        outcome = relax(start, load, direction, field, SOLVERS[solver](TIGHT))
        assert outcome.sweeps < 20_000
        # It stands where it belongs, and the residual says how well.
        assert np.all((outcome.front >= 1.5) & (outcome.front <= 1.5 + width))
        assert outcome.residual < 1e-15 / width
        # A radius may happen to have just the digits that balance the force.
        assert outcome.status in (Status.ROUND_OFF, Status.CONVERGED)
        found.append(outcome.status)
    assert found.count(Status.ROUND_OFF) >= 3
    assert "raise the tolerance" in Status.ROUND_OFF.value
