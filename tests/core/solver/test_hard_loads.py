"""Hard cases of the load, the energy and round-off; docs/experiments/hard-cases.md."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import first_place, last_place, tile_field
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS, front_force, relax
from crackfront.core.units import WORK_OF_ADHESION
from tests.commands import slow
from tests.core.solvers import every_solver

TIGHT = 1e-12
"""Tolerance at which fronts are compared; they then agree to SAME."""
SAME = 1e-8

fast_solver = pytest.mark.parametrize("solver", ["newton", slow("reference")])


def random_field(seed, n_ray=24, amplitude=0.4, *, tile=False, interpolation="linear"):
    """White noise on a tile or on rays."""
    rng = np.random.default_rng(seed)
    if tile:
        noise = rng.standard_normal((17, 17))
        adhesion = AdhesionMap(WORK_OF_ADHESION * (1 + amplitude * noise), 0.12, 0.0, 0.0)
        return tile_field(adhesion, sphere(n_ray), 0.05, 3.4, interpolation)
    radii = np.cumsum(rng.uniform(0.03, 0.09, 60))
    noise = rng.standard_normal((60, n_ray))
    return polar_field(radii, WORK_OF_ADHESION * (1 + amplitude * noise), interpolation)


every_kind = st.builds(
    random_field,
    seed=st.integers(0, 2**32 - 1),
    n_ray=st.integers(8, 32) | st.sampled_from([65, 128]),
    amplitude=st.sampled_from([0.05, 0.2, 0.4, 0.8]),
    tile=st.booleans(),
    interpolation=st.sampled_from(["linear", "cubic"]),
)


def circle(field):
    """The innermost circle of a field."""
    return np.full(field.geometry.n_site, first_place(field))


def extent(front, penetration, direction, field, solver):
    """Tight front, nothing where contact is lost."""
    outcome = relax(front, penetration, direction, field, SOLVERS[solver](TIGHT))
    if outcome.status is Status.CONVERGED:
        return outcome.front
    assert outcome.status in (Status.LOST_CONTACT, Status.LEFT_FIELD_INWARD)
    return np.zeros_like(front)


def held(front, penetration, direction, field, solver):
    """Tight front; examples in which contact is lost are passed over."""
    radii = extent(front, penetration, direction, field, solver)
    assume(radii[0] > 0)
    return radii


def tight(front, penetration, direction, field, solver):
    """Tight front where contact is never lost."""
    radii = extent(front, penetration, direction, field, solver)
    assert radii[0] > 0
    return radii


# --- no passing and what follows, on every kind of field


@every_solver
@pytest.mark.parametrize("direction", [1, -1])
@given(field=every_kind, seed=st.integers(0, 2**32 - 1), loads=st.tuples(*2 * [st.floats(-0.6, 1)]))
def test_no_front_passes_another_on_any_kind_of_field(solver, direction, field, seed, loads):
    rng = np.random.default_rng(seed)
    count = field.geometry.n_site
    inner = rng.uniform(0.3, 1.2, count)
    outer = inner + rng.uniform(0, 0.8, count) * (rng.random(count) < 0.5)
    behind = extent(inner, min(loads), direction, field, solver)
    ahead = extent(outer, max(loads), direction, field, solver)
    assert np.all(behind <= ahead + SAME)


@every_solver
@pytest.mark.parametrize("direction", [1, -1])
@given(field=every_kind, cuts=st.lists(st.floats(-0.3, 0.9), max_size=10))
def test_the_load_steps_leave_no_trace_on_any_kind_of_field(solver, direction, field, cuts):
    front = circle(field) if direction > 0 else held(circle(field), 0.9, 1, field, solver)
    end = 0.9 if direction > 0 else -0.3
    at_once = extent(front, end, direction, field, solver)
    for load in [*sorted(cuts)[::direction], end]:
        front = extent(front, load, direction, field, solver)
        if front[0] == 0:
            break
    assert np.allclose(front, at_once, rtol=0, atol=SAME)


@pytest.mark.slow
@pytest.mark.parametrize("direction", [1, -1])
@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1), tile=st.booleans(), n_ray=st.sampled_from([8, 15, 16, 21]))
def test_any_order_of_forward_moves_ends_in_the_same_front_on_cubic_pieces(
    direction, seed, tile, n_ray
):
    field = random_field(seed, n_ray, 0.3, tile=tile, interpolation="cubic")
    rng, load = np.random.default_rng(seed), 0.3 if direction > 0 else -0.1
    start = np.full(n_ray, 0.9 if direction > 0 else 2.2)
    # Steeper than any chord of a site's own force: line, products and rings on the whole field.
    fine = np.linspace(0.2, 0.99 * last_place(field), 3000)
    forces = [front_force(np.full(n_ray, radius), load, field) for radius in fine]
    bound = 1.1 * np.max(np.abs(np.diff(forces, axis=0))) / np.diff(fine)[0]
    bound += n_ray / 4 * WORK_OF_ADHESION
    front = start.copy()
    for _ in range(400_000):
        drive = np.maximum(direction * front_force(front, load, field), 0.0)
        if np.max(drive) < 1e-11 or np.min(front) < 0.25:
            break
        moving = rng.random(n_ray) < rng.random()
        front += direction * np.where(moving, drive / bound, 0.0)
    assume(np.min(front) >= 0.25)
    for solver in SOLVERS:
        radii = held(start, load, direction, field, solver)
        assert np.abs(radii - start).max() > 0.05
        assert np.allclose(radii, front, rtol=0, atol=1e-7), solver


@every_solver
@given(
    field=every_kind,
    shares=st.lists(st.floats(0.05, 0.95), min_size=2, max_size=6),
    skip=st.booleans(),
)
def test_nested_minor_loops_close_one_after_the_other(solver, field, shares, skip):
    loads, fronts = [1.0], [held(circle(field), 1.0, 1, field, solver)]
    low, high = -0.2, 1.0
    for turn, share in enumerate(shares):
        # Each turning point lies between the two before it.
        load = low + share * (high - low)
        low, high = (load, high) if turn % 2 == 0 else (low, load)
        direction = 1 if turn % 2 else -1
        fronts.append(held(fronts[-1], load, direction, field, solver))
        loads.append(load)
    front = fronts[-1]
    last = len(loads) - 1
    # Back over every turning point, or straight past an inner loop, which is then forgotten.
    for k in [max(last - 3, (last - 1) % 2)] if skip else range(last - 1, -1, -1):
        direction = 1 if k % 2 == 0 else -1
        front = held(front, loads[k], direction, field, solver)
        assert np.allclose(front, fronts[k], rtol=0, atol=SAME)


# --- steps of the load: large, tiny, none


@every_solver
def test_a_load_that_is_repeated_moves_nothing_and_dissipates_nothing(solver):
    field = random_field(3, 48, interpolation="cubic")
    recorder = Recorder(fronts=True, energy=True)
    ways = [(0.0, 1), (0.0, 1), (0.5, 1), (0.5, 1), (0.5, -1), (0.2, -1), (0.2, -1)]
    recorder.run(field, circle(field), [Load(*way) for way in ways], SOLVERS[solver]())
    record = recorder.record()
    assert record.status is Status.CONVERGED
    assert len(recorder.states) == len(ways)
    for row in (1, 3, 4, 6):
        assert np.array_equal(record.fronts[row], record.fronts[row - 1])
        assert record.dissipated_energy[row] == 0.0
        assert record.states.force[row] == record.states.force[row - 1]
    assert np.all(record.dissipated_energy[[0, 2, 5]] > 0)


# --- pull-off


def last_held(front, low, high, field, solver, n_step):
    """Penetrations that hold and that lose the contact, by halving; the front that is held."""
    for _ in range(n_step):
        middle = (low + high) / 2
        outcome = relax(front, middle, -1, field, SOLVERS[solver](TIGHT))
        if outcome.status is Status.CONVERGED:
            front, high = outcome.front, middle
        else:
            assert outcome.status is Status.LOST_CONTACT
            low = middle
    return low, high, front


@fast_solver
def test_pull_off_of_a_smooth_sphere_is_met_to_ten_digits_by_ever_smaller_steps(solver):
    field = polar_field(0.01 * np.arange(1, 201), np.full((200, 4), WORK_OF_ADHESION))
    low, high, front = last_held(np.full(4, 1.0), -1.0, -0.8, field, solver, 32)
    assert jkr.pull_off_penetration() == pytest.approx(-0.908560296, abs=5e-10)
    assert high - low < 1e-10
    assert high == pytest.approx(jkr.pull_off_penetration(), abs=1e-10)
    # The stiffness vanishes there as the root of the distance, and so does the radius.
    assert front == pytest.approx(jkr.pull_off_radius(), abs=1e-5)


@every_solver
def test_the_radius_nears_pull_off_as_the_root_of_the_distance(solver):
    field = polar_field(0.01 * np.arange(1, 201), np.full((200, 4), WORK_OF_ADHESION))
    front, distances = np.full(4, 1.0), 10.0 ** -np.arange(2, 10)
    excess = []
    for distance in distances:
        front = tight(front, jkr.pull_off_penetration() + distance, -1, field, solver)
        excess.append(front[0] - jkr.pull_off_radius())
    # b - b_c = c (a - a_c)^2 / 2 with c = d2b/da2 there.
    curvature = 2 + 0.25 * np.sqrt(8 / 3) * jkr.pull_off_radius() ** -1.5
    expected = np.sqrt(2 * distances / curvature)
    assert np.array(excess)[2:] == pytest.approx(expected[2:], rel=0.02)


@fast_solver
@pytest.mark.parametrize("tile", [False, True])
def test_pull_off_of_a_rough_sphere_does_not_depend_on_the_steps_that_lead_to_it(solver, tile):
    field = random_field(4, 24, 0.2, tile=tile, interpolation="cubic")
    top = tight(circle(field), 0.5, 1, field, solver)
    by_halving = last_held(top, -2.0, 0.5, field, solver, 26)
    shallow = tight(top, by_halving[1] + 0.01, -1, field, solver)
    from_near = last_held(shallow, -2.0, by_halving[1] + 0.01, field, solver, 26)
    assert by_halving[1] - by_halving[0] < 1e-7
    assert from_near[1] == pytest.approx(by_halving[1], abs=1e-7)


# --- round-off


@every_solver
@pytest.mark.parametrize("n_ray", [24, 131, 300])
def test_tolerances_next_to_round_off_are_met_or_told(solver, n_ray):
    field = random_field(5, n_ray, interpolation="cubic")
    limit = np.finfo(float).eps * n_ray
    fronts = []
    for factor in (1.0, 4.0, 1e4):
        method = SOLVERS[solver](factor * limit, max_sweeps=200_000)
        outcome = relax(circle(field), 0.6, 1, field, method)
        # At the limit itself the last digit may decide; the status then says so.
        allowed = {Status.CONVERGED} | ({Status.ROUND_OFF} if factor == 1 else set())
        assert outcome.status in allowed
        fronts.append(outcome.front)
    assert np.allclose(fronts[0], fronts[2], rtol=0, atol=1e-8)


@every_solver
@pytest.mark.parametrize("n_ray", [slow(128), 131, slow(300)])
def test_the_order_of_the_sums_leaves_ten_digits_of_a_cycle(solver, n_ray):
    # The same problem with other round-off: rays in another order, and the mirror image.
    radii = np.cumsum(np.random.default_rng(6).uniform(0.03, 0.09, 60))
    noise = np.random.default_rng(7).standard_normal((60, n_ray))
    adhesion = WORK_OF_ADHESION * (1 + 0.4 * noise)

    def cycle(values):
        return run_cycle(
            polar_field(radii, values, "cubic"),
            LoadSchedule(0.8, 0.2),
            SOLVERS[solver](TIGHT),
            Recorder(fronts=True),
        )

    plain = cycle(adhesion)
    for change in (lambda x: np.roll(x, 37, axis=1), lambda x: x[:, ::-1]):
        reordered = cycle(change(adhesion))
        assert np.array_equal(reordered.states.penetration, plain.states.penetration)
        assert np.allclose(reordered.fronts, change(plain.fronts), rtol=0, atol=1e-10)
        assert np.allclose(reordered.states.force, plain.states.force, rtol=0, atol=1e-10)


PLAIN = """
import json, sys
import numpy as np
np.seterr(all="raise", under="ignore")
sys.path.insert(0, sys.argv[1])
from test_hard_loads import plain_cycles
json.dump(plain_cycles(), sys.stdout)
"""


def plain_cycles():
    """Fronts and energies of small cycles in both solvers, on all kinds of fields."""
    cycles = []
    for tile, interpolation, n_ray, amplitude in [
        (False, "linear", 8, 0.4),
        (False, "linear", 33, 0.8),
        (False, "cubic", 33, 1.5),
        (True, "cubic", 33, 0.05),
        (True, "cubic", 64, 0.8),
        (True, "linear", 33, 0.4),
    ]:
        field = random_field(8, n_ray, amplitude, tile=tile, interpolation=interpolation)
        for solver in ("reference", "newton") if n_ray < 64 else ("newton",):
            record = run_cycle(
                field, LoadSchedule(0.8, 0.4), SOLVERS[solver](1e-7), Recorder(energy=True)
            )
            means, lost = record.states.mean_radius.tolist(), record.dissipated_energy.tolist()
            cycles.append([record.status.name, means, lost])
    return cycles


@pytest.mark.slow
def test_kernels_in_plain_python_raise_no_floating_point_error_and_find_the_compiled_fronts():
    # Compiled code does not raise: a division by zero or an overflow would pass unseen.
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", PLAIN, str(Path(__file__).parent)],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    for plain, compiled in zip(json.loads(done.stdout), plain_cycles(), strict=True):
        assert plain[0] == compiled[0] == "LOST_CONTACT"
        assert plain[1] == pytest.approx(compiled[1], rel=1e-6)
        assert plain[2] == pytest.approx(compiled[2], abs=1e-6)
