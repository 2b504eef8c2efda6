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
from crackfront.core.solver.codes import Code
from crackfront.core.solver.filters import (
    Filter,
    apply_filter,
    make_filter,
    set_inverse,
    set_stiffness,
)
from crackfront.core.solver.forces import (
    GROWTH,
    RIGID,
    largest_entry,
    largest_positive,
    locate,
    touch_samples,
)
from crackfront.core.solver.hardening import harden

Single = NDArray[np.float32]

_ACCURACY = 0.05
"""Residual to which the linear system is solved, relative to the mean drive.

The right side is lowered by it. A larger residual shortens the step, a smaller one takes more FFTs.
"""

_SINGLE = 0.9
"""Part of that residual below which double precision checks what single precision has solved.

It is below 1, since the residual of single precision is off by its round-off.
"""

_MOST_PAIRS = 100
"""Pairs of FFTs after which conjugate gradients are given up.

The step is then tried again with less softening, or with a scaled system.
"""

_TRIALS = 6
"""Largest number of solves per step, each with stiffnesses valid over the step before.

If the last step is not safe either, each site moves by its own force alone.
"""

_FALL = 0.8
"""Factor that lowers the share of the softening where the matrix is not positive definite.

Every failure costs a solve; a smaller factor leaves out more softening, which shortens steps.
"""

_RISE = 1.1
"""Factor that raises the share of the softening from one step to the next.

A larger one recovers faster from a stiff place, and fails more often.
"""

_LEAST_SOFTENING = 0.2
"""Smallest share of the softening; below it the softening is left out.

Then the matrix is positive definite in any case, so that trials end.
"""

_LEAST_RELATIVE_DRIVE = 1e-4
"""Least mean drive that sets the accuracy of a solve, relative to the largest drive."""

_LEAST_RELATIVE_STEP = 1e-9
"""Least step of a site that its stiffness must cover, relative to the longest allowed step.

It is so short that it matters only for sites that would not move at all.
"""


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
        Scale of the site in the linear system: 0 for one that is driven backward and stays fixed.
    residual, preconditioned : array
        Right side less the forces against the step, scaled; the same after the preconditioner.
    search, line_along, force_along : array
        Direction of search, force of the line along it, and the same with the force of the sites.
    softening, rigid : (1,) array
        Part of the softening that the last step used; stiffness of a site, relative to the
        line, above which the system is scaled.
    site_stiffness : float
        Stiffness of the line against a single site.
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
    site_stiffness: float
    stiff_line: Filter
    single_line: Filter
    preconditioner: Filter


@jit
def make_workspace(n_site, geometry):
    """Work space for a front of so many sites."""
    double, single = np.empty(0, np.complex128), np.empty(0, np.complex64)
    work = Workspace(
        reach=np.zeros(n_site),
        hardening=np.empty(n_site),
        step=np.empty(n_site),
        right=np.empty(n_site),
        line=np.empty(n_site),
        stiffness=np.empty(n_site, np.float32),
        scale=np.empty(n_site, np.float32),
        residual=np.empty(n_site, np.float32),
        preconditioned=np.empty(n_site, np.float32),
        search=np.empty(n_site, np.float32),
        line_along=np.empty(n_site, np.float32),
        force_along=np.empty(n_site, np.float32),
        softening=np.ones(1),
        rigid=np.full(1, RIGID),
        site_stiffness=mode_stiffness(geometry, 1) * self_modes(n_site),
        stiff_line=make_filter(n_site, double),
        single_line=make_filter(n_site, single),
        preconditioner=make_filter(n_site, single),
    )
    set_stiffness(work.stiff_line, geometry)
    set_stiffness(work.single_line, geometry)
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
    set_inverse(work.preconditioner, geometry, shift)
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
def _scale(work):
    """Scale the free sites so that none is stiffer than the line against it.

    Without that, needles of the field spoil the preconditioner. Returns the mean scaled stiffness.
    """
    total = 0.0
    for i in range(work.step.size):
        stiffness = max(work.stiffness[i], 0.0)
        part = work.site_stiffness / max(stiffness, work.site_stiffness)
        if work.scale[i] > 0.0:
            work.scale[i] = np.sqrt(part)
        total += part * stiffness
    return total / work.step.size


@kernel
def _solve_softest(work, geometry, floor, tolerance, all_free, started):
    """Solve with as much softening as leaves the matrix positive definite.

    Returns the number of FFT pairs and whether it succeeded.
    """
    pairs = 0
    while True:
        if not started:
            work.step[:] = 0.0
        mean, stiffest = _soften(work, floor)
        scaled = stiffest > work.rigid[0] * work.site_stiffness
        if scaled:
            mean, all_free = _scale(work), False
        used, solved = _solve(
            work,
            geometry,
            mean + floor,
            tolerance,
            all_free=all_free,
            scaled=scaled,
            started=started,
        )
        pairs += used
        if solved or work.softening[0] == 0.0:
            return pairs, solved
        started = False
        if used >= _MOST_PAIRS and stiffest > work.site_stiffness and not scaled:
            work.rigid[0] = 1.0
        elif work.softening[0] > _LEAST_SOFTENING:
            work.softening[0] *= _FALL
        else:
            work.softening[0] = 0.0


@kernel
def newton_step(work, task, front, among_needles):
    """Move the whole front by one step that passes no barrier; return code and pairs of FFTs.

    The right side is lowered by the largest residual of the linear solver and the step clipped at
    zero: an inexact step then still leaves every drive forward. Sites driven backward by more than
    the slack stay fixed. Where a site would pass the lowest place nothing moves, and the code is
    PASSES_LOWEST, as the step of a site is safe only together with all others. Nothing moves either
    where the first needle is met, and the code is MET_NEEDLES.
    """
    drive = front.drive
    largest = largest_positive(drive)
    # Stiffness that keeps a step of the front as a whole below the longest allowed one.
    floor = largest / task.furthest
    guess = _first_guess(work, task, front, largest, floor)
    longest = max(largest_entry(work.reach), guess, largest / work.site_stiffness)
    furthest = min(task.furthest, GROWTH * longest)
    mean = max(_forward_sum(drive) / drive.size, _LEAST_RELATIVE_DRIVE * largest)
    tolerance = _ACCURACY * mean
    all_free = _prepare(work, task, front, tolerance, furthest, guess)
    _raise_hardening(work, task, front, 1.0)
    if not among_needles and largest_entry(work.hardening) > RIGID * work.site_stiffness:
        return Code.MET_NEEDLES, 0
    pairs, is_safe = _choose_step(work, task, front, floor, furthest, tolerance, all_free)
    if not is_safe:
        _choose_steps_alone(work, task, front, furthest)
    if _passes_lowest(work, front, task.lowest):
        return Code.PASSES_LOWEST, pairs
    return _move(work, task, front), pairs


@kernel
def _first_guess(work, task, front, largest, floor):
    """How far the front would go as a whole if only the load stopped it; 0 after the first step."""
    if largest_entry(work.reach) > 0.0:
        return 0.0
    slope = restoring_slope(task.field.geometry, front.place[0], task.load)
    return min(task.furthest / GROWTH, largest / max(slope, floor))


@kernel
def _choose_step(work, task, front, floor, furthest, tolerance, all_free):
    """Solve for a step until its stiffnesses are valid over it.

    Returns the number of FFT pairs, and whether the step is safe and moves a site.
    """
    work.softening[0] = min(_RISE * max(work.softening[0], _LEAST_SOFTENING), 1.0)
    pairs, longest = 0, 0.0
    for _ in range(_TRIALS):
        started = longest > 0.0
        used, solved = _solve_softest(
            work, task.field.geometry, floor, tolerance, all_free, started
        )
        pairs += used
        if not solved:
            break
        np.maximum(work.step, 0.0, work.step)
        longest = largest_entry(work.step)
        # A part of a safe step is safe.
        part = min(1.0, furthest / max(longest, _LEAST_RELATIVE_STEP * furthest))
        _raise_hardening(work, task, front, part)
        if _is_valid(work):
            for i in range(work.step.size):
                work.step[i] *= part
            return pairs, longest > 0.0
    return pairs, False


@kernel
def _prepare(work, task, front, tolerance, furthest, guess):
    """Set right side, free sites and a first guess of the step; return whether all are free."""
    drive, all_free = front.drive, True
    touch_samples(task, front, 0, work.hardening)
    for i in range(np.uint64(drive.size)):
        work.right[i] = max(drive[i], 0.0) - tolerance
        free = drive[i] >= -task.slack
        work.scale[i], all_free = 1.0 if free else 0.0, all_free and free
        work.step[i] = min(max(work.reach[i], guess, _LEAST_RELATIVE_STEP * furthest), furthest)
        work.reach[i], work.hardening[i] = 0.0, -np.inf
    return all_free


@kernel
def _raise_hardening(work, task, front, part):
    """Raise the hardenings to values that are valid over part of the step."""
    harden(task, front, 0, work.step, part, work.reach, work.hardening)


@kernel
def _is_valid(work):
    """Whether no site hardens more over the step than the linear system assumed."""
    valid = True
    for i in range(np.uint64(work.step.size)):
        valid = valid and work.hardening[i] <= work.stiffness[i]
    return valid


@kernel
def _passes_lowest(work, front, lowest):
    """Whether a site would pass the lowest place."""
    passes = False
    for i in range(work.step.size):
        passes |= work.step[i] > max(front.place[i] - lowest, 0.0)
    return passes


@kernel
def _move(work, task, front):
    """Move the sites by their steps; return MOVING, or the code of a site that leaves the field."""
    place, segment, step = front.place, front.segment, work.step
    for i in range(place.size):
        moved = place[i] + task.direction * step[i]
        code, below, value = locate(task, i, moved, segment[i])
        if code != Code.MOVING:
            return code
        place[i], segment[i], front.product[i] = moved, below, value
        work.reach[i] = 3 * step[i]
    return Code.MOVING


@kernel
def _choose_steps_alone(work, task, front, furthest):
    """Choose for each site the step with all others fixed, which is always safe."""
    drive, step, stiffness = front.drive, work.step, work.site_stiffness
    for i in range(step.size):
        step[i] = min(max(drive[i], 0.0) / stiffness, furthest)
        work.reach[i], work.hardening[i] = 0.0, -np.inf
    _raise_hardening(work, task, front, 1.0)
    for i in range(step.size):
        step[i] = min(max(drive[i], 0.0) / (stiffness + max(work.hardening[i], 0.0)), step[i])
