"""Hysteresis of the crack front and of boundary elements on the same surfaces, by amplitude."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes, label

from crackfront.analysis.estimate import Estimate, mean_estimate, student_estimate
from crackfront.analysis.validity import ValidityRow
from crackfront.core import jkr
from crackfront.core.adhesion import rough_adhesion
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, ENERGY, LATERAL, VERTICAL, variable
from crackfront.studies.boundary_elements.comparison import jumps
from crackfront.studies.boundary_elements.cycle import BoundaryCycle
from crackfront.studies.boundary_elements.front import (
    FrontCycle,
    States,
    front_cycle,
    shared_states,
)
from crackfront.studies.boundary_elements.parameters import (
    AmplitudeParameters,
    Case,
    amplitude_cases,
)

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Model = Literal["boundary", "front"]

_JUMP = 0.25
"""Least motion of an arc that jumps, in short cutoffs."""

_SMOOTH = 0.5
"""Part of it that a smooth front may move in a load step where jumps are counted."""


@dataclass(frozen=True, slots=True)
class SurfaceComparison:
    """Both models over the steady parts of both branches on one surface.

    Works of adhesion are means over the states of a branch, of the smooth sphere that has the same
    force at the same penetration. The hysteresis is the energy that either branch loses per area
    that it sweeps, summed: it does not depend on where on the surface the branches are. Areas are
    means over all states, relative to that of the front.
    """

    seed: int = variable("seed of the surface", "1")
    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    step: float = variable("load step", VERTICAL)
    roll_off: float = variable("roll-off wavelength", LATERAL)
    hurst: float = variable("Hurst exponent", "1")
    asked_energy: float = variable("energy of full conformity that was asked for", ADHESION)
    elastic_energy: float = variable("energy of full conformity on the tile", ADHESION)
    repelling: float = variable("part of the surface whose work of adhesion is negative", "1")
    boundary_approach: float = variable("w_appr of the boundary elements", ADHESION)
    boundary_retraction: float = variable("w_retr of the boundary elements", ADHESION)
    front_approach: float = variable("w_appr of the front", ADHESION)
    front_retraction: float = variable("w_retr of the front", ADHESION)
    zone_approach: float = variable("w_appr of a front with a cohesive zone", ADHESION)
    zone_retraction: float = variable("w_retr of a front with a cohesive zone", ADHESION)
    zone_hysteresis: float = variable("energy it loses per area swept", ADHESION)
    open_inside: float = variable("area within the front that boundary elements leave open", "1")
    closed_outside: float = variable("area outside the front that they close", "1")
    pockets: float = variable("open area enclosed by contact, boundary elements", "1")
    islands: float = variable("closed area apart from the contact, boundary elements", "1")
    overhangs: float = variable(
        "open area behind the perimeter but not enclosed, boundary elements", "1"
    )
    boundary_jumps: float = variable(
        "jumps of a quarter of a cutoff or more, boundary elements; NaN in large load steps", "1"
    )
    front_jumps: float = variable("the same of the front", "1")
    boundary_dissipated: float = variable("energy lost in both branches, boundary", ENERGY)
    front_dissipated: float = variable("energy lost in both branches, front", ENERGY)
    boundary_hysteresis: float = variable("energy lost per area swept, boundary", ADHESION)
    front_hysteresis: float = variable("energy lost per area swept, front", ADHESION)
    barriers: int = variable("steps that would have passed a barrier, and were shortened", "1")
    saddles: int = variable("states without forces that were no minimum, and were left", "1")
    least_released: float = variable("least fall of the energy at a penetration", ENERGY)
    products: float = variable("conjugate-gradient products of a load step", "1")
    boundary_seconds: float = variable("processor time of the boundary elements", "s")
    front_seconds: float = variable("processor time of the front and its field", "s")

    @property
    def setting(self) -> tuple[float, ...]:
        """What surfaces share that are averaged: grid, range, load step, spectrum, amplitude."""
        return (*self.resolution, *self.scene)

    @property
    def resolution(self) -> tuple[float, ...]:
        """Grid, range of the attraction, load step."""
        return self.n_point, self.interaction_range, self.step

    @property
    def scene(self) -> tuple[float, ...]:
        """Spectrum and amplitude."""
        return self.roll_off, self.hurst, self.asked_energy


@dataclass(frozen=True, slots=True)
class Setting:
    """Surfaces of one spectrum, amplitude, grid and load step."""

    rows: tuple[SurfaceComparison, ...]

    def mean(self, value: Callable[[SurfaceComparison], float]) -> Estimate:
        """Mean of a quantity over the surfaces."""
        return mean_estimate(np.array([value(row) for row in self.rows]))[0]

    def hysteresis(self, model: Model) -> Estimate:
        """Mean hysteresis of a model over the surfaces (Units: w_int)."""
        return self.mean(lambda row: float(getattr(row, f"{model}_hysteresis")))

    def hysteresis_ratio(self) -> Estimate:
        """Hysteresis of the front over that of the boundary elements, means over the surfaces.

        The standard error is that of the jackknife.
        """
        front, boundary = (
            np.array([getattr(row, f"{model}_hysteresis") for row in self.rows])
            for model in ("front", "boundary")
        )
        count = len(self.rows)
        value = np.sum(front) / np.sum(boundary)
        if count < 2:
            return student_estimate(value, math.nan, 0)
        left = (np.sum(front) - front) / (np.sum(boundary) - boundary)
        error = math.sqrt((count - 1) / count * float(np.sum((left - np.mean(left)) ** 2)))
        return student_estimate(value, error, count - 1)


def settings(rows: Iterable[SurfaceComparison]) -> tuple[Setting, ...]:
    """Surfaces that are averaged together, by resolution, spectrum and amplitude."""
    alike: dict[tuple[float, ...], list[SurfaceComparison]] = {}
    for row in rows:
        alike.setdefault(row.setting, []).append(row)
    return tuple(Setting(tuple(alike[key])) for key in sorted(alike))


def surface_comparison(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, zone: FrontCycle
) -> SurfaceComparison:
    """Both models on one surface, in the states that they share but for that of the turn.

    The second front has a cohesive zone as long as that of the boundary elements.
    """
    theirs, ours = _compared(case, boundary, front)
    states = front.states
    adhesion = rough_adhesion(case.heights(), case.pixel)
    works = [
        [
            float(np.mean(apparent_adhesion(model.force[kept], model.penetration[kept])))
            for kept in (numbers[model.direction[numbers] == sign] for sign in (1, -1))
        ]
        for model, numbers in ((boundary, theirs), (states, ours), (zone.states, ours))
    ]
    areas = _areas(case, boundary, front)
    lost = [
        _lost(model, energy, kept)
        for model, energy, kept in (
            (boundary, boundary.energy, theirs),
            (states, front.energy, ours),
            (zone.states, zone.energy, ours),
        )
    ]
    counts = [
        _jump_count(case, model.penetration[kept], model.direction[kept], radius[kept])
        for model, kept, radius in (
            (boundary, theirs, boundary.radius),
            (states, ours, front.radius),
        )
    ]
    return SurfaceComparison(
        seed=case.seed,
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        step=case.schedule.step,
        roll_off=case.roll_off or case.short_cutoff,
        hurst=case.hurst,
        asked_energy=case.elastic_energy,
        elastic_energy=adhesion.e_el,
        repelling=float(np.mean(adhesion.work_of_adhesion < 0)),
        boundary_approach=works[0][0],
        boundary_retraction=works[0][1],
        front_approach=works[1][0],
        front_retraction=works[1][1],
        zone_approach=works[2][0],
        zone_retraction=works[2][1],
        zone_hysteresis=lost[2][1],
        open_inside=areas[0],
        closed_outside=areas[1],
        pockets=areas[2],
        islands=areas[3],
        overhangs=areas[4],
        boundary_jumps=counts[0],
        front_jumps=counts[1],
        boundary_dissipated=lost[0][0],
        front_dissipated=lost[1][0],
        boundary_hysteresis=lost[0][1],
        front_hysteresis=lost[1][1],
        barriers=int(np.sum(boundary.barriers)),
        saddles=int(np.sum(boundary.saddles)),
        least_released=float(np.min(boundary.released)),
        products=float(np.mean(boundary.products)),
        boundary_seconds=float(np.sum(boundary.seconds)),
        front_seconds=front.mapping_seconds + front.cycle_seconds,
    )


def apparent_adhesion(force: Array, penetration: Array) -> Array:
    """Work of adhesion of the smooth sphere that has a force at a penetration (Units: w_int).

    Of the two radii of F = 3 a b / 2 - a^3 / 2 the larger one has an open edge.

    Examples
    --------
    >>> radius = np.array([1.2, 1.7])
    >>> penetration = jkr.equilibrium_penetration(radius, 0.8)
    >>> apparent_adhesion(jkr.equilibrium_force(radius, 0.8), penetration).round(12).tolist()
    [0.8, 0.8]
    """
    radius = [
        float(np.max(np.real(np.roots([1.0, 0.0, -3 * b, 2 * load]))))
        for load, b in zip(force.tolist(), penetration.tolist(), strict=True)
    ]
    return jkr.apparent_work_of_adhesion(radius, penetration)


def within(radius: Array, n_point: int, pixel: float) -> Mask:
    """Points of a grid around the apex that are within a line of these radii at equal angles."""
    position = (np.arange(n_point) - n_point // 2) * pixel
    x, y = np.meshgrid(position, position, indexing="ij")
    angle = np.mod(np.arctan2(y, x), 2 * np.pi)
    corners = 2 * np.pi * np.arange(radius.size + 1) / radius.size
    edge = np.interp(angle, corners, np.append(radius, radius[0]))
    return np.asarray(np.hypot(x, y) < edge)


@dataclass(frozen=True, slots=True)
class Regions:
    """Where one state of the boundary elements differs from a front, and from a disc.

    Attributes
    ----------
    inside : (n_point, n_point) array
        Points within the front.
    open_inside, closed_outside, pockets, islands, overhangs : (n_point, n_point) array
        As of :class:`SurfaceComparison`.
    """

    inside: Mask
    open_inside: Mask
    closed_outside: Mask
    pockets: Mask
    islands: Mask
    overhangs: Mask


def regions(closed: Mask, perimeter: Array, front: Array, pixel: float) -> Regions:
    """Regions of one state, from where surfaces are closed and the edges at equal angles."""
    inside = within(front, len(closed), pixel)
    parts, _ = label(closed)
    sizes = np.bincount(parts.ravel())
    main = closed & (parts == 1 + int(np.argmax(sizes[1:])))
    filled = binary_fill_holes(closed)
    return Regions(
        inside=inside,
        open_inside=inside & ~closed,
        closed_outside=closed & ~inside,
        pockets=filled & ~closed,
        islands=closed & ~main,
        overhangs=within(perimeter, len(closed), pixel) & ~filled,
    )


def _areas(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> list[float]:
    """Mean areas of the regions, relative to that within the front."""
    theirs, ours = _compared(case, boundary, front)
    parts = []
    for one, other in zip(theirs.tolist(), ours.tolist(), strict=True):
        found = regions(
            boundary.closed_at(one), boundary.radius[one], front.radius[other], case.pixel
        )
        whole = np.count_nonzero(found.inside)
        parts.append(
            [
                np.count_nonzero(part) / whole
                for part in (
                    found.open_inside,
                    found.closed_outside,
                    found.pockets,
                    found.islands,
                    found.overhangs,
                )
            ]
        )
    return [float(value) for value in np.mean(parts, axis=0)]


def _compared(
    case: Case, boundary: BoundaryCycle, front: FrontCycle
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """States of both branches in both models, without that of the turn."""
    theirs, ours = shared_states(boundary, front.states)
    kept = boundary.penetration[theirs] < case.schedule.max_penetration - 1e-9
    return theirs[kept], ours[kept]


def _lost(states: States, energy: Array, kept: NDArray[np.int64]) -> tuple[float, float]:
    """Energy that both branches lose, and the sum of what they lose per area (Units: w_int).

    In a load step it is the work of the force, by the trapezoidal rule, less the energy's rise.
    """
    lost = density = 0.0
    for sign in (1, -1):
        branch = kept[states.direction[kept] == sign]
        force, area = states.force[branch], states.contact_area[branch]
        work = np.diff(states.penetration[branch]) * (force[1:] + force[:-1]) / 2
        part = float(np.sum(work - np.diff(energy[branch])))
        lost += part
        density += part / abs(float(area[-1] - area[0])) / WORK_OF_ADHESION
    return lost, density


def _jump_count(
    case: Case, penetration: Array, direction: NDArray[np.int64], radius: Array
) -> float:
    """Jumps of both branches; NaN where a load step moves a smooth front too far to tell them."""
    largest = case.schedule.step / jkr.penetration_slope(float(np.min(penetration)))
    if largest > _SMOOTH * _JUMP * case.short_cutoff:
        return math.nan
    return float(len(jumps(penetration, direction, radius, _JUMP * case.short_cutoff)))


def compared_surfaces(
    parameters: AmplitudeParameters,
    cycle: Callable[[Case], BoundaryCycle | None],
) -> Iterator[tuple[Case, BoundaryCycle, FrontCycle, SurfaceComparison]]:
    """Every case with its cycles and their comparison; what has no cycle is left out."""
    given = parameters.front
    fronts: dict[tuple[object, ...], FrontCycle] = {}

    def front(case: Case, zone: float) -> FrontCycle:
        # The surface is that of the spectrum, not of the grid: so is the front.
        key = case.seed, case.roll_off, case.hurst, case.elastic_energy, case.schedule, zone
        if key not in fronts:
            fronts[key] = front_cycle(case, given.n_angle, given.spacing, zone=zone)
        return fronts[key]

    for case in amplitude_cases(parameters):
        boundary = cycle(case)
        if boundary is None:
            continue
        sharp, blunt = front(case, 0.0), front(case, zone_length(case.interaction_range))
        yield case, boundary, sharp, surface_comparison(case, boundary, sharp, blunt)


def zone_length(interaction_range: float) -> float:
    """Length E' w_int / tension^2 of a cohesive zone, by its largest tension 3 w_int / g_c.

    Examples
    --------
    >>> round(zone_length(0.3), 4)
    0.0236
    """
    return CONTACT_MODULUS * interaction_range**2 / (9 * WORK_OF_ADHESION)


def range_limits(rows: Sequence[SurfaceComparison]) -> list[SurfaceComparison]:
    """The two shortest ranges of every surface, extrapolated to a vanishing one.

    Works of adhesion are linear in the length of the cohesive zone, hence in the square of the
    range; so is the logarithm of the hysteresis, where both are positive. Everything else is that
    of the shorter range.
    """
    alike: dict[tuple[float, ...], list[SurfaceComparison]] = {}
    for row in rows:
        alike.setdefault((*row.scene, row.seed, row.step), []).append(row)
    limits = []
    for found in alike.values():
        found.sort(key=lambda row: (row.interaction_range, -row.n_point))
        fine = found[0]
        longer = [row for row in found if row.interaction_range > fine.interaction_range]
        if not longer:
            continue
        coarse = longer[0]
        share = 1 / ((coarse.interaction_range / fine.interaction_range) ** 2 - 1)
        lost, more = fine.boundary_hysteresis, coarse.boundary_hysteresis
        limits.append(
            replace(
                fine,
                interaction_range=0.0,
                boundary_approach=fine.boundary_approach
                + share * (fine.boundary_approach - coarse.boundary_approach),
                boundary_retraction=fine.boundary_retraction
                + share * (fine.boundary_retraction - coarse.boundary_retraction),
                boundary_hysteresis=lost * (lost / more) ** share
                if min(lost, more) > 0
                else lost + share * (lost - more),
                zone_approach=fine.front_approach,
                zone_retraction=fine.front_retraction,
                zone_hysteresis=fine.front_hysteresis,
            )
        )
    return limits


def validity_row(setting: Setting, short_cutoff: float) -> ValidityRow:
    """What is told of the front at one spectrum and amplitude."""
    ratio, row = setting.hysteresis_ratio(), setting.rows[0]
    return ValidityRow(
        roll_off=row.roll_off / short_cutoff,
        hurst=row.hurst,
        elastic_energy=float(setting.mean(lambda one: one.elastic_energy).value),
        ratio=float(ratio.value),
        error=float(ratio.standard_error),
        surfaces=len(setting.rows),
        n_point=row.n_point,
        interaction_range=row.interaction_range,
    )
