"""One loop of a recording that has several."""

from __future__ import annotations

import itertools

import numpy as np
import scipy

from crackfront.analysis.steady_adhesion import Rows
from crackfront.core.arrays import Array
from crackfront.core.words import counted
from crackfront.measured.loops.recording import Recording

_PROMINENCE = 0.5
"""Least height of a turn above the rows around it, over the travel of the whole recording."""

_AT_END = 0.02
"""Part of the rows next to an end of the recording, in which a turn is at this end."""

_LOW = 0.02
"""Part of the travel within which rows between two loops are as far away as the furthest."""


def chosen_loop(recording: Recording, number: int | None) -> Recording:
    """Rows of the loop with a number, from 1; of all rows without one.

    Raises ValueError if the recording has several loops and no number is given, or fewer loops, or
    its displacement has the opposite sign.
    """
    path = np.asarray(
        recording.radius if recording.displacement is None else recording.displacement
    )
    rows = np.flatnonzero(np.isfinite(path))
    if rows.size == 0:
        return recording
    # The median of five rows is free of their noise.
    smooth_path = scipy.ndimage.median_filter(path[rows], 5, mode="nearest")
    turns = _turns(smooth_path)
    if (
        turns.size == 2
        and turns[0] < _AT_END * smooth_path.size
        and turns[1] > (1 - _AT_END) * smooth_path.size
    ):
        raise ValueError(
            "the displacement is largest at the beginning and the end, where the sphere should be "
            "away from the surface; give --invert displacement (invert='displacement')"
        )
    n_loop = max(turns.size, 1)
    if number is None and n_loop == 1:
        return recording
    if number is None or not 1 <= number <= n_loop:
        absent = "" if number is None else f" and lacks number {number}"
        loops = counted(n_loop, "loop")
        raise ValueError(
            f"the recording contains {loops}{absent}; choose one, 1 to {n_loop}, by --loop "
            "(loop_number)"
        )
    between = [_row_between(smooth_path, rows, *pair) for pair in itertools.pairwise(turns)]
    ends = [0, *between, path.size]
    return recording.rows(slice(ends[number - 1], ends[number]))


def _turns(smooth_path: Array) -> Rows:
    """Places where the mount turns, or the contact is largest; they may be the ends."""
    lowest, span = float(np.min(smooth_path)), float(np.ptp(smooth_path))
    padded = np.pad(smooth_path, 1, constant_values=lowest - span)
    turns, _ = scipy.signal.find_peaks(padded, prominence=_PROMINENCE * span)
    return np.asarray(turns - 1)


def _row_between(smooth_path: Array, rows: Rows, first: int, last: int) -> int:
    """Row in the middle of the time away from the surface between two turns."""
    steps = np.diff(rows[first : last + 1])
    longest = int(np.argmax(steps))
    if steps[longest] > 1:
        # Radii were recorded in contact alone, so that rows are missing between two loops.
        return int(rows[first + longest] + steps[longest] // 2)
    low = np.min(smooth_path[first:last]) + _LOW * np.ptp(smooth_path)
    away = first + np.flatnonzero(smooth_path[first:last] <= low)
    return int(rows[away[away.size // 2]])
