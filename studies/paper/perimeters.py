"""Perimeters of a contact in approach, and the parts of them that jump in a load step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import find_objects, label

from crackfront.core.arrays import Array
from crackfront.core.cycle.instabilities import resolved_motion
from crackfront.core.cycle.record import Recorder
from crackfront.core.field.fields import Field
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.solver.relax import Solver
from studies.records import thinned

_MOST_SITES = 4096
"""Sites of a perimeter that are kept for drawing."""


@dataclass(frozen=True, slots=True)
class Advance:
    """A connected part of a front that has advanced: its sites, (n_site,) each.

    The angles (rad) make no jump at 2 pi; the radii are those before and after.
    """

    angle: Array
    inner: Array
    outer: Array

    @property
    def extent(self) -> float:
        """Width along the perimeter, at the mean of both fronts (Units: length)."""
        if self.angle.size == 0:
            return 0.0
        width = (self.angle[-1] - self.angle[0]) * (1 + 1 / max(self.angle.size - 1, 1))
        return float(width * np.mean(self.inner + self.outer) / 2)


def advances(before: Array, after: Array, threshold: float) -> list[Advance]:
    """Connected parts of a front, (n_angle,) radii, that have advanced by more than a threshold.

    Examples
    --------
    >>> before = np.ones(8)
    >>> after = before + np.array([0.5, 0.5, 0, 0, 0.5, 0, 0, 0.5])
    >>> [(part.angle * 4 / np.pi).tolist() for part in advances(before, after, 0.1)]
    [[4.0], [7.0, 8.0, 9.0]]
    """
    moved = after - before > threshold
    # From a site at rest on, no part is cut in two.
    start = int(np.argmin(moved))
    labels, n_part = label(np.roll(moved, -start))
    parts = []
    for (sites,) in find_objects(labels, n_part):
        index = np.arange(sites.start, sites.stop) + start
        wrapped = index % before.size
        parts.append(Advance(2 * np.pi * index / before.size, before[wrapped], after[wrapped]))
    return parts


@dataclass(frozen=True, slots=True)
class WideStep:
    """Load step of an approach in which a wide part of the front has advanced."""

    start: float
    """Penetration of the front before. (Units: reduced vertical length)"""
    end: float
    """Penetration of the front after. (Units: reduced vertical length)"""
    before: Array
    after: Array
    extent: float
    """Width of its widest part, which several instabilities may share."""


class Perimeters:
    """What is kept of the fronts of an approach after jump-in: an observer of its states.

    All sites have then travelled by more than `passed`; a site that advances by more in a load step
    has jumped. Fronts up to the force `highest` count. `extents` has the widths of all connected
    parts that jump in a load step, and `steps` the load steps with a part wider than `wide`. Every
    so many load steps a front is kept in `lines`, with its state in `states`, at few enough angles
    for a drawing.
    """

    def __init__(self, passed: float, highest: float, *, wide: float, every: int) -> None:
        self._passed, self._highest, self._wide, self._every = passed, highest, wide, every
        self._before: tuple[float, Array] | None = None
        self._count = 0
        self.extents: list[float] = []
        self.steps: list[WideStep] = []
        self.states: list[ContactState[float]] = []
        self.lines: list[Array] = []
        self.angle = np.empty(0)

    def __call__(self, recorder: Recorder) -> None:
        """Compare a front with the one before."""
        state, front = recorder.states[-1], recorder.front
        # Before it jumps into contact, the sphere rests on a few places about its apex.
        landed = state.direction > 0 and state.least_travel > self._passed
        if not landed or state.force > self._highest:
            return
        if self._before is not None:
            self._compare(*self._before, state.penetration, front)
        if self._count % self._every == 0:
            sites = thinned(front.size, _MOST_SITES)
            self.angle = (2 * np.pi * np.arange(front.size) / front.size)[sites]
            self.states.append(state)
            self.lines.append(front[sites])
        self._before = state.penetration, front
        self._count += 1

    def _compare(self, start: float, before: Array, end: float, after: Array) -> None:
        """Add what jumps in a load step."""
        extents = [part.extent for part in advances(before, after, self._passed)]
        self.extents += extents
        widest = max(extents, default=0.0)
        if widest > self._wide:
            self.steps.append(WideStep(start, end, before, after, widest))


def widest_instability(
    field: Field, steps: Sequence[WideStep], threshold: float, precision: float, solver: Solver
) -> Advance:
    """The widest instability of some load steps, each halved until its instabilities are separate.

    A front only advances, so that no instability is wider than the parts that jump in its load
    step: load steps are halved from the widest on, down to the first that cannot contain a wider
    instability. Those closer in load than `precision` count as one.
    """
    widest = Advance(*(np.empty(0),) * 3)
    for step in sorted(steps, key=lambda step: -step.extent):
        if step.extent <= widest.extent:
            break
        motion = resolved_motion(
            field,
            step.before,
            step.start,
            [step.end],
            1,
            travel=threshold,
            precision=precision,
            solver=solver,
        )
        for move in filter(lambda move: move.unstable, motion):
            for part in advances(move.before, move.after, threshold):
                widest = max(widest, part, key=lambda part: part.extent)
    return widest
