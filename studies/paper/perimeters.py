"""Perimeters of a contact in approach, and the parts of them that jump in a load step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import find_objects, label

from crackfront.core.arrays import Array
from crackfront.core.cycle.record import Recorder
from crackfront.core.geometry.sphere import ContactState

STRIDES = (1, 2, 4)
"""Strides, in load steps of the approach, over which the widest instability is looked for."""

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


class Perimeters:
    """What is kept of the fronts of an approach after jump-in: an observer of its states.

    All sites have then travelled by more than `passed`; a site that advances by more has jumped.
    Fronts up to the force `highest` count; `every` so many load steps one is kept in `lines`, with
    its state in `states`, at few enough angles for a drawing. For each of STRIDES
    `widest` has the widest advance and `extents` the widths of all. A state does not
    depend on the load step that led there (no passing), so that every second state is what twice
    the step would find.
    """

    def __init__(self, passed: float, highest: float, every: int) -> None:
        self._passed, self._highest, self._every = passed, highest, every
        self._before: dict[int, Array | None] = dict.fromkeys(STRIDES)
        self._count = 0
        self.widest = {stride: Advance(*(np.empty(0),) * 3) for stride in STRIDES}
        self.extents: dict[int, list[float]] = {stride: [] for stride in STRIDES}
        self.states: list[ContactState[float]] = []
        self.lines: list[Array] = []
        self.angle = np.empty(0)

    def __call__(self, recorder: Recorder) -> None:
        """Compare a front with the ones before, and keep every few of them."""
        state, front = recorder.states[-1], recorder.front
        # Before it jumps into contact, the sphere rests on a few places about its apex.
        landed = state.direction > 0 and state.least_travel > self._passed
        if not landed or state.force > self._highest:
            return
        self.follow(front)
        if self._count % self._every == 1 % self._every:
            sites = slice(None, None, -(-front.size // _MOST_SITES))
            self.angle = (2 * np.pi * np.arange(front.size) / front.size)[sites]
            self.states.append(state)
            self.lines.append(front[sites])

    def follow(self, front: Array) -> None:
        """Compare the front of the next state, (n_angle,) radii, with earlier ones."""
        for stride, before in self._before.items():
            if self._count % stride:
                continue
            if before is not None:
                moved = advances(before, front, self._passed)
                self.extents[stride] += [part.extent for part in moved]
                candidates = [self.widest[stride], *moved]
                self.widest[stride] = max(candidates, key=lambda part: part.extent)
            self._before[stride] = front
        self._count += 1
