"""Relaxation of a few neighbouring sites while the rest of the front is held.

The coupling to sites beyond :data:`HALF_BAND` neighbours is left out of the step (it only pulls
forward), which makes the step a banded system that is solved directly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import is_below_lowest, restoring_force, weight
from crackfront.core.solver.forces import BLOCKED, CONVERGED, hardening, locate
from crackfront.core.units import WORK_OF_ADHESION

Array = NDArray[np.float64]

HALF_BAND = 7
"""Neighbours on each side whose coupling the step keeps."""

LONGEST = 256
"""Largest number of sites relaxed at once."""


class Window(NamedTuple):
    """Work space of a window: one entry a site, and the coupling between sites.

    Attributes
    ----------
    drive, reach, stiffness, step : (LONGEST + HALF_BAND,) array
        Force along the motion, distance over which the stiffness holds, stiffness of the site's
        own force, and the step.
    band : (LONGEST + HALF_BAND, HALF_BAND + 1) array
        Factors of the banded system.
    coupling : (2 LONGEST + 1,) array
        Line stiffness between sites by their distance, its centre at LONGEST.
    """

    drive: Array
    reach: Array
    stiffness: Array
    step: Array
    band: Array
    coupling: Array


@jit
def make_window(row):
    """Work space for a line whose stiffness matrix has the given first row."""
    size = LONGEST + HALF_BAND
    coupling = np.zeros(2 * LONGEST + 1)
    for lag in range(min(LONGEST, row.size)):
        coupling[LONGEST + lag] = coupling[LONGEST - lag] = row[lag]
    return Window(
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros((size, HALF_BAND + 1)),
        coupling,
    )


@kernel
def _solve_banded(window, count, slack, pull):
    """Step of (K + D) step = drive with K cut to a band, by Gaussian elimination, clipped at 0.

    A site that is driven backward by more than `slack` is held: pushed back harder than its
    neighbours can ever `pull`, by a stiffness against which its step vanishes in round-off.
    """
    band, step, drive, stiffness = window.band, window.step, window.drive, window.stiffness
    row = window.coupling[LONGEST : LONGEST + HALF_BAND + 1]
    for i in range(count):
        step[i] = max(drive[i], 0.0)
        for lag in range(HALF_BAND + 1):
            band[i, lag] = row[lag]
        band[i, 0] += stiffness[i]
        if drive[i] < -slack:
            step[i] = -pull
            band[i, 0] = 1e15 * row[0]
    for i in range(count):
        inverse = 1.0 / band[i, 0]
        for lag in range(1, HALF_BAND + 1):
            factor = band[i, lag] * inverse
            step[i + lag] -= factor * step[i]
            for other in range(lag, HALF_BAND + 1):
                band[i + lag, other - lag] -= factor * band[i, other]
        band[i, 0] = inverse
    step[count : count + HALF_BAND] = 0.0
    for i in range(count - 1, -1, -1):
        value = step[i]
        for lag in range(1, HALF_BAND + 1):
            value -= band[i, lag] * step[i + lag]
        step[i] = value * band[i, 0]
    for i in range(count):
        step[i] = max(step[i], 0.0)


@kernel
def _choose_step(
    window, field, memory, front, first, count, b, direction, largest, furthest, slack
):
    """Step that no stiffness underestimates.

    Sites that would go beyond the reach of their stiffness get it anew for the longer way. It can
    only grow, so that the second step is shorter everywhere and needs no third.
    """
    place, segment, product = front.place, front.segment, front.product
    reach, stiffness, step = window.reach, window.stiffness, window.step
    # With a stiffness of at least largest / furthest no site moves beyond `furthest`.
    floor, pull = largest / furthest, window.coupling[LONGEST] * furthest
    i = first
    for j in range(count):
        ahead = hardening(
            field, memory, i, place[i], product[i], segment[i], reach[j], b, direction
        )
        stiffness[j] = max(ahead, floor)
        i = i + 1 if i + 1 < place.size else 0
    _solve_banded(window, count, slack, pull)
    short = False
    i = first
    for j in range(count):
        if step[j] > reach[j]:
            short = True
            reach[j] = step[j]
            ahead = hardening(
                field, memory, i, place[i], product[i], segment[i], reach[j], b, direction
            )
            stiffness[j] = max(ahead, stiffness[j])
        i = i + 1 if i + 1 < place.size else 0
    if short:
        _solve_banded(window, count, slack, pull)


@kernel
def _move(window, field, memory, front, first, count, b, direction):
    """Take the step and bring the drive within the window up to date."""
    place, segment, product = front.place, front.segment, front.product
    drive, step, coupling = window.drive, window.step, window.coupling
    geometry = field.geometry
    if direction < 0:
        # All or none: the step of a site is safe only together with those of its neighbours.
        for j in range(count):
            if is_below_lowest(geometry, place[(first + j) % place.size] - step[j], b):
                return BLOCKED
    i = first
    for j in range(count):
        moved = place[i] + direction * step[j]
        low, value = locate(field, memory, i, moved, segment[i], direction)
        if low < 0:
            return -low
        rise = restoring_force(geometry, moved, b) - restoring_force(geometry, place[i], b)
        drive[j] += direction * (value - product[i] - rise)
        place[i], segment[i], product[i] = moved, low, value
        i = i + 1 if i + 1 < place.size else 0
    for j in range(count):
        row = coupling[LONGEST - j : LONGEST - j + count]
        for other in range(count):
            drive[other] -= row[other] * step[j]
    return CONVERGED


@kernel
def relax_window(
    window, field, memory, front, drive, first, count, b, direction, level, furthest, slack, rounds
):
    """Move `count` sites from `first` on until their drive falls below a level.

    At most `rounds` steps of at most `furthest` are taken; `drive` is that of the whole front.
    Sites driven backward by more than `slack` are held. Returns a code and the number of steps.
    """
    place, local, reach, step = front.place, window.drive, window.reach, window.step
    own = window.coupling[LONGEST]
    for j in range(count):
        local[j] = drive[(first + j) % place.size]
        reach[j] = 4 * max(local[j], 0.0) / own
    steps = 0
    while steps < rounds:
        largest, calm = 0.0, True
        i = first
        for j in range(count):
            largest = max(largest, local[j])
            bound = level * weight(field.geometry, place[i]) * WORK_OF_ADHESION
            calm = calm and local[j] <= bound
            reach[j] = min(max(reach[j], 1e-9 * furthest), furthest)
            i = i + 1 if i + 1 < place.size else 0
        if calm:
            break
        _choose_step(
            window, field, memory, front, first, count, b, direction, largest, furthest, slack
        )
        steps += 1
        code = _move(window, field, memory, front, first, count, b, direction)
        if code != CONVERGED:
            return code, steps
        for j in range(count):
            reach[j] = 3 * step[j]
    return CONVERGED, steps
