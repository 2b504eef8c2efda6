"""What is kept of the states that a front visits, and what it takes to go on from one of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.core.cycle.energy import contact_energy, dissipated_energy
from crackfront.core.cycle.follow import Load, Step, follow
from crackfront.core.field.fields import Field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Solver
from crackfront.core.variables import ENERGY, STEP, variable

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CycleRecord:
    """The metastable states that a cycle visited, in order.

    Attributes
    ----------
    status : Status
        What ended the cycle; a full cycle of a sphere ends by losing contact.
    end_load : float
        Load at which it ended (where contact was lost).
    states : dataclass of (n_step,) arrays
        The states as the geometry records them, as
        :class:`crackfront.core.geometry.sphere.ContactState` that of a sphere.
    dissipated_energy : (n_step,) array or None
        Energy lost in the jumps of each load step, where it was asked for; the first includes that
        of making contact. (Units: pi w_int R times a reduced vertical length)
    pull_off_energy : float or None
        Energy lost when the contact vanishes after the last state; with it the dissipated energies
        sum up to the loop integral of F db. None where energies were not asked for or contact was
        not lost. (Units: as dissipated_energy)
    fronts : (n_step, n_site) array or None
        The fronts, where they were asked for. (Units: reduced lateral length)
    """

    status: Status
    end_load: float
    states: Any
    dissipated_energy: Array | None = variable(
        "energy lost in the jumps of a load step", ENERGY, STEP, default=None
    )
    pull_off_energy: float | None = None
    fronts: Array | None = None


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """What it takes to go on from the last state.

    Attributes
    ----------
    record : CycleRecord
        All states so far.
    front : (n_site,) array
        Front of the last state. (Units: reduced lateral length)
    turn : (n_site,) array
        Front at which its branch began. (Units: reduced lateral length)
    """

    record: CycleRecord
    front: Array
    turn: Array


Observer = Callable[["Recorder"], None]
"""What is called at every new state, with the recorder that holds it."""


class Recorder:
    """What records the steps of a front.

    Parameters
    ----------
    fronts, energy : bool, optional
        Whether every front is kept, and the energy computed that each load step dissipates.
    observers : sequence of callable, optional
        Called with the recorder at every new state, for progress, checkpoints, pictures.
    resume : Checkpoint, optional
        An earlier run of the same loads to go on from, to the same record bit for bit.

    Attributes
    ----------
    states : list
        States so far, as the geometry records them.
    front : (n_site,) array
        Front of the last state. (Units: reduced lateral length)
    load : float
        Where the last step went. (Units: those of the load)
    status : Status
        How it ended.
    """

    states: list[Any]
    front: Array
    load: float
    status: Status

    def __init__(
        self,
        *,
        fronts: bool = False,
        energy: bool = False,
        observers: Sequence[Observer] = (),
        resume: Checkpoint | None = None,
    ) -> None:
        self.states = []
        self._observers, self._resume = observers, resume
        known = None if resume is None else resume.record
        self._fronts: list[Array] | None = [] if fronts else None
        if known is not None and known.fronts is not None:
            self._fronts = list(known.fronts)
        self._dissipated: list[float] | None = [] if energy else None
        if known is not None and known.dissipated_energy is not None:
            self._dissipated = known.dissipated_energy.tolist()

    def run(
        self, field: Field, front: Array, loads: Iterable[Load], solver: Solver | None = None
    ) -> None:
        """Record all steps of a front from load to load, as far as they converge.

        Parameters
        ----------
        field, front, loads, solver
            As of :func:`crackfront.core.cycle.follow.follow`.
        """
        self._field, self.front, self._turn = field, front, front
        coming = iter(loads)
        for load in self._recalled(coming):
            self.status, self.load = Status.CONVERGED, load.value
        for step in follow(field, self.front, coming, solver):
            self.status, self.load = step.status, step.load.value
            if step.status is Status.CONVERGED:
                self._add(step)

    def _recalled(self, loads: Iterator[Load]) -> Iterator[Load]:
        """Take the loads that the checkpoint knows; the last one brings the front."""
        if self._resume is None:
            return
        for state in rows(self._resume.record.states):
            load = next(loads)
            known = getattr(state, fields(state)[0].name), state.direction
            if known != (load.value, load.direction):
                raise ValueError(
                    f"the checkpoint goes to penetration {known[0]} where {load.value} is "
                    "asked for; it is that of another load"
                )
            self.states.append(state)
            yield load
        self.front, self._turn = self._resume.front, self._resume.turn

    def _add(self, step: Step) -> None:
        """Record a state."""
        load, energy = step.load, math.nan
        if load.start is not None:
            self._turn = load.start
        elif self.states and self.states[-1].direction != load.direction:
            self._turn = step.before
        state = self._field.geometry.state(step.found, load.value, load.direction, self._turn)
        if self._dissipated is not None:
            if load.start is None and self.states:
                energy = dissipated_energy(step.before, step.front, load.value, self._field)
            elif load.start is None:
                energy = -contact_energy(step.front, load.value, self._field)
            self._dissipated.append(energy)
        self.front = step.front
        self.states.append(state)
        if self._fronts is not None:
            self._fronts.append(step.front)
        for observer in self._observers:
            observer(self)

    @property
    def load_name(self) -> str:
        """What the load is called."""
        return fields(self._field.geometry.state_type)[0].name

    def checkpoint(self) -> Checkpoint:
        """What it takes to go on from the last state."""
        return Checkpoint(self.record(), self.front, self._turn)

    def record(self, status: Status | None = None) -> CycleRecord:
        """All states so far.

        Parameters
        ----------
        status : Status, optional
            What ended them, if not the last relaxation.
        """
        status = status or self.status
        lost = self._dissipated is not None and status is Status.LOST_CONTACT
        return CycleRecord(
            status=status,
            end_load=self.load,
            states=columns(self.states, self._field.geometry.state_type),
            dissipated_energy=None if self._dissipated is None else np.array(self._dissipated),
            pull_off_energy=contact_energy(self.front, self.load, self._field) if lost else None,
            fronts=None
            if self._fronts is None
            else np.array(self._fronts).reshape(-1, self.front.size),
        )


def columns(states: Sequence[Any], kind: type[Any]) -> Any:
    """One state whose fields are the columns of many.

    Parameters
    ----------
    states : sequence of dataclass
        The states; there may be none.
    kind : type
        Their dataclass.
    """
    return kind(
        **{
            item.name: np.array([getattr(one, item.name) for one in states])
            for item in fields(kind)
        }
    )


def rows(states: Any) -> Iterator[Any]:
    """Many states from the columns of one."""
    table = {item.name: getattr(states, item.name).tolist() for item in fields(states)}
    for values in zip(*table.values(), strict=True):
        yield replace(states, **dict(zip(table, values, strict=True)))
