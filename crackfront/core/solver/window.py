"""Windows: a few neighbouring sites are relaxed while the rest of the front is fixed.

A step leaves out the coupling to sites beyond :data:`HALF_BAND` neighbours (it only pulls forward),
which makes it a banded system that is solved directly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import restoring_force, weight
from crackfront.core.solver.codes import Code
from crackfront.core.solver.forces import GROWTH, following, largest_entry, locate, touch_samples
from crackfront.core.solver.hardening import harden
from crackfront.core.units import WORK_OF_ADHESION

HALF_BAND = 7
"""Neighbours on each side whose coupling the step keeps.

More couplings would give longer steps for more work; the elimination is written out for seven.
"""

LONGEST = 256
"""Largest number of sites relaxed at once.

The sums over pairs of sites that each step takes grow with the square of this number.
"""

_MARGIN = 8
"""Sites on each side of the active ones that a step moves, too.

Fewer make a step cheaper, but their fixed neighbours stop the active sites earlier.
"""

_DOMINANCE = 0.02
"""By how much a pivot exceeds its row, relative to the stiffness of the line against one site.

It keeps the system positive definite where the field softens. A larger one shortens steps there.
"""

_CLAMP = 1e15
"""Stiffness of a site whose step is prescribed, relative to the line's against one site.

The forces of all other sites vanish in its round-off.
"""

_ROUNDS = 12
"""Most steps of a window before the drives of the whole front are computed again.

Until then a window does not feel the motion of the others; fewer steps take more transforms.
"""


class Window(NamedTuple):
    """Work space of a window.

    Attributes
    ----------
    drive, reach, stiffness, step, prescribed : (LONGEST + HALF_BAND,) array
        For each site the force along the motion, the stiffness of its own force and the distance
        over which this is valid, its step, and a step that is prescribed, negative for none.
    band : (LONGEST + HALF_BAND, HALF_BAND + 1) array
        Factors of the banded system.
    coupling : (2 LONGEST + 1,) array
        Stiffness of the line between two sites by their distance, its centre at LONGEST.
    """

    drive: Array
    reach: Array
    stiffness: Array
    step: Array
    prescribed: Array
    band: Array
    coupling: Array


@jit
def make_window(row):
    """Work space for a line whose stiffness matrix has the given first row."""
    size = LONGEST + HALF_BAND
    coupling = np.zeros(2 * LONGEST + 1)
    for lag in range(min(LONGEST, row.size)):
        coupling[LONGEST + lag] = coupling[LONGEST - lag] = row[lag]
    drive, reach, stiffness = np.zeros(size), np.zeros(size), np.zeros(size)
    step, prescribed, band = np.zeros(size), np.zeros(size), np.zeros((size, HALF_BAND + 1))
    return Window(drive, reach, stiffness, step, prescribed, band, coupling)


@kernel(inline="always")
def _behind(row):
    """The pivot's row shifted to the next site: coupling to that site first, right side last."""
    return (row[1], row[2], row[3], row[4], row[5], row[6], row[7], 0.0, row[8])


@kernel(fastmath={"contract", "nnan", "nsz"})
def _eliminated(row, pivot, inverse):
    """A row after elimination of the pivot's site from it."""
    part = pivot[0] * inverse
    return (
        row[0] - part * pivot[0],
        row[1] - part * pivot[1],
        row[2] - part * pivot[2],
        row[3] - part * pivot[3],
        row[4] - part * pivot[4],
        row[5] - part * pivot[5],
        row[6] - part * pivot[6],
        row[7] - part * pivot[7],
        row[8] - part * pivot[8],
    )


@kernel(fastmath={"contract"})
def _solve_banded(window, count):
    """Solve (Q + D) step = drive with Q cut to a band, by Gaussian elimination; clip at 0.

    D is raised where its softening would make a pivot no larger than the rest of its row. A site
    of prescribed step gets a stiffness against which all others vanish in round-off. Each row
    behind the pivot has a name of its own, so that it stays in registers.
    """
    band, step, drive, stiffness = window.band, window.step, window.drive, window.stiffness
    k = window.coupling[LONGEST : LONGEST + HALF_BAND + 1]
    dominance = _DOMINANCE * k[0]
    clamp = _CLAMP * k[0]
    fresh = (k[0], k[1], k[2], k[3], k[4], k[5], k[6], k[7], 0.0)
    row = second = third = fourth = fifth = sixth = seventh = fresh
    for i in range(count):
        pivot, c1, c2, c3, c4, c5, c6, c7, right = row
        pivot += stiffness[i]
        right += max(drive[i], 0.0)
        if window.prescribed[i] >= 0.0:
            right, pivot = clamp * window.prescribed[i], clamp
        least_pivot = dominance - (c1 + c2) - (c3 + c4) - (c5 + c6) - c7
        if pivot < least_pivot:
            stiffness[i] += least_pivot - pivot
            pivot = least_pivot
        inverse, step[i] = 1.0 / pivot, right
        band[i, 0], band[i, 1], band[i, 2], band[i, 3] = inverse, c1, c2, c3
        band[i, 4], band[i, 5], band[i, 6], band[i, 7] = c4, c5, c6, c7
        pivot_row = _behind((pivot, c1, c2, c3, c4, c5, c6, c7, right))
        row, pivot_row = _eliminated(second, pivot_row, inverse), _behind(pivot_row)
        second, pivot_row = _eliminated(third, pivot_row, inverse), _behind(pivot_row)
        third, pivot_row = _eliminated(fourth, pivot_row, inverse), _behind(pivot_row)
        fourth, pivot_row = _eliminated(fifth, pivot_row, inverse), _behind(pivot_row)
        fifth, pivot_row = _eliminated(sixth, pivot_row, inverse), _behind(pivot_row)
        sixth, pivot_row = _eliminated(seventh, pivot_row, inverse), _behind(pivot_row)
        seventh = _eliminated(fresh, pivot_row, inverse)
    s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0
    for i in range(count - 1, -1, -1):
        # The nearest site last: its step is computed last.
        far = band[i, 7] * s7 + band[i, 6] * s6 + band[i, 5] * s5 + band[i, 4] * s4
        value = step[i] - far - band[i, 3] * s3 - band[i, 2] * s2 - band[i, 1] * s1
        step[i] = max(value * band[i, 0], 0.0)
        if window.prescribed[i] >= 0.0:
            step[i] = window.prescribed[i]
        s1, s2, s3, s4, s5, s6, s7 = step[i], s1, s2, s3, s4, s5, s6


@kernel
def _choose_step(window, task, front, first, count, furthest):
    """Compute a step of at most `furthest` that passes no barrier and not the lowest place.

    The stiffness of a site that would go beyond its reach is computed again for the longer step. It
    can only grow, so that the second step is shorter everywhere and needs no third.
    """
    reach, stiffness, step = window.reach[:count], window.stiffness[:count], window.step[:count]
    for j in range(count):
        # A stiffness for a step that is much too long is much too large.
        step[j] = min(max(reach[j], 1e-9 * furthest), furthest)
        reach[j], stiffness[j] = 0.0, -np.inf
    harden(task, front, first, step, 1.0, reach, stiffness)
    _solve_banded(window, count)
    # A part of a safe step is safe.
    part = min(1.0, furthest / largest_entry(step))
    if harden(task, front, first, step, part, reach, stiffness):
        _solve_banded(window, count)
    if task.lowest > -np.inf:
        _stop_at_lowest(window, front, first, count, task.lowest, part)
    if part < 1.0:
        for j in range(count):
            step[j] *= part


@kernel
def _stop_at_lowest(window, front, first, count, lowest, part):
    """Let sites that would pass the lowest place go by their own force alone, and not beyond it."""
    place, step = front.place, window.step
    site_stiffness, passing = window.coupling[LONGEST], False
    for j in range(count):
        distance = max(place[(first + j) % place.size] - lowest, 0.0)
        if part * step[j] > distance:
            passing = True
            stiffness = site_stiffness + max(window.stiffness[j], 0.0)
            window.prescribed[j] = min(max(window.drive[j], 0.0) / stiffness, distance)
    if passing:
        _solve_banded(window, count)


@kernel(fastmath={"contract"})
def _couple(drive, coupling, step, count):
    """Subtract the forces of the line against the steps from the drives, four steps at a time."""
    step[count : count + 3] = 0.0
    for j in range(0, count, 4):
        first, second, third, fourth = step[j], step[j + 1], step[j + 2], step[j + 3]
        row = coupling[LONGEST - j - 3 : LONGEST - j + count]
        for site in range(np.uint64(count)):
            near = first * row[site + np.uint64(3)] + second * row[site + np.uint64(2)]
            drive[site] -= near + (third * row[site + np.uint64(1)] + fourth * row[site])


@kernel
def _move(window, task, front, first, count):
    """Move the sites by their steps and update the drives within the window.

    Returns MOVING, or the code of a site that leaves the field.
    """
    place, segment, product = front.place, front.segment, front.product
    drive, step, direction = window.drive, window.step, task.direction
    geometry, load, lowest = task.field.geometry, task.load, task.lowest
    i = np.uint64(first)
    for j in range(count):
        moved = place[i] + direction * step[j]
        resting = direction < 0 and moved <= lowest
        moved = min(place[i], lowest) if resting else moved
        code, below, value = locate(task, i, moved, segment[i])
        if code != Code.MOVING:
            return code
        rise = restoring_force(geometry, moved, load) - restoring_force(geometry, place[i], load)
        drive[j] = -np.inf if resting else drive[j] + direction * (value - product[i] - rise)
        place[i], segment[i], product[i] = moved, below, value
        i = following(i, place.size)
    _couple(drive, window.coupling, step, count)
    return Code.MOVING


@kernel
def _trim(window, task, front, first, count, level):
    """Reduce the window to sites with a drive above a level, and some next to them.

    Returns the first and the number of its sites, which is 0 if none is active.
    """
    place, drive, reach = front.place, window.drive, window.reach
    low, high = count, 0
    i = np.uint64(first)
    for j in range(count):
        if drive[j] > level * weight(task.field.geometry, place[i]) * WORK_OF_ADHESION:
            low, high = min(low, j), j + 1
        i = following(i, place.size)
    if high == 0:
        return first, 0
    low, high = max(low - _MARGIN, 0), min(high + _MARGIN, count)
    for j in range(low, high):
        drive[j - low], reach[j - low] = drive[j], reach[j]
        window.prescribed[j - low] = 0.0 if drive[j] < -task.slack else -1.0
    return (first + low) % place.size, high - low


@kernel
def relax_window(window, task, front, first, count, level):
    """Move `count` sites from `first` on until their drives fall below a level, or for some steps.

    Sites driven backward by more than the slack stay fixed, also those at the lowest place. The
    drives of the front are left as they are. Returns a code, the number of updates of a site and
    the largest stiffness of a site's own force.
    """
    drive, reach, step = window.drive, window.reach, window.step
    site_stiffness = window.coupling[LONGEST]
    touch_samples(task, front, first, step[:count])
    for j in range(count):
        drive[j] = front.drive[(first + j) % front.drive.size]
        reach[j] = 4 * max(drive[j], 0.0) / site_stiffness
    updates, stiffest = 0, 0.0
    for _ in range(_ROUNDS):
        first, count = _trim(window, task, front, first, count, level)
        if count == 0:
            break
        furthest = min(GROWTH * largest_entry(reach[:count]), task.furthest)
        _choose_step(window, task, front, first, count, furthest)
        updates += count
        stiffest = max(stiffest, largest_entry(window.stiffness[:count]))
        code = _move(window, task, front, first, count)
        if code != Code.MOVING:
            return code, updates, stiffest
        for j in range(count):
            reach[j] = 3 * step[j]
    return Code.MOVING, updates, stiffest
