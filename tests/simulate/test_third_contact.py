"""A third kind of contact in one file, by the rules of `crackfront.simulate.contact`: a cylinder.

A long cylinder is pressed on the surface by a force per length (JKR of a line contact). Its edge is
straight and, by symmetry, only one of its two edges is simulated. With the half-width a, the line
force P and c = pi E' / 4 (R = 1), G = (c a^2 - P)^2 / (2 pi E' a). As on a sphere, forces are
multiplied by the place, so that they are convex in it. Its kernels take some seconds to compile:
most tests are left to the night.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np
import pytest

from crackfront.analysis.steady_adhesion import steady_means
from crackfront.core.compiled import implements
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.field.fields import first_place, tile_field
from crackfront.core.geometry import base
from crackfront.core.outcome import Status
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, FORCE, LATERAL, Variable, variable
from crackfront.simulate.contact import ExpectedMotion, Schedule
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.cycle_files import read_checkpoint, write_checkpoint
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.provenance import provenance
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.settings import Settings
from crackfront.simulate.tiles import correlated_adhesion
from crackfront.sweep.advice import expectation
from crackfront.sweep.finished_shards import finish_shard
from crackfront.sweep.rows import sweep_row
from crackfront.sweep.store import Store
from crackfront.sweep.sweep import FitRange, NamedSpectrum, Sweep
from crackfront.sweep.tasks import run_and_store

CURVATURE = np.pi * CONTACT_MODULUS / 4
"""Line force over the square of the half-width without adhesion, R = 1."""

PLANE = 2 * np.pi * CONTACT_MODULUS
"""Square of the opening force over half-width and G."""


def opening(half_width, work):
    """c a^2 - P in equilibrium at a work of adhesion (Units: w_int)."""
    return np.sqrt(PLANE * work * WORK_OF_ADHESION * half_width)


def smooth_half_width(force, work=1.0):
    """Stable half-width of a smooth contact: the largest root of a quartic in its square root."""
    adhesion = np.sqrt(PLANE * work * WORK_OF_ADHESION)
    roots = np.roots([CURVATURE, 0, 0, -adhesion, -force])
    return float(np.max(roots[np.abs(roots.imag) < 1e-9].real) ** 2)


PULL_OFF = -3 * (np.pi * CONTACT_MODULUS * WORK_OF_ADHESION**2 / 16) ** (1 / 3)
"""Line force at pull-off of a smooth cylinder (Barquins, J. Adhesion 26, 1988)."""

UNLOADED = smooth_half_width(0.0)
"""Half-width at which the line is as stiff as that of a straight front."""


# Rule 1: the geometry.


@dataclass(frozen=True)
class CylinderState:
    """A metastable contact, or all of a cycle, one entry a state."""

    load_noun: ClassVar[str] = "line force"
    branch_names: ClassVar[Mapping[int, str]] = {1: "approach", -1: "retraction"}
    front_name: ClassVar[str] = "half_width"

    force: Any = variable("force per length", FORCE)
    direction: Any = variable("+1 in approach, -1 in retraction", "1")
    mean_half_width: Any = variable("mean half-width", LATERAL)
    rms_half_width: Any = variable("rms deviation of the half-width from its mean", LATERAL)
    apparent_work_of_adhesion: Any = variable("mean of a G over mean of a", ADHESION)
    least_travel: Any = variable("smallest way of a site since its branch began", LATERAL)
    iterations: Any = variable("sweeps of the solver", "1")
    updates: Any = variable("updates of single sites by the solver", "1")
    residual: Any = variable("largest force along the motion, per front length", ADHESION)

    @property
    def summary(self):
        return f"line force {self.force:+.4f}, half-width {self.mean_half_width:.4f}"

    def forces_summary(self, status):
        return f"lowest line force {np.min(self.force):.4g}"


class Cylinder(NamedTuple):
    """A cylinder with a number of rays along x, over a period of its length."""

    n_site: int
    perimeter: float

    @property
    def state_type(self):
        return CylinderState

    @property
    def sites(self):
        return self.perimeter * np.arange(self.n_site) / self.n_site

    @property
    def variables(self):
        site = Variable("y", ("y",), LATERAL, "place of a site along the front")
        return Variable(CylinderState.front_name, ("y",), LATERAL, "front"), site

    def state(self, relaxation, load, direction, turn):
        front = relaxation.front
        products = np.maximum(CURVATURE * front**2 - load, 0.0) ** 2 / PLANE
        return CylinderState(
            force=load,
            direction=direction,
            mean_half_width=float(np.mean(front)),
            rms_half_width=float(np.std(front)),
            apparent_work_of_adhesion=float(np.mean(products) / np.mean(front) / WORK_OF_ADHESION),
            least_travel=float(np.min(np.abs(front - turn))),
            iterations=relaxation.sweeps,
            updates=relaxation.updates,
            residual=relaxation.residual,
        )

    def stored_energy(self, front, load):
        a = np.maximum(front, np.sqrt(max(load, 0.0) / CURVATURE))
        powers = CURVATURE**2 * a**5 / 5 - 2 * CURVATURE * load * a**3 / 3 + load**2 * a
        modes = np.abs(np.fft.rfft(front, norm="forward")) ** 2
        modes[1 : (self.n_site + 1) // 2] *= 2
        stiffness = 2 * np.pi / self.perimeter * WORK_OF_ADHESION * UNLOADED
        line = stiffness * np.sum(np.arange(modes.size) * modes) / 2
        return self.perimeter * float(np.mean(powers) / PLANE + line)

    def can_rest_inside(self, place, product, load):
        a = np.linspace(0, place, 201)[1:]
        needed = np.maximum(CURVATURE * a**2 - load, 0.0) ** 2 / PLANE
        return bool(np.any(a * (product / place) >= needed))


@implements(base.restoring_force, Cylinder)
def _force(geometry, place, load):
    above = CURVATURE * place * place - load
    return above * above / PLANE if above > 0.0 else 0.0


@implements(base.restoring_slope, Cylinder)
def _slope(geometry, place, load):
    above = CURVATURE * place * place - load
    return 4 * CURVATURE * place * above / PLANE if above > 0.0 else 0.0


@implements(base.lowest_place, Cylinder)
def _lowest(geometry, load):
    return np.sqrt(max(load, 0.0) / CURVATURE)


@implements(base.mode_stiffness, Cylinder)
def _stiffness(geometry, mode):
    return WORK_OF_ADHESION * UNLOADED * 2 * np.pi / geometry.perimeter * mode


@implements(base.weight, Cylinder)
def _place(geometry, place):
    return place


@implements(base.weight_slope, Cylinder)
def _state_at_one_load(geometry):
    return 1.0


@implements(base.ray_start, Cylinder)
def _start(geometry, ray, n_x, n_y, inverse_pixel):
    return 0.0, ray * geometry.perimeter / geometry.n_site * inverse_pixel


@implements(base.ray_direction, Cylinder)
def _along(geometry, ray):
    return 1.0, 0.0


# Rules 2 to 6: the loads.


@dataclass(frozen=True, slots=True)
class CylinderCycle(Schedule):
    """A cylinder from first contact to the largest line force, and back to pull-off."""

    max_force: float
    step: float
    length: float
    """Period of the cylinder along its axis. (Units: reduced lateral length)"""

    load_name = "cylinder"

    @property
    def front_length(self):
        return self.length

    def resolution(self, fineness):
        return fineness.resolution(self.length, self.length)

    def tile(self, resolution):
        return (resolution.n_point, resolution.n_point), (self.length, self.length)

    def geometry(self, n_site):
        return Cylinder(n_site, self.length)

    def adhesion(self, surface):
        return correlated_adhesion(surface)

    def field(self, adhesion, resolution):
        strongest = float(np.max(adhesion.work_of_adhesion)) / WORK_OF_ADHESION
        return tile_field(
            adhesion,
            self.geometry(resolution.n_angle),
            resolution.spacing,
            1.1 * smooth_half_width(self.max_force, strongest),
            resolution.interpolation,
            band_limited=True,
        )

    def run(self, problem, solver, recorder):
        geometry = problem.field.geometry
        touch = np.full(geometry.n_site, first_place(problem.field))
        loads = LoadSchedule(self.max_force, self.step).loads()
        recorder.run(problem.field, touch, loads, solver)
        return recorder.record()

    @classmethod
    def smallest(cls):
        return cls(0.0, 0.5, 4.0)

    def steady_adhesion(self, record, correlation_length, mean_adhesion):
        states = record.states
        columns = (
            states.apparent_work_of_adhesion,
            states.mean_half_width,
            states.rms_half_width,
        )
        return steady_means(states, columns, "half-widths", correlation_length)

    def averaged_cutoffs(self, steady, correlation_length, short_cutoff):
        sites = self.length / short_cutoff
        return sites * steady.n_approach, sites * steady.n_retraction, self.length

    def usual_cutoffs(self, spectrum):
        return 8 * self.length / spectrum.short_cutoff

    def expected_motion(self, surface):
        half_width = smooth_half_width(self.max_force)
        slope = 2 * CURVATURE * half_width - opening(half_width, 1.0) / (2 * half_width)
        n_state = (2 * self.max_force - PULL_OFF) / self.step
        return ExpectedMotion(n_state, self.step / slope / surface.correlation_length)

    def spring_at(self, work_of_adhesion):
        half_width = smooth_half_width(self.max_force, work_of_adhesion)
        above = opening(half_width, work_of_adhesion)
        slope = 4 * CURVATURE * above / PLANE - above**2 / (PLANE * half_width**2)
        return WORK_OF_ADHESION / slope


# What follows needs nothing that is not public.

FLAT = SelfAffineSpectrum(0.25, 0.25, 1.0)
SWEEP = Sweep(
    seed=7,
    kind="roughness",
    scales=None,
    spectra=(NamedSpectrum("flat", FLAT),),
    elastic_energies=(0.04, 0.09),
    n_realisation=1,
    numerics=Numerics(settings=Settings(None, 2.0, 4.0, "cubic", 4.0, 1e-9), solver="reference"),
    schedule=CylinderCycle(max_force=2.0, step=0.1, length=4.0),
    record=("fronts", "energy"),
    failed_fraction=0.0,
    fit=FitRange(0.01, 0.1, 100),
)
ROUGH = SWEEP.simulation(SWEEP.spectra[0], 0.04, 0)


@pytest.fixture(scope="module")
def rough():
    """Result of a rough cylinder."""
    return run_simulation(ROUGH)


@pytest.mark.slow
def test_a_smooth_cylinder_is_that_of_jkr_to_its_pull_off():
    result = run_simulation(replace(ROUGH, elastic_energy=1e-18))
    states, record = result.record.states, result.record
    expected = CURVATURE * states.mean_half_width**2 - opening(states.mean_half_width, 1.0)
    np.testing.assert_allclose(states.force, expected, atol=1e-7)
    assert record.status is Status.LOST_CONTACT
    assert record.end_load < PULL_OFF < states.force[-1]
    assert record.end_load == pytest.approx(states.force[-1] - 0.1)
    row = sweep_row(result)
    assert (row.w_appr, row.w_retr) == pytest.approx((1.0, 1.0), abs=1e-7)


def test_the_edge_is_held_by_the_slope_of_g_at_a_constant_force():
    force, a = 2.0, smooth_half_width(2.0)
    rates = [(CURVATURE * (a + da) ** 2 - force) ** 2 / (PLANE * (a + da)) for da in (-1e-6, 1e-6)]
    slope = (rates[1] - rates[0]) / 2e-6
    assert ROUGH.schedule.spring_at(1.0) == pytest.approx(WORK_OF_ADHESION / slope, rel=1e-8)


@pytest.mark.slow
def test_a_rough_cylinder_has_hysteresis_and_loses_energy_in_every_step(rough):
    row, record = sweep_row(rough), rough.record
    assert row.status == "lost_contact"
    assert row.w_appr < row.w_retr
    assert row.pull_off_force == record.states.force[-1]
    assert row.hysteresis / (2 * row.e_el) > 0.3
    assert np.all(record.dissipated_energy[1:] > -1e-9)
    assert record.fronts.shape == (row.n_step, ROUGH.resolution.n_angle)


@pytest.mark.slow
def test_its_cost_and_its_factor_are_expected_as_those_of_other_kinds(rough):
    expected = expected_cost(ROUGH)
    assert 0 < expected.seconds < 60
    n_state = ROUGH.schedule.expected_motion(ROUGH.surface).n_state
    assert n_state == pytest.approx(rough.record.states.direction.size, rel=0.3)
    assert 0 < expectation(ROUGH).factor < 4
    assert expectation(ROUGH).needed_penetration is None


def test_its_loads_are_in_its_key():
    deeper = replace(ROUGH, schedule=replace(ROUGH.schedule, max_force=2.1))
    assert deeper.key != ROUGH.key
    assert ROUGH.parameters["load"] == {
        "kind": "cylinder",
        "max_force": 2.0,
        "step": 0.1,
        "length": 4.0,
    }


@pytest.mark.slow
def test_it_goes_on_from_a_checkpoint_to_the_same_states(rough, tmp_path):
    kept = []
    run_simulation(ROUGH, keep=lambda make: kept.append(make()))
    path = write_checkpoint(tmp_path, "checkpoint", kept[len(kept) // 2], provenance("text"))
    resumed = run_simulation(ROUGH, resume=read_checkpoint(path, ROUGH))
    np.testing.assert_array_equal(resumed.record.fronts, rough.record.fronts)


@pytest.mark.slow
def test_a_sweep_stores_its_states_and_has_its_rows_in_the_table(rough, tmp_path):
    store, origin, [shard] = Store(tmp_path), provenance("text"), SWEEP.shards()
    simulations = [*SWEEP.simulations()]
    assert len([*run_and_store(store, [(shard, simulations)], origin)]) == 2
    finish_shard(store, SWEEP, shard, origin)
    store.aggregate(SWEEP, origin)
    again, table = store.result(SWEEP, ROUGH), store.table(SWEEP)
    np.testing.assert_array_equal(again.record.fronts, rough.record.fronts)
    assert type(again.record.states) is CylinderState
    row = sweep_row(rough)
    assert (table.w_appr[0, 0, 0], table.w_retr[0, 0, 0]) == (row.w_appr, row.w_retr)
    assert np.all(table.finite)
    assert not table.on_springs
