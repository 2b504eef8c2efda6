"""A front that follows a load from one metastable state to the next."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.cycle.energy import contact_energy, dissipated_energy
from crackfront.core.cycle.record import Checkpoint, CycleRecord, CycleState, Keep, recorded_states
from crackfront.core.field.kinds import Field
from crackfront.core.field.samples import make_memory
from crackfront.core.solver.relax import Direction, Relaxation, Status, relax
from crackfront.core.units import WORK_OF_ADHESION

Array = NDArray[np.float64]


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
        self._known = [] if resume is None else recorded_states(resume.record)
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
            return -contact_energy(self._front, penetration, self._field)
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
            pull_off_energy=contact_energy(front, penetration, self._field) if lost else None,
            dissipated_energy=None if self._dissipated is None else np.array(self._dissipated),
            radius=None if self._fronts is None else np.array(self._fronts).reshape(-1, front.size),
            **columns,
        )


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
