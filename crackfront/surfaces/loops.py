"""Loops on a surface under any loads, and the single instabilities of a branch."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Annotated, Any

from pydantic import PlainValidator
from xarray import DataArray, Dataset

from crackfront.analysis.estimate import with_error
from crackfront.analysis.steady_adhesion import SteadyAdhesion, SteadyMeasures
from crackfront.analysis.table import COLUMNS
from crackfront.core.cycle.follow import Load, front_at
from crackfront.core.cycle.instabilities import measured_instabilities, resolved_motion
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.touch import first_touch
from crackfront.core.outcome import Direction
from crackfront.core.resources import check_memory
from crackfront.core.solver.relax import SOLVERS, Newton, force_round_off, named_solver
from crackfront.core.variables import variables
from crackfront.core.versions import PHYSICS_VERSION
from crackfront.simulate.cycle_files import cycle_dataset
from crackfront.simulate.labels import labelled, labelled_fields
from crackfront.simulate.provenance import __version__
from crackfront.surfaces.loop_setup import (
    LoopContact,
    LoopNumerics,
    LoopSetup,
    load_values,
)
from crackfront.surfaces.pressed_sphere import PressedSphere
from crackfront.validation import Density, Finite, Fraction, Positive, Sites, checked_call, one_of


@checked_call
def run_loop(
    surface: DataArray | LoopContact,
    *,
    loads: Annotated[Iterable[float], PlainValidator(load_values)] | None = None,
    max_penetration: Finite | None = None,
    step: Positive | None = None,
    error: Fraction | None = None,
    sites: Sites | None = None,
    samples: Density | None = None,
    solver: Annotated[str, one_of(SOLVERS)] = "newton",
    fronts: bool = True,
    energy: bool = False,
    progress: Callable[[Any], None] | None = None,
) -> Dataset:
    """States of a sphere on a surface, or of a straight front, under any loads.

    The orientation of the crack is fixed: w_loc everywhere is of a front along `y`, with the
    contact at smaller `x`. If a map is turned by 90 degrees, w_appr and w_retr change by 0.005
    w_int rms, or by 0.012 if its lengths along both axes differ by a factor of four.

    Parameters
    ----------
    surface : xarray.DataArray or StraightFront
        Surface of :func:`crackfront.surface`, `random_surface` or `read_scan`, the apex of the
        sphere at the centre of the tile, wherever the zero of its coordinates is; or what
        :func:`crackfront.straight_front` makes of one.
    loads : iterable of float, optional
        Loads to visit in their order, down and up as often as they say; a repeated load is a pause.
        The loop ends where contact is lost. Without loads a sphere goes from first contact to the
        largest penetration, and to pull-off. (Units: reduced vertical length; for a straight front
        the unit of length of its tile)
    max_penetration : float, optional
        Largest penetration in place of loads, by default 1. (Units: reduced vertical length)
    step : float, optional
        Largest difference of loads: equal steps lead from one to the next. The default is 0.02
        without loads; stated loads are visited as they are. The fronts do not depend on it.
        (Units: as the loads)
    error : float, optional
        Standard error of the factor k of either branch that the numerics may leave; measured
        laws choose sites, samples and tolerance. They need a sphere and the attributes
        `short_cutoff`, `roll_off` and `hurst`, as :func:`crackfront.random_surface` sets them;
        with these it is 0.03 by default, or what the finest numerics on the pixels leave, and the
        result states it; without these attributes `error` is not allowed.
    sites : int, optional
        Sites of the front, in place of an error. The default is what the error needs; without an
        error, one a pixel or more.
    samples : float, optional
        Samples a pixel along a ray, in place of an error. The default is what the error needs;
        without an error 2, for a straight front 1.
    solver : {"newton", "reference"}, optional
        Solver; both find the same fronts.
    fronts, energy : bool, optional
        Whether to keep the fronts, and to compute the energy that each load step dissipates. A load
        step loses energy even where a front would follow a slow load without loss; the comment of
        the variable says how much of the energies of a straight front this is.
    progress : callable, optional
        Called with every state as it is found, a `ContactState` of a sphere or a `LineState` of a
        straight front.

    Returns
    -------
    xarray.Dataset
        The curves over `step` (`penetration`, `force`, `mean_radius`, ..., each with its units),
        the fronts `radius(step, angle)` or `position(step, y)`, and
        measures of the whole: `e_el`, `w_rms`, `correlation_length`, `w_appr`, `w_retr` and what
        else the table of a sweep has of them, of a straight front over the last period of its tile
        or less; NaN where the loop lacks a steady part. The attribute `result` states them, the
        forces of jump-in and pull-off or the pinning force, `steady_sentence` why they are NaN.

    Raises
    ------
    ValueError
        If the surface, a length or the solver cannot be used, the pixels are too coarse for an
        error that is asked for, or the memory is too small for the fronts.
    TypeError
        If an argument is of another type.

    Examples
    --------
    >>> from crackfront import random_surface, straight_front
    >>> surface = random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
    >>> loop = run_loop(surface, step=0.25)
    >>> loop.attrs["status"], loop.radius.dims
    ('lost_contact', ('step', 'angle'))
    >>> minor = run_loop(surface, loads=[0, 0.5, 0.2, 0.5], step=0.1)
    >>> bool(abs(minor.force[5] - minor.force[11]) < 1e-6)
    True
    >>> pulled = run_loop(straight_front(surface, spring=2), loads=[0, 2, 0], step=0.5)
    >>> pulled.position.dims
    ('step', 'y')
    """
    visited = None if loads is None else tuple(loads)
    if visited is None and max_penetration is None and not isinstance(surface, LoopContact):
        max_penetration = 1.0
    if step is None:
        step = 0.02 if visited is None else math.inf
    contact = loop_contact(surface, max_penetration)
    setup = contact.setup(visited, step, LoopNumerics(error, sites, samples))
    if fronts:
        check_memory(
            f"{setup.expected} fronts of {setup.front.size} sites",
            8.0 * setup.expected * setup.front.size,
            "set fronts=False, or take larger steps or a smaller max_penetration",
        )
    observers = [] if progress is None else [lambda recorder: progress(recorder.states[-1])]
    recorder = Recorder(fronts=fronts, energy=energy, observers=observers)
    recorder.run(setup.field, setup.front, setup.loads, named_solver(solver, setup.tolerance))
    return loop_dataset(recorder.record(), setup).assign_attrs(
        solver=solver,
        tolerance=setup.tolerance,
        crackfront_version=__version__,
        physics_version=PHYSICS_VERSION,
    )


def loop_contact(surface: DataArray | LoopContact, max_penetration: float | None) -> LoopContact:
    """Contact of a loop; a sphere if it is a surface alone.

    ValueError if another contact than a sphere has a largest penetration.
    """
    if not isinstance(surface, LoopContact):
        return PressedSphere(surface, max_penetration)
    if max_penetration is not None:
        raise ValueError(
            f"max_penetration is {max_penetration:g}, but only a sphere has one; give loads in "
            "its place"
        )
    return surface


def loop_dataset(record: CycleRecord, setup: LoopSetup) -> Dataset:
    """Labelled curves of a run, and measures of the whole."""
    measures = setup.measures
    curves = cycle_dataset(record, setup.field.geometry)
    lost = record.dissipated_energy
    if lost is not None and (comment := setup.comment_on_energy(record, lost)):
        curves["dissipated_energy"] = curves.dissipated_energy.assign_attrs(comment=comment)
    values = {name: getattr(measures, name) for name in ("e_el", "w_rms", "correlation_length")}
    steady = setup.steady_adhesion(record)
    numerical = setup.numerical_errors(steady)
    values["w_appr_numerical_error"], values["w_retr_numerical_error"] = numerical
    values |= {item.name: getattr(steady, item.name) for item in variables(SteadyMeasures)}
    result = result_sentence(record, steady, setup.remark)
    sentences = {"result": result, "steady_sentence": steady.sentence}
    whole = curves.assign(
        {name: labelled(replace(COLUMNS[name], dims=()), value) for name, value in values.items()}
    )
    return whole.drop_attrs(deep=False).assign_attrs(sentences | curves.attrs, kind=measures.kind)


def result_sentence(record: CycleRecord, steady: SteadyAdhesion, remark: str = "") -> str:
    """Result of a cycle in one line, with a remark on its works of adhesion."""
    states = record.states
    if states.direction.size == 0:
        return "no state was found"
    forces = states.forces_summary(record.status)
    if steady.sentence:
        unknown = "no steady part: w_appr and w_retr are unknown"
        return "; ".join(filter(None, (unknown, remark, forces)))
    works = (
        f"w_appr {_value_text(steady.w_appr, steady.w_appr_error)}, "
        f"w_retr {_value_text(steady.w_retr, steady.w_retr_error)}, "
        f"hysteresis {_value_text(steady.hysteresis, steady.hysteresis_error)} (w_int)"
    )
    return "; ".join(filter(None, (works, remark, forces)))


def _value_text(value: float, error: float) -> str:
    """A value with its standard error, if it has one."""
    return with_error(value, error) if error > 0 else f"{value:.4g}"


@checked_call
def find_instabilities(
    surface: DataArray | LoopContact,
    *,
    direction: Direction = -1,
    max_penetration: Finite = 1.0,
    step: Positive = 0.02,
    travel: Positive = 0.05,
    precision: Positive | None = None,
    error: Fraction | None = None,
    sites: Sites | None = None,
    samples: Density | None = None,
) -> Dataset:
    """The single instabilities of a branch, from first contact or to pull-off.

    Load steps are halved until the front moves smoothly, or until the step is too small to
    matter, which is an instability.

    Parameters
    ----------
    surface : xarray.DataArray
        As in :func:`run_loop`.
    direction : {1, -1}, optional
        Approach or retraction.
    max_penetration, step : float, optional
        As in :func:`run_loop`.
    travel : float, optional
        Largest motion of a site in a smooth step, in correlation lengths of w_loc; at least a
        quarter of the root of the precision, by which a front moves smoothly before it jumps.
    precision : float, optional
        Penetration to which an instability is located, at most a tenth of the step: a smooth step
        that is not divided further would count as one. The default is 2e-5, or less if the step or
        the `travel` is small: before pull-off the whole front moves with the root of the
        penetration. (Units: reduced vertical length)
    error : float, optional
        As in :func:`run_loop`, by default 0.05 where the surface states its spectrum.
    sites, samples : optional
        As in :func:`run_loop`.

    Returns
    -------
    xarray.Dataset
        Over `instability` the `penetration` (Units: reduced vertical length), the
        `dissipated_energy` (Units: pi w_int R times that), the whole `area` between the fronts
        before and after (Units: reduced lateral length**2), and the `extent` of the largest patch
        of sites that moved by more than the attribute `travel`; these fronts, `before` and `after`,
        over `angle` as well. (Units: reduced lateral length)

    Raises
    ------
    ValueError
        If an argument cannot be used, a front is not found, or the surface is a straight front,
        which lacks the first contact and the pull-off that end a branch.
    TypeError
        If an argument is of another type.
    """
    if isinstance(surface, LoopContact):
        raise ValueError(
            "instabilities are located on a sphere, between first contact and pull-off, which a "
            "straight front lacks; give the surface itself"
        )
    schedule = LoadSchedule(max_penetration, step)
    numerics = LoopNumerics(error, sites, samples, usual_error=0.05)
    setup = PressedSphere(surface, max_penetration).setup(None, step, numerics)
    largest_motion = travel * setup.measures.correlation_length
    if precision is None:
        precision = min(2e-5, step / 10, max(largest_motion**2, _round_off(setup)))
    if precision > step / 10:
        raise ValueError(
            f"precision is {precision:g}; it must be at most a tenth of the step, {step / 10:g}"
        )
    _check_resolved_motion(setup, travel, precision, direction)
    field, solver = setup.field, Newton(min(setup.tolerance, precision / 10))
    if direction > 0:
        start, loads = 0.0, schedule.approach()
    else:
        start, loads = max_penetration, schedule.retraction()
    steps = resolved_motion(
        field,
        front_at(field, first_touch(field), Load(start, 1), solver),
        start,
        loads,
        direction,
        travel=largest_motion,
        precision=precision,
        solver=solver,
    )
    jumps = [motion for motion in steps if motion.unstable]
    instabilities = labelled_fields(measured_instabilities(jumps, field, largest_motion))
    _, angle = field.geometry.variables
    angles = {angle.name: labelled(angle, field.geometry.sites)}
    return Dataset(instabilities, angles, {"travel": largest_motion})


_SMOOTH = 0.25
"""Motion of a smooth front within a step before a fold, over the root of the step, in correlation
lengths: where a site is about to jump, it moves with that root."""


def _round_off(setup: LoopSetup) -> float:
    """Penetration below which steps are round-off, in reduced units."""
    return 10 * force_round_off(setup.front.size)


_PULL_OFF = 1.5
"""Penetration from pull-off over the square of the motion of the smooth sphere there: half of the
curvature of the penetration in the radius. (Units: reduced lengths)"""


def _check_resolved_motion(
    setup: LoopSetup, travel: float, precision: float, direction: Direction
) -> None:
    """Raise if round-off hides steps of a precision, or if smooth motion counts as a jump."""
    round_off = _round_off(setup)
    if precision < round_off:
        raise ValueError(
            f"precision is {precision:g}, below the round-off of a front of {setup.front.size} "
            f"sites ({round_off:.1e}); raise it"
        )
    length = setup.measures.correlation_length
    smooth_motion = max(_SMOOTH * math.sqrt(precision), precision / length)
    if direction < 0:
        smooth_motion = max(smooth_motion, math.sqrt(precision / _PULL_OFF) / length)
    if travel < smooth_motion:
        raise ValueError(
            f"travel is {travel:g} correlation lengths, but within a precision of {precision:g} a "
            f"front moves smoothly by up to {smooth_motion:.2g} of them; raise travel or lower "
            "precision"
        )
