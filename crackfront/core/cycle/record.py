"""Records of the states that a front visits, and checkpoints to continue them from."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.cycle.energy import contact_energy, dissipated_energy
from crackfront.core.cycle.follow import Load, Step, follow
from crackfront.core.cycle.jumps import JumpRecorder, Jumps
from crackfront.core.field.fields import Field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Newton, Solver
from crackfront.core.variables import ENERGY, STEP, variable


@dataclass(frozen=True, slots=True)
class CycleRecord:
    """The metastable states that a cycle visited, in order."""

    status: Status
    """What ended the cycle; a full cycle of a sphere ends by losing contact."""
    end_load: float
    """Load at which it ended (where contact was lost)."""
    states: Any
    """Dataclass of (n_step,) arrays, a state of the geometry, as
    :class:`crackfront.core.geometry.sphere.ContactState` for a sphere."""
    dissipated_energy: Array | None = variable(
        "energy lost in the jumps of a load step", ENERGY, STEP, default=None
    )
    """If recorded; the first includes the energy of making contact. Shape (n_step,)."""
    pull_off_energy: float | None = None
    """Energy lost when the contact vanishes after the last state; with it the dissipated energies
    sum up to the loop integral of F db. None where energies are not recorded or contact was not
    lost. (Units: as dissipated_energy)"""
    fronts: Array | None = None
    """If recorded. Shape (n_step, n_site). (Units: reduced lateral length)"""
    jumps: Jumps | None = None
    """If recorded, the jumps of the steady load steps."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """A record and the fronts with which it is continued."""

    record: CycleRecord
    front: Array
    """Front of the last state. (Units: reduced lateral length)"""
    turn: Array
    """Front at which its branch began. (Units: reduced lateral length)"""
    resolved: Array | None = None
    """Last front on which jumps were resolved, if there is one. (Units: reduced lateral length)"""


Observer = Callable[["Recorder"], None]
"""Function that is called at every new state, with the recorder."""


class Recorder:
    """Recorder of the steps of a front.

    Parameters
    ----------
    fronts, energy : bool, optional
        Whether to record every front, and the energy that each load step dissipates.
    jumps : float, optional
        Correlation length of w_loc, if the jumps of steady load steps are to be recorded. (Units:
        reduced lateral length)
    observers : sequence of callable, optional
        Called with the recorder at every new state, for progress, checkpoints, pictures.
    resume : Checkpoint, optional
        An earlier run of the same loads to continue, to the same record bit for bit.
    """

    states: list[Any]
    """States so far, as the geometry records them."""
    front: Array
    """Front of the last state. (Units: reduced lateral length)"""
    load: float
    """Load of the last step. (Units: of the loads of the geometry)"""
    status: Status
    """How the last step ended."""

    def __init__(
        self,
        *,
        fronts: bool = False,
        energy: bool = False,
        jumps: float | None = None,
        observers: Sequence[Observer] = (),
        resume: Checkpoint | None = None,
    ) -> None:
        self.states = []
        self._observers, self._resume = observers, resume
        earlier = None if resume is None else resume.record
        self._fronts: list[Array] | None = [] if fronts else None
        if earlier is not None and earlier.fronts is not None:
            self._fronts = list(earlier.fronts)
        self._dissipated: list[float] | None = [] if energy else None
        if earlier is not None and earlier.dissipated_energy is not None:
            self._dissipated = earlier.dissipated_energy.tolist()
        self._jumps: JumpRecorder | None = None
        if jumps is not None and resume is not None:
            self._jumps = JumpRecorder(jumps, resume.record.jumps, resume.resolved)
        elif jumps is not None:
            self._jumps = JumpRecorder(jumps)

    def run(
        self, field: Field, front: Array, loads: Iterable[Load], solver: Solver | None = None
    ) -> None:
        """Record all steps of a front from load to load, as far as they converge.

        Arguments are as of :func:`crackfront.core.cycle.follow.follow`.
        """
        self._field, self.front, self._turn = field, front, front
        self._solver = solver or Newton()
        coming = iter(loads)
        if self._resume is not None:
            self._recall(self._resume, coming)
        for step in follow(field, self.front, coming, solver):
            self.status, self.load = step.status, step.load.value
            if step.status is Status.CONVERGED:
                self._add(step)

    def _recall(self, checkpoint: Checkpoint, loads: Iterator[Load]) -> None:
        """Take the states of a checkpoint and as many loads, which may depend on these states."""
        for state in rows(checkpoint.record.states):
            load = next(loads)
            load_value = getattr(state, self.load_name)
            if (load_value, state.direction) != (load.value, load.direction):
                raise ValueError(
                    f"the checkpoint goes to {state.load_noun} {load_value} where this run goes to "
                    f"{load.value}; it belongs to other loads"
                )
            self.states.append(state)
            self.status, self.load = Status.CONVERGED, load.value
        self.front, self._turn = checkpoint.front, checkpoint.turn

    def _add(self, step: Step) -> None:
        """Record the state at the end of a step, and show it to the observers."""
        load = step.load
        if load.start is not None:
            self._turn = load.start
        elif self.states and self.states[-1].direction != load.direction:
            self._turn = step.before
        if self._jumps is not None:
            before = self._load_before(load, self._jumps.correlation_length)
            self._jumps.add(self._field, step, before, self._solver)
        state = self._field.geometry.state(step.relaxation, load.value, load.direction, self._turn)
        if self._dissipated is not None:
            self._dissipated.append(self._lost_energy(step))
        if self._fronts is not None:
            self._fronts.append(step.front)
        self.front = step.front
        self.states.append(state)
        for observer in self._observers:
            observer(self)

    def _load_before(self, load: Load, least_travel: float) -> Load | None:
        """Load of the last state, if it is of the same branch and every site has travelled so far.

        None otherwise.
        """
        if load.start is not None or not self.states:
            return None
        last = self.states[-1]
        if last.direction != load.direction or last.least_travel < least_travel:
            return None
        return Load(getattr(last, self.load_name), last.direction)

    def _lost_energy(self, step: Step) -> float:
        """Energy that a step dissipates; NaN if a branch begins with it at a front of its own."""
        load = step.load
        if load.start is not None:
            return math.nan
        if not self.states:
            return -contact_energy(step.front, load.value, self._field)
        return dissipated_energy(step.before, step.front, load.value, self._field)

    @property
    def load_noun(self) -> str:
        """What messages call the load."""
        noun: str = self._field.geometry.state_type.load_noun
        return noun

    @property
    def load_name(self) -> str:
        """Name of the load in the record of a state."""
        return fields(self._field.geometry.state_type)[0].name

    def checkpoint(self) -> Checkpoint:
        """Checkpoint at the last state."""
        resolved = None if self._jumps is None else self._jumps.front
        return Checkpoint(self.record(), self.front, self._turn, resolved)

    def record(self, status: Status | None = None) -> CycleRecord:
        """Record of all states so far; by default with the status of the last relaxation."""
        status, energies, fronts = status or self.status, self._dissipated, self._fronts
        lost = energies is not None and status is Status.LOST_CONTACT
        return CycleRecord(
            status=status,
            end_load=self.load,
            states=columns(self.states, self._field.geometry.state_type),
            dissipated_energy=None if energies is None else np.array(energies),
            pull_off_energy=contact_energy(self.front, self.load, self._field) if lost else None,
            fronts=None if fronts is None else np.array(fronts).reshape(-1, self.front.size),
            jumps=None if self._jumps is None else self._jumps.jumps(),
        )


def columns(states: Sequence[Any], kind: type[Any]) -> Any:
    """State of a kind whose fields are arrays with one entry for each of some states, or empty."""
    names = [item.name for item in fields(kind)]
    return kind(*(np.array([getattr(state, name) for state in states]) for name in names))


def rows(states: Any) -> Iterator[Any]:
    """Single states from one whose fields are arrays, the inverse of :func:`columns`."""
    table = (getattr(states, item.name).tolist() for item in fields(states))
    yield from (type(states)(*values) for values in zip(*table, strict=True))
