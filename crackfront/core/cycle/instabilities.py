"""The single elastic instabilities of a branch, and the smooth motion between them.

A load step is halved until the front moves little, which is smooth motion, or until the step is
too small to matter, which is an instability. No passing makes this exact: the front at a load does
not depend on the steps that led there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.follow import Load, converged_front, follow
from crackfront.core.field.fields import Field
from crackfront.core.geometry.base import Geometry, weight, weight_slope
from crackfront.core.outcome import Direction, Status
from crackfront.core.solver.relax import Solver
from crackfront.core.variables import AREA, ENERGY, LATERAL, VERTICAL, variable

_JUMP = "instability"


@dataclass(frozen=True, slots=True)
class Motion:
    """One step between two metastable fronts."""

    start: float
    """Load of the first front, on a sphere its penetration. (Units: reduced vertical length)"""
    end: float
    """Load of the second front. (Units: as start)"""
    before: Array
    """First front, (n_site,). (Units: reduced lateral length)"""
    after: Array
    """Second front, (n_site,). (Units: reduced lateral length)"""
    unstable: bool
    """Whether the front jumped, however small the step."""


def resolved_motion(
    field: Field,
    front: Array,
    start: float,
    loads: Iterable[float],
    direction: Direction,
    *,
    travel: float,
    precision: float,
    solver: Solver | None = None,
) -> Iterator[Motion]:
    """Motion of a front from load to load, resolved into smooth steps and single instabilities.

    The steps follow each other from a metastable front (n_site,) at the load start, in direction +1
    (approach) or -1 (retraction), and end where contact is lost. A smooth step moves no site
    further than `travel` (Units: reduced lateral length). A larger motion within a step of
    `precision` (Units: reduced vertical length, as the loads) is an instability: instabilities
    closer in load come out as one. A tolerance of the solver above the precision delays them.
    ValueError if a relaxation fails.
    """
    requested: list[Load] = []
    # Loads are read from the list when a step is wanted: all steps share the samples of the field.
    steps = follow(field, front, iter(requested.pop, None), solver)

    def front_at(value: float) -> Array | None:
        requested.append(Load(value, direction, front))
        step = next(steps)
        return None if step.status is Status.LOST_CONTACT else converged_front(step, field)

    for load in loads:
        # Fronts that were found from further behind are those that a halved step arrives at.
        ahead = [(load, front_at(load))]
        while ahead:
            end, after = ahead[-1]
            moved = math.inf if after is None else float(np.max(np.abs(after - front)))
            if moved > travel and abs(end - start) > precision:
                middle = (start + end) / 2
                ahead.append((middle, front_at(middle)))
                continue
            if after is None:
                return
            yield Motion(start, end, front, after, moved > travel)
            start, front = end, after
            ahead.pop()


@dataclass(frozen=True, slots=True)
class Instabilities:
    """The instabilities of a branch, one entry each."""

    penetration: Array = variable("penetration of the instability", VERTICAL, _JUMP)
    dissipated_energy: Array = variable("energy that the instability dissipates", ENERGY, _JUMP)
    area: Array = variable("area between the fronts before and after", AREA, _JUMP)
    extent: Array = variable("width of the largest patch along the perimeter", LATERAL, _JUMP)
    before: Array = variable("front before the instability", LATERAL, _JUMP, "angle")
    after: Array = variable("front after the instability", LATERAL, _JUMP, "angle")


@dataclass(frozen=True, slots=True)
class JumpSize:
    """What one instability swept and dissipated."""

    dissipated_energy: float
    """Energy that it dissipates. (Units: reduced energy)"""
    area: float
    """Area between the fronts before and after. (Units: reduced lateral length**2)"""
    extent: float
    """Width of its largest patch along the perimeter. (Units: reduced lateral length)"""


def jump_size(jump: Motion, field: Field, travel: float) -> JumpSize:
    """What an instability swept and dissipated; travel as of :func:`resolved_motion`."""
    before, after, geometry = jump.before, jump.after, field.geometry
    return JumpSize(
        dissipated_energy=dissipated_energy(before, after, jump.end, field),
        area=float(np.sum(swept_areas(before, after, geometry))),
        extent=swept_clusters(before, after, travel, geometry)[0].extent,
    )


def measured_instabilities(jumps: Sequence[Motion], field: Field, travel: float) -> Instabilities:
    """What the jumps of one branch swept and dissipated; travel as of :func:`resolved_motion`."""
    sizes = [jump_size(jump, field, travel) for jump in jumps]
    fronts = [np.array([getattr(jump, name) for jump in jumps]) for name in ("before", "after")]
    return Instabilities(
        np.array([jump.end for jump in jumps]),
        *(
            np.array([getattr(size, name) for size in sizes])
            for name in ("dissipated_energy", "area", "extent")
        ),
        *(front.reshape(-1, field.geometry.n_site) for front in fronts),
    )


@dataclass(frozen=True, slots=True)
class Cluster:
    """A contiguous part of the perimeter that moved in one instability."""

    area: float
    """Area between the fronts. (Units: reduced lateral length**2)"""
    depth: float
    """Largest motion of a site. (Units: reduced lateral length)"""
    extent: float
    """Area over depth: the width along the perimeter of a patch that has that depth everywhere.
    (Units: reduced lateral length)"""


def swept_areas(before: Array, after: Array, geometry: Geometry) -> Array:
    """Area that each site of a front sweeps on its way to another, never negative.

    Parameters are as in :func:`swept_clusters`. (Units: reduced lateral length**2)
    """
    # The weight (on a sphere, the radius) is linear: its value in the middle makes a sector exact.
    width = weight(geometry, 0.0) + weight_slope(geometry) * (before + after) / 2
    return np.asarray(np.abs(after - before) * width * geometry.perimeter / before.size)


def swept_clusters(
    before: Array, after: Array, threshold: float, geometry: Geometry
) -> list[Cluster]:
    """Contiguous parts of the perimeter that moved by more than a threshold, the largest first.

    The front is elastic over long distances: an instability may move several of them (Laurson,
    Santucci, Zapperi, Phys. Rev. E 81, 046116, 2010). Fronts (n_site,) and threshold are in reduced
    lateral lengths.

    Examples
    --------
    >>> from crackfront.core.geometry.sphere import sphere
    >>> before, after = np.full(8, 2.0), np.array([1.5, 2, 2, 1.5, 1.5, 2, 2, 1.5])
    >>> clusters = swept_clusters(before, after, 0.1, sphere(8))
    >>> [round(item.extent / (np.pi / 4), 6) for item in clusters]
    [3.5, 3.5]
    """
    moved = np.abs(after - before)
    area = swept_areas(before, after, geometry)
    inside = moved > threshold
    if not np.any(inside):
        return []
    # Begin on a site that rests, so that no part spans the ends of the array.
    turn = -int(np.argmin(inside))
    moved, area, inside = np.roll(moved, turn), np.roll(area, turn), np.roll(inside, turn)
    edges = np.diff(inside.astype(int), prepend=0, append=0)
    clusters = []
    for first, last in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        total, depth = float(np.sum(area[first:last])), float(np.max(moved[first:last]))
        clusters.append(Cluster(total, depth, total / depth))
    return sorted(clusters, key=lambda cluster: cluster.area, reverse=True)


def shortest_instability(correlation_length: float, rms: float) -> float:
    r"""Length on which disorder is as stiff as the line, below which a front has one state.

    On it the slope of w_loc, summed along the front, equals the stiffness of the line:

    .. math:: \ell^{-1} = w_{int}^{-2} \int \frac{dq}{2\pi}\, q^2 C_w(q, 0)
              = \frac{4\pi}{\xi} \left(\frac{w_{rms}}{w_{int}}\right)^2

    for an isotropic spectrum C_w of correlation length xi, in the units of xi; the rms is in w_int.
    The factor is a convention. The paper calls it Larkin length; the Larkin length of the law of
    k, :func:`crackfront.core.adhesion.larkin_length`, is 13 times as long for a flat spectrum.

    Examples
    --------
    >>> round(shortest_instability(4 / 3, 1.0), 3)
    0.106
    """
    return correlation_length / (4 * math.pi * rms**2)
