"""A front that follows a load from one metastable state to the next: the one loop over loads."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.field.fields import Field, first_place, last_place
from crackfront.core.field.samples import make_memory
from crackfront.core.outcome import Direction, Relaxation, Status
from crackfront.core.solver.relax import Newton, Solver, force_round_off, relax


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

    Raises
    ------
    ValueError
        If a branch begins at a front that does not fit the field or is not finite, a load is not
        finite, its direction is not 1 or -1, or the tolerance is below the round-off of the front.
    """
    solver = solver or Newton()
    _check_tolerance(solver.tolerance, field.geometry.n_site)
    _check_start(front, field)
    memory, at_rest = make_memory(field), True
    for load in loads:
        _check_load(load, field)
        if load.start is not None:
            _check_start(load.start, field)
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


def _check_start(front: Array, field: Field) -> None:
    """Raise if a branch cannot begin at a front."""
    n_site = field.geometry.n_site
    if front.shape != (n_site,):
        raise ValueError(
            f"front has shape {front.shape}; the field has {n_site} rays, so give as many places"
        )
    if not np.all(np.isfinite(front)):
        raise ValueError("the front is not finite everywhere; check its places")
    inner, outer = first_place(field), last_place(field)
    if np.min(front) < inner or np.max(front) > outer:
        raise ValueError(
            f"the front spans {np.min(front):.6g} to {np.max(front):.6g}; the field is sampled "
            f"from {inner:.6g} to {outer:.6g}, so start inside it"
        )


def _check_load(load: Load, field: Field) -> None:
    """Raise if a load is not finite or its direction is unknown."""
    if load.direction not in (1, -1):
        raise ValueError(f"direction is {load.direction}; it must be 1 or -1")
    if not math.isfinite(load.value):
        noun = field.geometry.state_type.load_noun
        raise ValueError(f"{noun} is {load.value}; it must be finite")


def _check_tolerance(tolerance: float, n_site: int) -> None:
    """Raise if the round-off of forces exceeds a tolerance."""
    round_off = force_round_off(n_site)
    if not tolerance >= round_off:
        raise ValueError(
            f"tolerance {tolerance} is below the round-off of a front of {n_site} sites "
            f"({round_off:.1e}); raise it"
        )
