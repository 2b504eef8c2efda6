"""Jumps in the steady part of a simulation: their energy balance, their counts, resumed runs.

The main case is a straight front over a period of its tile, where the balance is exact.
"""

from dataclasses import asdict, fields, replace

import numpy as np
import pytest

from crackfront.core.cycle.energy import contact_energy
from crackfront.core.cycle.instabilities import jump_size, resolved_motion
from crackfront.core.cycle.jumps import SMOOTH_TRAVEL
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.cycle_files import read_checkpoint, write_checkpoint
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.provenance import provenance
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import Simulation, simulation_field
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.tiles import Resolution
from crackfront.sweep.rows import sweep_row

LENGTH, PERIOD = 4.0, 3.0

LINE = Simulation(
    spectrum_name="line",
    kind="roughness",
    spectrum=SelfAffineSpectrum(0.2, 0.4, 0.8),
    elastic_energy=0.25,
    realisation=0,
    sweep_seed=71,
    resolution=Resolution(
        n_angle=40, spacing=0.05, interpolation="cubic", tile_side=LENGTH, n_point=60
    ),
    schedule=LineSchedule(spring=1.5, length=LENGTH, period=PERIOD, lead_in=0.5, step=0.05),
    solver=Newton(1e-5),
    record_fronts=True,
    record_jumps=True,
)

SPHERE = replace(
    LINE,
    spectrum=SelfAffineSpectrum(0.3, 0.3, 1.0),
    resolution=replace(LINE.resolution, n_angle=64, tile_side=6.0),
    schedule=SteadySchedule(start=0.3, max_penetration=2.5, travel=0.15, standard_error=0.02),
)


@pytest.fixture(scope="module")
def line():
    return run_simulation(LINE)


@pytest.fixture(scope="module")
def sphere():
    return run_simulation(SPHERE)


def test_jumps_dissipate_the_hysteresis_times_the_area(line):
    row = sweep_row(line)
    for area in (row.swept_area_appr, row.swept_area_retr):
        assert area == pytest.approx(LENGTH * PERIOD, rel=1e-5)
    energy = row.jump_energy_appr + row.jump_energy_retr
    lost = row.hysteresis * WORK_OF_ADHESION * LENGTH * PERIOD
    assert energy == pytest.approx(lost, rel=0.01)


@pytest.mark.parametrize("direction", [1, -1])
def test_jumps_of_a_sphere_dissipate_the_work_that_is_not_stored(sphere, direction):
    record = sphere.record
    states, jumps, field = record.states, record.jumps, simulation_field(SPHERE)
    ends = np.flatnonzero(np.isfinite(jumps.swept_area) & (states.direction == direction))
    passed = np.array([ends[0] - 1, *ends])
    loads = states.penetration[passed]
    work = np.trapezoid(states.force[passed], loads)
    first, last = (
        contact_energy(record.fronts[passed[place]], loads[place], field) for place in (0, -1)
    )
    energy = np.sum(jumps.jump_energy[np.isin(jumps.jump_state, ends)])
    assert energy == pytest.approx(work - (last - first), rel=0.05)


def test_every_jump_dissipates_energy_and_sweeps_no_more_than_its_load_step(line):
    jumps = line.record.jumps
    assert jumps.jump_energy.min() > 0
    swept = np.bincount(jumps.jump_state, jumps.jump_area, jumps.swept_area.size)
    steady = np.isfinite(jumps.swept_area)
    assert np.all(swept[steady] <= jumps.swept_area[steady] * (1 + 1e-9))
    assert not swept[~steady].any()


def test_finer_loads_separate_as_many_jumps(line):
    record, length = line.record, LINE.correlation_length
    states, field = record.states, simulation_field(LINE)
    least, n_fine, n_recorded = 0.1 * length**2, 0, 0
    for direction in (1, -1):
        steady = np.isfinite(record.jumps.swept_area) & (states.direction == direction)
        ends = np.flatnonzero(steady)
        first = ends[0] - 1
        motions = resolved_motion(
            field,
            record.fronts[first],
            states.spring_position[first],
            states.spring_position[ends],
            direction,
            travel=SMOOTH_TRAVEL * length / 2,
            precision=2e-5,
            solver=Newton(1e-7),
        )
        jumps = [motion for motion in motions if motion.unstable]
        areas = [jump_size(jump, field, SMOOTH_TRAVEL * length / 2).area for jump in jumps]
        n_fine += np.count_nonzero(np.array(areas) > least)
        chosen = np.isin(record.jumps.jump_state, ends)
        n_recorded += np.count_nonzero(record.jumps.jump_area[chosen] > least)
    assert n_fine > 60
    assert n_recorded == pytest.approx(n_fine, rel=0.03)


def assert_equal_records(first, second):
    for part in ("states", "jumps"):
        pair = getattr(first, part), getattr(second, part)
        for item in fields(pair[0]):
            np.testing.assert_array_equal(*(getattr(record, item.name) for record in pair))


def test_a_killed_run_goes_on_to_the_same_jumps(line, tmp_path):
    n_state, partial = line.record.states.direction.size, []

    def keep(make):
        if len(partial) < n_state // 3:
            partial.append(make())

    run_simulation(LINE, keep=keep)
    path = write_checkpoint(tmp_path, "checkpoint", partial[-1], provenance())
    assert 0 < partial[-1].checkpoint.record.jumps.jump_area.size < line.record.jumps.jump_area.size
    resumed = run_simulation(LINE, resume=read_checkpoint(path, LINE))
    assert_equal_records(resumed.record, line.record)


def test_recording_jumps_changes_no_state_and_no_other_measure(line):
    plain = run_simulation(replace(LINE, record_jumps=False))
    assert plain.record.jumps is None
    np.testing.assert_array_equal(plain.record.fronts, line.record.fronts)
    np.testing.assert_equal(asdict(plain.steady_adhesion), asdict(line.steady_adhesion))
    assert "jumps" not in plain.simulation.parameters["record"]
