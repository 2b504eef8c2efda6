"""The paper's algorithm (Rosso and Krauth), the reference for every other solver."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.arrays import Array
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
from crackfront.core.solver.codes import Code
from crackfront.core.solver.forces import GROWTH, line_force, locate
from crackfront.core.solver.hardening import hardening
from crackfront.core.units import WORK_OF_ADHESION

_MOST_SITE_STEPS = 8
"""Most steps of a site to where it would rest with all others fixed.

More would move sites further in a sweep; the next sweep goes on from where these end.
"""

_LEAST_DRIVE = 0.1
"""Drive above which a site is moved, over the backward drive up to which it counts as at rest."""


class Sites(NamedTuple):
    """Sites of a front and the segments of the field that they are in; one entry a site.

    Attributes
    ----------
    place : array
        Places of the sites.
    segment : int array
        Segment of each site.
    inner, outer : array
        Ends of the segments.
    pieces : (n_site, 4) array
        Coefficients of the product in a segment, in the distance from its inner end.
    drive : array
        Force along the motion, 0 where it is backward.
    """

    place: Array
    segment: NDArray[np.int64]
    inner: Array
    outer: Array
    pieces: Array
    drive: Array


@jit
def rosso_krauth(place, task, max_sweeps):
    """Move every site by its own force over its own stiffness, at most to the next sample.

    The places are changed. What a site leaves out when it moves, the pull of its neighbours' moves,
    only pushes it on: no barrier is ever passed. The stiffness of a cubic piece is the slope of its
    steepest chord from the site to the next sample; a linear piece has only one. Returns a code,
    the numbers of sweeps and of updates of a site, and the largest drive left.
    """
    n_site, geometry = place.size, task.field.geometry
    line_stiffness = mode_stiffness(geometry, 1) * self_modes(n_site)
    lowest = lowest_place(geometry, task.load)
    sites = _enter_field(place, task)
    residual = np.inf
    for sweep in range(1, max_sweeps + 1):
        residual = _drive_sites(sites, task, lowest, line_force(geometry, place))
        if residual <= task.tolerance:
            return Code.CONVERGED, sweep, sweep * n_site, residual
        has_moved = False
        for i in range(n_site):
            if sites.drive[i] == 0.0:
                continue
            code, site_has_moved = _advance_site(sites, task, i, line_stiffness, lowest)
            if code != Code.MOVING:
                return code, sweep, sweep * n_site, residual
            has_moved |= site_has_moved
        if not has_moved:
            return Code.STANDS_STILL, sweep, sweep * n_site, residual
    return Code.SWEEP_LIMIT, max_sweeps, max_sweeps * n_site, residual


@jit
def _enter_field(place, task):
    """Sites at some places, with the segments that they are in."""
    n_site = place.size
    sites = Sites(
        place=place,
        segment=np.empty(n_site, np.int64),
        inner=np.empty(n_site),
        outer=np.empty(n_site),
        pieces=np.empty((n_site, 4)),
        drive=np.empty(n_site),
    )
    for i in range(n_site):
        _enter_segment(sites, task, i, segment_below(task.field, place[i], task.direction))
    return sites


@kernel
def _enter_segment(sites, task, i, segment):
    """Let a site come to a segment: store the ends and the polynomial of the segment."""
    field, memory = task.field, task.memory
    inner, outer = sample_place(field, segment), sample_place(field, segment + 1)
    fetch(field, memory, i, segment, segment + 1)
    piece = polynomial(field, peek_piece(field, memory, i, segment), outer - inner)
    sites.segment[i], sites.inner[i], sites.outer[i] = segment, inner, outer
    for k in range(4):
        sites.pieces[i, k] = piece[k]


@kernel
def _drive_sites(sites, task, lowest, line):
    """Compute the drives from the forces of the line; return the largest, relative to w_int."""
    geometry, load, direction, pieces = task.field.geometry, task.load, task.direction, sites.pieces
    residual = 0.0
    for i in range(sites.place.size):
        place = sites.place[i]
        x = place - sites.inner[i]
        product = pieces[i, 0] + x * (pieces[i, 1] + x * (pieces[i, 2] + x * pieces[i, 3]))
        force = product - restoring_force(geometry, place, load) - line[i]
        resting = direction < 0 and place <= lowest
        sites.drive[i] = 0.0 if resting else max(direction * force, 0.0)
        residual = max(residual, sites.drive[i] / (weight(geometry, place) * WORK_OF_ADHESION))
    return residual


@kernel
def _advance_site(sites, task, i, line_stiffness, lowest):
    """Move a site by its drive over its stiffness, at most to the next sample or the lowest place.

    Returns MOVING, or the code of a site that leaves the field, and whether the site has moved.
    """
    place, direction = sites.place[i], task.direction
    inner, outer = sites.inner[i], sites.outer[i]
    target = outer if direction > 0 else max(inner, lowest)
    stiffness = _site_stiffness(sites, task, i, line_stiffness)
    moved = direction * np.inf
    if stiffness > 0.0:
        moved = place + direction * sites.drive[i] / stiffness
    if direction * (moved - target) < 0.0:
        sites.place[i] = moved
        return Code.MOVING, moved != place
    sites.place[i] = target
    segment = sites.segment[i] + direction
    if direction < 0 and target > inner:
        # It rests at the lowest place, within its segment.
        return Code.MOVING, True
    if segment < 0:
        return Code.LEFT_FIELD_INWARD, True
    if segment > sample_count(task.field) - 2:
        return Code.LEFT_FIELD_OUTWARD, True
    _enter_segment(sites, task, i, segment)
    return Code.MOVING, True


@kernel
def _site_stiffness(sites, task, i, line_stiffness):
    """Stiffness of a site up to the next sample: of the line, the load and the field."""
    geometry, direction = task.field.geometry, task.direction
    place, inner, outer, pieces = sites.place[i], sites.inner[i], sites.outer[i], sites.pieces
    reach = outer - place if direction > 0 else place - inner
    piece = (pieces[i, 0], pieces[i, 1], pieces[i, 2], pieces[i, 3])
    steepest = steepest_inside(piece, place - inner, reach, direction)
    # The restoring force is convex: over the segment ahead its slope is largest at the outer end.
    restoring = restoring_slope(geometry, outer if direction > 0 else place, task.load)
    return line_stiffness + restoring + steepest


@kernel
def sweep_from(task, front, before, site_stiffness):
    """Move every site to where it would rest with all others fixed at the places before.

    This is at least as far as the reference moves it. Both its place and this are behind the first
    metastable front, so that a site which is further on already stays. The drives are those at the
    places before. Returns a code and the sum of the distances from these.
    """
    direction = task.direction
    total = 0.0
    for i in range(before.size):
        if not front.drive[i] > _LEAST_DRIVE * task.slack:
            continue
        code, place, segment, product = _rest_alone(
            task, i, before[i], front.drive[i], site_stiffness
        )
        if code != Code.MOVING:
            return code, total
        total += direction * (place - before[i])
        if direction * (place - front.place[i]) > 0.0:
            front.place[i], front.segment[i], front.product[i] = place, segment, product
    return Code.MOVING, total


@kernel
def _rest_alone(task, i, place, drive, site_stiffness):
    """Where a site would rest with all others fixed: a code, its place, segment and product."""
    field, direction, geometry = task.field, task.direction, task.field.geometry
    load, slack = task.load, _LEAST_DRIVE * task.slack
    step = np.inf
    code, segment, product = locate(task, i, place, segment_below(field, place, direction))
    for _ in range(_MOST_SITE_STEPS):
        target = sample_place(field, segment + 1 if direction > 0 else segment)
        target = target if direction > 0 else max(target, task.lowest)
        to_target = direction * (target - place)
        reach = min(to_target, GROWTH * step)
        if not (drive > slack and reach > 0.0):
            break
        stiffness = site_stiffness + hardening(task, i, place, product, segment, reach)
        step = min(drive / stiffness, reach) if stiffness > 0.0 else reach
        moved = target if step == to_target else place + direction * step
        if moved == place:
            break
        code, segment, value = locate(task, i, moved, segment)
        if code != Code.MOVING:
            break
        rise = restoring_force(geometry, moved, load) - restoring_force(geometry, place, load)
        distance = direction * (moved - place)
        drive += direction * (value - product - rise) - site_stiffness * distance
        place, product = moved, value
    return code, place, segment, product
