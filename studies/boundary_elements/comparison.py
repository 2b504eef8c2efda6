"""Differences of the crack front from the boundary elements of one case, and jumps of both."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.outcome import Direction
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable
from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.front import FrontCycle, perimeter_at, shared_states
from studies.boundary_elements.parameters import Case

Array = NDArray[np.float64]

_SAME_PLACE, _SAME_LOAD = 1.0, 0.1
"""Largest distance of matched jumps along the front, in short cutoffs, and in penetration."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """Differences of one front model from the boundary elements of one case."""

    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    rotated: int = variable("1 where the crack turns with the angle, else 0", "1")
    begin: float = variable(
        "penetration from which on approach is compared, inf where it is not", VERTICAL
    )
    force_mean: float = variable("mean difference of the force", FORCE)
    force_median: float = variable("median of the magnitude of the difference", FORCE)
    force_rms: float = variable("rms difference of the force", FORCE)
    force_largest: float = variable("largest difference of the force", FORCE)
    area_mean: float = variable("mean difference of the contact area, relative", "1")
    area_rms: float = variable("rms difference of the contact area, relative", "1")
    perimeter_approach: float = variable(
        "mean distance of the perimeters at the shown penetration, approach", "short cutoff"
    )
    perimeter_retraction: float = variable("the same in retraction", "short cutoff")
    perimeter_all: float = variable("mean distance over all common states", "short cutoff")
    jumps_boundary: int = variable("jumps of a quarter of a cutoff or more, boundary", "1")
    jumps_front: int = variable("jumps of a quarter of a cutoff or more, front", "1")
    jumps_shared: int = variable("of the front's, those that the boundary elements share", "1")
    jump_shift: float = variable("mean of their penetrations, boundary minus front", VERTICAL)
    jump_spread: float = variable("rms of their difference of penetration", VERTICAL)
    pull_off_force: float = variable("lowest force, boundary minus front", FORCE)
    pull_off_penetration: float = variable("end of contact, boundary minus front", VERTICAL)
    boundary_seconds: float = variable("processor time of the boundary elements", "s")
    mapping_seconds: float = variable("processor time of the field", "s")
    front_seconds: float = variable("processor time of the front", "s")


@dataclass(frozen=True, slots=True)
class Jump:
    """An arc of the perimeter that moved far in one load step."""

    penetration: float = variable("penetration at which it had moved", VERTICAL)
    direction: int = variable("+1 in approach, -1 in retraction", "1")
    angle: float = variable("where it moved furthest", "rad")
    distance: float = variable("how far it moved there", LATERAL)


@dataclass(frozen=True, slots=True)
class SharedJumps:
    """Numbers of large jumps, and pairs of those of the boundary elements and of the front."""

    pairs: tuple[tuple[Jump, Jump], ...]
    n_boundary: int
    n_front: int


def comparison(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> Comparison:
    """Differences of a front from the boundary elements of its case, where both have contact.

    The boundary elements jump into contact too early, by the range of their attraction, and with a
    larger radius; approach is compared from where their perimeter has left that one everywhere.
    """
    states = front.states
    theirs, ours = _compared_states(case, boundary, front)
    force = boundary.force[theirs] - states.force[ours]
    area = boundary.contact_area[theirs] / states.contact_area[ours] - 1
    apart = np.abs(boundary.radius[theirs] - front.radius[ours])
    compared = states.penetration[ours][states.direction[ours] > 0]
    shared = shared_jumps(case, boundary, front)
    shift = np.array([one.penetration - other.penetration for one, other in shared.pairs])
    return Comparison(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=rough_adhesion(case.heights(), case.pixel).e_el,
        rotated=int(front.rotated),
        begin=float(np.min(compared, initial=math.inf)),
        force_mean=float(np.mean(force)),
        force_median=float(np.median(np.abs(force))),
        force_rms=_rms(force),
        force_largest=float(np.max(np.abs(force))),
        area_mean=float(np.mean(area)),
        area_rms=_rms(area),
        perimeter_approach=_shown_distance(case, boundary, front, 1),
        perimeter_retraction=_shown_distance(case, boundary, front, -1),
        perimeter_all=float(np.mean(apart)) / case.short_cutoff,
        jumps_boundary=shared.n_boundary,
        jumps_front=shared.n_front,
        jumps_shared=len(shared.pairs),
        jump_shift=float(np.mean(shift)) if shared.pairs else 0.0,
        jump_spread=_rms(shift) if shared.pairs else 0.0,
        pull_off_force=float(boundary.force.min() - states.force.min()),
        pull_off_penetration=float(boundary.penetration[-1] - front.end),
        boundary_seconds=float(np.sum(boundary.seconds)),
        mapping_seconds=front.mapping_seconds,
        front_seconds=front.cycle_seconds,
    )


def shared_jumps(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> SharedJumps:
    """Jumps of a quarter of a short cutoff or more, and those at the same place in both models."""
    theirs, ours = _compared_states(case, boundary, front)
    small, large = case.short_cutoff / 8, case.short_cutoff / 4
    one, other = (
        jumps(states.penetration[kept], states.direction[kept], radius[kept], small)
        for states, radius, kept in (
            (boundary, boundary.radius, theirs),
            (front.states, front.radius, ours),
        )
    )
    angle = _SAME_PLACE * case.short_cutoff / float(np.mean(front.states.mean_radius))
    pairs = matched_jumps(one, other, angle, _SAME_LOAD)
    return SharedJumps(
        pairs=tuple(pair for pair in pairs if pair[1].distance >= large),
        n_boundary=sum(jump.distance >= large for jump in one),
        n_front=sum(jump.distance >= large for jump in other),
    )


def jumps(
    penetration: Array, direction: NDArray[np.int64], radius: Array, least: float
) -> list[Jump]:
    """Jumps of a cycle, whose perimeters are (n_step, n_angle) and whose branches are whole.

    A motion is a jump from the least distance on; arcs that move half of it belong to one.
    """
    found = []
    n_angle = radius.shape[1]
    for step in range(1, len(penetration)):
        if direction[step] != direction[step - 1]:
            continue
        moved = direction[step] * (radius[step] - radius[step - 1])
        # Begin where nothing moves, so that no arc is cut in two.
        start = int(np.argmin(moved))
        turned = np.roll(moved, -start)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], turned > least / 2, [0]])))
        for first, last in edges.reshape(-1, 2):
            place = first + int(np.argmax(turned[first:last]))
            if turned[place] >= least:
                angle = 2 * np.pi * ((place + start) % n_angle) / n_angle
                load = float(penetration[step])
                found.append(Jump(load, int(direction[step]), angle, float(turned[place])))
    return found


def matched_jumps(
    ours: list[Jump], theirs: list[Jump], angle: float, penetration: float
) -> list[tuple[Jump, Jump]]:
    """Pairs of jumps that differ by no more than these, those closest in penetration first."""
    near = [
        (abs(one.penetration - other.penetration), i, j)
        for i, one in enumerate(ours)
        for j, other in enumerate(theirs)
        if one.direction == other.direction
        and abs(one.penetration - other.penetration) <= penetration
        and abs(np.angle(np.exp(1j * (one.angle - other.angle)))) <= angle
    ]
    pairs: list[tuple[Jump, Jump]] = []
    taken: tuple[set[int], set[int]] = (set(), set())
    for _, i, j in sorted(near):
        if i not in taken[0] and j not in taken[1]:
            pairs.append((ours[i], theirs[j]))
            taken[0].add(i)
            taken[1].add(j)
    return pairs


def _compared_states(
    case: Case, boundary: BoundaryCycle, front: FrontCycle
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """States of both in contact; in approach where the jump into it is left behind everywhere."""
    theirs, ours = shared_states(boundary, front.states)
    touching = np.any(boundary.radius, axis=1)
    first = boundary.radius[np.argmax(touching)]
    left = np.all(boundary.radius > first + case.short_cutoff / 8, axis=1)
    kept = (touching & (left | (boundary.direction < 0)))[theirs]
    return theirs[kept], ours[kept]


def _shown_distance(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, direction: Direction
) -> float:
    """Mean distance of the perimeters at the shown penetration, in short cutoffs."""
    one = perimeter_at(case.shown_penetration, direction, boundary, boundary.radius)
    other = perimeter_at(case.shown_penetration, direction, front.states, front.radius)
    return float(np.mean(np.abs(one - other))) / case.short_cutoff


def _rms(values: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))
