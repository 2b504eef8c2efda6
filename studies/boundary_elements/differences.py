"""Differences of the crack front from the boundary elements, state by state, and jumps of both."""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, FORCE, VERTICAL, variable
from studies.accuracy.study import rms
from studies.boundary_elements.cases import Case
from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.front import FrontCycle, shared_states, shown_states

_SAME_PLACE = 1.0
"""Largest distance of matched jumps along the front, in short cutoffs."""

_SAME_LOAD = 0.1
"""Largest distance of matched jumps in penetration. (Units: reduced vertical length)"""


@dataclass(frozen=True, slots=True)
class Differences:
    """Differences of one front model from the boundary elements over one whole loop."""

    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    rotated: int = variable("1 where the crack turns with the angle, else 0", "1")
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


class Jump(NamedTuple):
    """An arc of the perimeter that moved far in one load step, and where it moved furthest."""

    penetration: float
    direction: int
    angle: float
    distance: float


def differences(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> Differences:
    """Differences of a front from the boundary elements of its case, where both have contact.

    The boundary elements jump into contact too early, by the range of their attraction, and with a
    larger radius; approach is compared from where their perimeter has left that one everywhere.
    """
    states, theirs, ours = front.states, *_compared_states(case, boundary, front)
    force = boundary.force[theirs] - states.force[ours]
    area = boundary.contact_area[theirs] / states.contact_area[ours] - 1
    distance = np.abs(boundary.radius[theirs] - front.radius[ours])
    shown = boundary.radius[shown_states(case, boundary)] - front.radius[shown_states(case, states)]
    perimeters = np.mean(np.abs(shown), axis=1) / case.short_cutoff
    return Differences(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=rough_adhesion(case.heights(), case.pixel).e_el,
        rotated=int(front.rotated),
        force_mean=float(np.mean(force)),
        force_median=float(np.median(np.abs(force))),
        force_rms=rms(force),
        force_largest=float(np.max(np.abs(force))),
        area_mean=float(np.mean(area)),
        area_rms=rms(area),
        perimeter_approach=float(perimeters[0]),
        perimeter_retraction=float(perimeters[1]),
        perimeter_all=float(np.mean(distance)) / case.short_cutoff,
        **_jump_values(case, boundary, front, (theirs, ours)),
        pull_off_force=float(boundary.force.min() - states.force.min()),
        pull_off_penetration=float(boundary.penetration[-1] - front.end),
    )


def _jump_values(
    case: Case,
    boundary: BoundaryCycle,
    front: FrontCycle,
    compared: tuple[NDArray[np.int64], NDArray[np.int64]],
) -> dict[str, Any]:
    """Numbers of jumps of both, and where those that they share differ."""
    states, (theirs, ours) = front.states, compared
    smallest, large = case.short_cutoff / 8, case.short_cutoff / 4
    boundary_jumps = jumps(
        boundary.penetration[theirs], boundary.direction[theirs], boundary.radius[theirs], smallest
    )
    front_jumps = jumps(
        states.penetration[ours], states.direction[ours], front.radius[ours], smallest
    )
    angle = _SAME_PLACE * case.short_cutoff / float(np.mean(states.mean_radius))
    pairs = matched_jumps(boundary_jumps, front_jumps, angle, _SAME_LOAD)
    shift = np.array(
        [
            boundary_jump.penetration - front_jump.penetration
            for boundary_jump, front_jump in pairs
            if front_jump.distance >= large
        ]
    )
    return {
        "jumps_boundary": sum(jump.distance >= large for jump in boundary_jumps),
        "jumps_front": sum(jump.distance >= large for jump in front_jumps),
        "jumps_shared": shift.size,
        "jump_shift": float(np.mean(shift)) if shift.size else 0.0,
        "jump_spread": rms(shift) if shift.size else 0.0,
    }


def jumps(penetration: Array, direction: NDArray[Any], radius: Array, least: float) -> list[Jump]:
    """Jumps of a cycle, whose perimeters are (n_step, n_angle) and whose branches are whole.

    A motion is a jump from the least distance on; arcs that move half of it belong to one.
    """
    jumps_so_far = []
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
                jumps_so_far.append(Jump(load, int(direction[step]), angle, float(turned[place])))
    return jumps_so_far


def matched_jumps(
    ours: list[Jump], theirs: list[Jump], angle: float, penetration: float
) -> list[tuple[Jump, Jump]]:
    """Pairs of jumps that differ by no more than these, those closest in penetration first."""
    near = [
        (abs(our_jump.penetration - their_jump.penetration), our_jump, their_jump)
        for our_jump in ours
        for their_jump in theirs
        if our_jump.direction == their_jump.direction
        and abs(our_jump.penetration - their_jump.penetration) <= penetration
        and abs(np.angle(np.exp(1j * (our_jump.angle - their_jump.angle)))) <= angle
    ]
    pairs: dict[Jump, Jump] = {}
    for _, our_jump, their_jump in sorted(near, key=itemgetter(0)):
        if our_jump not in pairs and their_jump not in pairs.values():
            pairs[our_jump] = their_jump
    return list(pairs.items())


def _compared_states(
    case: Case, boundary: BoundaryCycle, front: FrontCycle
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """States of both in contact; in approach where the jump into it is left behind everywhere."""
    theirs, ours = shared_states(boundary, front.states)
    touching = np.any(boundary.radius, axis=1)
    first = boundary.radius[np.argmax(touching)]
    is_beyond = np.all(boundary.radius > first + case.short_cutoff / 8, axis=1)
    is_compared = (touching & (is_beyond | (boundary.direction < 0)))[theirs]
    return theirs[is_compared], ours[is_compared]
