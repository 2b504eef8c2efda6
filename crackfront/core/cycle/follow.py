"""A front that follows a load from one metastable state to the next: the one loop over loads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from crackfront.core.arrays import Array
from crackfront.core.field.fields import Field
from crackfront.core.field.samples import make_memory
from crackfront.core.outcome import Direction, Relaxation, Status
from crackfront.core.solver.relax import Solver, relax


class Load(NamedTuple):
    """A load and how it is reached."""

    value: float
    """Penetration (Units: reduced vertical length), or place of springs (Units: lateral)."""
    direction: Direction
    """Direction in which it is reached."""
    start: Array | None = None
    """Front at which a branch begins with it; by default the front of the load before."""


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a front."""

    load: Load
    before: Array
    """Front that it began with. Shape (n_site,). (Units: reduced lateral length)"""
    relaxation: Relaxation
    """Front at its end, and why it ended."""

    @property
    def front(self) -> Array:
        """Front at the end (Units: reduced lateral length)."""
        return self.relaxation.front

    @property
    def status(self) -> Status:
        """How the relaxation at this load ended."""
        return self.relaxation.status


def follow(
    field: Field, front: Array, loads: Iterable[Load], solver: Solver | None = None
) -> Iterator[Step]:
    """Steps of a front from load to load.

    Parameters
    ----------
    field : Field
        Work of adhesion along the rays.
    front : (n_site,) array
        First front. (Units: reduced lateral length)
    loads : iterable of Load
        Loads to visit. The next one is read after the step before it was used, so that it may
        depend on that step.
    solver : Solver, optional
        How each front is found.

    Yields
    ------
    Step
        One for every load. After a step that did not converge, only a load with a front of its own
        is followed; any other ends the iteration.
    """
    memory, at_rest = make_memory(field), True
    for load in loads:
        if load.start is not None:
            front, at_rest = load.start, True
        if not at_rest:
            return
        relaxation = relax(front, load.value, load.direction, field, solver, memory)
        yield Step(load, front, relaxation)
        at_rest = relaxation.status is Status.CONVERGED
        front = relaxation.front


def front_at(field: Field, front: Array, load: Load, solver: Solver | None = None) -> Array:
    """Front of one step (Units: reduced lateral length); arguments as of :func:`follow`.

    Raises
    ------
    ValueError
        If there is none, with the reason.
    """
    return converged_front(next(follow(field, front, [load], solver)), field)


def converged_front(step: Step, field: Field) -> Array:
    """Front of a step; ValueError, with the reason, if it did not converge."""
    if step.status is not Status.CONVERGED:
        noun = field.geometry.state_type.load_noun
        raise ValueError(f"at {noun} {step.load.value:.6g}: {step.status.value}")
    return step.front
