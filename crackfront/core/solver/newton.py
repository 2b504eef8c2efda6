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
    touch_samples,
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
    free : (n_angle,) array
        1 for a site that may move, 0 for one that is driven backward and held.
    force : (n_angle,) array
        What a direction of search changes of the drives.
    """

    reach: Array
    ahead: Array
    stiffness: Array
    step: Array
    free: Array
    force: Array


@jit
def make_newton(count):
    """Work space for a front of `count` sites."""
    return Newton(
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.ones(count),
        np.zeros(count),
    )


@jit
def _precondition(vector, inverse):
    """Vector whose modes are multiplied by an array."""
    modes = scipy.fft.rfft(vector)
    _scale_modes(modes.view(np.float64), inverse)
    return scipy.fft.irfft(modes, vector.size)


@kernel
def _scale_modes(modes, factors):
    """Multiply modes, given as real and imaginary parts in turn, by factors."""
    for n in range(factors.size):
        modes[2 * n] *= factors[n]
        modes[2 * n + 1] *= factors[n]


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


@kernel
def _largest(vector):
    """Largest absolute value."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    whole = vector.size - vector.size % 4
    for i in range(0, whole, 4):
        a = max(a, abs(vector[i]))
        b = max(b, abs(vector[i + 1]))
        c = max(c, abs(vector[i + 2]))
        d = max(d, abs(vector[i + 3]))
    for i in range(whole, vector.size):
        a = max(a, abs(vector[i]))
    return max(max(a, b), max(c, d))


@kernel
def _add(target, factor, other):
    """Add a multiple of a vector to another."""
    for i in range(target.size):
        target[i] += factor * other[i]


@kernel
def _scale_and_add(target, factor, other):
    """Multiply a vector by a factor, then add another."""
    for i in range(target.size):
        target[i] = factor * target[i] + other[i]


@kernel
def _multiply(target, factors):
    """Multiply a vector by another, entry by entry."""
    for i in range(target.size):
        target[i] *= factors[i]


@kernel
def _add_products(target, one, first, second):
    """Vector plus the products of two others."""
    for i in range(target.size):
        target[i] = one[i] + first[i] * second[i]


@jit
def _solve(geometry, newton, right, shift, tolerance, limit):
    """Conjugate gradients for (K + D) step = right on the free sites, to a tolerance in each.

    Returns the number of FFT pairs and whether it succeeded; it fails where the matrix is not
    positive definite. With all sites free, K times a direction follows by recurrence from the
    preconditioner.
    """
    step, stiffness, free, force = newton.step, newton.stiffness, newton.free, newton.force
    all_free = np.min(free) > 0.0
    inverse = np.empty(step.size // 2 + 1)
    for n in range(inverse.size):
        inverse[n] = 1.0 / (mode_stiffness(geometry, n) + shift)
    residual = right.copy()
    if np.max(step) > 0.0:
        _add_products(force, line_force(geometry, step), stiffness, step)
        _add(residual, -1.0, force)
    _multiply(residual, free)
    search, along, old = np.zeros(step.size), np.zeros(step.size), 1.0
    pairs = 0
    while pairs < limit:
        pairs += 1
        if _largest(residual) <= tolerance:
            return pairs, True
        descent = _precondition(residual, inverse)
        new = _inner_product(residual, descent)
        _scale_and_add(along, new / old, residual)
        _add(along, -shift, descent)
        _multiply(descent, free)
        _scale_and_add(search, new / old, descent)
        if not all_free:
            along[:] = line_force(geometry, search)
            pairs += 1
        _add_products(force, along, stiffness, search)
        curvature = _inner_product(search, force)
        if not curvature > 0.0:
            return pairs, False
        _add(step, new / curvature, search)
        _multiply(force, free)
        _add(residual, -new / curvature, force)
        old = new
    return pairs, False


@kernel
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
    count, step, reach = drive.size, newton.step, newton.reach
    largest = np.max(drive)
    own = mode_stiffness(field.geometry, 1) * self_modes(count)
    floor = largest / furthest
    furthest = min(furthest, _GROWTH * max(np.max(reach), largest / own))
    tolerance = min(accuracy * largest, 0.3 * max(np.mean(np.maximum(drive, 0.0)), 1e-6 * largest))
    right = np.maximum(drive, 0.0) - tolerance
    for i in range(count):
        newton.free[i] = 1.0 if drive[i] >= -slack else 0.0
        reach[i] = min(max(reach[i], 1e-9 * furthest), furthest)
    _harden(newton, field, memory, front, b, direction)
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
        safe = _holds(newton, field, memory, front, b, direction, part)
        if safe:
            break
    step *= part
    if not safe or np.max(step) == 0.0:
        _own_steps(newton, field, memory, front, drive, b, direction, furthest)
    return _move(newton, field, memory, front, b, direction), pairs


@kernel
def _harden(newton, field, memory, front, b, direction):
    """Stiffness ahead of every site over its reach."""
    place, segment, product, reach = front.place, front.segment, front.product, newton.reach
    touch_samples(field, memory, front, 0, newton.ahead)
    for i in range(place.size):
        newton.ahead[i] = hardening(
            field, memory, i, place[i], product[i], segment[i], reach[i], b, direction
        )


@kernel
def _holds(newton, field, memory, front, b, direction, part):
    """Whether the stiffness holds over part of the step; if not, it is raised for the next."""
    place, segment, product = front.place, front.segment, front.product
    step, reach, ahead, holds = newton.step, newton.reach, newton.ahead, True
    for i in range(place.size):
        if part * step[i] > reach[i]:
            reach[i] = part * step[i]
            further = hardening(
                field, memory, i, place[i], product[i], segment[i], reach[i], b, direction
            )
            holds = holds and further <= newton.stiffness[i]
            ahead[i] = max(ahead[i], further)
    return holds


@kernel
def _move(newton, field, memory, front, b, direction):
    """Take the step, or none of it: that of a site is safe only together with the others."""
    place, segment, step = front.place, front.segment, newton.step
    lowest = resting_place(field, b, direction)
    for i in range(place.size):
        if step[i] > max(place[i] - lowest, 0.0):
            return BLOCKED
    for i in range(place.size):
        moved = place[i] + direction * step[i]
        low, value = locate(field, memory, i, moved, segment[i], direction)
        if low < 0:
            return -low
        place[i], segment[i], front.product[i] = moved, low, value
        newton.reach[i] = 3 * step[i]
    return CONVERGED


@kernel
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
