"""Hard cases of the field and of the front; docs/experiments/hard-cases.md lists the main ones."""

from pathlib import Path

import numpy as np
import pytest

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap, chemical_adhesion
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import tile_field
from crackfront.core.field.rays import front_adhesion
from crackfront.core.geometry.sphere import contact_field, half_laplacian, polar_field, sphere
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import SOLVERS, Newton, front_force, relax
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION, Scales
from crackfront.simulate.run_simulation import run_simulation
from crackfront.sweep.parameters import load_sweep
from tests.core.solvers import every_solver
from tests.yaml_texts import from_yaml, to_yaml


def tight(front, penetration, direction, field, solver, tolerance=1e-12):
    """Converged front of one relaxation."""
    outcome = relax(front, penetration, direction, field, SOLVERS[solver](tolerance))
    assert outcome.status is Status.CONVERGED
    return outcome.front


def chemical_tile(rms, cutoff, seed, n_angle, *, penetration=1.0, interpolation="cubic"):
    """Field of a flat chemical spectrum, 5 samples and 4 pixels a cutoff."""
    spectrum, n_point, pixel = SelfAffineSpectrum(cutoff, cutoff, 1.0), 64, cutoff / 4
    noise = gaussian_field(spectrum, n_point, n_point * pixel, np.random.default_rng(seed))
    noise *= rms / np.sqrt(spectrum.mean_square(0.0))
    adhesion = chemical_adhesion(noise, pixel)
    return contact_field(
        adhesion, penetration, n_angle, cutoff / 5, interpolation, band_limited=True
    )


def branches(record):
    """Rows of the penetrations that both branches visit, approach and retraction."""
    up = np.flatnonzero(record.states.direction > 0)[:-1]
    down = up[-1] + 2 + np.arange(up.size)
    assert np.array_equal(record.states.penetration[down], record.states.penetration[up[::-1]])
    return up, down[::-1]


# --- amplitude: from nothing to repulsion


@every_solver
def test_disorder_too_weak_to_pin_has_no_hysteresis_although_the_adhesion_fluctuates(solver):
    field = chemical_tile(0.02, 0.16, 1, 256)
    record = run_cycle(
        field, LoadSchedule(1.0, 0.05), SOLVERS[solver](1e-12), Recorder(fronts=True)
    )
    up, down = branches(record)
    fluctuation = [np.std(front_adhesion(front, field)) for front in record.fronts[up]]
    assert np.min(fluctuation) > 0.015 * WORK_OF_ADHESION
    assert np.ptp(record.fronts[up], axis=1).min() > 1e-3
    assert np.max(np.abs(record.fronts[down] - record.fronts[up])) < 1e-11
    apparent = record.states.apparent_work_of_adhesion
    assert np.max(np.abs(apparent[down] - apparent[up])) < 1e-11


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_solvers_agree_where_the_fluctuation_is_twice_w_int_and_much_of_the_surface_repels(
    interpolation,
):
    field = chemical_tile(2.0, 0.16, 2, 128, interpolation=interpolation)
    reference, newton = (
        run_cycle(field, LoadSchedule(1.0, 0.2), SOLVERS[solver](1e-10), Recorder(fronts=True))
        for solver in ("reference", "newton")
    )
    assert reference.status is newton.status is Status.LOST_CONTACT
    assert reference.end_load == newton.end_load
    assert np.max(np.abs(reference.fronts - newton.fronts)) < 1e-9
    assert np.all(newton.states.residual <= 1e-10)
    lowest = np.sqrt(np.maximum(newton.states.penetration, 0.0))
    assert np.all(newton.states.min_radius >= lowest * (1 - 1e-12))
    repelled = [np.mean(front_adhesion(front, field) < 0) for front in newton.fronts]
    assert np.max(repelled) > 0.1
    up, down = branches(newton)
    apparent = newton.states.apparent_work_of_adhesion
    assert np.mean(apparent[down] - apparent[up]) > 0.2


def test_hysteresis_and_bending_grow_from_nothing_as_the_line_turns_from_stiff_to_floppy():
    # A bulge as wide as a patch is held by w_int against a slope of the field of w_rms.
    pinned, bent = [], []
    for rms in (0.02, 0.1, 0.3, 1.0):
        record = run_cycle(chemical_tile(rms, 0.1, 3, 256), LoadSchedule(1.0, 0.05), Newton(1e-9))
        up, down = branches(record)
        apparent = record.states.apparent_work_of_adhesion
        pinned.append(np.mean((apparent[down] - apparent[up])[up > 5]) / rms)
        bent.append(np.mean(record.states.rms_radius[up]) / 0.1)
    assert np.max(np.abs(pinned[:2])) < 1e-7
    assert 0.05 < pinned[2] < pinned[3] / 2 < 0.15
    # A stiff line bends in proportion to the disorder.
    assert bent[0] < 0.02
    assert bent[1] / bent[0] == pytest.approx(5, rel=0.02)
    assert bent[3] > 0.5


# --- obstacles


def obstacle_field(n_angle, strengths, *, interpolation="linear"):
    """Uniform adhesion but for single rays, by ray; radii from 0.05 to 2.5."""
    radii = 0.05 * np.arange(1, 51)
    adhesion = np.full((50, n_angle), WORK_OF_ADHESION)
    for ray, strength in strengths.items():
        adhesion[:, ray] *= strength
    return polar_field(radii, adhesion, interpolation)


def bending(n_angle, penetration):
    """Shape of the front per unit of force on one ray, of the line on the hardening of JKR."""
    radius = jkr.equilibrium_radius(penetration)
    opening = radius**2 - penetration
    # Slope of a G - a w_int, in units of w_int.
    slope = 0.375 * 4 * radius * opening - 1
    order = np.minimum(np.arange(n_angle), n_angle - np.arange(n_angle))
    return radius, np.fft.ifft(1 / (order + slope)).real


@every_solver
@pytest.mark.parametrize("n_angle", [64, 63])
def test_a_front_bends_about_a_weak_obstacle_as_linear_elasticity_says(solver, n_angle):
    radius, shape = bending(n_angle, 0.5)
    errors = []
    for weakness in (0.02, 0.01):
        field = obstacle_field(n_angle, {0: 1 - weakness})
        front = tight(np.full(n_angle, 0.1), 0.5, 1, field, solver)
        deflection = front - radius
        force = weakness * front[0]
        errors.append(np.max(np.abs(deflection + force * shape)) / force)
    # What is left is of second order in the obstacle.
    assert errors[1] < 2e-3 * shape[0]
    assert errors[0] / errors[1] == pytest.approx(2, abs=0.05)


@every_solver
def test_a_front_bends_logarithmically_near_a_strong_obstacle(solver):
    n_angle = 1024
    field = obstacle_field(n_angle, {0: -50.0})
    front = tight(np.full(n_angle, 0.1), 0.0, 1, field, solver, 1e-8)
    lag = jkr.equilibrium_radius(0.0) - front[0]
    assert lag > 0.3
    # a = (p / pi) ln(theta) between the site's own width and where JKR hardens, at about 1/3.
    pull = -half_laplacian(front)[0] * 2 * np.pi / n_angle
    near, far = 3, 12
    rise = (front[far] - front[near]) / np.log(far / near)
    assert rise == pytest.approx(pull / np.pi, rel=0.08)
    assert np.allclose(front[1:], front[:0:-1], rtol=0, atol=1e-9)


@every_solver
@pytest.mark.parametrize("direction", [1, -1])
def test_obstacles_give_way_in_the_order_of_their_strength(solver, direction):
    # Four rays with an obstacle between the radii 1.25 and 1.5, a quarter apart.
    adhesion = np.full((60, 64), WORK_OF_ADHESION)
    adhesion[25:29, ::16] *= 1 - direction * np.array([0.5, 1.0, 2.0, 4.0])
    field = polar_field(0.05 * np.arange(1, 61), adhesion)
    front = np.full(64, 0.1 if direction > 0 else 2.4)
    let_go = np.full(4, np.nan)
    for load in np.linspace(-0.9, 1.6, 126)[::direction]:
        front = tight(front, load, direction, field, solver, 1e-10)
        passed = front[::16] > 1.5 if direction > 0 else front[::16] < 1.25
        let_go[passed & np.isnan(let_go)] = load
    assert np.all(direction * np.diff(let_go) > 0.05)


# --- steps of the field


def stepped_field(inside, outside, width, edge=1.5):
    """Uniform adhesion but for one step at a radius."""
    radii = np.array([0.05, edge, edge + width, 2.8])
    adhesion = np.array([inside, inside, outside, outside])
    return polar_field(radii, WORK_OF_ADHESION * np.repeat(adhesion[:, None], 24, axis=1))


@every_solver
@pytest.mark.parametrize("width", [1e-3, 1e-6])
def test_a_front_waits_at_a_step_down_of_the_adhesion_and_has_no_hysteresis(solver, width):
    field = stepped_field(1.0, 0.3, width)
    first, last = jkr.equilibrium_penetration(1.5, [1.0, 0.3])
    front = np.full(24, 0.05)
    up = [first - 0.1, first + 0.01, last - 0.01, last + 0.1]
    for load, direction in [*((load, 1) for load in up), *((load, -1) for load in up[::-1])]:
        front = tight(front, load, direction, field, solver, 1e-9)
        if load < first or load > last:
            exact = jkr.equilibrium_radius(load, 1.0 if load < first else 0.3)
            assert np.allclose(front, exact, rtol=0, atol=1e-8)
        else:
            assert np.all((front > 1.5) & (front < 1.5 + width))


@every_solver
@pytest.mark.parametrize("width", [1e-3, 1e-6])
def test_a_front_jumps_at_a_step_up_of_the_adhesion_at_another_load_on_the_way_back(solver, width):
    field = stepped_field(0.3, 1.0, width)
    inward, outward = jkr.equilibrium_penetration(1.5, [1.0, 0.3])
    front = np.full(24, 0.05)
    for load, direction, adhesion in [
        (outward - 0.01, 1, 0.3),
        (outward + 0.01, 1, 1.0),
        (inward + 0.01, -1, 1.0),
        (inward - 0.01, -1, 0.3),
    ]:
        front = tight(front, load, direction, field, solver, 1e-9)
        exact = jkr.equilibrium_radius(load, adhesion)
        assert np.allclose(front, exact, rtol=0, atol=1e-8)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_solvers_agree_on_patches_with_sharp_edges(interpolation):
    # Squares of 5 pixels of 0.4 and 1.6 w_int; 5 samples a pixel resolve what the splines make.
    patches = np.random.default_rng(6).choice([0.4, 1.6], (8, 8)).repeat(5, 0).repeat(5, 1)
    adhesion = AdhesionMap(WORK_OF_ADHESION * patches, 0.05, 0.0, 0.0)
    field = tile_field(adhesion, sphere(160), 0.01, 3.0, interpolation)
    reference, newton = (
        run_cycle(field, LoadSchedule(0.8, 0.2), SOLVERS[solver](1e-10), Recorder(fronts=True))
        for solver in ("reference", "newton")
    )
    assert newton.status is reference.status is Status.LOST_CONTACT
    assert np.max(np.abs(reference.fronts - newton.fronts)) < 1e-8
    # Splines through a step overshoot it, along each axis by less than 11% of the step.
    held = np.array([front_adhesion(front, field) for front in newton.fronts]) / WORK_OF_ADHESION
    assert 0.4 - 0.3 < held.min() < 0.4 < 1.6 < held.max() < 1.6 + 0.3


# --- ties


@every_solver
@pytest.mark.parametrize("fold", [2, 3, 5, 8])
@pytest.mark.parametrize("rms", [0.3, 1.0])
def test_a_front_on_a_field_of_n_fold_symmetry_keeps_the_symmetry(solver, fold, rms):
    radii = 0.04 * np.arange(1, 80)
    part = np.random.default_rng(fold).standard_normal((radii.size, 120 // fold))
    field = polar_field(radii, WORK_OF_ADHESION * (1 + rms * np.tile(part, (1, fold))))
    front = np.full(120, 0.04)
    for load, direction in [(0.0, 1), (0.6, 1), (1.0, 1), (0.4, -1), (0.0, -1), (0.7, 1)]:
        front = tight(front, load, direction, field, solver)
        copies = front.reshape(fold, -1)
        assert np.max(np.ptp(copies, axis=0)) < 1e-11
        assert np.ptp(copies[0]) > 0.02


# --- sizes


@every_solver
@pytest.mark.parametrize("n_point", [15, 16])
def test_a_tile_smaller_than_the_contact_gives_the_fronts_of_its_repetition(solver, n_point):
    noise = np.random.default_rng(4).standard_normal((n_point, n_point))
    adhesion = WORK_OF_ADHESION * (1 + 0.3 * noise)
    start = np.full(48, 0.04)
    fronts = [
        tight(
            start,
            0.7,
            1,
            tile_field(AdhesionMap(tile, 0.06, 0.0, 0.0), sphere(48), 0.04, 3.2),
            solver,
        )
        for tile in (adhesion, np.tile(adhesion, (3, 3)))
    ]
    # The contact is three to four times as wide as the tile.
    assert 2 * fronts[0].min() > 3 * 0.06 * n_point
    assert np.ptp(fronts[0]) > 0.05
    assert np.allclose(fronts[0], fronts[1], rtol=0, atol=1e-11)


@every_solver
def test_any_factorisation_of_the_number_of_sites_gives_the_same_front_of_a_smooth_field(solver):
    position = np.arange(24)
    wave = np.cos(2 * np.pi * (position[:, None] + position[None, :]) / 24)
    adhesion = AdhesionMap(WORK_OF_ADHESION * (1 + 0.03 * wave), 0.1, 0.0, 0.0)
    modes = []
    for n_angle in (128, 125, 127, 126, 256):
        field = tile_field(adhesion, sphere(n_angle), 0.05, 2.6)
        front = tight(np.full(n_angle, 0.5), 0.5, 1, field, solver)
        modes.append(np.fft.rfft(front)[:20] / n_angle)
    # Powers of two and of five, a prime, and 2 * 3 * 3 * 7.
    assert abs(modes[0][2]) > 1e-3
    for mode in modes[:-1]:
        assert np.max(np.abs(mode - modes[-1])) < 1e-9


# --- single sites and the centre


@every_solver
@pytest.mark.parametrize("n_angle", [64, 256])
def test_one_site_may_lag_behind_all_others_by_most_of_the_radius(solver, n_angle):
    radii = np.linspace(0.02, 2.4, 120)
    adhesion = np.full((120, n_angle), WORK_OF_ADHESION)
    adhesion[radii > 0.4, 3] *= -1000.0
    field = polar_field(radii, adhesion)
    front = tight(np.full(n_angle, 0.02), -0.2, 1, field, solver)
    other_sites = np.delete(front, 3)
    assert front[3] < 0.45 < 0.7 < other_sites.min()
    force = front_force(front, -0.2, field) / (front * WORK_OF_ADHESION)
    assert np.max(np.abs(force)) < 1e-11
    # A front that lags so far is still the first: the solvers meet in it.
    again = tight(np.full(n_angle, 0.02), -0.2, 1, field, "reference")
    assert np.allclose(front, again, rtol=0, atol=1e-9)


@every_solver
@pytest.mark.parametrize("core", [0.1, 0.01, 0.001])
def test_a_front_shrinks_onto_a_strong_spot_at_the_centre_and_is_held_there(solver, core):
    # A spot of w_loc falling as 1/a, so that the product is constant: held at its edge.
    load, strength = -1.5, 3.0
    radii = np.array([core / 4, core, core * 1.001, 2.0])
    adhesion = np.array([strength / core, strength / core, 1.0, 1.0])
    field = polar_field(radii, WORK_OF_ADHESION * np.repeat(adhesion[:, None], 16, axis=1))
    front = tight(np.full(16, 1.5), load, -1, field, solver, 1e-8)
    # The rings ask for 3/8 b^2 = 0.84 w_int of radius times adhesion, the spot gives up to 3.
    assert np.all((front >= core) & (front <= core * 1.001))
    lost = relax(front, -3.0, -1, field, SOLVERS[solver]())
    assert lost.status is Status.LOST_CONTACT


# --- bad and odd values


@every_solver
def test_zero_adhesion_at_places_is_physical_and_is_accepted(solver):
    noise = np.random.default_rng(3).standard_normal((16, 16))
    holes = AdhesionMap(WORK_OF_ADHESION * np.maximum(1 + 0.8 * noise, 0.0), 0.2, 0.0, 0.0)
    assert np.count_nonzero(holes.work_of_adhesion == 0) > 10
    rays = np.full((50, 32), WORK_OF_ADHESION)
    rays[20, 5] = rays[:, 9] = 0.0
    fields = [tile_field(holes, sphere(64), 0.04, 3.2), polar_field(0.06 * np.arange(1, 51), rays)]
    for field in fields:
        record = run_cycle(field, LoadSchedule(0.6, 0.2), SOLVERS[solver](), Recorder(energy=True))
        assert record.status is Status.LOST_CONTACT
        assert np.all(record.states.residual <= 1e-8)
        assert np.all(record.dissipated_energy > 0)


@every_solver
def test_a_field_of_zeros_gives_the_contact_of_hertz(solver):
    field = polar_field(0.06 * np.arange(1, 51), np.zeros((50, 32)))
    states = run_cycle(field, LoadSchedule(0.6, 0.2), SOLVERS[solver]()).states
    pressed = (states.penetration > 0) & (states.direction > 0)
    radius = np.sqrt(states.penetration[pressed])
    assert np.count_nonzero(pressed) == 3
    assert states.mean_radius[pressed] == pytest.approx(radius, rel=1e-12)
    assert states.force[pressed] == pytest.approx(4 / 3 * CONTACT_MODULUS * radius**3, rel=1e-12)


# --- units


@pytest.mark.parametrize("radius", [1e-9, 1e-6, 1e-3, 1.0])
def test_a_scene_from_nanometres_to_metres_gives_the_reduced_result(tmp_path, radius):
    reduced = from_yaml(Path(__file__).parents[3].joinpath("config/test.yaml").read_text())
    reduced["numerics"] |= {"tolerance": 1e-12}
    # Adhesion and modulus that leave the contact smaller than the sphere at every size.
    scales = Scales(radius, 0.05, 1e9 * (1e-9 / radius) ** 0.5)
    metres = reduced | {
        "scales": {
            "radius": radius,
            "work_of_adhesion": 0.05,
            "contact_modulus": scales.contact_modulus,
        },
        "load": {name: value * scales.vertical for name, value in reduced["load"].items()},
        "spectra": [
            {name: value * scales.lateral if name in ("short_cutoff", "roll_off") else value
             for name, value in item.items()}
            for item in reduced["spectra"]
        ],
    }  # fmt: skip
    records = []
    for content in (reduced, metres):
        (tmp_path / "sweep.yaml").write_text(to_yaml(content))
        sweep = load_sweep(tmp_path / "sweep.yaml")
        records.append(run_simulation(sweep.simulation(sweep.named("rough"), 0.1, 0)).record)
    nanometres, in_metres = records
    assert in_metres.status is nanometres.status is Status.LOST_CONTACT
    assert np.allclose(
        in_metres.states.penetration, nanometres.states.penetration, rtol=1e-13, atol=1e-15
    )
    assert np.allclose(
        in_metres.states.mean_radius, nanometres.states.mean_radius, rtol=0, atol=1e-12
    )
    assert np.allclose(in_metres.states.force, nanometres.states.force, rtol=0, atol=1e-12)
