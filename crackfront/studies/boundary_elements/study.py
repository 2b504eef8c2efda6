"""All that a validation finds, from the cycles of its cases."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module

from crackfront.core.extras import MissingExtraError
from crackfront.studies.boundary_elements.comparison import Comparison, comparison, shared_jumps
from crackfront.studies.boundary_elements.cycle import BoundaryCycle
from crackfront.studies.boundary_elements.front import FrontCycle, front_cycle
from crackfront.studies.boundary_elements.jumps import Jump
from crackfront.studies.boundary_elements.parameters import Case, ValidationParameters
from crackfront.studies.boundary_elements.picture import ValidationPicture, validation_picture
from crackfront.studies.boundary_elements.trends import (
    RotationEffect,
    Speed,
    extrapolated,
    rotation_effects,
    speed,
)

Progress = Callable[[str], None]

_LIBRARIES = ("ContactMechanics", "Adhesion", "SurfaceTopography", "finufft")


@dataclass(frozen=True, slots=True)
class Validation:
    """Differences, costs and averages of a validation, and the picture of its last rough case.

    Attributes
    ----------
    differences : tuple of Comparison
        Every case, and what is extrapolated to a vanishing range of attraction.
    speeds : tuple of Speed
        Rough cases that have a smooth one on the same grid.
    effects : tuple of RotationEffect
        One for each surface of the statistics; none where none were asked for.
    picture : ValidationPicture or None
        The last rough case.
    boundary_jumps, front_jumps : tuple of Jump
        Its large jumps that both models share, in one order.
    """

    differences: tuple[Comparison, ...]
    speeds: tuple[Speed, ...]
    effects: tuple[RotationEffect, ...]
    picture: ValidationPicture | None
    boundary_jumps: tuple[Jump, ...]
    front_jumps: tuple[Jump, ...]


@dataclass(frozen=True, slots=True)
class _Compared:
    """A case, its cycles and their differences."""

    case: Case
    boundary: BoundaryCycle
    turning: FrontCycle
    fixed: FrontCycle | None
    rows: tuple[Comparison, ...]


def refuse_missing_libraries() -> None:
    """Raise before anything is computed if a library is missing that a validation needs.

    Raises
    ------
    MissingExtraError
        If one is not installed.
    """
    for name in _LIBRARIES:
        try:
            import_module(name)
        except ModuleNotFoundError as error:
            raise MissingExtraError("boundary elements", error, "bem") from error


def validation(
    parameters: ValidationParameters,
    cycles: list[tuple[Case, BoundaryCycle]],
    progress: Progress,
) -> Validation:
    """Compare the front with the boundary elements of all cases.

    Parameters
    ----------
    parameters : ValidationParameters
        What was asked for.
    cycles : list of (Case, BoundaryCycle)
        Cases and their cycles by boundary elements.
    progress : callable
        Called with a line for every case.

    Raises
    ------
    ValueError
        If a front fails.
    """
    compared = []
    for case, boundary in cycles:
        compared.append(_compared(parameters, case, boundary))
        rows = compared[-1].rows
        progress(
            f"{case.label}: rms difference of the force {rows[0].force_rms:.4f}, of the perimeter "
            f"{rows[0].perimeter_all:.4f} short cutoffs"
        )
    rough = [one for one in compared if one.fixed is not None]
    smooth = {
        (one.case.n_point, one.case.interaction_range): one.rows[0].force_rms
        for one in compared
        if one.fixed is None
    }
    last = rough[-1] if rough else None
    pairs = () if last is None else shared_jumps(last.case, last.boundary, last.turning).pairs
    return Validation(
        differences=tuple(row for one in compared for row in one.rows) + _limits(compared),
        speeds=tuple(
            speed(one.case, one.boundary, smooth[key], one.turning)
            for one in rough
            if (key := (one.case.n_point, one.case.interaction_range)) in smooth
        ),
        effects=() if parameters.statistics is None else rotation_effects(parameters),
        picture=None
        if last is None or last.fixed is None
        else validation_picture(last.case, last.boundary, last.turning, last.fixed),
        boundary_jumps=tuple(one for one, _ in pairs),
        front_jumps=tuple(other for _, other in pairs),
    )


def _compared(parameters: ValidationParameters, case: Case, boundary: BoundaryCycle) -> _Compared:
    """A case beside the front; that of a smooth sphere does not know where the crack points."""
    front = parameters.front
    turning = front_cycle(case, front.n_angle, front.spacing)
    rows = [comparison(case, boundary, turning, rotated=True)]
    fixed = None
    if case.elastic_energy > 0:
        fixed = front_cycle(case, front.n_angle, front.spacing, rotated=False)
        rows.append(comparison(case, boundary, fixed, rotated=False))
    return _Compared(case, boundary, turning, fixed, tuple(rows))


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
        rows.append(comparison(case, limit, fine.turning, rotated=True))
    return tuple(rows)
