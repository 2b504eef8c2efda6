"""Forces on the sites of a front and the hardening that lies ahead of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.pieces import blend, hull_until, peek_piece, polynomial, steepest_inside
from crackfront.core.field.rays import front_products, segment_below
from crackfront.core.field.samples import fetch, is_cubic, peek, sample_count, sample_place
from crackfront.core.geometry.base import (
    lowest_place,
    mode_stiffness,
    restoring_force,
    restoring_slope,
    weight,
)
from crackfront.core.units import WORK_OF_ADHESION

Array = NDArray[np.float64]

CONVERGED, INWARD, OUTWARD, LIMIT, BLOCKED, TURNED, STILL = range(7)
"""Codes with which a compiled solver ends."""


class Front(NamedTuple):
    """A front with what is known of the field under it.

    Attributes
    ----------
    place : (n_site,) array
        Place of each site.
    segment : (n_site,) int array
        Sample below the site (above it in the sense of the motion for a site on a sample).
    product : (n_site,) array
        Weighted work of adhesion under the site.
    """

    place: Array
    segment: NDArray[np.int64]
    product: Array


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


@jit
def line_force(geometry, front):
    """Force of the line on each site against its advance."""
    modes = scipy.fft.rfft(front)
    _stiffen(geometry, modes.view(np.float64))
    return scipy.fft.irfft(modes, front.size)


@kernel
def _stiffen(geometry, modes):
    """Multiply modes, given as real and imaginary parts in turn, by their stiffness."""
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
def locate(field, memory, ray, place, segment, direction):
    """Segment ahead of a place that was in `segment` before it moved, and the product there.

    A negative segment says that the ray ends: -INWARD or -OUTWARD. A site on the first sample may
    rest there, and leaves only as it moves on.
    """
    last = sample_count(field) - 2
    if direction > 0:
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
    fetch(field, memory, ray, segment, segment + 1)
    piece = peek_piece(field, memory, ray, segment)
    return segment, blend(piece, (place - inner) / (outer - inner))


@kernel
def place_sites(front, field, memory, direction, low, high):
    """Find the segments and products of some sites of a front.

    Returns CONVERGED, or the side on which one left the field.
    """
    code = CONVERGED
    for i in range(low, high):
        segment = segment_below(field, front.place[i], direction)
        front.segment[i], front.product[i] = locate(
            field, memory, i, front.place[i], segment, direction
        )
        if front.segment[i] < 0:
            code = -front.segment[i]
    return code


@kernel(inline="always")
def hardening(field, memory, ray, place, product, segment, reach, load, direction):
    """Stiffness D >= (f(0) - f(s)) / s for 0 < s <= reach, f the site's own drive after s.

    Pieces lie in the hull of their control points, so that no chord of the product is steeper than
    the steepest to one of those; of straight pieces only the ends count.
    The slope of the restoring force increases and is convex: no chord outward is steeper than the
    mean of the slopes at its ends, none inward steeper than that under the site.
    """
    restoring = restoring_slope(field.geometry, place, load)
    if direction > 0:
        restoring = 0.5 * (restoring + restoring_slope(field.geometry, place + reach, load))
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
def harden(field, memory, front, first, step, part, reach, stiffness, load, direction):
    """Let reaches grow to part of the steps, and stiffnesses to what holds over them.

    The arrays have one entry for each site from `first` on. Returns whether a stiffness grew.
    """
    place, segment, product = front.place, front.segment, front.product
    grew = False
    i = np.uint64(first)
    for j in range(step.size):
        if part * step[j] > reach[j]:
            reach[j] = part * step[j]
            ahead = hardening(
                field, memory, i, place[i], product[i], segment[i], reach[j], load, direction
            )
            grew = grew or ahead > stiffness[j]
            stiffness[j] = max(ahead, stiffness[j])
        i = following(i, place.size)
    return grew


@kernel
def touch_samples(field, memory, front, first, values):
    """Read the sample under each of the sites from `first` on, so that it is at hand.

    The reads do not wait for one another, as those between the computations of bounds do.
    """
    i = np.uint64(first)
    for j in range(values.size):
        values[j] = peek(field, memory, i, front.segment[i])[0]
        i = following(i, front.place.size)


@jit
def resting_place(field, load, direction):
    """Lowest place, where a site that recedes rests; -inf where it leaves the field before."""
    lowest = lowest_place(field.geometry, load)
    return lowest if direction < 0 and lowest > sample_place(field, 0) else -np.inf


@kernel
def drive_sites(geometry, front, line, load, direction, lowest, drive, low, high):
    """Fill in the force along the motion of some sites, `line` being that of the line.

    Returns its largest and least value relative to w_int. Sites that rest at the lowest place are
    driven back without bound, and do not count.
    """
    place, product = front.place, front.product
    most, least = 0.0, 0.0
    for i in range(np.uint64(low), np.uint64(high)):
        drive[i] = direction * (product[i] - restoring_force(geometry, place[i], load) - line[i])
        if place[i] <= lowest:
            drive[i] = -np.inf
            continue
        relative = drive[i] / (weight(geometry, place[i]) * WORK_OF_ADHESION)
        most, least = max(most, relative), min(least, relative)
    return most, least
