"""What the animations of a cycle share: the loop that grows, and frames after contact is lost."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from crackfront.core.arrays import Array
from crackfront.plots.style import BLACK
from studies.paper.drawing import BRANCHES
from studies.paper.figure import Integers

LAST_FRAMES = 10
"""Frames without contact at the end."""

_MARGIN = 0.06
"""Room on each side of the loop, relative to its extent."""


def shown_state(frame: int, n_state: int) -> tuple[int, bool]:
    """State that a frame shows, and whether it is in contact; the last frames are not."""
    return min(frame, n_state - 1), frame < n_state


class GrowingLoop:
    """Radius against force of both branches up to a state, with a point at the state."""

    def __init__(
        self, axes: Axes, direction: Integers, force: Array, radius: Array, point: str
    ) -> None:
        self._direction, self._force, self._radius = direction, force, radius
        axes.set_xlim(*_limits(force))
        axes.set_ylim(*_limits(radius))
        self._branches = {
            sign: axes.plot([], [], color=colour, label=name)[0]
            for sign, name, _, colour in BRANCHES
        }
        (self._point,) = axes.plot([], [], "o", color=BLACK, zorder=4, label=point)
        axes.legend(loc="lower right")

    @property
    def artists(self) -> tuple[Artist, ...]:
        """Lines of both branches, and the point."""
        return (*self._branches.values(), self._point)

    def show(self, state: int, *, in_contact: bool) -> None:
        """Draw the loop up to a state; the point is drawn only in contact."""
        for sign, line in self._branches.items():
            branch = np.flatnonzero(self._direction[: state + 1] == sign)
            line.set_data(self._force[branch], self._radius[branch])
        shown = slice(state, state + 1) if in_contact else slice(0, 0)
        self._point.set_data(self._force[shown], self._radius[shown])


def _limits(values: Array) -> tuple[float, float]:
    """Limits of an axis with room on both sides."""
    low, high = float(values.min()), float(values.max())
    margin = _MARGIN * (high - low)
    return low - margin, high + margin
