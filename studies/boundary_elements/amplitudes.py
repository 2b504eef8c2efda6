"""Hysteresis of the crack front and of boundary elements on the same surfaces, by amplitude."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes, label

from crackfront.core import jkr
from crackfront.core.adhesion import rough_adhesion
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION
from crackfront.core.variables import ADHESION, ENERGY, LATERAL, VERTICAL, variable
from studies.boundary_elements.comparison import jumps
from studies.boundary_elements.cycle import BoundaryCycle
from studies.boundary_elements.front import (
    FrontCycle,
    States,
    front_cycle,
    shared_states,
)
from studies.boundary_elements.parameters import (
    AmplitudeParameters,
    Case,
    amplitude_cases,
)

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

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
    boundary_hysteresis: float = variable("energy that they lose per area swept", ADHESION)
    boundary_dissipated: float = variable("energy that they lose in both branches", ENERGY)
    front_approach: float = variable("w_appr of the front", ADHESION)
    front_retraction: float = variable("w_retr of the front", ADHESION)
    front_hysteresis: float = variable("energy that it loses per area swept", ADHESION)
    front_dissipated: float = variable("energy that it loses in both branches", ENERGY)
    zone_approach: float = variable("w_appr of a front with a cohesive zone", ADHESION)
    zone_retraction: float = variable("w_retr of a front with a cohesive zone", ADHESION)
    zone_hysteresis: float = variable("energy that it loses per area swept", ADHESION)
    zone_dissipated: float = variable("energy that it loses in both branches", ENERGY)
    squared_approach: float = variable("w_appr of a front with K^2", ADHESION)
    squared_retraction: float = variable("w_retr of a front with K^2", ADHESION)
    squared_hysteresis: float = variable("energy that it loses per area swept", ADHESION)
    squared_dissipated: float = variable("energy that it loses in both branches", ENERGY)
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
        """Grid, range of the attraction, load step; where there is no range no grid is told."""
        return self.n_point if self.interaction_range else 0, self.interaction_range, self.step

    @property
    def scene(self) -> tuple[float, ...]:
        """Spectrum and amplitude."""
        return self.roll_off, self.hurst, self.asked_energy


def surface_comparison(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, **changed: FrontCycle
) -> SurfaceComparison:
    """Both models on one surface, in the states that they share but for that of the turn.

    Fronts of a changed model come by their names, `zone` and `squared`.
    """
    theirs, ours = _compared(case, boundary, front)
    branches = _branches("boundary", boundary, boundary.energy, theirs)
    for name, model in {"front": front, **changed}.items():
        branches |= _branches(name, model.states, model.energy, ours)
    counts = [
        _jump_count(case, model.penetration[kept], model.direction[kept], radius[kept])
        for model, kept, radius in (
            (boundary, theirs, boundary.radius),
            (front.states, ours, front.radius),
        )
    ]
    adhesion = rough_adhesion(case.heights(), case.pixel)
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
        **branches,
        **_areas(case, boundary, front),
        boundary_jumps=counts[0],
        front_jumps=counts[1],
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


def _areas(case: Case, boundary: BoundaryCycle, front: FrontCycle) -> dict[str, float]:
    """Mean areas of the regions, relative to that within the front."""
    names = ("open_inside", "closed_outside", "pockets", "islands", "overhangs")
    parts = []
    for one, other in zip(*_compared(case, boundary, front), strict=True):
        found = regions(
            boundary.closed_at(one), boundary.radius[one], front.radius[other], case.pixel
        )
        whole = np.count_nonzero(found.inside)
        parts.append([np.count_nonzero(getattr(found, name)) / whole for name in names])
    return dict(zip(names, np.mean(parts, axis=0).tolist(), strict=True))


def _compared(
    case: Case, boundary: BoundaryCycle, front: FrontCycle
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """States of both branches in both models, without that of the turn."""
    theirs, ours = shared_states(boundary, front.states)
    kept = boundary.penetration[theirs] < case.schedule.max_penetration - 1e-9
    return theirs[kept], ours[kept]


def _branches(
    name: str, states: States, energy: Array, kept: NDArray[np.int64]
) -> dict[str, float]:
    """Works of adhesion, hysteresis and lost energy of a model.

    In a load step it loses the work of the force, by the trapezoidal rule, less the energy's rise.
    """
    works, lost, density = [], 0.0, 0.0
    for sign in (1, -1):
        branch = kept[states.direction[kept] == sign]
        force, area = states.force[branch], states.contact_area[branch]
        works.append(float(np.mean(apparent_adhesion(force, states.penetration[branch]))))
        work = np.diff(states.penetration[branch]) * (force[1:] + force[:-1]) / 2
        part = float(np.sum(work - np.diff(energy[branch])))
        lost += part
        density += part / abs(float(area[-1] - area[0])) / WORK_OF_ADHESION
    return {
        f"{name}_approach": works[0],
        f"{name}_retraction": works[1],
        f"{name}_hysteresis": density,
        f"{name}_dissipated": lost,
    }


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

    def front(case: Case, zone: float = 0.0, squared: bool = False) -> FrontCycle:
        # The surface is that of the spectrum, not of the grid: so is the front.
        surface = case.seed, case.roll_off, case.hurst, case.elastic_energy, case.schedule
        key = *surface, zone, squared
        if key not in fronts:
            fronts[key] = front_cycle(
                case, given.n_angle, given.spacing, zone=zone, squared=squared
            )
        return fronts[key]

    for case in amplitude_cases(parameters):
        boundary = cycle(case)
        if boundary is None:
            continue
        sharp, blunt = front(case), front(case, zone=zone_length(case.interaction_range))
        found = surface_comparison(
            case, boundary, sharp, zone=blunt, squared=front(case, squared=True)
        )
        yield case, boundary, sharp, found


def zone_length(interaction_range: float) -> float:
    """Length E' w_int / tension^2 of a cohesive zone, by its largest tension 3 w_int / g_c.

    Examples
    --------
    >>> round(zone_length(0.3), 4)
    0.0236
    """
    return CONTACT_MODULUS * interaction_range**2 / (9 * WORK_OF_ADHESION)
