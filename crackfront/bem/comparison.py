"""The crack front on the heights of a case, and its differences from the boundary elements."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from crackfront.adhesion import rough_adhesion
from crackfront.bem.cycle import BoundaryCycle
from crackfront.bem.jumps import Jump, jumps, matched_jumps
from crackfront.bem.parameters import Case
from crackfront.bem.perimeter import N_ANGLE
from crackfront.cycle import CycleRecord, run_cycle
from crackfront.records import ADHESION, FORCE, VERTICAL, variable
from crackfront.relax import Status
from crackfront.rotated import rotated_field

Array = NDArray[np.float64]

_TOLERANCE = 1e-6
_SAME_PLACE, _SAME_LOAD = 1.0, 0.1
"""Largest distance of matched jumps along the front, in short cutoffs, and in penetration."""


@dataclass(frozen=True, slots=True)
class FrontCycle:
    """A cycle of the crack front on the heights of a case.

    Attributes
    ----------
    record : CycleRecord
        Its states, with the fronts.
    mapping_seconds, cycle_seconds : float
        Processor time of the field and of the cycle. (Units: s)
    """

    record: CycleRecord
    mapping_seconds: float
    cycle_seconds: float


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


def front_cycle(case: Case, n_angle: int, spacing: float, *, rotated: bool = True) -> FrontCycle:
    """Cycle of the crack front on the heights of a case.

    Parameters
    ----------
    case : Case
        Surface and load.
    n_angle, spacing, rotated
        As in :func:`crackfront.rotated.rotated_field`.

    Raises
    ------
    ValueError
        If the cycle does not end by losing contact.
    """
    began = time.process_time()
    field = rotated_field(
        case.heights(), case.pixel, n_angle, spacing, case.side / 2, rotated=rotated
    )
    mapped = time.process_time()
    record = run_cycle(field, case.schedule, tolerance=_TOLERANCE, record_fronts=True)
    if record.status is not Status.LOST_CONTACT:
        raise ValueError(
            f"{case.label}: at penetration {record.end_penetration:.6g} the front "
            f"{record.status.value}; raise n_angle or lower the spacing"
        )
    return FrontCycle(record, mapped - began, time.process_time() - mapped)


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
    theirs, ours = shared_states(boundary, record)
    touching = np.any(boundary.radius[theirs], axis=1)
    theirs, ours = theirs[touching], ours[touching]
    apart = np.abs(boundary.radius[theirs] - on_rays(record.radius)[ours])
    distance = np.mean(apart, axis=1) / case.short_cutoff
    shown = np.isclose(record.penetration[ours], case.shown_penetration, atol=1e-9)
    approach, retraction = (
        float(np.mean(distance[shown & (record.direction[ours] == sign)])) for sign in (1, -1)
    )
    kept = _comparable(boundary, case.short_cutoff / 8)[theirs]
    theirs, ours, distance = theirs[kept], ours[kept], distance[kept]
    force = boundary.force[theirs] - record.force[ours]
    area = boundary.contact_area[theirs] / record.contact_area[ours] - 1
    compared = record.penetration[ours][record.direction[ours] > 0]
    pairs, boundary_jumps, front_jumps = _shared_jumps(case, boundary, record, theirs, ours)
    shift = np.array([one.penetration - other.penetration for one, other in pairs])
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
        perimeter_approach=approach,
        perimeter_retraction=retraction,
        perimeter_all=float(np.mean(distance)),
        jumps_boundary=boundary_jumps,
        jumps_front=front_jumps,
        jumps_shared=len(pairs),
        jump_shift=float(np.mean(shift)) if pairs else 0.0,
        jump_spread=float(np.sqrt(np.mean(shift**2))) if pairs else 0.0,
        pull_off_force=float(boundary.force.min() - record.force.min()),
        pull_off_penetration=float(boundary.penetration[-1] - record.end_penetration),
        boundary_seconds=float(np.sum(boundary.seconds)),
        mapping_seconds=front.mapping_seconds,
        front_seconds=front.cycle_seconds,
    )


class States(Protocol):
    """What tells which states a cycle visited."""

    @property
    def penetration(self) -> Array:
        """Penetrations, state by state."""

    @property
    def direction(self) -> NDArray[np.int64]:
        """+1 in approach, -1 in retraction."""


def shared_states(one: States, other: States) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices, in both, of the states that two cycles share, in the order of the first."""
    known, asked = (
        [(round(b, 9), d) for b, d in zip(*pair, strict=True)]
        for pair in (
            (other.penetration.tolist(), other.direction.tolist()),
            (one.penetration.tolist(), one.direction.tolist()),
        )
    )
    place = {key: number for number, key in enumerate(known)}
    pairs = [(number, place[key]) for number, key in enumerate(asked) if key in place]
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return first, second


def force_error(found: CycleRecord, exact: CycleRecord) -> float:
    """Rms difference of two cycles' forces where they share a state (Units: pi w_int R)."""
    one, other = shared_states(found, exact)
    return float(np.sqrt(np.mean((found.force[one] - exact.force[other]) ** 2)))


def on_rays(radius: Array | None) -> Array:
    """Fronts at the angles of the boundary elements' perimeters, by their Fourier series.

    Parameters
    ----------
    radius : (n_step, n_angle) array
        Fronts. (Units: reduced lateral length)
    """
    if radius is None:
        raise ValueError("the cycle holds no fronts; record them")
    modes = np.fft.rfft(radius, norm="forward")
    return np.asarray(np.fft.irfft(modes, n=N_ANGLE, norm="forward"))


def _comparable(boundary: BoundaryCycle, travel: float) -> NDArray[np.bool_]:
    """States whose perimeter has, in approach, left that of the jump into contact everywhere."""
    first = boundary.radius[np.argmax(np.any(boundary.radius, axis=1))]
    left = np.all(boundary.radius > first + travel, axis=1)
    return np.asarray(left | (boundary.direction < 0))


def _shared_jumps(
    case: Case,
    boundary: BoundaryCycle,
    record: CycleRecord,
    theirs: NDArray[np.int64],
    ours: NDArray[np.int64],
) -> tuple[list[tuple[Jump, Jump]], int, int]:
    """Pairs of which the front's is large, and numbers of large jumps of both models."""
    small, large = case.short_cutoff / 8, case.short_cutoff / 4
    one, other = (
        jumps(model.penetration[kept], model.direction[kept], radius[kept], small)
        for model, radius, kept in (
            (boundary, boundary.radius, theirs),
            (record, on_rays(record.radius), ours),
        )
    )
    angle = _SAME_PLACE * case.short_cutoff / float(np.mean(record.mean_radius))
    pairs = matched_jumps(one, other, angle, _SAME_LOAD)
    return (
        [pair for pair in pairs if pair[1].distance >= large],
        sum(jump.distance >= large for jump in one),
        sum(jump.distance >= large for jump in other),
    )
