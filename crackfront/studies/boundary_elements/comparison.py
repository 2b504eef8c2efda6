"""Differences of the crack front from the boundary elements of one case."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.outcome import Direction
from crackfront.core.records import ADHESION, FORCE, VERTICAL, variable
from crackfront.studies.boundary_elements.cycle import BoundaryCycle
from crackfront.studies.boundary_elements.front import (
    FrontCycle,
    on_rays,
    perimeter_at,
    shared_states,
)
from crackfront.studies.boundary_elements.jumps import SharedJumps, jumps, matched_jumps
from crackfront.studies.boundary_elements.parameters import Case

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


def comparison(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, *, rotated: bool
) -> Comparison:
    """Differences of a front from the boundary elements of its case, where both have contact.

    The boundary elements jump into contact too early, by the range of their attraction, and with a
    larger radius; approach is compared from where their perimeter has left that one everywhere.

    Parameters
    ----------
    case : Case
        What both computed.
    boundary : BoundaryCycle
        The boundary elements.
    front : FrontCycle
        The front.
    rotated : bool
        Whether its crack turned.
    """
    record = front.record
    theirs, ours = _compared_states(case, boundary, record)
    force = boundary.force[theirs] - record.states.force[ours]
    area = boundary.contact_area[theirs] / record.states.contact_area[ours] - 1
    apart = np.abs(boundary.radius[theirs] - on_rays(record.fronts)[ours])
    compared = record.states.penetration[ours][record.states.direction[ours] > 0]
    shared = shared_jumps(case, boundary, front)
    shift = np.array([one.penetration - other.penetration for one, other in shared.pairs])
    return Comparison(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=rough_adhesion(case.heights(), case.pixel).elastic_energy,
        rotated=int(rotated),
        begin=float(np.min(compared, initial=math.inf)),
        force_mean=float(np.mean(force)),
        force_median=float(np.median(np.abs(force))),
        force_rms=float(np.sqrt(np.mean(force**2))),
        force_largest=float(np.max(np.abs(force))),
        area_mean=float(np.mean(area)),
        area_rms=float(np.sqrt(np.mean(area**2))),
        perimeter_approach=_shown_distance(case, boundary, record, 1),
        perimeter_retraction=_shown_distance(case, boundary, record, -1),
        perimeter_all=float(np.mean(apart)) / case.short_cutoff,
        jumps_boundary=shared.n_boundary,
        jumps_front=shared.n_front,
        jumps_shared=len(shared.pairs),
        jump_shift=float(np.mean(shift)) if shared.pairs else 0.0,
        jump_spread=float(np.sqrt(np.mean(shift**2))) if shared.pairs else 0.0,
        pull_off_force=float(boundary.force.min() - record.states.force.min()),
        pull_off_penetration=float(boundary.penetration[-1] - record.end_load),
        boundary_seconds=float(np.sum(boundary.seconds)),
        mapping_seconds=front.mapping_seconds,
        front_seconds=front.cycle_seconds,
    )


def shared_jumps(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> SharedJumps:
    """Jumps of a quarter of a short cutoff or more, and those at the same place in both models.

    Parameters
    ----------
    case, boundary, front
        As in :func:`comparison`.
    """
    record = front.record
    theirs, ours = _compared_states(case, boundary, record)
    small, large = case.short_cutoff / 8, case.short_cutoff / 4
    one, other = (
        jumps(states.penetration[kept], states.direction[kept], radius[kept], small)
        for states, radius, kept in (
            (boundary, boundary.radius, theirs),
            (record.states, on_rays(record.fronts), ours),
        )
    )
    angle = _SAME_PLACE * case.short_cutoff / float(np.mean(record.states.mean_radius))
    pairs = matched_jumps(one, other, angle, _SAME_LOAD)
    return SharedJumps(
        pairs=tuple(pair for pair in pairs if pair[1].distance >= large),
        n_boundary=sum(jump.distance >= large for jump in one),
        n_front=sum(jump.distance >= large for jump in other),
    )


def _compared_states(
    case: Case, boundary: BoundaryCycle, record: CycleRecord
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """States of both in contact; in approach where the jump into it is left behind everywhere."""
    theirs, ours = shared_states(boundary, record.states)
    touching = np.any(boundary.radius, axis=1)
    first = boundary.radius[np.argmax(touching)]
    left = np.all(boundary.radius > first + case.short_cutoff / 8, axis=1)
    kept = (touching & (left | (boundary.direction < 0)))[theirs]
    return theirs[kept], ours[kept]


def _shown_distance(
    case: Case, boundary: BoundaryCycle, record: CycleRecord, direction: Direction
) -> float:
    """Mean distance of the perimeters at the shown penetration, in short cutoffs."""
    one, other = (
        perimeter_at(case.shown_penetration, direction, states, radius)
        for states, radius in (
            (boundary, boundary.radius),
            (record.states, on_rays(record.fronts)),
        )
    )
    return float(np.mean(np.abs(one - other))) / case.short_cutoff
