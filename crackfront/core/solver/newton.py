"""A safe Newton step of the whole front, by conjugate gradients.

They run in single precision; what their step leaves of the drives is then told in double precision,
and they go on from there where it is too much.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import mode_stiffness, restoring_slope, self_modes
from crackfront.core.solver.filters import (
    Filter,
    Transform,
    apply_filter,
    make_filter,
    make_transform,
    set_filter,
)
from crackfront.core.solver.forces import (
    BLOCKED,
    CONVERGED,
    harden,
    largest_entry,
    locate,
    resting_place,
    touch_samples,
)
from crackfront.core.solver.team import bounds, greatest, hear, my_blocks, summed, tell, wait

Array = NDArray[np.float64]
Single = NDArray[np.float32]

_GROWTH = 8
"""How many times as far as the furthest reach, or as its own force takes it, a site may go."""

_ACCURACY = 0.05
"""To which part of the mean drive the linear system is solved."""

_MARGIN = 0.9
"""To which part of that single precision is to come, before double precision tells."""

_LIMIT = 100
"""Pairs of FFTs after which conjugate gradients are given up."""

_FALL = 0.8
"""Part of the softening that is tried next where the matrix is not positive definite."""

_RISE = 1.1
"""How many times as much of the softening as the last step used the next one tries."""

_LEAST = 0.2
"""Share of the softening below which none is used."""


class Newton(NamedTuple):
    """Work space of the Newton step; arrays have one entry a site.

    Attributes
    ----------
    reach : (n_site,) array
        Distance over which the stiffness holds.
    ahead : (n_site,) array
        Stiffness of the site's own force, negative where the field softens.
    step, right, line_force : (n_site,) array
        The step, the drives that it is to use up, and the force of the line against it.
    stiffness : (n_site,) array, in single precision as all that follow
        Stiffness that the step uses.
    free : (n_site,) array
        1 for a site that may move, 0 for one that is driven backward and held.
    residual, descent, search, along, force : (n_site,) array
        What is left of the drives, that by the preconditioner, the direction of search, the force
        of the line along it, and with that of the sites.
    transform, coarse : Transform
        Work space for modes in double and in single precision.
    line, coarse_line, inverse : Filter
        Stiffness of the line in both, and the preconditioner.
    """

    reach: Array
    ahead: Array
    step: Array
    right: Array
    line_force: Array
    stiffness: Single
    free: Single
    residual: Single
    descent: Single
    search: Single
    along: Single
    force: Single
    transform: Transform
    coarse: Transform
    line: Filter
    coarse_line: Filter
    inverse: Filter


@jit
def make_newton(count):
    """Work space for a front of `count` sites."""
    transform = make_transform(count, np.empty(0, np.complex128))
    coarse = make_transform(count, np.empty(0, np.complex64))
    return Newton(
        np.zeros(count),
        np.empty(count),
        np.empty(count),
        np.empty(count),
        np.empty(count),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        np.empty(count, np.float32),
        transform,
        coarse,
        make_filter(transform),
        make_filter(coarse),
        make_filter(coarse),
    )


@kernel(fastmath={"reassoc", "nsz"})
def _forward(vector):
    """Sum of what is positive."""
    total = 0.0
    for i in range(np.uint64(vector.size)):
        total += max(vector[i], 0.0)
    return total


@kernel(fastmath={"contract"})
def _begin(newton, started, low, high):
    """Drives that a step leaves, none if it was not started; return the largest."""
    for i in range(np.uint64(low), np.uint64(high)):
        force = newton.line_force[i] + newton.stiffness[i] * newton.step[i] if started else 0.0
        newton.residual[i] = newton.free[i] * (newton.right[i] - force)
        newton.search[i] = newton.along[i] = 0.0
    return largest_entry(newton.residual[low:high])


@kernel(fastmath={"reassoc", "nsz", "contract"})
def _turn(newton, factor, shift, low, high):
    """Next direction of search, and :func:`_oppose` for it if all sites are free."""
    residual, descent, free = newton.residual, newton.descent, newton.free
    force, along, stiffness, search = newton.force, newton.along, newton.stiffness, newton.search
    factor, shift, total = np.float32(factor), np.float32(shift), 0.0
    for i in range(np.uint64(low), np.uint64(high)):
        along[i] = factor * along[i] + residual[i] - shift * descent[i]
        search[i] = factor * search[i] + free[i] * descent[i]
        force[i] = along[i] + stiffness[i] * search[i]
        total += search[i] * force[i]
    return total


@kernel(fastmath={"reassoc", "nsz", "contract"})
def _oppose(newton, low, high):
    """Change of the drives along the direction of search; return its product with that."""
    force, along, stiffness, search = newton.force, newton.along, newton.stiffness, newton.search
    total = 0.0
    for i in range(np.uint64(low), np.uint64(high)):
        force[i] = along[i] + stiffness[i] * search[i]
        total += search[i] * force[i]
    return total


@kernel(fastmath={"contract"})
def _advance(newton, length, low, high):
    """Go along the direction of search; return the largest drive left."""
    step, residual, free = newton.step, newton.residual, newton.free
    search, force = newton.search, newton.force
    length = np.float32(length)
    for i in range(np.uint64(low), np.uint64(high)):
        step[i] += length * search[i]
        residual[i] -= length * free[i] * force[i]
    return largest_entry(residual[low:high])


@kernel
def _solve(team, newton, geometry, shift, tolerance, all_free, longest):
    """Conjugate gradients for (K + D) step = right on the free sites, to a tolerance in each.

    They start from the step, of which `longest` is the largest entry. Returns the number of FFT
    pairs and whether it succeeded; it fails where the matrix is not positive definite. With all
    sites free, K times a direction follows by recurrence from the preconditioner.
    """
    count, coarse, started = newton.step.size, newton.coarse, longest > 0.0
    set_filter(team, coarse, newton.inverse, geometry, shift, True)
    largest, old, pairs = 0.0, 1.0, 0
    while pairs < _LIMIT:
        if largest <= _MARGIN * tolerance:
            if started:
                apply_filter(team, newton.transform, newton.line, newton.step, newton.line_force)
                pairs += 1
            for block in range(*my_blocks(team)):
                low, high = bounds(team, block, count)
                tell(team, 0, block, _begin(newton, started, low, high))
            largest = greatest(team, hear(team), 0)
            if largest <= tolerance:
                return pairs, True
            started = True
        new = apply_filter(team, coarse, newton.inverse, newton.residual, newton.descent)
        pairs += 1
        for block in range(*my_blocks(team)):
            low, high = bounds(team, block, count)
            tell(team, 0, block, _turn(newton, new / old, shift, low, high))
        if not all_free:
            wait(team)
            apply_filter(team, coarse, newton.coarse_line, newton.search, newton.along)
            pairs += 1
            for block in range(*my_blocks(team)):
                tell(team, 0, block, _oppose(newton, *bounds(team, block, count)))
        curvature = summed(team, hear(team), 0)
        if not curvature > 0.0:
            return pairs, False
        for block in range(*my_blocks(team)):
            tell(team, 0, block, _advance(newton, new / curvature, *bounds(team, block, count)))
        largest, old = greatest(team, hear(team), 0), new
    return pairs, False


@kernel
def _soften(newton, share, floor, low, high):
    """Stiffness with a share of the softening; none at all means at least the floor.

    Returns the sum of what is not negative.
    """
    total = 0.0
    for i in range(np.uint64(low), np.uint64(high)):
        ahead = newton.ahead[i]
        stiffness = max(ahead, share * ahead) if share > 0.0 else max(ahead, floor)
        # Rounded up, as it is a bound.
        newton.stiffness[i] = stiffness + 2.0**-23 * abs(stiffness)
        total += max(stiffness, 0.0)
    return total


@kernel
def _solve_softest(team, newton, geometry, floor, tolerance, share, all_free, longest):
    """Step with as much softening as leaves the matrix positive definite.

    Returns FFT pairs, success and the share of the softening that was used.
    """
    pairs, count = 0, newton.step.size
    while True:
        for block in range(*my_blocks(team)):
            low, high = bounds(team, block, count)
            if longest == 0.0:
                newton.step[low:high] = 0.0
            tell(team, 0, block, _soften(newton, share, floor, low, high))
        mean = summed(team, hear(team), 0) / count
        used, solved = _solve(team, newton, geometry, mean + floor, tolerance, all_free, longest)
        pairs += used
        if solved or share == 0.0:
            return pairs, solved, share
        longest = 0.0
        share = _FALL * share if share > _LEAST else 0.0


@kernel
def newton_step(
    team, newton, field, memory, front, drive, b, direction, furthest, slack, share
):  # fmt: skip
    """Move the whole front by one safe step of at most about `furthest`.

    `share` is the part of the softening that the last step used. Returns code, pairs of FFTs and
    the share of this step.

    The right-hand side is lowered by the tolerance of the linear solver and the step clipped at
    zero: an inexact step then still leaves every drive forward. Sites driven backward by more than
    `slack` are held. Where a site would pass the lowest place nothing moves, and BLOCKED is told.
    """
    count, step, geometry = drive.size, newton.step, field.geometry
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, count)
        tell(team, 0, block, np.max(drive[low:high]))
        tell(team, 1, block, largest_entry(newton.reach[low:high]))
        tell(team, 2, block, _forward(drive[low:high]))
    told = hear(team)
    largest, longest = greatest(team, told, 0), greatest(team, told, 1)
    own = mode_stiffness(geometry, 1) * self_modes(count)
    floor = largest / furthest
    guess = 0.0
    if longest == 0.0:
        # How far the front would go as a whole, if only the load held it.
        guess = min(
            furthest / _GROWTH, largest / max(restoring_slope(geometry, front.place[0], b), floor)
        )
    furthest = min(furthest, _GROWTH * max(longest, guess, largest / own))
    tolerance = _ACCURACY * max(summed(team, told, 2) / count, 1e-4 * largest)
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, count)
        held = _prepare(
            newton, field, memory, front, drive, tolerance, slack, furthest, guess, low, high
        )
        tell(team, 0, block, held)
        _fails(newton, field, memory, front, b, direction, 1.0, low, high)
    all_free = greatest(team, hear(team), 0) == 0.0
    share = min(_RISE * max(share, _LEAST), 1.0)
    pairs, safe, part, longest = 0, False, 1.0, 0.0
    for _ in range(6):
        used, solved, share = _solve_softest(
            team, newton, geometry, floor, tolerance, share, all_free, longest
        )
        pairs += used
        if not solved:
            break
        for block in range(*my_blocks(team)):
            low, high = bounds(team, block, count)
            np.maximum(step[low:high], 0.0, step[low:high])
            tell(team, 0, block, largest_entry(step[low:high]))
        longest = greatest(team, hear(team), 0)
        # A part of a safe step is safe.
        part = min(1.0, furthest / max(longest, 1e-9 * furthest))
        for block in range(*my_blocks(team)):
            low, high = bounds(team, block, count)
            fails = _fails(newton, field, memory, front, b, direction, part, low, high)
            tell(team, 0, block, fails)
        safe = greatest(team, hear(team), 0) == 0.0
        if safe:
            break
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, count)
        for i in range(low, high):
            step[i] *= part
        if not safe or longest == 0.0:
            _own_steps(newton, field, memory, front, drive, b, direction, furthest, low, high)
        tell(team, 0, block, _passes_lowest(newton, field, front, b, direction, low, high))
    # That of a site is safe only together with the others.
    if greatest(team, hear(team), 0) > 0.0:
        return BLOCKED, pairs, share
    for block in range(*my_blocks(team)):
        low, high = bounds(team, block, count)
        tell(team, 0, block, _move(newton, field, memory, front, direction, low, high))
    return int(greatest(team, hear(team), 0)), pairs, share


@kernel
def _prepare(newton, field, memory, front, drive, tolerance, slack, furthest, guess, low, high):
    """Drives to use up, free sites and steps to look at; return whether a site is held."""
    held = 0.0
    touch_samples(field, memory, front, low, newton.ahead[low:high])
    for i in range(np.uint64(low), np.uint64(high)):
        newton.right[i] = max(drive[i], 0.0) - tolerance
        newton.free[i] = 1.0 if drive[i] >= -slack else 0.0
        held = max(held, 1.0 - newton.free[i])
        newton.step[i] = min(max(newton.reach[i], guess, 1e-9 * furthest), furthest)
        newton.reach[i], newton.ahead[i] = 0.0, -np.inf
    return held


@kernel
def _fails(newton, field, memory, front, b, direction, part, low, high):
    """Whether a stiffness does not hold over part of the step; it is raised for the next."""
    ahead, fails = newton.ahead, 0.0
    step, reach = newton.step[low:high], newton.reach[low:high]
    if harden(field, memory, front, low, step, part, reach, ahead[low:high], b, direction):
        for i in range(np.uint64(low), np.uint64(high)):
            fails = max(fails, 1.0 if ahead[i] > newton.stiffness[i] else 0.0)
    return fails


@kernel
def _passes_lowest(newton, field, front, b, direction, low, high):
    """Whether a site would pass the lowest place."""
    lowest, passes = resting_place(field, b, direction), 0.0
    for i in range(low, high):
        if newton.step[i] > max(front.place[i] - lowest, 0.0):
            passes = 1.0
    return passes


@kernel
def _move(newton, field, memory, front, direction, low, high):
    """Take the step of some sites."""
    place, segment, step = front.place, front.segment, newton.step
    for i in range(low, high):
        moved = place[i] + direction * step[i]
        below, value = locate(field, memory, i, moved, segment[i], direction)
        if below < 0:
            return -below
        place[i], segment[i], front.product[i] = moved, below, value
        newton.reach[i] = 3 * step[i]
    return CONVERGED


@kernel
def _own_steps(newton, field, memory, front, drive, b, direction, furthest, low, high):
    """Steps of each site by its own force alone, the others held; always safe."""
    line, step = mode_stiffness(field.geometry, 1) * self_modes(drive.size), newton.step
    for i in range(low, high):
        step[i] = min(max(drive[i], 0.0) / line, furthest)
        newton.reach[i], newton.ahead[i] = 0.0, -np.inf
    _fails(newton, field, memory, front, b, direction, 1.0, low, high)
    for i in range(low, high):
        step[i] = min(max(drive[i], 0.0) / (line + max(newton.ahead[i], 0.0)), step[i])
