"""One approach and retraction: the load schedule, the fronts it visits and the record of both."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from crackfront import jkr
from crackfront.line import line_energy
from crackfront.pinning import (
    Field,
    first_radius,
    front_adhesion,
    front_products,
    last_radius,
    make_memory,
    n_angle,
    swept_adhesion,
)
from crackfront.relax import Direction, Relaxation, Status, relax
from crackfront.units import WORK_OF_ADHESION

Array = NDArray[np.float64]

DEFAULT_STEP = 0.004
"""Load step that leaves the dissipated energies of a full cycle within 1% of the quasi-static loop.

docs/hard-cases.md has the measure. (Units: reduced vertical length)
"""


@dataclass(frozen=True, slots=True)
class LoadSchedule:
    """Penetrations 0, step, 2 step ... max, and back until contact is lost.

    Parameters
    ----------
    max_penetration : float
        Largest penetration; it is visited even where it is no multiple of the step.
        (Units: reduced vertical length)
    step : float
        Difference of penetrations. (Units: reduced vertical length)

    Raises
    ------
    ValueError
        If the step is not positive, or the largest penetration is negative: the sphere makes
        contact at 0.

    Examples
    --------
    >>> list(LoadSchedule(0.5, 0.25).approach())
    [0.0, 0.25, 0.5]
    """

    max_penetration: float
    step: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.step) and self.step > 0):
            raise ValueError(f"load step is {self.step}; it must be positive")
        if not (math.isfinite(self.max_penetration) and self.max_penetration >= 0):
            raise ValueError(
                f"max penetration {self.max_penetration} never makes contact; the sphere touches "
                "at 0, so ask for 0 or more"
            )

    @property
    def _whole_steps(self) -> int:
        """Number of whole steps that fit under the largest penetration."""
        return math.floor(self.max_penetration / self.step * (1 + 1e-12))

    def approach(self) -> Iterator[float]:
        """Penetrations of the approach, increasing."""
        for k in range(self._whole_steps + 1):
            yield k * self.step
        if self._whole_steps * self.step < self.max_penetration * (1 - 1e-12):
            yield self.max_penetration

    def retraction(self) -> Iterator[float]:
        """Penetrations below the largest one, decreasing without end."""
        k = self._whole_steps
        if k * self.step >= self.max_penetration * (1 - 1e-12):
            k -= 1
        while True:
            yield k * self.step
            k -= 1


@dataclass(frozen=True, slots=True)
class CycleRecord:
    """The metastable states that a cycle visited, in order.

    Attributes
    ----------
    status : Status
        What ended the cycle; a full cycle ends by losing contact.
    end_penetration : float
        Penetration at which it ended (where contact was lost).
    penetration : (n_step,) array
        Rigid body penetration b. (Units: reduced vertical length)
    direction : (n_step,) int array
        +1 in approach, -1 in retraction.
    mean_radius, min_radius, max_radius, rms_radius : (n_step,) array
        Radius of the front; the last is the rms of its deviation from the mean.
        (Units: reduced lateral length)
    force : (n_step,) array
        Normal force. (Units: pi w_int R)
    contact_area : (n_step,) array
        Area within the front. (Units: reduced lateral length**2)
    apparent_work_of_adhesion : (n_step,) array
        <a G> / <a>, in equilibrium the mean of w_loc along the front. (Units: w_int)
    least_travel : (n_step,) array
        Smallest distance that any site has moved since its branch began.
        (Units: reduced lateral length)
    iterations : (n_step,) int array
        Sweeps of the solver.
    updates : (n_step,) int array
        Updates of single sites.
    residual : (n_step,) array
        Largest force along the motion that is left, relative to w_int per front length.
    dissipated_energy : (n_step,) array or None
        Energy lost in the jumps of each load step, where it was asked for; the first includes that
        of making contact. (Units: pi w_int R times a reduced vertical length)
    pull_off_energy : float or None
        Energy lost when the contact vanishes after the last state; with it the dissipated energies
        sum up to the loop integral of F db. None where energies were not asked for or contact was
        not lost. (Units: as dissipated_energy)
    radius : (n_step, n_angle) array or None
        The fronts, where they were asked for. (Units: reduced lateral length)
    """

    status: Status
    end_penetration: float
    penetration: Array
    direction: NDArray[np.int64]
    mean_radius: Array
    min_radius: Array
    max_radius: Array
    rms_radius: Array
    force: Array
    contact_area: Array
    apparent_work_of_adhesion: Array
    least_travel: Array
    iterations: NDArray[np.int64]
    updates: NDArray[np.int64]
    residual: Array
    dissipated_energy: Array | None = None
    pull_off_energy: float | None = None
    radius: Array | None = None


@dataclass(frozen=True, slots=True)
class CycleState:
    """One metastable state; each field is a row of the record that bears the same name."""

    penetration: float
    direction: Direction
    mean_radius: float
    min_radius: float
    max_radius: float
    rms_radius: float
    force: float
    contact_area: float
    apparent_work_of_adhesion: float
    least_travel: float
    iterations: int
    updates: int
    residual: float


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """What a history needs to go on from its last state.

    Attributes
    ----------
    record : CycleRecord
        All states so far.
    front : (n_angle,) array
        Front of the last state. (Units: reduced lateral length)
    turn : (n_angle,) array
        Front at which its branch began. (Units: reduced lateral length)
    """

    record: CycleRecord
    front: Array
    turn: Array


Keep = Callable[[Callable[[], Checkpoint]], None]
"""What is called at every new state, with a function that makes its checkpoint."""


class FrontHistory:
    """A front that follows a load from one metastable state to the next, and their record.

    One that resumes from a checkpoint must be asked for the same loads from the first on: it
    recalls the states that it knows and computes those that follow.

    Parameters
    ----------
    field : Field
        Work of adhesion along the rays.
    front : (n_angle,) array
        Where it begins, in contact that is just made. (Units: reduced lateral length)
    tolerance, max_sweeps, solver, record_fronts, record_energy, progress, resume, keep
        As in :func:`run_cycle`.
    """

    def __init__(
        self,
        field: Field,
        front: Array,
        *,
        tolerance: float = 1e-8,
        max_sweeps: int = 10_000_000,
        solver: str = "newton",
        record_fronts: bool = False,
        record_energy: bool = False,
        progress: Callable[[CycleState], None] | None = None,
        resume: Checkpoint | None = None,
        keep: Keep | None = None,
    ) -> None:
        self.states: list[CycleState] = []
        self._field = field
        self._memory = make_memory(field)
        self._front = self._turn = front
        self._begun = True
        self._solve = functools.partial(
            relax,
            field=field,
            tolerance=tolerance,
            max_sweeps=max_sweeps,
            solver=solver,
            memory=self._memory,
        )
        self._fronts: list[Array] | None = [] if record_fronts else None
        self._dissipated: list[float] | None = [] if record_energy else None
        self._progress, self._keep = progress, keep
        self._resumed = resume
        self._known = [] if resume is None else _states(resume.record)
        if resume is not None and resume.record.radius is not None:
            self._fronts = list(resume.record.radius)
        if resume is not None and resume.record.dissipated_energy is not None:
            self._dissipated = resume.record.dissipated_energy.tolist()

    @property
    def front(self) -> Array:
        """The front of the last state (Units: reduced lateral length)."""
        return self._front

    def begin(self, front: Array) -> None:
        """Begin a branch at a front, no matter how it was reached; its first step has no energy."""
        self._front = self._turn = front
        self._begun = False

    def follow(self, penetration: float, direction: Direction) -> Status:
        """Go to the next state, and record it if there is one."""
        if len(self.states) < len(self._known):
            return self._recall(penetration, direction)
        outcome = self._solve(self._front, penetration, direction)
        self._status, self._penetration = outcome.status, penetration
        if outcome.status is not Status.CONVERGED:
            return outcome.status
        before, self._front = self._front, outcome.radius
        if self.states and self.states[-1].direction != direction:
            self._turn = before
        self.states.append(_measure(outcome, penetration, direction, self._turn))
        if self._dissipated is not None:
            self._dissipated.append(self._energy_lost(before, penetration))
        self._begun = True
        if self._fronts is not None:
            self._fronts.append(self._front)
        if self._progress is not None:
            self._progress(self.states[-1])
        if self._keep is not None:
            self._keep(self.checkpoint)
        return outcome.status

    def _recall(self, penetration: float, direction: Direction) -> Status:
        """Go to a state that the checkpoint knows; the last one brings the front."""
        state = self._known[len(self.states)]
        if (state.penetration, state.direction) != (penetration, direction):
            raise ValueError(
                f"the checkpoint goes to penetration {state.penetration} where {penetration} is "
                "asked for; it is that of another load"
            )
        self.states.append(state)
        self._status, self._penetration = Status.CONVERGED, penetration
        if self._resumed is not None and len(self.states) == len(self._known):
            self._front, self._turn = self._resumed.front, self._resumed.turn
            self._begun = True
        return Status.CONVERGED

    def checkpoint(self) -> Checkpoint:
        """What it takes to go on from the last state."""
        return Checkpoint(self.record(), self._front, self._turn)

    def _energy_lost(self, before: Array, penetration: float) -> float:
        """Energy that the last step dissipated; the first one of a cycle makes the contact."""
        if not self._begun:
            return math.nan
        if len(self.states) == 1:
            return -_contact_energy(self._front, penetration, self._field)
        return dissipated_energy(before, self._front, penetration, self._field)

    def record(self, status: Status | None = None) -> CycleRecord:
        """All states so far.

        Parameters
        ----------
        status : Status, optional
            What ended the history, if not the last relaxation.
        """
        columns = {
            item.name: np.array([getattr(state, item.name) for state in self.states])
            for item in fields(CycleState)
        }
        status = status or self._status
        lost = self._dissipated is not None and status is Status.LOST_CONTACT
        front, penetration = self._front, self._penetration
        return CycleRecord(
            status=status,
            end_penetration=penetration,
            pull_off_energy=_contact_energy(front, penetration, self._field) if lost else None,
            dissipated_energy=None if self._dissipated is None else np.array(self._dissipated),
            radius=None if self._fronts is None else np.array(self._fronts).reshape(-1, front.size),
            **columns,
        )


def run_cycle(
    field: Field,
    schedule: LoadSchedule,
    *,
    tolerance: float = 1e-8,
    max_sweeps: int = 10_000_000,
    solver: str = "newton",
    record_fronts: bool = False,
    record_energy: bool = False,
    progress: Callable[[CycleState], None] | None = None,
    resume: Checkpoint | None = None,
    keep: Keep | None = None,
) -> CycleRecord:
    """Quasi-static approach from first contact to the largest penetration, and back to pull-off.

    Parameters
    ----------
    field : Field
        Work of adhesion along the rays.
    schedule : LoadSchedule
        Penetrations to visit.
    tolerance : float, optional
        Largest force along the motion that may be left, relative to w_int per front length.
    max_sweeps : int, optional
        Limit on the sweeps of one load step.
    solver : str, optional
        A name in :data:`crackfront.relax.SOLVERS`.
    record_fronts : bool, optional
        Keep every front, not only its measures.
    record_energy : bool, optional
        Compute the energy that each load step dissipates.
    progress : callable, optional
        Called with every state as it is found.
    resume : Checkpoint, optional
        State of an earlier run of the same cycle to go on from, to the same result bit for bit.
    keep : callable, optional
        Called at every new state with a function that makes its checkpoint.

    Returns
    -------
    CycleRecord
        All states in equilibrium, and what ended the cycle.

    Raises
    ------
    ValueError
        If a smooth sphere would already outgrow the field at the largest penetration, the field
        begins too far outside to make contact in, or the solver is unknown.
    """
    refuse_outgrown(field, schedule.max_penetration)
    _refuse_untouched(field)
    history = FrontHistory(
        field,
        np.full(n_angle(field), first_radius(field)),
        tolerance=tolerance,
        max_sweeps=max_sweeps,
        solver=solver,
        record_fronts=record_fronts,
        record_energy=record_energy,
        progress=progress,
        resume=resume,
        keep=keep,
    )
    for penetration, direction in loads(schedule):
        if history.follow(penetration, direction) is not Status.CONVERGED:
            break
    return history.record()


def dissipated_energy(before: Array, after: Array, penetration: float, field: Field) -> float:
    """Energy that is lost when a front moves at fixed penetration.

    Parameters
    ----------
    before, after : (n_angle,) array
        Fronts inside the field. (Units: reduced lateral length)
    penetration : float
        Rigid body penetration b. (Units: reduced vertical length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    float
        Fall of the total energy. A quasi-static move loses energy, except in approach where the
        sphere closes an edge in compression over places that repel (w_loc < 0): there it may be
        negative, by no more than the integral of -w_loc over those places.
        (Units: pi w_int R times a reduced vertical length)
    """
    fall = _elastic_energy(before, penetration) - _elastic_energy(after, penetration)
    return fall + swept_adhesion(before, after, field)


def _contact_energy(front: Array, penetration: float, field: Field) -> float:
    """Energy of a contact above that of none."""
    innermost = np.full(front.size, first_radius(field))
    # Within the first sample the product falls linearly to zero at the apex.
    core = np.pi * first_radius(field) * np.mean(front_products(innermost, field))
    outside = swept_adhesion(innermost, front, field)
    return _elastic_energy(front, penetration) - outside - float(core)


def _elastic_energy(front: Array, penetration: float) -> float:
    """Elastic energy of a front: rings of a smooth sphere, and the line."""
    # No energy is released or stored where an edge in compression advances.
    open_edge = np.maximum(front, math.sqrt(max(penetration, 0.0)))
    return float(np.mean(jkr.elastic_energy(open_edge, penetration))) + line_energy(front)


def _states(record: CycleRecord) -> list[CycleState]:
    """States of a record, one by one."""
    columns = {item.name: getattr(record, item.name).tolist() for item in fields(CycleState)}
    rows = zip(*columns.values(), strict=True)
    return [CycleState(**dict(zip(columns, row, strict=True))) for row in rows]


def loads(schedule: LoadSchedule) -> Iterator[tuple[float, Direction]]:
    """Penetrations of a whole cycle, without end, with the direction in which each is reached."""
    for penetration in schedule.approach():
        yield penetration, 1
    for penetration in schedule.retraction():
        yield penetration, -1


def _measure(
    outcome: Relaxation, penetration: float, direction: Direction, turn: Array
) -> CycleState:
    """Quantities recorded of a front in equilibrium; the branch began at the front `turn`."""
    front = outcome.radius
    release = front * jkr.energy_release_rate(front, penetration)
    return CycleState(
        penetration=penetration,
        direction=direction,
        mean_radius=float(np.mean(front)),
        min_radius=float(np.min(front)),
        max_radius=float(np.max(front)),
        rms_radius=float(np.std(front)),
        force=float(np.mean(jkr.force(front, penetration))),
        contact_area=float(np.pi * np.mean(front**2)),
        apparent_work_of_adhesion=float(np.mean(release) / np.mean(front) / WORK_OF_ADHESION),
        least_travel=float(np.min(np.abs(front - turn))),
        iterations=outcome.sweeps,
        updates=outcome.updates,
        residual=outcome.residual,
    )


def refuse_outgrown(field: Field, max_penetration: float) -> None:
    """Raise if a smooth sphere is larger than the field before its load is fully applied."""
    smooth = jkr.equilibrium_radius(max_penetration)
    if smooth >= last_radius(field):
        raise ValueError(
            f"contact outgrows the field: a smooth sphere at penetration {max_penetration} has "
            f"radius {smooth:.4g}, the field ends at {last_radius(field):.4g}; enlarge the field "
            "or lower the penetration"
        )


def _refuse_untouched(field: Field) -> None:
    """Raise if the innermost circle of a field is too large for contact to be made in it."""
    radius = first_radius(field)
    needed = float(jkr.apparent_work_of_adhesion(radius, 0.0))
    adhesion = front_adhesion(np.full(n_angle(field), radius), field) / WORK_OF_ADHESION
    # A circle that needs next to no adhesion is the first touch, whatever is found there.
    if needed > max(float(np.mean(adhesion)), 1e-3):
        raise ValueError(
            f"field begins at radius {radius:.4g}, where a contact at penetration 0 needs a mean "
            f"work of adhesion of {needed:.4g} w_int but finds {np.mean(adhesion):.4g}; "
            "add samples at smaller radii"
        )
