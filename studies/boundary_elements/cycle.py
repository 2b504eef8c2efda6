"""Approach and retraction by boundary elements, resumable after every load step."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from scipy.ndimage import map_coordinates

from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.variables import ENERGY, FORCE, LATERAL, STEP, VERTICAL, variable, variables
from studies.boundary_elements.cases import Case
from studies.boundary_elements.contact import Equilibrium, HalfSpaceContact, equilibrium

_ANGLE, _SHOWN, _X, _Y = "angle", "shown", "x", "y"
PRESSURE = f"{FORCE} / ({LATERAL})^2"

_LEAST_RADIUS = 1e-2
"""Trust radius that every load step may begin with."""

RUNNING, LOST_CONTACT, ALL_LOADS = "running", "lost contact", "all loads"

N_ANGLE = 720
"""Rays on which the perimeter of a contact is looked for."""

EDGE = 0.25
"""Gap at the edge of the contact, relative to the range of attraction.

The crack of linear elasticity that is equivalent to a cohesive zone has its tip within the zone, at
a gap that scales with the range.
"""


@dataclass(frozen=True, slots=True)
class BoundaryCycle:
    """States of a cycle by boundary elements, and what it takes to go on from the last of them."""

    status: str = variable("running, or what ended the cycle", "1")
    penetration: Array = variable("rigid body penetration", VERTICAL, STEP)
    direction: Array = variable("+1 in approach, -1 in retraction", "1", STEP)
    force: Array = variable("normal force", FORCE, STEP)
    radius: Array = variable("distance of the perimeter from the apex", LATERAL, STEP, _ANGLE)
    products: Array = variable("conjugate-gradient products", "1", STEP)
    residual: Array = variable("pressure out of balance", "largest tension", STEP)
    seconds: Array = variable("processor time of the load step", "s", STEP)
    energy: Array = variable("energy relative to surfaces far apart", ENERGY, STEP)
    released: Array = variable("how far the energy fell at the penetration", ENERGY, STEP)
    barriers: Array = variable("steps that were shortened before a barrier", "1", STEP)
    saddles: Array = variable("unstable states without forces that were left", "1", STEP)
    shown_pressure: Array = variable("pressure at the shown states", PRESSURE, _SHOWN, _X, _Y)
    pressure: Array = variable("pressure of the last state", PRESSURE, _X, _Y)
    trust_radius: float = variable("trust radius of the next load step", "1")

    @property
    def contact_area(self) -> Array:
        """Area within the perimeter (Units: reduced lateral length squared)."""
        return np.asarray(np.pi * np.mean(self.radius**2, axis=1))


def boundary_cycle(
    case: Case,
    resume: BoundaryCycle | None = None,
    keep: Callable[[BoundaryCycle], None] = lambda cycle: None,
) -> BoundaryCycle:
    """Quasi-static approach and retraction: a whole loop, or the steady parts of its branches.

    An unfinished cycle of the same case is resumed; `keep` gets the cycle so far after every
    load step. A ValueError says if a state does not come to rest.
    """
    contact, cycle = case.contact(), resume or _no_states(case.n_point)
    displacement = contact.elastic_displacement(np.pad(cycle.pressure, (0, case.n_point)))
    loads = islice(case.loads.loads(case.interaction_range), cycle.penetration.size, None)
    for load in loads:
        if cycle.status != RUNNING:
            return cycle
        started = time.process_time()
        balanced = equilibrium(
            contact,
            displacement,
            load.value,
            tolerance=case.tolerance,
            radius=max(cycle.trust_radius, _LEAST_RADIUS),
        )
        displacement = balanced.displacement
        cycle = _continued(case, contact, cycle, load, balanced, started)
        keep(cycle)
    cycle = replace(cycle, status=ALL_LOADS)
    keep(cycle)
    return cycle


def _continued(
    case: Case,
    contact: HalfSpaceContact,
    cycle: BoundaryCycle,
    load: Load,
    balanced: Equilibrium,
    started: float,
) -> BoundaryCycle:
    """A cycle with one more state, whose load step started at a processor time in s."""
    side, area = case.n_point, case.pixel**2
    pressure = contact.elastic_pressure(balanced.displacement)[:side, :side]
    gap = contact.gap(balanced.displacement, load.value)
    is_lost = load.direction < 0 and not np.any(gap < case.interaction_range)
    shown = cycle.shown_pressure
    if math.isclose(load.value, case.loads.shown_penetration, abs_tol=1e-9):
        shown = shown.copy()
        shown[0 if load.direction > 0 else 1] = pressure
    state = {
        "penetration": load.value,
        "direction": load.direction,
        "force": float(np.sum(pressure)) * area,
        "radius": perimeter(gap, case.pixel, EDGE * case.interaction_range),
        "seconds": time.process_time() - started,
        "energy": balanced.energy * area,
        "released": balanced.released * area,
        "products": balanced.products,
        "residual": balanced.residual,
        "barriers": balanced.barriers,
        "saddles": balanced.saddles,
    }
    columns = {
        name: np.append(getattr(cycle, name), np.asarray(value)[None], axis=0)
        for name, value in state.items()
    }
    return replace(
        cycle,
        status=LOST_CONTACT if is_lost else RUNNING,
        shown_pressure=shown,
        pressure=pressure,
        trust_radius=balanced.radius,
        **columns,
    )


def _no_states(side: int) -> BoundaryCycle:
    """A cycle that has not begun."""
    sizes = {STEP: 0, _ANGLE: N_ANGLE, _SHOWN: 2, _X: side, _Y: side}
    nothing = {
        item.name: np.zeros([sizes[name] for name in item.dims])
        for item in variables(BoundaryCycle)
        if item.dims
    }
    return BoundaryCycle(status=RUNNING, trust_radius=1.0, **nothing)


def perimeter(gap: Array, pixel: float, edge: float) -> Array:
    """Outermost distance from the apex at which the gap is below the gap at the edge, on every ray.

    The gap is (n_point, n_point), the distance (N_ANGLE,) and 0 on rays without contact.
    (Units: reduced vertical length, reduced lateral length)
    """
    centre = len(gap) // 2
    angle = 2 * np.pi * np.arange(N_ANGLE) / N_ANGLE
    distance = np.arange(0.0, centre - 1, 0.25)
    rays = map_coordinates(
        gap,
        centre + distance * np.stack([np.cos(angle), np.sin(angle)])[:, :, None],
        order=1,
        mode="nearest",
    )
    within = rays < edge
    last = distance.size - 1 - np.argmax(within[:, ::-1], axis=1)
    last = np.minimum(last, distance.size - 2)
    ray = np.arange(N_ANGLE)
    near, far = rays[ray, last], rays[ray, last + 1]
    opening = far - near
    part = np.divide(edge - near, opening, out=np.zeros(N_ANGLE), where=opening > 0)
    return np.where(np.any(within, axis=1), (distance[last] + 0.25 * part) * pixel, 0.0)
