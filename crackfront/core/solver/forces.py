"""Forces on the sites of a front and the hardening that lies ahead of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from crackfront.core.compiled import jit, kernel
from crackfront.core.field.pieces import blend, hull_until, peek_piece, polynomial, steepest_inside
from crackfront.core.field.rays import front_products, segment_below
from crackfront.core.field.samples import fetch, is_cubic, sample_count, sample_radius
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

Array = NDArray[np.float64]

RING = CONTACT_MODULUS / (2 * np.pi)
"""Factor of (a^2 - b)^2 in a G_JKR."""

CONVERGED, INWARD, OUTWARD, LIMIT, BLOCKED, TURNED, STILL = range(7)
"""Codes with which a compiled solver ends."""


class Front(NamedTuple):
    """A front with what is known of the field under it.

    Attributes
    ----------
    radius : (n_angle,) array
        Radius a of each site.
    segment : (n_angle,) int array
        Sample below the site (above it in the sense of the motion for a site on a sample).
    product : (n_angle,) array
        a w_loc under the site.
    """

    radius: Array
    segment: NDArray[np.int64]
    product: Array


@jit
def line_force(radius):
    """w_int times the half-Laplacian of a front."""
    modes = scipy.fft.rfft(radius)
    for n in range(modes.size):
        modes[n] *= WORK_OF_ADHESION * n
    return scipy.fft.irfft(modes, radius.size)


@kernel
def ring_force(radius, penetration):
    """Force a G_JKR of an open edge, zero in compression."""
    opening = radius * radius - penetration
    return RING * opening * opening if opening > 0.0 else 0.0


@jit
def front_force(radius, penetration, field):
    """Force that drives each site outward."""
    force = front_products(radius, field) - line_force(radius)
    for i in range(radius.size):
        force[i] -= ring_force(radius[i], penetration)
    return force


@kernel(inline="always")
def locate(field, memory, ray, radius, segment, direction):
    """Segment ahead of a radius that was in `segment` before it moved, and a w_loc there.

    A negative segment says that the ray ends: -INWARD or -OUTWARD.
    """
    last = sample_count(field) - 2
    if direction > 0:
        while radius >= sample_radius(field, segment + 1):
            segment += 1
            if segment > last:
                return -OUTWARD, 0.0
    else:
        while radius <= sample_radius(field, segment):
            segment -= 1
            if segment < 0:
                return -INWARD, 0.0
    inner, outer = sample_radius(field, segment), sample_radius(field, segment + 1)
    fetch(field, memory, ray, segment, segment + 1)
    piece = peek_piece(field, memory, ray, segment)
    return segment, blend(piece, (radius - inner) / (outer - inner))


@jit
def place_front(radius, field, memory, direction):
    """Front at the given radii and a code: CONVERGED, or the side on which it left the field."""
    segment = np.empty(radius.size, np.int64)
    product = np.empty(radius.size)
    code = CONVERGED
    for i in range(radius.size):
        low = segment_below(field, radius[i], direction)
        segment[i], product[i] = locate(field, memory, i, radius[i], low, direction)
        if segment[i] < 0:
            code = -segment[i]
    return Front(radius, segment, product), code


@kernel(inline="always")
def hardening(field, memory, ray, radius, product, segment, reach, penetration, direction):
    """Stiffness D >= (f(0) - f(s)) / s for 0 < s <= reach, f the site's own drive after s.

    On the piece under the site the steepest chord of a w_loc is exact; further pieces lie in the
    hull of their control points, so that no chord is steeper than the steepest to one of those.
    a G is convex: its slope at the outer end bounds its chords.
    """
    furthest = radius + reach if direction > 0 else radius
    opening = furthest * furthest - penetration
    ring = 4 * RING * furthest * opening if opening > 0.0 else 0.0
    last = sample_count(field) - 2
    inner, outer = sample_radius(field, segment), sample_radius(field, segment + 1)
    inverse = 1.0 / (outer - inner)
    further = int(reach * inverse) + 1
    if direction > 0:
        fetch(field, memory, ray, segment, min(segment + 1 + further, last + 1))
    else:
        fetch(field, memory, ray, max(segment - further, 0), segment + 1)
    distance = outer - radius if direction > 0 else radius - inner
    piece = peek_piece(field, memory, ray, segment)
    cubic = is_cubic(field)
    coefficients = polynomial(field, piece, outer - inner)
    steepest = steepest_inside(coefficients, radius - inner, min(reach, distance), direction)
    segment += direction
    while distance < reach and 0 <= segment <= last:
        width = sample_radius(field, segment + 1) - sample_radius(field, segment)
        part = min(1.0, (reach - distance) / width)
        piece = peek_piece(field, memory, ray, segment)
        if cubic:
            first, second, end = hull_until(piece, part, direction)
            third = part * width / 3
            steepest = max(steepest, direction * (product - first) / (distance + third))
            steepest = max(steepest, direction * (product - second) / (distance + 2 * third))
        else:
            near, far = (piece[0], piece[3]) if direction > 0 else (piece[3], piece[0])
            end = near + part * (far - near)
        chord = direction * (product - end) / (distance + part * width)
        steepest = max(steepest, chord)
        distance += width
        segment += direction
    return steepest + ring


@jit
def drive_sites(front, penetration, direction, drive):
    """Fill in the force along the motion; return its largest and least value relative to w_int."""
    radius, product = front.radius, front.product
    line = line_force(radius)
    most, least = 0.0, 0.0
    for i in range(drive.size):
        drive[i] = direction * (product[i] - ring_force(radius[i], penetration) - line[i])
        relative = drive[i] / (radius[i] * WORK_OF_ADHESION)
        most, least = max(most, relative), min(least, relative)
    return most, least


@kernel
def is_compressed(radius, step, penetration):
    """Whether a receding site would come to lie where its edge is in compression."""
    moved = radius - step
    return moved * abs(moved) <= penetration
