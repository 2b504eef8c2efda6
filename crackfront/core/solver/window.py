"""Relaxation of a few neighbouring sites while the rest of the front is held.

The coupling to sites beyond :data:`HALF_BAND` neighbours is left out of the step (it only pulls
forward), which makes the step a banded system that is solved directly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import restoring_force, weight
from crackfront.core.solver.forces import (
    CONVERGED,
    hardening,
    locate,
    resting_place,
    touch_samples,
)
from crackfront.core.units import WORK_OF_ADHESION

Array = NDArray[np.float64]

HALF_BAND = 7
"""Neighbours on each side whose coupling the step keeps."""

LONGEST = 256
"""Largest number of sites relaxed at once."""

_DOMINANCE = 0.02
"""By how much a pivot exceeds its row, relative to the stiffness of the line against one site."""

_GROWTH = 8
"""How many times as far as the furthest reach a site may go."""


class Window(NamedTuple):
    """Work space of a window: one entry a site, and the coupling between sites.

    Attributes
    ----------
    drive, reach, stiffness, step, given : (LONGEST + HALF_BAND,) array
        Force along the motion, distance over which the stiffness holds, stiffness of the site's
        own force, the step, and the step that is given to a site, negative for none.
    band : (LONGEST + HALF_BAND, HALF_BAND + 1) array
        Factors of the banded system.
    coupling : (2 LONGEST + 1,) array
        Line stiffness between sites by their distance, its centre at LONGEST.
    """

    drive: Array
    reach: Array
    stiffness: Array
    step: Array
    given: Array
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
        np.zeros(size),
        np.zeros((size, HALF_BAND + 1)),
        coupling,
    )


@kernel(fastmath={"contract"})
def _solve_banded(window, count):
    """Step of (K + D) step = drive with K cut to a band, by Gaussian elimination, clipped at 0.

    D is raised where its softening would make a pivot no larger than the rest of its row. A site
    whose step is given has a stiffness against which all others vanish in round-off.
    """
    band, step, drive, stiffness = window.band, window.step, window.drive, window.stiffness
    row = window.coupling[LONGEST : LONGEST + HALF_BAND + 1]
    least, given = _DOMINANCE * row[0], 1e15 * row[0]
    for i in range(count):
        step[i] = max(drive[i], 0.0)
        for lag in range(HALF_BAND + 1):
            band[i, lag] = row[lag]
        band[i, 0] += stiffness[i]
        if window.given[i] >= 0.0:
            step[i] = given * window.given[i]
            band[i, 0] = given
    for i in range(count):
        rest = least
        for lag in range(1, HALF_BAND + 1):
            rest -= band[i, lag]
        if band[i, 0] < rest:
            stiffness[i] += rest - band[i, 0]
            band[i, 0] = rest
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
        # The nearest site last: its step is known last.
        for lag in range(HALF_BAND, 0, -1):
            value -= band[i, lag] * step[i + lag]
        step[i] = window.given[i] if window.given[i] >= 0.0 else max(value * band[i, 0], 0.0)


@kernel
def _choose_step(window, field, memory, front, first, count, b, direction, furthest, lowest):
    """Step of at most `furthest` that no stiffness underestimates, with no site below the lowest.

    Sites that would go beyond the reach of their stiffness get it anew for the longer way. It can
    only grow, so that the second step is shorter everywhere and needs no third.
    """
    place, segment, product = front.place, front.segment, front.product
    reach, stiffness, step = window.reach, window.stiffness, window.step
    i = first
    for j in range(count):
        stiffness[j] = hardening(
            field, memory, i, place[i], product[i], segment[i], reach[j], b, direction
        )
        i = i + 1 if i + 1 < place.size else 0
    _solve_banded(window, count)
    # A part of a safe step is safe.
    part = min(1.0, furthest / np.max(step[:count]))
    short = False
    i = first
    for j in range(count):
        if part * step[j] > reach[j]:
            reach[j] = part * step[j]
            ahead = hardening(
                field, memory, i, place[i], product[i], segment[i], reach[j], b, direction
            )
            short = short or ahead > stiffness[j]
            stiffness[j] = max(ahead, stiffness[j])
        i = i + 1 if i + 1 < place.size else 0
    if short:
        _solve_banded(window, count)
    if lowest > -np.inf:
        _stop_at_lowest(window, front, first, count, lowest, part)
    if part < 1.0:
        for j in range(count):
            step[j] *= part


@kernel
def _stop_at_lowest(window, front, first, count, lowest, part):
    """Give the sites that would pass the lowest place steps by their own force, not beyond it."""
    place, step = front.place, window.step
    own, passing = window.coupling[LONGEST], False
    for j in range(count):
        rest = max(place[(first + j) % place.size] - lowest, 0.0)
        if part * step[j] > rest:
            passing = True
            stiffness = own + max(window.stiffness[j], 0.0)
            window.given[j] = min(max(window.drive[j], 0.0) / stiffness, rest)
    if passing:
        _solve_banded(window, count)


@kernel
def _move(window, field, memory, front, first, count, b, direction, lowest):
    """Take the step and bring the drive within the window up to date."""
    place, segment, product = front.place, front.segment, front.product
    drive, step, coupling = window.drive, window.step, window.coupling
    geometry = field.geometry
    i = first
    for j in range(count):
        moved = place[i] + direction * step[j]
        resting = direction < 0 and moved <= lowest
        moved = min(place[i], lowest) if resting else moved
        low, value = locate(field, memory, i, moved, segment[i], direction)
        if low < 0:
            return -low
        rise = restoring_force(geometry, moved, b) - restoring_force(geometry, place[i], b)
        drive[j] = -np.inf if resting else drive[j] + direction * (value - product[i] - rise)
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
    Sites driven backward by more than `slack` are held, also those that rest at the lowest place.
    Returns a code and the number of steps.
    """
    place, local, reach, step = front.place, window.drive, window.reach, window.step
    own, lowest = window.coupling[LONGEST], resting_place(field, b, direction)
    touch_samples(field, memory, front, first, step[:count])
    i = first
    for j in range(count):
        local[j] = drive[i]
        i = i + 1 if i + 1 < place.size else 0
        reach[j] = 4 * max(local[j], 0.0) / own
    steps = 0
    while steps < rounds:
        far, calm = 0.0, True
        i = first
        for j in range(count):
            bound = level * weight(field.geometry, place[i]) * WORK_OF_ADHESION
            calm = calm and local[j] <= bound
            far = max(far, reach[j])
            window.given[j] = 0.0 if local[j] < -slack else -1.0
            i = i + 1 if i + 1 < place.size else 0
        if calm:
            break
        # A stiffness for a way that is much too long is much too large.
        far = min(_GROWTH * far, furthest)
        for j in range(count):
            reach[j] = min(max(reach[j], 1e-9 * far), far)
        _choose_step(window, field, memory, front, first, count, b, direction, far, lowest)
        steps += 1
        code = _move(window, field, memory, front, first, count, b, direction, lowest)
        if code != CONVERGED:
            return code, steps
        for j in range(count):
            reach[j] = 3 * step[j]
    return CONVERGED, steps
