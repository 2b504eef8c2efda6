"""What remains of the differences without the range of attraction, and what the front saves."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from crackfront.core.cycle.record import CycleRecord
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.records import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.studies.boundary_elements.cycle import BoundaryCycle
from crackfront.studies.boundary_elements.front import (
    FrontCycle,
    force_error,
    front_cycle,
    shared_states,
)
from crackfront.studies.boundary_elements.parameters import Case, ValidationParameters

Array = NDArray[np.float64]

_ORDER = 2
"""Order of the differences in the range: the cohesive zone is as long as its square."""

_DENSITIES = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""Sites of a front per short cutoff, half the samples of a ray per cutoff."""

_REACH = 2.0
"""Radius at which the sites are counted (Units: reduced lateral length)."""

_WINDOW = (0.25, 0.75)
"""States whose works of adhesion are averaged, between these parts of the largest penetration."""


@dataclass(frozen=True, slots=True)
class Speed:
    """Cost of a cycle by boundary elements, and of one of the front that is as wrong."""

    n_point: int = variable("points along a side of the boundary elements' grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    boundary_error: float = variable("rms error of their force, on the smooth sphere", FORCE)
    boundary_seconds: float = variable("processor time of their cycle on the rough sphere", "s")
    n_angle: int = variable("sites of the front", "1")
    spacing: float = variable("distance of samples along its rays", LATERAL)
    front_error: float = variable("rms error of its force, against a fine front", FORCE)
    front_seconds: float = variable("processor time of its field and cycle", "s")


@dataclass(frozen=True, slots=True)
class RotationEffect:
    """Works of adhesion of one surface, with and without the rotation of the crack."""

    approach: float = variable("mean of a G in approach, rotated", ADHESION)
    retraction: float = variable("mean of a G in retraction, rotated", ADHESION)
    approach_fixed: float = variable("the same of a crack that does not turn", ADHESION)
    retraction_fixed: float = variable("the same of a crack that does not turn", ADHESION)


def extrapolated(coarse: BoundaryCycle, fine: BoundaryCycle) -> BoundaryCycle:
    """Cycle at a vanishing range of attraction, state by state, from those of two ranges.

    Parameters
    ----------
    coarse, fine : BoundaryCycle
        Cycles of one surface and one load; the first has the longer range.

    Raises
    ------
    ValueError
        If the ranges do not decrease.
    """
    ratio = (coarse.interaction_range / fine.interaction_range) ** _ORDER
    if not ratio > 1:
        raise ValueError(
            f"ranges of attraction are {coarse.interaction_range:g} and "
            f"{fine.interaction_range:g}; the second must be the smaller one"
        )
    ours, theirs = shared_states(coarse, fine)
    touching = np.any(coarse.radius[ours], axis=1) & np.any(fine.radius[theirs], axis=1)
    ours, theirs = ours[touching], theirs[touching]

    def limit(name: str) -> Array:
        one, other = getattr(coarse, name)[ours], getattr(fine, name)[theirs]
        return np.asarray(other + (other - one) / (ratio - 1))

    return replace(
        fine,
        interaction_range=0.0,
        penetration=fine.penetration[theirs],
        direction=fine.direction[theirs],
        force=limit("force"),
        radius=limit("radius"),
        seconds=fine.seconds[theirs],
    )


def speed(case: Case, boundary: BoundaryCycle, error: float, fine: FrontCycle) -> Speed:
    """Cost of the coarsest front whose force is as good as that of the boundary elements.

    Parameters
    ----------
    case : Case
        What both compute.
    boundary : BoundaryCycle
        The boundary elements.
    error : float
        Rms error of their force. (Units: pi w_int R)
    fine : FrontCycle
        A front that counts as exact.

    Raises
    ------
    ValueError
        If no front is as good.
    """
    for density in _DENSITIES:
        spacing = case.short_cutoff / (2 * density)
        n_angle = 2 * round(np.pi * _REACH / case.short_cutoff * density)
        front_cycle(case, n_angle, spacing)  # what compiles and plans is not counted
        front = front_cycle(case, n_angle, spacing)
        found = force_error(front.record, fine.record)
        if found <= error:
            return Speed(
                n_point=case.n_point,
                interaction_range=case.interaction_range,
                boundary_error=error,
                boundary_seconds=float(np.sum(boundary.seconds)),
                n_angle=n_angle,
                spacing=spacing,
                front_error=found,
                front_seconds=front.mapping_seconds + front.cycle_seconds,
            )
    raise ValueError(f"{case.label}: no front has a force within {error:.2g}; refine it")


def rotation_effects(parameters: ValidationParameters) -> tuple[RotationEffect, ...]:
    """Works of adhesion of independent surfaces, with and without the rotation of the crack.

    Parameters
    ----------
    parameters : ValidationParameters
        Those of a validation with a section `statistics`.

    Raises
    ------
    ValueError
        If it has none, or a cycle ends early.
    """
    given, front = parameters.statistics, parameters.front
    if given is None:
        raise ValueError("the configuration has no section statistics; add it")
    effects = []
    for number in range(given.surfaces):
        sequence = np.random.SeedSequence(parameters.seed, spawn_key=(number,))
        case = Case(
            seed=int(sequence.generate_state(1)[0]),
            short_cutoff=parameters.short_cutoff,
            side=parameters.side,
            shown_penetration=parameters.shown_penetration,
            tolerance=parameters.tolerance,
            n_point=given.n_point,
            interaction_range=0.0,
            elastic_energy=given.elastic_energy,
            schedule=LoadSchedule(parameters.max_penetration, parameters.step),
        )
        works = [
            work
            for rotated in (True, False)
            for work in _branch_works(
                front_cycle(case, front.n_angle, front.spacing, rotated=rotated).record,
                parameters.max_penetration,
            )
        ]
        effects.append(RotationEffect(*works))
    return tuple(effects)


def _branch_works(record: CycleRecord, max_penetration: float) -> list[float]:
    """Mean works of adhesion of approach and retraction in the window."""
    low, high = (part * max_penetration for part in _WINDOW)
    inside = (record.states.penetration >= low) & (record.states.penetration <= high)
    return [
        float(
            np.mean(
                record.states.apparent_work_of_adhesion[inside & (record.states.direction == sign)]
            )
        )
        for sign in (1, -1)
    ]
