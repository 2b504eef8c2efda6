"""Approach and retraction by boundary elements, resumable after every load step."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.schedule import LoadSchedule, loads
from crackfront.core.variables import ADHESION, ENERGY, FORCE, LATERAL, VERTICAL, variable
from studies.boundary_elements.contact import equilibrium
from studies.boundary_elements.parameters import BranchSchedule, Case

Array = NDArray[np.float64]

_STEP, _ANGLE, _SHOWN, _X, _Y, _BYTE = "step", "angle", "shown", "x", "y", "byte"
_AREA = f"({LATERAL})^2"
_PRESSURE = f"{FORCE} / {_AREA}"

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
    n_point: int = variable("points along a side of the grid", "1")
    pixel: float = variable("grid spacing", LATERAL)
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity of the roughness", ADHESION)
    shown_penetration: float = variable("penetration whose states are kept", VERTICAL)
    penetration: Array = variable("rigid body penetration", VERTICAL, _STEP)
    direction: NDArray[np.int64] = variable("+1 in approach, -1 in retraction", "1", _STEP)
    force: Array = variable("normal force", FORCE, _STEP)
    closed_area: Array = variable("area without gap", _AREA, _STEP)
    radius: Array = variable("distance of the perimeter from the apex", LATERAL, _STEP, _ANGLE)
    iterations: NDArray[np.int64] = variable("trust-region steps", "1", _STEP)
    products: NDArray[np.int64] = variable("conjugate-gradient products", "1", _STEP)
    residual: Array = variable("pressure out of balance", "largest tension", _STEP)
    seconds: Array = variable("processor time of the load step", "s", _STEP)
    energy: Array = variable("energy above that of surfaces far apart", ENERGY, _STEP)
    released: Array = variable("how far the energy fell at the penetration", ENERGY, _STEP)
    barriers: NDArray[np.int64] = variable(
        "steps that would have passed over a rise of the energy, and were shortened", "1", _STEP
    )
    saddles: NDArray[np.int64] = variable(
        "states without forces that were no minimum, and were left", "1", _STEP
    )
    closed: NDArray[np.uint8] = variable(
        "points within the edge's gap, eight to a byte, row by row", "1", _STEP, _BYTE
    )
    shown_pressure: NDArray[np.float32] = variable(
        "pressure at the kept penetration, approach and retraction", _PRESSURE, _SHOWN, _X, _Y
    )
    pressure: Array = variable("pressure of the last state", _PRESSURE, _X, _Y)
    trust_radius: float = variable("trust radius of the next load step", "1")

    @property
    def contact_area(self) -> Array:
        """Area within the perimeter (Units: reduced lateral length squared)."""
        return np.asarray(np.pi * np.mean(self.radius**2, axis=1))

    def closed_at(self, step: int) -> NDArray[np.bool_]:
        """Points of the grid within the edge's gap, (n_point, n_point)."""
        bits = np.unpackbits(self.closed[step], count=self.n_point**2)
        return bits.reshape(self.n_point, self.n_point).astype(bool)


def boundary_cycle(
    case: Case,
    resume: BoundaryCycle | None = None,
    keep: Callable[[BoundaryCycle], None] | None = None,
) -> BoundaryCycle:
    """Quasi-static approach and retraction: a whole cycle, or the steady parts of its branches.

    Parameters
    ----------
    resume : BoundaryCycle, optional
        An unfinished cycle of the same case.
    keep : callable, optional
        Called with the cycle so far after every load step.

    Raises
    ------
    ValueError
        If a state does not come to rest, or the cycle to resume is another one.
    """
    contact, so_far = case.contact(), resume or _no_states(case)
    known, side = so_far.penetration.size, case.n_point
    displacement = contact.elastic_displacement(np.pad(so_far.pressure, (0, side)))
    for number, load in enumerate(case_loads(case)):
        penetration, direction = load.value, load.direction
        if so_far.status != RUNNING:
            break
        if number < known:
            if so_far.penetration[number] != penetration:
                raise ValueError(
                    f"the cycle to resume has penetration {so_far.penetration[number]:g} where "
                    f"{penetration:g} is asked for; it is that of another load, so remove it"
                )
            continue
        started = time.process_time()
        found = equilibrium(
            contact,
            displacement,
            penetration,
            tolerance=case.tolerance,
            radius=max(so_far.trust_radius, _LEAST_RADIUS),
        )
        displacement = found.displacement
        pressure = contact.elastic_pressure(displacement)[:side, :side]
        gap = contact.gap(displacement, penetration)
        radius = perimeter(gap, case.pixel, EDGE * case.interaction_range)
        shown = so_far.shown_pressure
        if math.isclose(penetration, case.shown_penetration, abs_tol=1e-9):
            shown = shown.copy()
            shown[0 if direction > 0 else 1] = pressure
        lost = direction < 0 and not np.any(gap < case.interaction_range)
        area = case.pixel**2
        so_far = replace(
            so_far,
            status=LOST_CONTACT if lost else RUNNING,
            shown_pressure=shown,
            pressure=pressure,
            trust_radius=found.radius,
            **_appended(
                so_far,
                penetration=penetration,
                direction=direction,
                force=float(np.sum(pressure)) * area,
                closed_area=np.count_nonzero(gap <= 0) * area,
                radius=radius,
                iterations=found.iterations,
                products=found.products,
                residual=found.residual,
                seconds=time.process_time() - started,
                energy=found.energy * area,
                released=found.released * area,
                barriers=found.barriers,
                saddles=found.saddles,
                closed=np.packbits(gap < EDGE * case.interaction_range),
            ),
        )
        if keep is not None:
            keep(so_far)
    if so_far.status == RUNNING:
        so_far = replace(so_far, status=ALL_LOADS)
        if keep is not None:
            keep(so_far)
    return so_far


def case_loads(case: Case) -> Iterator[Load]:
    """Penetrations of a case, in order, with the direction in which each is reached."""
    if isinstance(case.schedule, BranchSchedule):
        return case.schedule.loads()
    return contact_loads(case.schedule, case.interaction_range)


def contact_loads(schedule: LoadSchedule, interaction_range: float) -> Iterator[Load]:
    """Penetrations of a cycle that begins before surfaces attract each other.

    Examples
    --------
    >>> from itertools import islice
    >>> [load.value for load in islice(contact_loads(LoadSchedule(0.5, 0.25), 0.3), 5)]
    [-0.5, -0.25, 0.0, 0.25, 0.5]
    """
    for count in range(math.ceil(interaction_range / schedule.step), 0, -1):
        yield Load(-count * schedule.step, 1)
    yield from loads(schedule)


def _no_states(case: Case) -> BoundaryCycle:
    """A cycle that has not begun."""
    side = case.n_point
    numbers, counts = np.empty(0), np.empty(0, dtype=np.int64)
    return BoundaryCycle(
        status=RUNNING,
        n_point=side,
        pixel=case.pixel,
        interaction_range=case.interaction_range,
        elastic_energy=case.elastic_energy,
        shown_penetration=case.shown_penetration,
        penetration=numbers,
        direction=counts,
        force=numbers,
        closed_area=numbers,
        radius=np.empty((0, N_ANGLE)),
        iterations=counts,
        products=counts,
        residual=numbers,
        seconds=numbers,
        energy=numbers,
        released=numbers,
        barriers=counts,
        saddles=counts,
        closed=np.empty((0, -(-(side**2) // 8)), dtype=np.uint8),
        shown_pressure=np.zeros((2, side, side), dtype=np.float32),
        pressure=np.zeros((side, side)),
        trust_radius=1.0,
    )


def _appended(so_far: BoundaryCycle, **state: Any) -> dict[str, Any]:
    """Columns of the states with one more."""
    return {
        name: np.append(getattr(so_far, name), np.asarray(value)[None], axis=0)
        for name, value in state.items()
    }


def perimeter(gap: Array, pixel: float, edge: float) -> Array:
    """Outermost distance from the apex at which the gap is below that of the edge, ray by ray.

    The gap is (n_point, n_point), the distance (N_ANGLE,) and 0 where a ray has no contact.
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
