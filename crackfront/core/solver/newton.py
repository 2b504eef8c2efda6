"""Newton steps of the whole front that pass no barrier, by conjugate gradients.

Conjugate gradients run in single precision. The residual of their step is then computed in double
precision, and they go on from there where it is too large.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.core.compiled import jit, kernel
from crackfront.core.geometry.base import mode_stiffness, restoring_slope, self_modes
from crackfront.core.solver.filters import Filter, apply_filter, make_filter, set_filter
from crackfront.core.solver.forces import (
    BLOCKED,
    CONVERGED,
    GROWTH,
    NEEDLES,
    RIGID,
    harden,
    largest_entry,
    largest_positive,
    locate,
    touch_samples,
)

Single = NDArray[np.float32]

_ACCURACY = 0.05
"""Residual to which the linear system is solved, over the mean drive."""

_SINGLE = 0.9
"""Part of that residual below which double precision checks what single precision has solved."""

_MOST_PAIRS = 100
"""Pairs of FFTs after which conjugate gradients are given up."""

_TRIALS = 6
"""Largest number of solves per step, each with stiffnesses valid over the previous step."""

_FALL = 0.8
"""Factor that lowers the share of the softening where the matrix is not positive definite."""

_RISE = 1.1
"""Factor that raises the share of the softening from one step to the next."""

_LEAST_SOFTENING = 0.2
"""Smallest share of the softening; below it the softening is left out."""


class Workspace(NamedTuple):
    """Work space of steps of the whole front; arrays have one entry a site.

    Attributes
    ----------
    reach, hardening : array
        Distance ahead, and stiffness of the site's own force that is valid over it, negative where
        the field softens.
    step, right, line : array
        Step along the motion, right side of the linear system, force of the line against the step.
    stiffness : array, in single precision as all that follow
        Hardening that the linear system uses.
    scale : array
        Scale of the site in the linear system: 0 for one that is driven backward and held.
    residual, preconditioned : array
        Right side less the forces against the step, scaled; the same after the preconditioner.
    search, line_along, force_along : array
        Direction of search, force of the line along it, and the same with the force of the sites.
    softening, rigid : (1,) array
        Part of the softening that the last step used; stiffness of a site, relative to the
        line, above which the system is scaled.
    stiff_line, single_line, preconditioner : Filter
        Stiffness of the line in double and in single precision, and the inverse of that with a mean
        stiffness of the sites.
    """

    reach: Array
    hardening: Array
    step: Array
    right: Array
    line: Array
    stiffness: Single
    scale: Single
    residual: Single
    preconditioned: Single
    search: Single
    line_along: Single
    force_along: Single
    softening: Array
    rigid: Array
    stiff_line: Filter
    single_line: Filter
    preconditioner: Filter


@jit
def make_workspace(count, geometry):
    """Work space for a front of `count` sites."""
    double, single = np.empty(0, np.complex128), np.empty(0, np.complex64)
    work = Workspace(
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
        np.ones(1),
        np.full(1, RIGID),
        make_filter(count, double),
        make_filter(count, single),
        make_filter(count, single),
    )
    set_filter(work.stiff_line, geometry, 0.0, False)
    set_filter(work.single_line, geometry, 0.0, False)
    return work


@kernel(fastmath={"reassoc", "nsz"})
def _forward_sum(vector):
    """Sum of the positive entries."""
    total = 0.0
    for i in range(np.uint64(vector.size)):
        total += max(vector[i], 0.0)
    return total


@kernel(fastmath={"contract"})
def _restart(work, started):
    """Compute the residual in double precision and reset the search."""
    for i in range(np.uint64(work.step.size)):
        force = work.line[i] + work.stiffness[i] * work.step[i] if started else 0.0
        work.residual[i] = work.scale[i] * (work.right[i] - force)
        work.search[i] = work.line_along[i] = 0.0


@kernel
def _largest_residual(work, scaled):
    """Largest residual of a free site, without its scale."""
    if not scaled:
        return largest_entry(work.residual)
    largest = np.float32(0.0)
    for i in range(work.scale.size):
        if work.scale[i] > 0.0:
            largest = max(largest, abs(work.residual[i]) / work.scale[i])
    return largest


@kernel(fastmath={"reassoc", "nsz", "contract"})
def _turn(work, factor, shift):
    """Compute the next direction of search, and :func:`_curvature` if all sites are free."""
    residual, preconditioned, scale = work.residual, work.preconditioned, work.scale
    force, along, stiffness = work.force_along, work.line_along, work.stiffness
    search = work.search
    factor, shift, total = np.float32(factor), np.float32(shift), 0.0
    for i in range(np.uint64(search.size)):
        along[i] = factor * along[i] + residual[i] - shift * preconditioned[i]
        search[i] = factor * search[i] + scale[i] * preconditioned[i]
        force[i] = along[i] + stiffness[i] * search[i]
        total += search[i] * force[i]
    return total


@kernel(fastmath={"reassoc", "nsz", "contract"})
def _curvature(work):
    """Compute the force along the direction of search; return its product with the direction."""
    force, along, stiffness = work.force_along, work.line_along, work.stiffness
    search, total = work.search, 0.0
    for i in range(np.uint64(search.size)):
        force[i] = along[i] + stiffness[i] * search[i]
        total += search[i] * force[i]
    return total


@kernel(fastmath={"contract"})
def _advance(work, length):
    """Add a length of the direction of search to the step."""
    step, residual, scale = work.step, work.residual, work.scale
    search, force = work.search, work.force_along
    length = np.float32(length)
    for i in range(np.uint64(step.size)):
        step[i] += length * search[i]
        residual[i] -= length * scale[i] * force[i]


@kernel
def _solve(work, geometry, shift, tolerance, all_free, scaled, started):
    """Solve (Q + D) step = right on the free sites by conjugate gradients, to a largest residual.

    They go on from the step if they have started. Returns the number of FFT pairs and whether it
    succeeded; it fails where the matrix is not positive definite. With all sites free, Q times a
    direction follows by recurrence from the preconditioner.
    """
    set_filter(work.preconditioner, geometry, shift, True)
    largest, old, pairs = 0.0, 1.0, 0
    while pairs < _MOST_PAIRS:
        if largest <= _SINGLE * tolerance:
            if started:
                apply_filter(work.stiff_line, work.step, work.line)
                pairs += 1
            _restart(work, started)
            largest = _largest_residual(work, scaled)
            if largest <= tolerance:
                return pairs, True
            started = True
        new = apply_filter(work.preconditioner, work.residual, work.preconditioned)
        pairs += 1
        curvature = _turn(work, new / old, shift)
        if not all_free:
            apply_filter(work.single_line, work.search, work.line_along)
            pairs += 1
            curvature = _curvature(work)
        if not curvature > 0.0:
            return pairs, False
        _advance(work, new / curvature)
        largest, old = _largest_residual(work, scaled), new
    return pairs, False


@kernel
def _soften(work, floor):
    """Set the stiffness to a share of the softening; none at all means at least the floor.

    Returns the mean of what is not negative, and the largest.
    """
    total, largest, share = 0.0, 0.0, work.softening[0]
    for i in range(np.uint64(work.step.size)):
        ahead = work.hardening[i]
        stiffness = max(ahead, share * ahead) if share > 0.0 else max(ahead, floor)
        # Rounded up, as it is a bound.
        work.stiffness[i] = stiffness + 2.0**-23 * abs(stiffness)
        total += max(stiffness, 0.0)
        largest = max(largest, stiffness)
    return total / work.step.size, largest


@kernel
def _scale(work, site_stiffness):
    """Scale the free sites so that none is stiffer than the line against it.

    Without that, needles of the field spoil the preconditioner. Returns the mean scaled stiffness.
    """
    total = 0.0
    for i in range(work.step.size):
        stiffness = max(work.stiffness[i], 0.0)
        part = site_stiffness / max(stiffness, site_stiffness)
        if work.scale[i] > 0.0:
            work.scale[i] = np.sqrt(part)
        total += part * stiffness
    return total / work.step.size


@kernel
def _solve_softest(work, geometry, site_stiffness, floor, tolerance, all_free, started):
    """Solve with as much softening as leaves the matrix positive definite.

    Returns the number of FFT pairs and whether it succeeded.
    """
    pairs = 0
    while True:
        if not started:
            work.step[:] = 0.0
        mean, stiffest = _soften(work, floor)
        scaled = stiffest > work.rigid[0] * site_stiffness
        if scaled:
            mean, all_free = _scale(work, site_stiffness), False
        used, solved = _solve(work, geometry, mean + floor, tolerance, all_free, scaled, started)
        pairs += used
        if solved or work.softening[0] == 0.0:
            return pairs, solved
        started = False
        if used >= _MOST_PAIRS and stiffest > site_stiffness and not scaled:
            work.rigid[0] = 1.0
        elif work.softening[0] > _LEAST_SOFTENING:
            work.softening[0] *= _FALL
        else:
            work.softening[0] = 0.0


@kernel
def newton_step(work, problem, front, among_needles):
    """Move the whole front by one step that passes no barrier; return code and pairs of FFTs.

    The right side is lowered by the largest residual of the linear solver and the step clipped at
    zero: an inexact step then still leaves every drive forward. Sites driven backward by more than
    the slack are held. Where a site would pass the lowest place nothing moves, and the code is
    BLOCKED, as the step of a site is safe only together with all others. Nothing moves either where
    the first needle is met, and the code is NEEDLES.
    """
    step, drive, geometry = work.step, front.drive, problem.field.geometry
    largest, longest = largest_positive(drive), largest_entry(work.reach)
    site_stiffness = mode_stiffness(geometry, 1) * self_modes(drive.size)
    floor, guess = largest / problem.furthest, 0.0
    if longest == 0.0:
        # How far the front would go as a whole, if only the load held it.
        slope = restoring_slope(geometry, front.place[0], problem.load)
        guess = min(problem.furthest / GROWTH, largest / max(slope, floor))
    furthest = min(problem.furthest, GROWTH * max(longest, guess, largest / site_stiffness))
    tolerance = _ACCURACY * max(_forward_sum(drive) / drive.size, 1e-4 * largest)
    all_free = _prepare(work, problem, front, tolerance, furthest, guess)
    _fails(work, problem, front, 1.0)
    if not among_needles and largest_entry(work.hardening) > RIGID * site_stiffness:
        return NEEDLES, 0
    work.softening[0] = min(_RISE * max(work.softening[0], _LEAST_SOFTENING), 1.0)
    pairs, safe, part, longest = 0, False, 1.0, 0.0
    for _ in range(_TRIALS):
        used, solved = _solve_softest(
            work, geometry, site_stiffness, floor, tolerance, all_free, longest > 0.0
        )
        pairs += used
        if not solved:
            break
        np.maximum(step, 0.0, step)
        longest = largest_entry(step)
        # A part of a safe step is safe.
        part = min(1.0, furthest / max(longest, 1e-9 * furthest))
        safe = not _fails(work, problem, front, part)
        if safe:
            break
    for i in range(step.size):
        step[i] *= part
    if not safe or longest == 0.0:
        _set_own_steps(work, problem, front, site_stiffness, furthest)
    if _passes_lowest(work, front, problem.lowest):
        return BLOCKED, pairs
    return _move(work, problem, front), pairs


@kernel
def _prepare(work, problem, front, tolerance, furthest, guess):
    """Set right side, free sites and a first guess of the step; return whether all are free."""
    drive, all_free = front.drive, True
    touch_samples(problem, front, 0, work.hardening)
    for i in range(np.uint64(drive.size)):
        work.right[i] = max(drive[i], 0.0) - tolerance
        free = drive[i] >= -problem.slack
        work.scale[i], all_free = 1.0 if free else 0.0, all_free and free
        work.step[i] = min(max(work.reach[i], guess, 1e-9 * furthest), furthest)
        work.reach[i], work.hardening[i] = 0.0, -np.inf
    return all_free


@kernel
def _fails(work, problem, front, part):
    """Whether a stiffness is not valid over part of the step; its hardening is raised."""
    fails = False
    if harden(problem, front, 0, work.step, part, work.reach, work.hardening):
        for i in range(np.uint64(work.step.size)):
            fails = fails or work.hardening[i] > work.stiffness[i]
    return fails


@kernel
def _passes_lowest(work, front, lowest):
    """Whether a site would pass the lowest place."""
    passes = False
    for i in range(work.step.size):
        passes |= work.step[i] > max(front.place[i] - lowest, 0.0)
    return passes


@kernel
def _move(work, problem, front):
    """Move the sites by their steps."""
    place, segment, step = front.place, front.segment, work.step
    for i in range(place.size):
        moved = place[i] + problem.direction * step[i]
        below, value = locate(problem, i, moved, segment[i])
        if below < 0:
            return -below
        place[i], segment[i], front.product[i] = moved, below, value
        work.reach[i] = 3 * step[i]
    return CONVERGED


@kernel
def _set_own_steps(work, problem, front, site_stiffness, furthest):
    """Move each site by its own force with all others fixed, which is always safe."""
    drive, step = front.drive, work.step
    for i in range(step.size):
        step[i] = min(max(drive[i], 0.0) / site_stiffness, furthest)
        work.reach[i], work.hardening[i] = 0.0, -np.inf
    _fails(work, problem, front, 1.0)
    for i in range(step.size):
        step[i] = min(max(drive[i], 0.0) / (site_stiffness + max(work.hardening[i], 0.0)), step[i])
