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
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS, front_force, relax
from crackfront.core.units import WORK_OF_ADHESION
from tests.core.solvers import every_solver

TIGHT = 1e-13
"""Tolerance at which two fronts are compared; the fronts then agree to SAME."""
SAME = 1e-8


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
    fronts = []
    for load in loads:
        outcome = tight(front, load, direction, field, solver)
        fronts.append(extent(outcome))
        if outcome.status is not Status.CONVERGED:
            break
        front = outcome.front
    return fronts


def noisy_tile(seed, n_point=24, pixel=0.12, amplitude=0.3):
    noise = np.random.default_rng(seed).standard_normal((n_point, n_point))
    return AdhesionMap(WORK_OF_ADHESION * (1 + amplitude * noise), pixel, 0.0, 0.0)


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
    outcome = relax(case.circle(), penetration, -1, case.field, SOLVERS[solver](TIGHT))
    assert outcome.status is Status.CONVERGED
    assert np.array_equal(outcome.front, case.circle())


@every_solver
@pytest.mark.parametrize("n_angle", [24, 300])
def test_sites_at_rest_on_the_first_sample_do_not_end_the_retraction_of_the_others(solver, n_angle):
    case = Rays(0, n_angle, amplitude=0.1, start=0.1)
    start = np.where(np.arange(n_angle) < n_angle // 2, case.radii[0], case.radii[-1])
    outcome = relax(start, 0.5, -1, case.field, SOLVERS[solver](TIGHT))
    assert outcome.status is Status.CONVERGED
    assert np.array_equal(outcome.front[: n_angle // 2], start[: n_angle // 2])
    assert np.all(outcome.front[n_angle // 2 :] < 2.0)
    assert case.residual(outcome.front, 0.5, -1) < 1e-12


@every_solver
def test_a_circle_on_the_first_sample_that_is_driven_inward_leaves(solver):
    case = Rays(0, start=0.1)
    outcome = relax(case.circle(), -1.0, -1, case.field, SOLVERS[solver](TIGHT))
    assert outcome.status is Status.LOST_CONTACT


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
def test_the_same_call_gives_the_same_bits_and_leaves_its_front_as_it_was(solver):
    case = Rays(4, n_angle=24)
    start = case.circle()
    first, again = (tight(start, 0.8, 1, case.field, solver) for _ in range(2))
    assert np.array_equal(start, case.circle())
    assert np.array_equal(first.front, again.front)
    assert (first.sweeps, first.residual) == (again.sweeps, again.residual)


# --- symmetries and units


@every_solver
@given(case=rays(), shift=st.integers(1, 299))
def test_relabelling_and_mirroring_the_rays_relabel_and_mirror_the_front(solver, case, shift):
    front = tight(case.circle(), 0.6, 1, case.field, solver).front
    rolled = polar_field(case.radii, np.roll(case.adhesion, shift, axis=1))
    mirrored = polar_field(case.radii, case.adhesion[:, ::-1])
    relabelled = tight(case.circle(), 0.6, 1, rolled, solver).front
    assert np.allclose(relabelled, np.roll(front, shift), rtol=0, atol=SAME)
    relabelled = tight(case.circle(), 0.6, 1, mirrored, solver).front
    assert np.allclose(relabelled, front[::-1], rtol=0, atol=SAME)


@every_solver
@pytest.mark.parametrize("n_angle", [16, 24])
def test_turning_or_mirroring_the_tile_turns_or_mirrors_the_front(solver, n_angle):
    tile = noisy_tile(3)
    values = tile.work_of_adhesion
    # About the apex, a grid point: the array is moved on by one row.
    tiles = values, np.roll(np.rot90(values), 1, axis=0), np.roll(values[:, ::-1], 1, axis=1)
    plain, turned, mirrored = (
        tight(
            np.full(n_angle, 0.05), 0.5, 1, tile_field(tile_map, sphere(n_angle), 0.03, 2.6), solver
        )
        for tile_map in (AdhesionMap(array, tile.pixel, 0.0, 0.0) for array in tiles)
    )
    assert np.ptp(plain.front) > 0.05
    assert np.allclose(turned.front, np.roll(plain.front, n_angle // 4), rtol=0, atol=SAME)
    assert np.allclose(mirrored.front, np.roll(plain.front[::-1], 1), rtol=0, atol=SAME)


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
@pytest.mark.parametrize("tolerance", [0.0, -1e-8, float("nan"), 1e-16])
def test_a_tolerance_that_round_off_cannot_reach_is_refused(solver, tolerance):
    case = Rays(15)
    with pytest.raises(ValueError, match=rf"tolerance {tolerance} is below the round-off"):
        front_at(case.field, case.circle(), Load(0.0, 1), SOLVERS[solver](tolerance))


@every_solver
@pytest.mark.parametrize("direction", [1, -1])
def test_a_field_that_is_too_steep_for_the_tolerance_stops_the_front_with_a_sentence(
    solver, direction
):
    fronts = []
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
        fronts.append(outcome.status)
    assert fronts.count(Status.ROUND_OFF) >= 3
    assert "raise the tolerance" in Status.ROUND_OFF.value
