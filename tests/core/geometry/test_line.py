"""The straight front: closed forms, the scalar problem, the reference, and its command."""

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from crackfront.cli import main
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.follow import Load, follow
from crackfront.core.cycle.load_schedule import protocol
from crackfront.core.cycle.record import Recorder
from crackfront.core.field.rays import front_adhesion
from crackfront.core.geometry.line import initial_front, line_field
from crackfront.core.solver.forces import line_force
from crackfront.core.solver.relax import SOLVERS, Newton, Reference, front_force
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.plots.figures import plot_fronts, plot_loop
from tests.core.solvers import every_solver


def tile(values, pixel=1.0, corner=(0.0, 0.0)):
    """A tile of a work of adhesion relative to w_int."""
    return AdhesionMap(WORK_OF_ADHESION * np.asarray(values), pixel, 0.0, 0.0, corner)


def noisy(seed, n_x=48, n_y=32, rms=0.3):
    """A tile of smooth noise, three points a wave and more."""
    modes = np.fft.rfft2(np.random.default_rng(seed).standard_normal((n_x, n_y)))
    fast = np.hypot(np.fft.fftfreq(n_x)[:, None], np.fft.rfftfreq(n_y)) > 0.3
    modes[fast], modes[0, 0] = 0.0, 0.0
    values = np.fft.irfft2(modes, (n_x, n_y))
    return tile(1 + rms * values / values.std())


def run(adhesion, spring, way, solver, interpolation="linear"):
    """Record of a front from far behind the first load on, and its field."""
    ends = min(load.value for load in way), max(load.value for load in way)
    field = line_field(adhesion, spring, ends, interpolation=interpolation)
    recorder = Recorder(fronts=True, energy=True)
    front = initial_front(field, adhesion, way[0].value)
    recorder.run(field, front, [way[0]._replace(start=front), *way[1:]], solver)
    return recorder.record(), field


@every_solver
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_without_disorder_the_front_is_where_the_load_is(solver, interpolation):
    way = [*protocol([0.3, 20.1, 0.3], 2.2)]
    record, _ = run(tile(np.ones((8, 16))), 5.0, way, SOLVERS[solver](1e-12), interpolation)
    assert np.allclose(
        record.states.mean_position, record.states.spring_position, rtol=0, atol=1e-10
    )
    assert np.allclose(record.states.pinning_force, 0.0, atol=1e-11)
    assert np.all(np.ptp(record.fronts, axis=1) < 1e-10)


def first_stops(wave, spring, loads, start):
    """Places at which a straight front first rests, one load after the other.

    In equilibrium the load is u - spring (w - mean) / w_int, straight between the points of the
    wave: its running maximum from behind is reached first.
    """
    balance = np.arange(wave.size) - spring * (wave - wave.mean())
    n_period = 80
    nodes = np.arange(-wave.size * n_period // 2, wave.size * n_period // 2)
    height = balance[nodes % wave.size] + (nodes - nodes % wave.size)
    places, place = [], start
    for load in loads:
        ahead = np.flatnonzero((nodes >= np.ceil(place)) & (height >= load.value))
        k = ahead[0]
        if load.direction < 0:
            behind = np.flatnonzero((nodes <= np.floor(place)) & (height <= load.value))
            k = behind[-1] + 1
        part = (load.value - height[k - 1]) / (height[k] - height[k - 1])
        place = nodes[k - 1] + part
        places.append(place)
    return np.array(places)


@every_solver
@pytest.mark.parametrize("spring", [3.0, 40.0])
def test_a_sinusoid_along_the_motion_is_the_scalar_problem(solver, spring):
    wave = 1 + 0.2 * np.sin(2 * np.pi * np.arange(12) / 12)
    adhesion = tile(np.repeat(wave[:, None], 16, axis=1))
    way = [*protocol([30.0, 95.0, 30.0], 0.7131)]  # no tie with a fold
    record, _ = run(adhesion, spring, way, SOLVERS[solver](1e-12))
    expected = first_stops(wave, spring, way, record.fronts[0].mean() - 12)
    assert np.allclose(record.states.mean_position, expected, rtol=0, atol=1e-8)
    assert np.all(np.ptp(record.fronts, axis=1) < 1e-8)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@settings(max_examples=15)
@given(
    seed=st.integers(0, 2**32 - 1),
    rms=st.sampled_from([0.05, 0.3, 1.0]),
    spring=st.sampled_from([2.0, 20.0, 200.0]),
)
def test_the_fast_solver_finds_the_fronts_of_the_reference(interpolation, seed, rms, spring):
    way = [*protocol([100.0, 160.0, 100.0], 15.0)]
    adhesion = noisy(seed, rms=rms)
    fast, slow = (
        run(adhesion, spring, way, solver, interpolation)[0]
        for solver in (Newton(1e-11), Reference(1e-11))
    )
    assert fast.status is slow.status
    assert np.max(np.abs(fast.fronts - slow.fronts)) < 1e-7 * max(spring, 10.0)
    assert np.all(fast.dissipated_energy[1:] > -1e-8)


def test_a_front_solves_the_equation_of_a_line_on_springs():
    adhesion, spring = noisy(5), 16.0
    way = [*protocol([60.0, 120.0, 60.0], 6.0)]
    record, field = run(adhesion, spring, way, Newton(1e-10))
    values, (n_x, n_y) = adhesion.work_of_adhesion, adhesion.work_of_adhesion.shape
    numbers = np.abs(np.fft.fftfreq(n_y)) * 2 * np.pi
    for front, load, direction in zip(
        record.fronts, record.states.spring_position, record.states.direction, strict=True
    ):
        low = np.floor(front).astype(int)
        below, above = (values[(low + k) % n_x, np.arange(n_y)] for k in (0, 1))
        held = below + (front - low) * (above - below)
        assert np.allclose(held, front_adhesion(front, field), rtol=0, atol=1e-12)
        line = WORK_OF_ADHESION * np.fft.ifft(numbers * np.fft.fft(front)).real
        drive = held - values.mean() - WORK_OF_ADHESION / spring * (front - load) - line
        assert np.allclose(drive, front_force(front, load, field), rtol=0, atol=1e-11)
        assert np.max(direction * drive) <= 1.01e-10 * WORK_OF_ADHESION


def test_the_pinning_force_is_the_mean_adhesion_that_the_front_feels():
    adhesion = noisy(2, rms=0.8)
    record, field = run(adhesion, 60.0, [*protocol([60.0, 260.0, 60.0], 5.0)], Newton(1e-12))
    felt = [front_adhesion(front, field).mean() / WORK_OF_ADHESION for front in record.fronts]
    assert record.states.pinning_force == pytest.approx(1.0 - np.array(felt), abs=1e-10)
    up = record.states.direction > 0
    advance, recede = (np.mean(record.states.pinning_force[part][15:]) for part in (up, ~up))
    assert advance - recede > 0.02


def test_the_force_is_the_gradient_of_the_energy():
    field = line_field(noisy(1, n_y=9), 7.0, (0.0, 10.0))
    line, rng = field.geometry, np.random.default_rng(0)
    front, step = 3 + 0.2 * rng.standard_normal(9), 1e-6
    springs = line.mean + line.stiffness * (front - 5.0)
    force = springs + line_force(line, front)
    for site, change in enumerate(step * np.eye(9)):
        rise = line.stored_energy(front + change, 5.0) - line.stored_energy(front - change, 5.0)
        assert rise / (2 * step) == pytest.approx(force[site] * line.length / 9, rel=1e-7), site


def test_places_are_those_of_the_tile_wherever_it_lies():
    values = noisy(4).work_of_adhesion
    corners = (-3.25, 7.0), (0.0, 0.0)
    moved, plain = (AdhesionMap(values, 0.5, 0.0, 0.0, corner) for corner in corners)
    way = [*protocol([30.0, 40.0, 30.0], 2.5)]
    shifted = [Load(load.value - 3.25, load.direction) for load in way]
    stops, field = run(moved, 4.0, shifted, Newton(1e-11))
    expected, _ = run(plain, 4.0, way, Newton(1e-11))
    assert np.allclose(stops.fronts, expected.fronts - 3.25, rtol=0, atol=1e-8)
    assert np.allclose(field.geometry.sites, 7.0 + 0.5 * np.arange(32))


def test_no_passing_holds_for_a_straight_front():
    field = line_field(noisy(8), 20.0, (50.0, 90.0))
    behind, ahead = np.full(32, 40.0), np.full(32, 41.0) + np.sin(np.arange(32))
    front_ahead, front_behind = (
        next(follow(field, front, [Load(load, 1)], Newton(1e-11))).front
        for front, load in ((behind, 70.0), (ahead, 71.0))
    )
    assert np.all(front_ahead <= front_behind + 1e-9)


@pytest.fixture
def command(tmp_path):
    """Result of `crackfront cycle` on a noisy tile as a straight front."""
    adhesion = noisy(3)
    axes = {name: np.arange(float(count)) for name, count in zip("xy", (48, 32), strict=True)}
    values = xr.DataArray(adhesion.work_of_adhesion, axes, ("x", "y"), "work_of_adhesion")
    values.to_dataset().to_netcdf(tmp_path / "F.nc")

    def invoked(**changes):
        options = {
            "--spring": 32,
            "--field": tmp_path / "F.nc",
            "--loads": "300,360,300",
            "--step": 10,
            "--record": "fronts",
            "--output": tmp_path / "out.nc",
        } | {f"--{name.replace('_', '-')}": value for name, value in changes.items()}
        words = [
            str(word) for option in options.items() if option[1] is not None for word in option
        ]
        return CliRunner().invoke(main, ["cycle", *words])

    invoked.output = tmp_path / "out.nc"
    return invoked


def test_the_command_writes_a_cycle_of_the_line(command):
    result = command()
    assert result.exit_code == 0, result.output
    dataset = xr.load_dataset(command.output)
    loads = [*range(300, 361, 10), *range(350, 299, -10)]
    assert dataset["spring_position"].values == pytest.approx(loads)
    assert dataset.direction.values.tolist() == [1] * 7 + [-1] * 6
    assert dataset.attrs["status"] == "converged"
    assert dataset.position.dims == ("step", "y")
    assert dataset.y.values == pytest.approx(np.arange(32))
    mean = dataset.position.mean("y")
    assert dataset.mean_position.values == pytest.approx(mean.values, rel=1e-14)
    stretched = dataset.spring_position - mean
    assert dataset.pinning_force.values == pytest.approx((stretched / 32).values)
    assert np.all(dataset.residual <= 1e-8)
    assert np.all(dataset.iterations > 0)
    expected, _ = run(
        noisy(3), 32.0, [*protocol([300.0, 360.0, 300.0], 10.0)], Newton(1e-8), "cubic"
    )
    assert np.array_equal(dataset.position, expected.fronts)
    most, least = float(dataset.pinning_force.max()), float(dataset.pinning_force.min())
    told = f"pinning force up to {most:.4g} forward and {least:.4g} back (w_int)"
    last_line = result.stdout.splitlines()[-1]
    assert "hysteresis 0.051 ± 0.025 (w_int); the front is 1 L_kappa long, below" in last_line
    assert last_line.endswith(told)
    loop, fronts = (draw(dataset, axes=Figure().add_subplot()) for draw in (plot_loop, plot_fronts))
    np.testing.assert_array_equal(loop.get_lines()[0].get_xdata(), loads[:7])
    np.testing.assert_array_equal(fronts.get_lines()[0].get_xdata(), dataset.position[6])
    with pytest.raises(ValueError, match="straight fronts are drawn without a surface"):
        plot_fronts(dataset, surface=dataset.position)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"spring": 0}, "Invalid value for '--spring': 0.0 is not in the range"),
        ({"spring": -2}, "Invalid value for '--spring': -2.0 is not in the range"),
        ({"loads": None}, "a straight front needs loads"),
        ({"loads": "3,x"}, "a load is 'x'; write numbers alone"),
        ({"step": 0}, "step is 0.0; it must be positive"),
        ({"max_penetration": 1}, "max_penetration is 1, but only a sphere has one; give loads"),
    ],
)
def test_options_that_do_not_fit_the_geometry_are_refused(command, changes, sentence):
    result = command(**changes)
    assert result.exit_code == 2
    assert sentence in result.output
    assert not command.output.exists()
