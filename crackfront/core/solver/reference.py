"""The paper's algorithm (Rosso and Krauth), the reference that every other solver is held to."""

from __future__ import annotations

import numpy as np

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.pieces import peek_piece, polynomial, steepest_inside
from crackfront.core.field.rays import segment_below
from crackfront.core.field.samples import fetch, sample_count, sample_place
from crackfront.core.geometry.base import (
    lowest_place,
    mode_stiffness,
    restoring_force,
    restoring_slope,
    self_modes,
    weight,
)
from crackfront.core.solver.forces import (
    CONVERGED,
    GROWTH,
    INWARD,
    LIMIT,
    OUTWARD,
    STILL,
    hardening,
    line_force,
    locate,
)
from crackfront.core.units import WORK_OF_ADHESION

_OWN_STEPS = 8
"""Most steps of a site in a sweep to where its own force rests."""


@kernel
def _enter(field, memory, ray, segment, pieces):
    """Compute the polynomial of the segment that a site comes to; return the segment's ends."""
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    fetch(field, memory, ray, segment, segment + 1)
    piece = polynomial(field, peek_piece(field, memory, ray, segment), outer - inner)
    pieces[ray, 0], pieces[ray, 1], pieces[ray, 2], pieces[ray, 3] = piece
    return inner, outer


@jit
def rosso_krauth(place, problem, max_sweeps):
    """Move every site by its own force over its own stiffness, at most to the next sample.

    The places are changed. What a site leaves out when it moves, the pull of its neighbours' moves,
    only pushes it on: no barrier is ever passed. The stiffness of a cubic piece is the slope of its
    steepest chord from the site to the next sample; a linear piece has only one. Returns a code,
    the numbers of sweeps and of updates of a site, and the largest drive left.
    """
    field, memory, load, direction = (
        problem.field, problem.memory, problem.load, problem.direction
    )  # fmt: skip
    count, last, geometry = place.size, sample_count(field) - 2, field.geometry
    line_stiffness = mode_stiffness(geometry, 1) * self_modes(count)
    lowest = lowest_place(geometry, load)
    segment = np.empty(count, np.int64)
    inner, outer = np.empty(count), np.empty(count)
    pieces = np.empty((count, 4))
    for i in range(count):
        segment[i] = segment_below(field, place[i], direction)
        inner[i], outer[i] = _enter(field, memory, i, segment[i], pieces)
    drive = np.empty(count)
    residual = np.inf
    for sweep in range(1, max_sweeps + 1):
        line = line_force(geometry, place)
        residual = 0.0
        for i in range(count):
            a = place[i]
            s = a - inner[i]
            product = pieces[i, 0] + s * (pieces[i, 1] + s * (pieces[i, 2] + s * pieces[i, 3]))
            force = product - restoring_force(geometry, a, load) - line[i]
            resting = direction < 0 and a <= lowest
            drive[i] = 0.0 if resting else max(direction * force, 0.0)
            residual = max(residual, drive[i] / (weight(geometry, a) * WORK_OF_ADHESION))
        if residual <= problem.tolerance:
            return CONVERGED, sweep, sweep * count, residual
        still = True
        for i in range(count):
            if drive[i] == 0.0:
                continue
            a = place[i]
            rest = outer[i] - a if direction > 0 else a - inner[i]
            piece = (pieces[i, 0], pieces[i, 1], pieces[i, 2], pieces[i, 3])
            steepest = steepest_inside(piece, a - inner[i], rest, direction)
            # It is convex: over the segment ahead its slope is largest at the outer end.
            hardening = restoring_slope(geometry, outer[i] if direction > 0 else a, load)
            stiffness = line_stiffness + hardening + steepest
            target = outer[i] if direction > 0 else max(inner[i], lowest)
            moved = a + direction * drive[i] / stiffness if stiffness > 0.0 else direction * np.inf
            if direction * (moved - target) < 0.0:
                still = still and moved == a
                place[i] = moved
                continue
            still = False
            place[i] = target
            if direction < 0 and target > inner[i]:
                continue
            low = segment[i] + direction
            if low < 0:
                return INWARD, sweep, sweep * count, residual
            if low > last:
                return OUTWARD, sweep, sweep * count, residual
            segment[i] = low
            inner[i], outer[i] = _enter(field, memory, i, low, pieces)
        if still:
            return STILL, sweep, sweep * count, residual
    return LIMIT, max_sweeps, max_sweeps * count, residual


@kernel
def sweep_from(problem, front, before, site_stiffness):
    """Move every site to where it would rest with all others held at the places before.

    This is at least as far as the reference moves it. Both its place and this are behind the first
    metastable front, so that a site which is further on already stays. The drives are those at the
    places before. Returns a code and the sum of the ways from these.
    """
    field, direction, geometry = problem.field, problem.direction, problem.field.geometry
    load, lowest, total = problem.load, problem.lowest, 0.0
    for i in range(before.size):
        place, drive, step = before[i], front.drive[i], np.inf
        if not drive > 0.1 * problem.slack:
            continue
        segment, product = locate(problem, i, place, segment_below(field, place, direction))
        for _ in range(_OWN_STEPS):
            target = sample_place(field, segment + 1 if direction > 0 else segment)
            target = target if direction > 0 else max(target, lowest)
            rest = direction * (target - place)
            reach = min(rest, GROWTH * step)
            if not (drive > 0.1 * problem.slack and reach > 0.0):
                break
            stiffness = site_stiffness + hardening(problem, i, place, product, segment, reach)
            step = min(drive / stiffness, reach) if stiffness > 0.0 else reach
            moved = target if step == rest else place + direction * step
            if moved == place:
                break
            segment, value = locate(problem, i, moved, segment)
            if segment < 0:
                return -segment, total
            rise = restoring_force(geometry, moved, load) - restoring_force(geometry, place, load)
            way = direction * (moved - place)
            drive += direction * (value - product - rise) - site_stiffness * way
            place, product = moved, value
        total += direction * (place - before[i])
        if direction * (place - front.place[i]) > 0.0:
            front.place[i], front.segment[i], front.product[i] = place, segment, product
    return CONVERGED, total
