"""Parts of a front that jump between the states of consecutive loads, and how wide they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Advance:
    """A connected part of a front that has advanced.

    Attributes
    ----------
    angle : (n_site,) array
        Angles of its sites, without a jump at 2 pi. (Units: rad)
    inner, outer : (n_site,) array
        Radii before and after. (Units: length)
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
    """Connected parts of a front that have advanced by more than a threshold.

    Parameters
    ----------
    before, after : (n_angle,) array
        Fronts. (Units: length)
    threshold : float
        Distance. (Units: length)

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


class AdvanceWatch:
    """The advances of a front, for the load step of its states and for multiples of it.

    A state does not depend on the load step that led there (no passing), so that every second state
    is what twice the step would find.

    Parameters
    ----------
    threshold : float
        As in :func:`advances`.
    strides : sequence of int
        Multiples of the load step.

    Attributes
    ----------
    widest : dict of int to Advance
        The widest for each multiple; without sites where there was none.
    extents : dict of int to list of float
        Widths of all. (Units: length)
    count : int
        States so far.
    """

    def __init__(self, threshold: float, strides: Sequence[int]) -> None:
        self._threshold = threshold
        self._before: dict[int, Array | None] = dict.fromkeys(strides)
        self.count = 0
        self.widest = {stride: Advance(*(np.empty(0),) * 3) for stride in strides}
        self.extents: dict[int, list[float]] = {stride: [] for stride in strides}

    def follow(self, front: Array) -> None:
        """Compare the next state with earlier ones.

        Parameters
        ----------
        front : (n_angle,) array
            Its radii. (Units: length)
        """
        for stride, before in self._before.items():
            if self.count % stride:
                continue
            if before is not None:
                found = advances(before, front, self._threshold)
                self.extents[stride] += [part.extent for part in found]
                candidates = [self.widest[stride], *found]
                self.widest[stride] = max(candidates, key=lambda part: part.extent)
            self._before[stride] = front
        self.count += 1
