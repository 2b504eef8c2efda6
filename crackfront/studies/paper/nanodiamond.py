"""Main Fig. 5b, c: a rubber sphere on nanodiamond in SI units, to a largest force and back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.steady import steady_adhesion
from crackfront.core import jkr
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import Recorder
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Status
from crackfront.core.records import variable
from crackfront.core.units import Scales
from crackfront.simulate.contact import simulation_adhesion, simulation_field
from crackfront.simulate.simulation import Simulation
from crackfront.studies.paper.advances import AdvanceWatch
from crackfront.studies.paper.figure import Progress
from crackfront.studies.paper.force_radius import ForceRadius, fitted_adhesion
from crackfront.studies.paper.nanodiamond_parameters import NanodiamondParameters
from crackfront.studies.paper.rough import recorded

Array = NDArray[np.float64]

_STATE, _LINE, _ANGLE, _STRIDE, _ARC, _BOUND, _POINT = (
    "state",
    "line",
    "angle",
    "stride",
    "arc",
    "bound",
    "point",
)
_SURFACE_ENERGY = "J m-2"
_FIT = (_SURFACE_ENERGY, _BOUND)

_MOST_SITES = 4096
"""Sites of a perimeter that are kept for drawing."""

_STRIDES = (1, 2, 4)
"""Load steps, in those of the approach, at which the widest instability is looked for."""

_SYNTHETIC_POINTS, _SYNTHETIC_NOISE = 40, 0.02
"""Points of a synthetic measurement, and the noise of its forces relative to the largest."""


@dataclass(frozen=True, slots=True)
class NanodiamondContact:
    """States of the cycle, perimeters of its approach and fits, in SI units."""

    status: str = variable("what ended the cycle", "1")
    sphere_radius: float = variable("radius of the sphere", "m")
    work_of_adhesion: float = variable("intrinsic work of adhesion", _SURFACE_ENERGY)
    contact_modulus: float = variable("contact modulus E'", "Pa")
    factor: float = variable("factor k of the fits", "1")
    whole_elastic_energy: float = variable("e_el of all wavelengths", _SURFACE_ENERGY)
    elastic_energy: float = variable("e_el on the tile", _SURFACE_ENERGY)
    short_cutoff: float = variable("shortest wavelength", "m")
    roll_off: float = variable("roll-off wavelength", "m")
    largest_force: float = variable("force at which the approach turns", "N")
    shown_force: float = variable("force up to which perimeters are shown", "N")
    jump_in: float = variable("penetration of the first state after jump-in", "m")
    direction: NDArray[np.int64] = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", "m", _STATE)
    radius: Array = variable("mean contact radius", "m", _STATE)
    force: Array = variable("normal force", "N", _STATE)
    approach: Array = variable("w_appr, with its standard error", _SURFACE_ENERGY, "estimate")
    retraction: Array = variable("w_retr, with its standard error", _SURFACE_ENERGY, "estimate")
    angle: Array = variable("angle of a site", "rad", _ANGLE)
    line: NDArray[np.float32] = variable("perimeters of the approach", "m", _LINE, _ANGLE)
    line_force: Array = variable("normal force at the perimeters", "N", _LINE)
    threshold: float = variable("advance above which a site has jumped", "m")
    load_step: Array = variable("penetration between compared states", "m", _STRIDE)
    extent: Array = variable("widest instability up to the shown force", "m", _STRIDE)
    extents: Array = variable("widths of all in the first load step", "m", "instability")
    arc_angle: Array = variable("the widest instability of the first load step", "rad", _ARC)
    arc_inner: Array = variable("radius before it", "m", _ARC)
    arc_outer: Array = variable("radius after it", "m", _ARC)
    synthetic_fit: Array = variable("w_int from synthetic points: value, low, high", *_FIT)
    simulated_fit: Array = variable("w_int from the simulated approach: value, low, high", *_FIT)
    measured_fit: Array = variable("w_int from the measured approach: value, low, high", *_FIT)
    measured_force: Array = variable("measured force", "N", _POINT)
    measured_radius: Array = variable("measured contact radius", "m", _POINT)
    measured_direction: NDArray[np.int64] = variable("+1 in approach, -1 back", "1", _POINT)

    @property
    def reduced(self) -> Scales:
        """Reduced units of the scene."""
        return Scales(self.sphere_radius, self.work_of_adhesion, self.contact_modulus)


class _Perimeters:
    """What is kept of the fronts of the approach, in reduced units."""

    def __init__(self, parameters: NanodiamondParameters, simulation: Simulation) -> None:
        self._passed = simulation.spectrum.correlation_length
        self._shown, self._unit = parameters.shown_force, parameters.scales.force
        self.watch = AdvanceWatch(self._passed, _STRIDES)
        self.states: list[ContactState[float]] = []
        self.lines: list[Array] = []
        n_angle = simulation.resolution.n_angle
        self._every = max(1, round(parameters.line_step / parameters.step))
        self._kept = slice(None, None, -(-n_angle // _MOST_SITES))
        self.angle = (2 * np.pi * np.arange(n_angle) / n_angle)[self._kept]

    def __call__(self, recorder: Recorder) -> None:
        """Compare a front with the one before, and keep every few of them."""
        state = recorder.states[-1]
        # Before it jumps into contact, the sphere rests on a few places about its apex.
        if state.direction < 0 or state.least_travel <= self._passed:
            return
        if state.force * self._unit > self._shown:
            return
        self.watch.follow(recorder.front)
        if self.watch.count % self._every == 1 % self._every:
            self.states.append(state)
            self.lines.append(recorder.front[self._kept])


def nanodiamond_contact(
    parameters: NanodiamondParameters, progress: Progress
) -> NanodiamondContact:
    """Approach to the largest force, retraction until contact is lost, and the fits of w_int.

    Parameters
    ----------
    parameters : NanodiamondParameters
        What to compute.
    progress : callable
        Called with a line for every branch.

    Raises
    ------
    ValueError
        If the largest force is not reached, no perimeter is to be shown, or a branch has no steady
        part.
    """
    scales, simulation = parameters.scales, parameters.simulation()
    adhesion = simulation_adhesion(simulation)
    field = simulation_field(simulation, adhesion)
    perimeters = _Perimeters(parameters, simulation)
    recorder = Recorder(observers=[perimeters])
    record = recorded(simulation, field, _loads(parameters, recorder, progress), recorder)
    if not np.any(record.states.direction < 0):
        raise ValueError(f"the largest force was not reached: {record.status.value}")
    if not perimeters.lines:
        raise ValueError("the contact has no state between jump-in and shown_force; raise that")
    surface = scales.work_of_adhesion
    progress(f"retraction: {record.status.value}")
    steady = steady_adhesion(record, simulation.spectrum.correlation_length)
    if steady.sentence:
        raise ValueError(steady.sentence)
    simulated = ForceRadius(
        record.states.force * scales.force,
        record.states.mean_radius * scales.lateral,
        record.states.direction,
    )
    points, energy = parameters.points(), adhesion.elastic_energy * surface
    widest, extents = perimeters.watch.widest, perimeters.watch.extents
    arc = widest[_STRIDES[0]]
    return NanodiamondContact(
        status=record.status.value,
        sphere_radius=scales.radius,
        work_of_adhesion=surface,
        contact_modulus=scales.contact_modulus,
        factor=parameters.factor,
        whole_elastic_energy=parameters.whole_elastic_energy,
        elastic_energy=energy,
        short_cutoff=parameters.short_cutoff,
        roll_off=parameters.roll_off,
        largest_force=parameters.largest_force,
        shown_force=parameters.shown_force,
        jump_in=perimeters.states[0].penetration * scales.vertical,
        direction=record.states.direction,
        penetration=record.states.penetration * scales.vertical,
        radius=simulated.radius,
        force=simulated.force,
        approach=surface * np.array([steady.w_appr, steady.w_appr_error]),
        retraction=surface * np.array([steady.w_retr, steady.w_retr_error]),
        angle=perimeters.angle,
        line=(np.array(perimeters.lines) * scales.lateral).astype(np.float32),
        line_force=np.array([state.force for state in perimeters.states]) * scales.force,
        threshold=simulation.spectrum.correlation_length * scales.lateral,
        load_step=parameters.step * np.array(_STRIDES),
        extent=scales.lateral * np.array([widest[stride].extent for stride in _STRIDES]),
        extents=scales.lateral * np.array(extents[_STRIDES[0]]),
        arc_angle=arc.angle,
        arc_inner=arc.inner * scales.lateral,
        arc_outer=arc.outer * scales.lateral,
        synthetic_fit=_bounds(_synthetic_fit(parameters, simulated.radius)),
        simulated_fit=_bounds(fitted_adhesion(simulated, scales, energy, parameters.factor)),
        measured_fit=_measured_fit(parameters, points),
        measured_force=points.force,
        measured_radius=points.radius,
        measured_direction=points.direction,
    )


def _loads(
    parameters: NanodiamondParameters, recorder: Recorder, progress: Progress
) -> Iterator[Load]:
    """Penetrations of the approach to the largest force, and down from there."""
    scales, count = parameters.scales, 0
    force = -np.inf
    while force < parameters.largest_force:
        yield Load(count * parameters.step / scales.vertical, 1)
        if recorder.status is not Status.CONVERGED:
            return
        force = recorder.states[-1].force * scales.force
        count += 1
    last = recorder.states[-1]
    progress(f"approach: mean radius {last.mean_radius * scales.lateral:.4g} m at the turn")
    penetration = last.penetration
    while True:
        penetration -= parameters.retraction_step / scales.vertical
        yield Load(penetration, -1)


def _synthetic_fit(parameters: NanodiamondParameters, radius: Array) -> Estimate:
    """w_int from points that the model itself gives, with noise of a known size."""
    scales, energy = parameters.scales, parameters.whole_elastic_energy
    adhesion = parameters.work_of_adhesion - (1 + parameters.factor) * energy
    radii = np.linspace(radius.min(), radius.max(), _SYNTHETIC_POINTS)
    smooth = jkr.equilibrium_force(radii / scales.lateral, adhesion / parameters.work_of_adhesion)
    rng = np.random.default_rng(np.random.SeedSequence(parameters.seed, spawn_key=(1,)))
    noise = _SYNTHETIC_NOISE * parameters.largest_force * rng.standard_normal(radii.size)
    points = ForceRadius(smooth * scales.force + noise, radii, np.ones(radii.size, dtype=np.int64))
    return fitted_adhesion(points, scales, energy, parameters.factor)


def _measured_fit(parameters: NanodiamondParameters, points: ForceRadius) -> Array:
    """w_int from what was measured, NaN where nothing was."""
    if points.force.size == 0:
        return np.full(3, np.nan)
    energy = parameters.whole_elastic_energy
    return _bounds(fitted_adhesion(points, parameters.scales, energy, parameters.factor))


def _bounds(estimate: Estimate) -> Array:
    """Value and ends of the interval."""
    return np.array([estimate.value, estimate.low, estimate.high])
