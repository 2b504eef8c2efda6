"""A safe Newton step of the whole front, by conjugate gradients."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import mode_stiffness, self_modes
from crackfront.core.solver.forces import (
    BLOCKED,
    CONVERGED,
    hardening,
    line_force,
    locate,
    resting_place,
)

Array = NDArray[np.float64]

_GROWTH = 8
"""How many times as far as the furthest reach, or as its own force takes it, a site may go."""


class Newton(NamedTuple):
    """Work space of the Newton step, one entry a site.

    Attributes
    ----------
    reach : (n_angle,) array
        Distance over which the stiffness holds.
    ahead : (n_angle,) array
        Stiffness of the site's own force, negative where the field softens.
    stiffness : (n_angle,) array
        Stiffness that the step uses.
    step : (n_angle,) array
        The step.
    free : (n_angle,) bool array
        Sites that may move; one that is driven backward is held.
    """

    reach: Array
    ahead: Array
    stiffness: Array
    step: Array
    free: NDArray[np.bool_]


@jit
def make_newton(count):
    """Work space for a front of `count` sites."""
    return Newton(
        np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count), np.ones(count, np.bool_)
    )


@jit
def _precondition(geometry, vector, shift):
    """Inverse of the line stiffness plus a uniform stiffness."""
    modes = scipy.fft.rfft(vector)
    for n in range(modes.size):
        modes[n] /= mode_stiffness(geometry, n) + shift
    return scipy.fft.irfft(modes, vector.size)


@kernel
def _inner_product(one, other):
    """Sum of products in a fixed order: BLAS would use threads and give their number a say."""
    sums = (0.0, 0.0, 0.0, 0.0)
    whole = one.size - one.size % 4
    for i in range(0, whole, 4):
        sums = (
            sums[0] + one[i] * other[i],
            sums[1] + one[i + 1] * other[i + 1],
            sums[2] + one[i + 2] * other[i + 2],
            sums[3] + one[i + 3] * other[i + 3],
        )
    total = (sums[0] + sums[1]) + (sums[2] + sums[3])
    for i in range(whole, one.size):
        total += one[i] * other[i]
    return total


@jit
def _solve(geometry, newton, right, shift, tolerance, limit):
    """Conjugate gradients for (K + D) step = right on the free sites, to a tolerance in each.

    Returns the number of FFT pairs and whether it succeeded; it fails where the matrix is not
    positive definite. With all sites free, K times a direction follows by recurrence from the
    preconditioner.
    """
    step, stiffness, free = newton.step, newton.stiffness, newton.free
    all_free = np.all(free)
    residual = np.where(free, right - line_force(geometry, step) - stiffness * step, 0.0)
    search, along, old = np.zeros(step.size), np.zeros(step.size), 1.0
    pairs = 0
    while pairs < limit:
        pairs += 1
        largest = 0.0
        for i in range(step.size):
            largest = max(largest, abs(residual[i]))
        if largest <= tolerance:
            return pairs, True
        descent = _precondition(geometry, residual, shift)
        new = _inner_product(residual, descent)
        for i in range(step.size):
            search[i] = descent[i] + new / old * search[i] if free[i] else 0.0
            along[i] = residual[i] - shift * descent[i] + new / old * along[i]
        if not all_free:
            along[:] = line_force(geometry, search)
            pairs += 1
        curvature = 0.0
        for i in range(step.size):
            curvature += search[i] * (along[i] + stiffness[i] * search[i])
        if not curvature > 0.0:
            return pairs, False
        length = new / curvature
        for i in range(step.size):
            step[i] += length * search[i]
            if free[i]:
                residual[i] -= length * (along[i] + stiffness[i] * search[i])
        old = new
    return pairs, False


@jit
def _soften(newton, share, floor):
    """Stiffness with a share of the softening; none at all means at least the floor."""
    total = 0.0
    for i in range(newton.step.size):
        ahead = newton.ahead[i]
        newton.stiffness[i] = max(ahead, share * ahead) if share > 0.0 else max(ahead, floor)
        total += max(newton.stiffness[i], 0.0)
    return total / newton.step.size


@jit
def _solve_softest(geometry, newton, right, floor, tolerance, share):
    """Step with as much softening as leaves the matrix positive definite.

    Returns FFT pairs, success and the share of the softening that was used.
    """
    pairs = 0
    while True:
        mean = _soften(newton, share, floor)
        used, solved = _solve(geometry, newton, right, mean + floor, tolerance, 100)
        pairs += used
        if solved or share == 0.0:
            return pairs, solved, share
        newton.step[:] = 0.0
        share = share / 2 if share > 0.2 else 0.0


@jit
def newton_step(newton, field, memory, front, drive, b, direction, furthest, slack, accuracy):
    """Move the whole front by one safe step of at most about `furthest`; return code and pairs.

    The right-hand side is lowered by the tolerance of the linear solver and the step clipped at
    zero: an inexact step then still leaves every drive forward. Sites driven backward by more than
    `slack` are held. Where a site would pass the lowest place nothing moves, and BLOCKED is told.
    """
    count, step, reach, ahead = drive.size, newton.step, newton.reach, newton.ahead
    place, segment, product = front.place, front.segment, front.product
    largest = np.max(drive)
    own = mode_stiffness(field.geometry, 1) * self_modes(count)
    floor = largest / furthest
    furthest = min(furthest, _GROWTH * max(np.max(reach), largest / own))
    tolerance = min(accuracy * largest, 0.3 * max(np.mean(np.maximum(drive, 0.0)), 1e-6 * largest))
    right = np.maximum(drive, 0.0) - tolerance
    for i in range(count):
        newton.free[i] = drive[i] >= -slack
        reach[i] = min(max(reach[i], 1e-9 * furthest), furthest)
        ahead[i] = hardening(
            field, memory, i, place[i], product[i], segment[i], reach[i], b, direction
        )
    step[:] = 0.0
    pairs, share, safe, part = 0, 1.0, False, 1.0
    for _ in range(6):
        used, solved, share = _solve_softest(field.geometry, newton, right, floor, tolerance, share)
        pairs += used
        if not solved:
            break
        np.maximum(step, 0.0, step)
        # A part of a safe step is safe.
        part = min(1.0, furthest / max(np.max(step), 1e-9 * furthest))
        safe = True
        for i in range(count):
            if part * step[i] > reach[i]:
                safe = False
                reach[i] = part * step[i]
                further = hardening(
                    field, memory, i, place[i], product[i], segment[i], reach[i], b, direction
                )
                ahead[i] = max(ahead[i], further)
        if safe:
            break
    step *= part
    if not safe or np.max(step) == 0.0:
        _own_steps(newton, field, memory, front, drive, b, direction, furthest)
    # All or none: the step of a site is safe only together with those of the others.
    lowest = resting_place(field, b, direction)
    for i in range(count):
        if step[i] > max(place[i] - lowest, 0.0):
            return BLOCKED, pairs
    for i in range(count):
        moved = place[i] + direction * step[i]
        low, value = locate(field, memory, i, moved, segment[i], direction)
        if low < 0:
            return -low, pairs
        place[i], segment[i], product[i] = moved, low, value
        reach[i] = 2 * step[i]
    return CONVERGED, pairs


@jit
def _own_steps(newton, field, memory, front, drive, b, direction, furthest):
    """Steps of each site by its own force alone, the others held; always safe."""
    count = drive.size
    line = mode_stiffness(field.geometry, 1) * self_modes(count)
    newton.step[:] = 0.0
    for i in range(count):
        if drive[i] > 0.0:
            reach = min(drive[i] / line, furthest)
            ahead = hardening(
                field, memory, i, front.place[i], front.product[i], front.segment[i], reach,
                b, direction,
            )  # fmt: skip
            newton.step[i] = min(drive[i] / (line + max(ahead, 0.0)), reach)
