"""A front at a load, the forces on its sites, and how far ahead these are valid."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.core.compiled import jit, kernel
from crackfront.core.field.pieces import blend, hull_until, peek_piece, polynomial, steepest_inside
from crackfront.core.field.rays import front_products, segment_below
from crackfront.core.field.samples import (
    SampleMemory,
    distance_ahead,
    fetch,
    is_cubic,
    peek,
    sample_count,
    sample_place,
)
from crackfront.core.geometry.base import (
    lowest_place,
    mode_stiffness,
    restoring_force,
    restoring_slope,
    weight,
)
from crackfront.core.units import WORK_OF_ADHESION

CONVERGED, INWARD, OUTWARD, LIMIT, BLOCKED, TURNED, STILL, NEEDLES = range(8)
"""Codes with which a compiled solver ends."""

RIGID = 10.0
"""Ratio of a site's own stiffness to the line's against it, above which it is a needle."""

GROWTH = 8
"""Longest step of a site, over the longest distance that its step before looked ahead."""


class Problem(NamedTuple):
    """What all kernels of a relaxation share.

    Attributes
    ----------
    field : Field
        Work of adhesion along the rays.
    memory : SampleMemory
        Samples of the field near the front.
    load : float
        Load of the geometry.
    direction : int
        1 where the front advances, -1 where it recedes.
    tolerance : float
        Largest drive that may be left, relative to w_int.
    lowest : float
        Place at which a receding site rests in any case; -inf where it leaves the field before.
    furthest : float
        Longest step of a site.
    slack : float
        Backward drive up to which a site counts as at rest.
    """

    field: Any
    memory: SampleMemory
    load: float
    direction: int
    tolerance: float
    lowest: float
    furthest: float
    slack: float


def make_problem(
    start: Array, load: float, direction: int, field: Any, memory: SampleMemory, tolerance: float
) -> Problem:
    """Relaxation of a front from its start."""
    lowest = float(lowest_place(field.geometry, load))
    if direction > 0 or lowest <= sample_place(field, 0):
        lowest = -np.inf
    slack = tolerance * WORK_OF_ADHESION * weight(field.geometry, float(np.min(start)))
    ahead = distance_ahead(field)
    return Problem(field, memory, load, direction, tolerance, lowest, ahead, slack)


class Front(NamedTuple):
    """A front, the field under it and the force on it; (n_site,) arrays.

    Attributes
    ----------
    place : array
        Places of the sites.
    segment : int array
        Sample below each site (above it in the sense of the motion for a site on a sample).
    product : array
        Weighted work of adhesion under each site.
    drive : array
        Force along the motion, -inf for a site at rest at the lowest place.
    """

    place: Array
    segment: NDArray[np.int64]
    product: Array
    drive: Array


@kernel
def largest_entry(vector):
    """Largest absolute value."""
    a = b = c = d = vector.dtype.type(0.0)
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
def largest_positive(vector):
    """Largest entry, 0 if none is positive."""
    largest = 0.0
    for value in vector:
        largest = max(largest, value)
    return largest


@jit
def line_force(geometry, front):
    """Force of the line on each site against its advance."""
    modes = scipy.fft.rfft(front)
    _stiffen(geometry, modes.view(np.float64))
    return scipy.fft.irfft(modes, front.size)


@kernel
def _stiffen(geometry, modes):
    """Multiply modes, given as real and imaginary parts in turn, by the stiffness of the line."""
    for n in range(modes.size // 2):
        stiffness = mode_stiffness(geometry, n)
        modes[2 * n] *= stiffness
        modes[2 * n + 1] *= stiffness


@jit
def front_force(front, load, field):
    """Force that drives each site outward."""
    force = front_products(front, field) - line_force(field.geometry, front)
    for i in range(front.size):
        force[i] -= restoring_force(field.geometry, front[i], load)
    return force


@kernel(inline="always")
def locate(problem, ray, place, segment):
    """Segment ahead of a place that was in `segment` before it moved, and the product there.

    A negative segment says that the ray ends: -INWARD or -OUTWARD. A site on the first sample may
    rest there, and leaves only as it moves on.
    """
    field = problem.field
    last = sample_count(field) - 2
    if problem.direction > 0:
        while place >= sample_place(field, segment + 1):
            segment += 1
            if segment > last:
                return -OUTWARD, 0.0
    else:
        while segment > 0 and place <= sample_place(field, segment):
            segment -= 1
        if place < sample_place(field, segment):
            return -INWARD, 0.0
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    fetch(field, problem.memory, ray, segment, segment + 1)
    piece = peek_piece(field, problem.memory, ray, segment)
    return segment, blend(piece, (place - inner) / (outer - inner))


@kernel
def place_sites(problem, front):
    """Find the segments and products under a front.

    Returns CONVERGED, or the side on which a site has left the field.
    """
    code = CONVERGED
    for i in range(front.place.size):
        segment = segment_below(problem.field, front.place[i], problem.direction)
        front.segment[i], front.product[i] = locate(problem, i, front.place[i], segment)
        if front.segment[i] < 0:
            code = -front.segment[i]
    return code


@kernel(inline="always")
def hardening(problem, ray, place, product, segment, reach):
    """Stiffness D >= (f(0) - f(s)) / s for 0 < s <= reach, f the site's own drive after s.

    Pieces lie in the hull of their control points, so that no chord of the product is steeper than
    the steepest to one of those; of straight pieces only the ends count.
    The slope of the restoring force increases and is convex: no chord outward is steeper than the
    mean of the slopes at its ends, none inward steeper than that under the site.
    """
    field, memory, direction = problem.field, problem.memory, problem.direction
    restoring = restoring_slope(field.geometry, place, problem.load)
    if direction > 0:
        ahead = restoring_slope(field.geometry, place + reach, problem.load)
        restoring = 0.5 * (restoring + ahead)
    last = sample_count(field) - 2
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    inverse = 1.0 / (outer - inner)
    further = int(reach * inverse) + 1
    if direction > 0:
        fetch(field, memory, ray, segment, min(segment + 1 + further, last + 1))
    else:
        fetch(field, memory, ray, max(segment - further, 0), segment + 1)
    distance = outer - place if direction > 0 else place - inner
    piece = peek_piece(field, memory, ray, segment)
    if not is_cubic(field):
        steepest = (piece[0] - piece[3]) * inverse
        sample, end = (segment + 1, piece[3]) if direction > 0 else (segment, piece[0])
        while distance < reach and 0 <= sample + direction <= last + 1:
            before, near = distance, end
            sample += direction
            distance = direction * (sample_place(field, sample) - place)
            end, _ = peek(field, memory, ray, sample)
            if distance > reach:
                end = near + (reach - before) / (distance - before) * (end - near)
                distance = reach
            steepest = max(steepest, direction * (product - end) / distance)
        return steepest + restoring
    coefficients = polynomial(field, piece, outer - inner)
    steepest = steepest_inside(coefficients, place - inner, min(reach, distance), direction)
    segment += direction
    while distance < reach and 0 <= segment <= last:
        width = sample_place(field, segment + 1) - sample_place(field, segment)
        until = min(distance + width, reach)
        piece = peek_piece(field, memory, ray, segment)
        part = (until - distance) / width
        first, second, end = hull_until(piece, part, direction)
        third = part * width / 3
        steepest = max(steepest, direction * (product - first) / (distance + third))
        steepest = max(steepest, direction * (product - second) / (distance + 2 * third))
        steepest = max(steepest, direction * (product - end) / until)
        distance += width
        segment += direction
    return steepest + restoring


@kernel(inline="always")
def following(site, count):
    """Site after another, as a number without a sign: others may count from the end."""
    after = site + np.uint64(1)
    return after if after < np.uint64(count) else np.uint64(0)


@kernel(fastmath={"contract", "nnan", "nsz"})
def harden(problem, front, first, step, part, reach, stiffness):
    """Raise reaches to part of the steps, and stiffnesses to values that are valid over them.

    The arrays have one entry for each site from `first` on. Returns whether a stiffness grew.
    """
    place, segment, product = front.place, front.segment, front.product
    grew = False
    i = np.uint64(first)
    for j in range(step.size):
        if part * step[j] > reach[j]:
            reach[j] = part * step[j]
            ahead = hardening(problem, i, place[i], product[i], segment[i], reach[j])
            grew = grew or ahead > stiffness[j]
            stiffness[j] = max(ahead, stiffness[j])
        i = following(i, place.size)
    return grew


@kernel
def touch_samples(problem, front, first, values):
    """Read the sample under each of the sites from `first` on, to bring them into the cache.

    The reads do not wait for one another, as those between the computations of bounds do.
    """
    i = np.uint64(first)
    for j in range(values.size):
        values[j] = peek(problem.field, problem.memory, i, front.segment[i])[0]
        i = following(i, front.place.size)


@kernel
def drive_sites(problem, front, line):
    """Compute the drives from the forces of the line.

    Returns the largest and the least relative to w_int, without sites at rest at the lowest
    place.
    """
    place, product, drive = front.place, front.product, front.drive
    geometry, load, direction = problem.field.geometry, problem.load, problem.direction
    most, least = 0.0, 0.0
    for i in range(np.uint64(place.size)):
        drive[i] = direction * (product[i] - restoring_force(geometry, place[i], load) - line[i])
        if place[i] <= problem.lowest:
            drive[i] = -np.inf
            continue
        relative = drive[i] / (weight(geometry, place[i]) * WORK_OF_ADHESION)
        most, least = max(most, relative), min(least, relative)
    return most, least
