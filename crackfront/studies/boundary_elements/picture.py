"""Both models of one case side by side, as the supplement shows them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.core.records import FORCE, LATERAL, VERTICAL, variable
from crackfront.studies.boundary_elements.cycle import BoundaryCycle
from crackfront.studies.boundary_elements.front import FrontCycle, on_rays, perimeter_at
from crackfront.studies.boundary_elements.parameters import Case
from crackfront.studies.boundary_elements.perimeter import N_ANGLE

Array = NDArray[np.float64]

_MOST_POINTS = 320
"""Points along a side of the part that is kept."""

_MARGIN = 0.15
"""What is shown beyond the contact (Units: reduced lateral length)."""


@dataclass(frozen=True, slots=True)
class ValidationPicture:
    """Force against penetration of both models, and their contacts at one penetration."""

    n_point: int = variable("points along a side of the grid", "1")
    interaction_range: float = variable("gap at which the attraction ends", VERTICAL)
    elastic_energy: float = variable("energy of full conformity that was asked for", "w_int")
    short_cutoff: float = variable("shortest wavelength", LATERAL)
    boundary_penetration: Array = variable("penetration", VERTICAL, "boundary")
    boundary_direction: NDArray[np.int64] = variable("+1 in approach, else -1", "1", "boundary")
    boundary_force: Array = variable("force, boundary elements", FORCE, "boundary")
    boundary_area: Array = variable("contact area", f"({LATERAL})^2", "boundary")
    front_penetration: Array = variable("penetration", VERTICAL, "front")
    front_direction: NDArray[np.int64] = variable("+1 in approach, else -1", "1", "front")
    front_force: Array = variable("force, crack front", FORCE, "front")
    front_area: Array = variable("contact area", f"({LATERAL})^2", "front")
    front_end: float = variable("penetration at which the front loses contact", VERTICAL)
    shown_penetration: float = variable("penetration of the contacts", VERTICAL)
    angle: Array = variable("angle of a ray", "rad", "angle")
    boundary_radius: Array = variable(
        "perimeters, approach and retraction", LATERAL, "branch", "angle"
    )
    front_radius: Array = variable("fronts, approach and retraction", LATERAL, "branch", "angle")
    fixed_radius: Array = variable(
        "fronts whose crack does not turn, approach and retraction", LATERAL, "branch", "angle"
    )
    position: Array = variable("distance from the apex", LATERAL, "x")
    heights: NDArray[np.float32] = variable("roughness", VERTICAL, "x", "y")
    pressure: NDArray[np.float32] = variable(
        "pressure in approach", f"{FORCE} / ({LATERAL})^2", "x", "y"
    )


def validation_picture(
    case: Case, boundary: BoundaryCycle, front: FrontCycle, fixed: FrontCycle
) -> ValidationPicture:
    """Picture of one case.

    Parameters
    ----------
    case : Case
        What all computed.
    boundary : BoundaryCycle
        The boundary elements.
    front, fixed : FrontCycle
        Fronts whose crack turns with the angle, and does not.
    """
    record = front.record
    shown, turning, still = (
        np.stack([perimeter_at(case.shown_penetration, sign, *model) for sign in (1, -1)])
        for model in (
            (boundary, boundary.radius),
            (record.states, on_rays(record.fronts)),
            (fixed.record.states, on_rays(fixed.record.fronts)),
        )
    )
    reach = float(np.max(shown)) + _MARGIN
    position: Array = np.arange(float(case.n_point)) * case.pixel - case.side / 2
    inside = np.flatnonzero(np.abs(position) <= reach)
    kept = inside[:: max(1, -(-inside.size // _MOST_POINTS))]
    part = np.ix_(kept, kept)
    return ValidationPicture(
        n_point=case.n_point,
        interaction_range=case.interaction_range,
        elastic_energy=case.elastic_energy,
        short_cutoff=case.short_cutoff,
        boundary_penetration=boundary.penetration,
        boundary_direction=boundary.direction,
        boundary_force=boundary.force,
        boundary_area=boundary.contact_area,
        front_penetration=record.states.penetration,
        front_direction=record.states.direction,
        front_force=record.states.force,
        front_area=record.states.contact_area,
        front_end=record.end_load,
        shown_penetration=case.shown_penetration,
        angle=2 * np.pi * np.arange(N_ANGLE) / N_ANGLE,
        boundary_radius=shown,
        front_radius=turning,
        fixed_radius=still,
        position=position[kept],
        heights=case.heights()[part].astype(np.float32),
        pressure=boundary.shown_pressure[0][part],
    )
