"""The fast solver finds the states of the reference, on fields that give it no reason to."""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter

from crackfront.core.adhesion import AdhesionMap, rough_adhesion
from crackfront.core.compiled import jit
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import first_place, last_place, tile_field
from crackfront.core.field.rays import front_products, segment_below
from crackfront.core.field.samples import make_memory
from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.jkr import energy_release_rate
from crackfront.core.outcome import Status
from crackfront.core.solver.forces import make_task
from crackfront.core.solver.hardening import hardening
from crackfront.core.solver.relax import SOLVERS, relax
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from tests.commands import slow


def rough_tile(
    elastic_energy, *, cutoff, roll_off, hurst, n_angle, seed, samples=16, interpolation="linear"
):
    spectrum = SelfAffineSpectrum(cutoff, roll_off, hurst).with_elastic_energy(elastic_energy)
    n_point = 128
    pixel = cutoff / 4
    heights = gaussian_field(spectrum, n_point, n_point * pixel, np.random.default_rng(seed))
    return tile_field(
        rough_adhesion(heights, pixel), sphere(n_angle), cutoff / samples, 3.0, interpolation
    )


def outcomes(front, penetration, direction, field):
    """Both solvers from the same start."""
    return [
        relax(front, penetration, direction, field, SOLVERS[solver](1e-11))
        for solver in ("reference", "newton")
    ]


# Kept on disk, as the kernels that it calls are.
@jit
def stiffness_ahead(task, radius, segment, product, reach):
    return hardening(task, 0, radius, product, segment, reach)


@pytest.mark.slow
@given(
    seed=st.integers(0, 2**32 - 1),
    share=st.floats(0.2, 0.8),
    reach=st.floats(1e-6, 0.5),
    direction=st.sampled_from([1, -1]),
    interpolation=st.sampled_from(["linear", "cubic"]),
    on_tile=st.booleans(),
)
def test_no_chord_of_the_drive_is_steeper_than_the_hardening(
    seed, share, reach, direction, interpolation, on_tile
):
    rng = np.random.default_rng(seed)
    radius, penetration = 0.8 + share, 0.4
    if on_tile:
        tile = AdhesionMap(rng.standard_normal((16, 16)), 0.11, 0.0, 0.0)
        field = tile_field(tile, sphere(4), 0.07, 3.0, interpolation)
    else:
        radii = np.cumsum(rng.uniform(0.03, 0.1, 60))
        field = polar_field(radii, rng.standard_normal((60, 4)), interpolation)
    reach = min(reach, 0.45 * last_place(field) / 3.0)

    def drive(distance):
        moved = radius + direction * np.asarray(distance)
        products = [front_products(np.full(4, a), field)[0] for a in np.atleast_1d(moved)]
        return direction * (np.array(products) - moved * energy_release_rate(moved, penetration))

    segment = segment_below(field, radius, direction)
    product = front_products(np.full(4, radius), field)[0]
    task = make_task(radius, penetration, direction, field, make_memory(field), 1e-8)
    stiffness = stiffness_ahead(task, radius, segment, product, reach)
    distances = reach * np.linspace(0.01, 1, 100)
    chords = (drive(0.0) - drive(distances)) / distances
    assert stiffness >= chords.max() - 1e-9 / reach
    # A short reach is judged by the slope under the site, which the bound must come down to.
    if reach < 1e-4:
        assert stiffness <= chords.max() + 0.1


@given(
    seed=st.integers(0, 2**32 - 1),
    n_angle=st.integers(15, 48),
    amplitude=st.sampled_from([0.0, 0.02, 0.1, 0.4, 0.8, 2.0]),
    spacing=st.sampled_from([0.02, 0.05, 0.1]),
    penetration=st.floats(-0.5, 1.0),
    direction=st.sampled_from([1, -1]),
    ragged=st.booleans(),
    interpolation=st.sampled_from(["linear", "cubic"]),
)
def test_the_fast_solver_stops_where_the_reference_stops(
    seed, n_angle, amplitude, spacing, penetration, direction, ragged, interpolation
):
    rng = np.random.default_rng(seed)
    radii = np.arange(0.2, 3.4, spacing)
    adhesion = (1 + amplitude * rng.standard_normal((radii.size, n_angle))) / np.pi
    field = polar_field(radii, adhesion, interpolation)
    start = np.full(n_angle, 0.25 if direction > 0 else 2.5)
    if ragged:
        # Sites that start with a force against the motion must wait for the others.
        start = rng.uniform(0.25, 2.0, n_angle)
    expected, outcome = outcomes(start, penetration, direction, field)
    assert outcome.status is expected.status
    if expected.status is Status.CONVERGED:
        assert np.max(np.abs(outcome.front - expected.front)) < 1e-8
        assert outcome.residual <= 1e-11


@pytest.mark.parametrize(("interpolation", "samples"), [("linear", 16), ("cubic", 4)])
@pytest.mark.parametrize(
    ("elastic_energy", "cutoff", "roll_off", "hurst"),
    [
        slow(0.0025, 0.08, 0.08, 1.0),
        slow(0.04, 0.08, 0.08, 1.0),
        (0.177, 0.08, 0.08, 1.0),
        (0.05, 0.08, 0.32, 0.3),
        slow(0.05, 0.08, 0.32, 0.8),
    ],
)
def test_a_whole_cycle_on_roughness_equals_that_of_the_reference(
    elastic_energy, cutoff, roll_off, hurst, interpolation, samples
):
    field = rough_tile(
        elastic_energy,
        cutoff=cutoff,
        roll_off=roll_off,
        hurst=hurst,
        n_angle=300,
        seed=5,
        samples=samples,
        interpolation=interpolation,
    )
    reference, newton = (
        run_cycle(field, LoadSchedule(0.6, 0.2), SOLVERS[s](1e-10), Recorder(fronts=True))
        for s in ("reference", "newton")
    )
    assert newton.status is reference.status is Status.LOST_CONTACT
    assert newton.end_load == reference.end_load
    assert np.max(np.abs(newton.fronts - reference.fronts)) < 1e-6 * cutoff
    assert newton.states.iterations.sum() < reference.states.iterations.sum()
    assert np.array_equal(reference.states.updates, 300 * reference.states.iterations)
    assert newton.states.updates.sum() < reference.states.updates.sum() / 2


@pytest.mark.slow
def test_over_a_dense_schedule_the_solvers_differ_by_the_tolerance_alone():
    field = rough_tile(0.04, cutoff=0.16, roll_off=0.16, hurst=1.0, n_angle=256, seed=2)
    differences = []
    for tolerance in (1e-8, 1e-10):
        reference, newton = (
            run_cycle(
                field, LoadSchedule(0.4, 0.002), SOLVERS[solver](tolerance), Recorder(fronts=True)
            )
            for solver in ("reference", "newton")
        )
        assert newton.fronts.shape == reference.fronts.shape
        differences.append(np.max(np.abs(newton.fronts - reference.fronts)) / 0.16)
    assert differences[0] < 1e-4
    assert differences[1] < differences[0] / 20


@pytest.mark.slow
def test_the_number_of_threads_has_no_say():
    # Libraries of linear algebra share vectors of more than 10000 numbers among threads.
    program = (
        "import hashlib, numpy as np\n"
        "from crackfront.core.geometry.sphere import polar_field\n"
        "from crackfront.core.solver.relax import Newton, relax\n"
        "rng = np.random.default_rng(1)\n"
        "field = polar_field(np.arange(1.0, 2.6, 0.1),"
        " (1 + 0.02 * rng.standard_normal((16, 10400))) / np.pi)\n"
        "front = relax(np.full(10400, 1.6), 1.0, 1, field, Newton(1e-6)).front\n"
        "print(hashlib.sha256(front.tobytes()).hexdigest())\n"
    )
    fronts = {
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads},
            capture_output=True,
            text=True,
            check=True,
            timeout=600,
        ).stdout
        for threads in ("1", "2")
    }
    assert len(fronts) == 1


# --- small fronts on straight pieces: never more transforms than the reference needs sweeps


def small_scene(seed):
    """Field, its first place and loads of a small cycle of any disorder and spacing."""
    rng = np.random.default_rng(seed)
    n_angle, n_sample = int(rng.integers(17, 132)), int(np.exp(rng.uniform(2.1, 5.7)))
    amplitude = rng.choice([0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.0, 1.5, 2.0, 3.0])
    inner = np.exp(rng.uniform(-3.9, -1.6))
    spacings = [
        np.ones(n_sample - 1),
        np.diff(np.geomspace(inner, 3.4, n_sample)),
        rng.uniform(0.1, 1.9, n_sample - 1),
        rng.exponential(1.0, n_sample - 1) + 1e-3,
    ][rng.integers(4)]
    ways = np.concatenate([[0.0], np.cumsum(spacings)])
    radii = inner + (3.4 - inner) * ways / ways[-1]
    noise = rng.standard_normal((n_sample, n_angle))
    if patch := rng.integers(3):
        noise = gaussian_filter(noise, patch, mode=("nearest", "wrap"))
    field = polar_field(radii, (1 + amplitude * noise / noise.std()) / np.pi)
    top, step = rng.uniform(0.1, 1.0), rng.choice([0.02, 0.1, 0.25, 0.5, 1.0])
    up, down = [*np.arange(0, top, step), top], np.arange(top - step, -6, -step)
    return field, inner, [(b, 1) for b in up] + [(b, -1) for b in down]


def compared(field, front, loads):
    """Outcomes of both solvers, each from the front of the reference before, until contact ends."""
    for load, direction in loads:
        expected, outcome = (
            relax(front, load, direction, field, SOLVERS[solver](1e-8, 30000))
            for solver in ("reference", "newton")
        )
        yield expected, outcome
        if expected.status is not Status.CONVERGED:
            return
        front = expected.front


def assert_no_small_cycle_needs_more_transforms(seeds):
    for seed in seeds:
        field, inner, loads = small_scene(seed)
        for expected, outcome in compared(field, np.full(field.geometry.n_site, inner), loads):
            assert outcome.status is expected.status, seed
            assert outcome.sweeps <= expected.sweeps, seed
            if outcome.status is Status.CONVERGED:
                assert np.max(np.abs(outcome.front - expected.front)) < 1e-5, seed


def test_no_small_cycle_on_straight_pieces_needs_more_transforms_than_the_reference_sweeps():
    assert_no_small_cycle_needs_more_transforms(range(8))


@pytest.mark.slow
def test_none_of_two_thousand_small_cycles_needs_more_transforms_than_the_reference_sweeps():
    assert_no_small_cycle_needs_more_transforms(range(2000))


@pytest.mark.parametrize(
    ("n_point", "pixel", "n_needle", "strength", "samples"),
    [
        slow(128, 0.04, 3, 1700.0, 5),
        slow(96, 0.04, 100, 1800.0, 5),
        slow(32, 0.1, 30, 1300.0, 5),
        (64, 0.06, 30, 2000.0, 1),
        slow(96, 0.04, 30, 170.0, 1),
        slow(128, 0.04, 10, 400.0, 2),
    ],
)
def test_needles_that_repel_take_no_more_transforms_than_the_reference_sweeps(
    n_point, pixel, n_needle, strength, samples
):
    adhesion, rng = np.ones((n_point, n_point)), np.random.default_rng(n_needle)
    adhesion.flat[rng.choice(n_point**2, n_needle, replace=False)] -= strength
    tile = AdhesionMap(WORK_OF_ADHESION * adhesion, pixel, 0.0, 0.0)
    field = tile_field(tile, sphere(1009), pixel / samples, 3.0)
    assert_no_more_transforms_than_sweeps(field, 0.6)


def assert_no_more_transforms_than_sweeps(field, top):
    """On a cycle to a largest penetration and back, of equal fronts."""
    loads = [(0.0, 1), (top / 6, 1), (top, 1), (top / 2, -1), (-0.3, -1)]
    for expected, outcome in compared(
        field, np.full(field.geometry.n_site, first_place(field)), loads
    ):
        assert outcome.status is expected.status
        assert outcome.sweeps <= expected.sweeps
        if outcome.status is Status.CONVERGED:
            assert np.max(np.abs(outcome.front - expected.front)) < 1e-5


# Without sweeps among needles, most of these take more transforms than the reference sweeps.
@pytest.mark.parametrize("seed", [6, *map(slow, [23, 42, 10, 30, 36, 37, 46, 49, 60, 65, 66, 78])])
def test_no_harsh_needles_take_more_transforms_than_the_reference_sweeps(seed):
    rng = np.random.default_rng(10_000 + seed)
    n_point, pixel = int(rng.choice([16, 32, 64, 96, 128])), rng.uniform(0.03, 0.12)
    samples = int(rng.choice([1, 2, 5, 8]))
    n_needle = int(np.exp(rng.uniform(np.log(2), np.log(n_point**2 / 8))))
    strength = np.exp(rng.uniform(np.log(10), np.log(1e5), n_needle))
    adhesion = 1 + rng.choice([0, 0.1, 0.4]) * rng.standard_normal((n_point, n_point))
    adhesion.flat[rng.choice(n_point**2, n_needle, replace=False)] -= strength
    tile = AdhesionMap(WORK_OF_ADHESION * adhesion, pixel, 0.0, 0.0)
    n_site, interpolation = int(rng.choice([300, 512, 1009])), str(rng.choice(["cubic", "linear"]))
    field = tile_field(tile, sphere(n_site), pixel / samples, 3.0, interpolation)
    assert_no_more_transforms_than_sweeps(field, rng.uniform(0.2, 1))
