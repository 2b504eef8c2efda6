"""All that a validation finds: differences of its cases, what the front saves, and averages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.optional_libraries import MissingExtraError
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.data.files import UnreadableFileError, set_aside
from crackfront.data.provenance import Provenance
from crackfront.data.records import read_record, write_record
from studies.boundary_elements.comparison import (
    Comparison,
    Jump,
    comparison,
    shared_jumps,
)
from studies.boundary_elements.cycle import RUNNING, BoundaryCycle, boundary_cycle
from studies.boundary_elements.front import (
    FrontCycle,
    force_error,
    front_cycle,
    shared_states,
)
from studies.boundary_elements.parameters import (
    Case,
    ValidationParameters,
    surface_seed,
    validation_cases,
)
from studies.boundary_elements.picture import ValidationPicture, validation_picture

Array = NDArray[np.float64]
Progress = Callable[[str], None]

_LIBRARIES = ("ContactMechanics", "Adhesion", "SurfaceTopography", "finufft")

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


@dataclass(frozen=True, slots=True)
class Validation:
    """Differences, costs and averages of a validation.

    The differences are those of every case and of what is extrapolated to a vanishing range of
    attraction, the speeds those of rough cases that have a smooth one on the same grid, the effects
    one for each surface of the statistics. Picture and jumps, of the boundary elements and of the
    front, are those of the last rough case.
    """

    differences: tuple[Comparison, ...]
    speeds: tuple[Speed, ...]
    effects: tuple[RotationEffect, ...]
    picture: ValidationPicture | None
    jumps: tuple[tuple[Jump, Jump], ...]


@dataclass(frozen=True, slots=True)
class _Compared:
    """A case, its cycles and their differences, the second front of a crack that does not turn."""

    case: Case
    boundary: BoundaryCycle
    fronts: list[FrontCycle]
    rows: list[Comparison]


def refuse_missing_libraries() -> None:
    """Raise before anything is computed if a library is missing that a validation needs."""
    for name in _LIBRARIES:
        try:
            import_module(name)
        except ModuleNotFoundError as error:
            raise MissingExtraError("boundary elements", error, "bem") from error


def validation(
    parameters: ValidationParameters, folder: Path, origin: Provenance, progress: Progress
) -> Validation:
    """Compare the front with the boundary elements of all cases.

    Parameters
    ----------
    folder : Path
        Where every load step of the boundary elements is kept, and found again.
    origin : Provenance
        Where they come from.

    Raises
    ------
    ValueError
        If a front fails.
    """
    cycles = [
        (case, stored_cycle(case, folder / f"{case.stem}.nc", origin, progress))
        for case in validation_cases(parameters)
    ]
    compared = []
    for case, boundary in cycles:
        compared.append(_compared(parameters, case, boundary))
        first = compared[-1].rows[0]
        progress(
            f"{case.label}: rms difference of the force {first.force_rms:.4f}, of the perimeter "
            f"{first.perimeter_all:.4f} short cutoffs"
        )
    rough = [one for one in compared if one.case.elastic_energy > 0]
    smooth = {
        (one.case.n_point, one.case.interaction_range): one.rows[0].force_rms
        for one in compared
        if one.case.elastic_energy == 0
    }
    last = rough[-1] if rough else None
    return Validation(
        differences=tuple(row for one in compared for row in one.rows) + _limits(compared),
        speeds=tuple(
            _speed(one.case, one.boundary, smooth[key], one.fronts[0])
            for one in rough
            if (key := (one.case.n_point, one.case.interaction_range)) in smooth
        ),
        effects=_rotation_effects(parameters),
        picture=validation_picture(last.case, last.boundary, *last.fronts) if last else None,
        jumps=shared_jumps(last.case, last.boundary, last.fronts[0]).pairs if last else (),
    )


def finished_cycle(path: Path) -> BoundaryCycle | None:
    """Cycle of a file, or none where there is no file or a load is left to do."""
    known = read_record(path, BoundaryCycle) if path.exists() else None
    return known if known is not None and known.status != RUNNING else None


def stored_cycle(case: Case, path: Path, origin: Provenance, progress: Progress) -> BoundaryCycle:
    """Cycle of a case: read, continued or computed."""

    def keep(cycle: BoundaryCycle) -> None:
        write_record(path, cycle, origin, case=case.label)
        branch = "approach" if cycle.direction[-1] > 0 else "retraction"
        progress(
            f"{case.label}: {branch} to {cycle.penetration[-1]:.4g}, force {cycle.force[-1]:.4f}, "
            f"{cycle.seconds[-1]:.2f} s"
        )

    known = None
    if path.exists():
        try:
            known = read_record(path, BoundaryCycle)
        except UnreadableFileError as error:
            progress(f"{error}; it is computed anew, and set aside as {set_aside(path).name}")
    if known is not None and known.status != RUNNING:
        return known
    return boundary_cycle(case, known, keep)


def _compared(parameters: ValidationParameters, case: Case, boundary: BoundaryCycle) -> _Compared:
    """A case beside the front; that of a smooth sphere does not know where the crack points."""
    front = parameters.front
    fronts = [
        front_cycle(case, front.n_angle, front.spacing, rotated=rotated)
        for rotated in ((True, False) if case.elastic_energy > 0 else (True,))
    ]
    return _Compared(case, boundary, fronts, [comparison(case, boundary, one) for one in fronts])


def _limits(compared: list[_Compared]) -> tuple[Comparison, ...]:
    """The two shortest ranges of every surface, extrapolated and compared."""
    rows = []
    for energy in sorted({one.case.elastic_energy for one in compared}):
        alike = [one for one in compared if one.case.elastic_energy == energy]
        alike.sort(key=lambda one: one.case.interaction_range)
        if len({one.case.interaction_range for one in alike[:2]}) < 2:
            continue
        fine, coarse = alike[:2]
        limit = extrapolated(coarse.boundary, fine.boundary)
        case = replace(fine.case, interaction_range=0.0)
        rows.append(comparison(case, limit, fine.fronts[0]))
    return tuple(rows)


def extrapolated(coarse: BoundaryCycle, fine: BoundaryCycle) -> BoundaryCycle:
    """Cycle at a vanishing range of attraction, state by state, from those of two ranges.

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

    def limit(one: Array, other: Array) -> Array:
        return np.asarray(other[theirs] + (other[theirs] - one[ours]) / (ratio - 1))

    return replace(
        fine,
        interaction_range=0.0,
        penetration=fine.penetration[theirs],
        direction=fine.direction[theirs],
        force=limit(coarse.force, fine.force),
        radius=limit(coarse.radius, fine.radius),
        seconds=fine.seconds[theirs],
    )


def _speed(case: Case, boundary: BoundaryCycle, error: float, fine: FrontCycle) -> Speed:
    """Cost of the coarsest front whose rms error, against a fine one, is that of its case."""
    for density in _DENSITIES:
        spacing = case.short_cutoff / (2 * density)
        n_angle = 2 * round(np.pi * _REACH / case.short_cutoff * density)
        front_cycle(case, n_angle, spacing)  # what compiles and plans is not counted
        front = front_cycle(case, n_angle, spacing)
        found = force_error(front, fine)
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


def _rotation_effects(parameters: ValidationParameters) -> tuple[RotationEffect, ...]:
    """Works of adhesion of independent surfaces, with and without the rotation of the crack."""
    given, front = parameters.statistics, parameters.front
    if given is None:
        return ()
    effects = []
    for number in range(given.surfaces):
        case = replace(
            validation_cases(parameters)[0],
            seed=surface_seed(parameters.seed, number),
            n_point=given.n_point,
            interaction_range=0.0,
            elastic_energy=given.elastic_energy,
            schedule=LoadSchedule(parameters.max_penetration, parameters.step),
        )
        works = [
            work
            for rotated in (True, False)
            for work in _branch_works(
                front_cycle(case, front.n_angle, front.spacing, rotated=rotated),
                parameters.max_penetration,
            )
        ]
        effects.append(RotationEffect(*works))
    return tuple(effects)


def _branch_works(cycle: FrontCycle, max_penetration: float) -> list[float]:
    """Mean works of adhesion of approach and retraction in the window."""
    states, (low, high) = cycle.states, (part * max_penetration for part in _WINDOW)
    inside = (states.penetration >= low) & (states.penetration <= high)
    return [
        float(np.mean(states.apparent_work_of_adhesion[inside & (states.direction == sign)]))
        for sign in (1, -1)
    ]
