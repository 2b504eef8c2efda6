"""How much a site's own force falls on the way ahead: the bound that makes a step safe."""

from __future__ import annotations

import numpy as np

from crackfront.core.compiled import kernel
from crackfront.core.field.pieces import hull_until, peek_piece, polynomial, steepest_inside
from crackfront.core.field.samples import fetch, is_cubic, peek, sample_count, sample_place
from crackfront.core.geometry.base import restoring_slope
from crackfront.core.solver.forces import following


@kernel(inline="always")
def hardening(task, ray, place, product, segment, reach):
    """Stiffness D >= (f(0) - f(s)) / s for 0 < s <= reach, f the site's own drive after s.

    It is the steepest fall of the product plus the steepest rise of the restoring force.
    """
    _fetch_ahead(task, ray, segment, reach)
    if is_cubic(task.field):
        steepest = _steepest_cubic(task, ray, place, product, segment, reach)
    else:
        steepest = _steepest_straight(task, ray, place, product, segment, reach)
    return steepest + _restoring_stiffness(task, place, reach)


@kernel(inline="always")
def _restoring_stiffness(task, place, reach):
    """Bound on the chords of the restoring force, whose slope increases and is convex.

    No chord outward is steeper than the mean of the slopes at its ends, none inward is steeper than
    the slope under the site.
    """
    slope = restoring_slope(task.field.geometry, place, task.load)
    if task.direction > 0:
        ahead = restoring_slope(task.field.geometry, place + reach, task.load)
        slope = 0.5 * (slope + ahead)
    return slope


@kernel(inline="always")
def _fetch_ahead(task, ray, segment, reach):
    """Make sure that the memory contains the samples that a site may pass within its reach."""
    field = task.field
    width = sample_place(field, segment + 1) - sample_place(field, segment)
    further = int(reach * (1.0 / width)) + 1
    if task.direction > 0:
        last = sample_count(field) - 1
        fetch(field, task.memory, ray, segment, min(segment + 1 + further, last))
    else:
        fetch(field, task.memory, ray, max(segment - further, 0), segment + 1)


@kernel(inline="always")
def _steepest_straight(task, ray, place, product, segment, reach):
    """Steepest fall of the product along straight pieces: the chords to their ends bound it."""
    field, memory, direction = task.field, task.memory, task.direction
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    piece = peek_piece(field, memory, ray, segment)
    steepest = (piece[0] - piece[3]) * (1.0 / (outer - inner))
    if direction > 0:
        sample, distance, end = segment + 1, outer - place, piece[3]
        last = sample_count(field) - 1
    else:
        sample, distance, end = segment, place - inner, piece[0]
        last = 0
    while distance < reach and sample != last:
        start, start_distance = end, distance
        sample += direction
        distance = direction * (sample_place(field, sample) - place)
        end, _ = peek(field, memory, ray, sample)
        if distance > reach:
            part = (reach - start_distance) / (distance - start_distance)
            end = start + part * (end - start)
            distance = reach
        steepest = max(steepest, direction * (product - end) / distance)
    return steepest


@kernel(inline="always")
def _steepest_cubic(task, ray, place, product, segment, reach):
    """Steepest fall of the product along cubic pieces.

    Pieces lie in the hull of their control points, so that no chord is steeper than the steepest to
    one of those.
    """
    field, memory, direction = task.field, task.memory, task.direction
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    distance = outer - place if direction > 0 else place - inner
    last = sample_count(field) - 2 if direction > 0 else 0
    coefficients = polynomial(field, peek_piece(field, memory, ray, segment), outer - inner)
    steepest = steepest_inside(coefficients, place - inner, min(reach, distance), direction)
    while distance < reach and segment != last:
        segment += direction
        width = sample_place(field, segment + 1) - sample_place(field, segment)
        until = min(distance + width, reach)
        part = (until - distance) / width
        piece = peek_piece(field, memory, ray, segment)
        first, second, end = hull_until(piece, part, direction)
        third = part * width / 3
        steepest = max(steepest, direction * (product - first) / (distance + third))
        steepest = max(steepest, direction * (product - second) / (distance + 2 * third))
        steepest = max(steepest, direction * (product - end) / until)
        distance += width
    return steepest


@kernel(fastmath={"contract", "nnan", "nsz"})
def harden(task, front, first, step, part, reach, stiffness):
    """Raise reaches to part of the steps, and stiffnesses to values that are valid over them.

    The arrays have one entry for each site from `first` on. Returns whether a stiffness grew.
    """
    place, segment, product = front.place, front.segment, front.product
    grew = False
    i = np.uint64(first)
    for j in range(step.size):
        if part * step[j] > reach[j]:
            reach[j] = part * step[j]
            ahead = hardening(task, i, place[i], product[i], segment[i], reach[j])
            grew = grew or ahead > stiffness[j]
            stiffness[j] = max(ahead, stiffness[j])
        i = following(i, place.size)
    return grew
