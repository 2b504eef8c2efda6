"""A front at a load and the forces on its sites."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.core.compiled import jit, kernel
from crackfront.core.field.pieces import blend, peek_piece
from crackfront.core.field.rays import front_products, segment_below
from crackfront.core.field.samples import (
    SampleMemory,
    distance_ahead,
    fetch,
    peek,
    sample_count,
    sample_place,
)
from crackfront.core.geometry.base import (
    lowest_place,
    mode_stiffness,
    restoring_force,
    weight,
)
from crackfront.core.solver.codes import Code
from crackfront.core.units import WORK_OF_ADHESION

RIGID = 10.0
"""Stiffness of a site's own force, over the line's against it, above which the site is a needle."""

GROWTH = 8
"""Longest step of a site, relative to the longest distance that its step before looked ahead.

A larger ratio crosses smooth parts in fewer steps, but bounds over longer ways are looser.
"""


class RelaxationTask(NamedTuple):
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


def make_task(
    start: Array, load: float, direction: int, field: Any, memory: SampleMemory, tolerance: float
) -> RelaxationTask:
    """Relaxation of a front from its start."""
    lowest = float(lowest_place(field.geometry, load))
    if direction > 0 or lowest <= sample_place(field, 0):
        lowest = -np.inf
    slack = tolerance * WORK_OF_ADHESION * weight(field.geometry, float(np.min(start)))
    return RelaxationTask(
        field=field,
        memory=memory,
        load=load,
        direction=direction,
        tolerance=tolerance,
        lowest=lowest,
        furthest=distance_ahead(field),
        slack=slack,
    )


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
def locate(task, ray, place, segment):
    """Code, segment ahead of a place that was in `segment` before it moved, and the product there.

    The code says whether the place lies inside the field. A site on the first sample may rest
    there, and leaves only as it moves on.
    """
    field = task.field
    last = sample_count(field) - 2
    if task.direction > 0:
        while place >= sample_place(field, segment + 1):
            segment += 1
            if segment > last:
                return Code.LEFT_FIELD_OUTWARD, segment, 0.0
    else:
        while segment > 0 and place <= sample_place(field, segment):
            segment -= 1
        if place < sample_place(field, segment):
            return Code.LEFT_FIELD_INWARD, segment, 0.0
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    fetch(field, task.memory, ray, segment, segment + 1)
    piece = peek_piece(field, task.memory, ray, segment)
    return Code.MOVING, segment, blend(piece, (place - inner) / (outer - inner))


@kernel
def place_sites(task, front):
    """Find segments and products under a front; return MOVING, or the code of a site outside."""
    code = Code.MOVING
    for i in range(front.place.size):
        below = segment_below(task.field, front.place[i], task.direction)
        end, front.segment[i], front.product[i] = locate(task, i, front.place[i], below)
        if end != Code.MOVING:
            code = end
    return code


@kernel(inline="always")
def following(site, count):
    """Site after another, as a number without a sign: others may count from the end."""
    after = site + np.uint64(1)
    return after if after < np.uint64(count) else np.uint64(0)


@kernel
def touch_samples(task, front, first, values):
    """Read the sample under each of the sites from `first` on, to bring them into the cache.

    The reads do not wait for one another, as those between the computations of bounds do.
    """
    i = np.uint64(first)
    for j in range(values.size):
        values[j] = peek(task.field, task.memory, i, front.segment[i])[0]
        i = following(i, front.place.size)


@kernel
def drive_sites(task, front, line):
    """Compute the drives from the forces of the line.

    Returns the largest and the least relative to w_int, without sites at rest at the lowest
    place.
    """
    place, product, drive = front.place, front.product, front.drive
    geometry, load, direction = task.field.geometry, task.load, task.direction
    most, least = 0.0, 0.0
    for i in range(np.uint64(place.size)):
        drive[i] = direction * (product[i] - restoring_force(geometry, place[i], load) - line[i])
        if place[i] <= task.lowest:
            drive[i] = -np.inf
            continue
        relative = drive[i] / (weight(geometry, place[i]) * WORK_OF_ADHESION)
        most, least = max(most, relative), min(least, relative)
    return most, least
