"""The energy that a front loses when it moves."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.elasticity import line_energy
from crackfront.core.field.kinds import Field, first_radius
from crackfront.core.field.rays import front_products, swept_adhesion

Array = NDArray[np.float64]


def dissipated_energy(before: Array, after: Array, penetration: float, field: Field) -> float:
    """Energy that is lost when a front moves at fixed penetration.

    Parameters
    ----------
    before, after : (n_angle,) array
        Fronts inside the field. (Units: reduced lateral length)
    penetration : float
        Rigid body penetration b. (Units: reduced vertical length)
    field : Field
        Work of adhesion along the rays.

    Returns
    -------
    float
        Fall of the total energy. A quasi-static move loses energy, except in approach where the
        sphere closes an edge in compression over places that repel (w_loc < 0): there it may be
        negative, by no more than the integral of -w_loc over those places.
        (Units: pi w_int R times a reduced vertical length)
    """
    fall = _elastic_energy(before, penetration) - _elastic_energy(after, penetration)
    return fall + swept_adhesion(before, after, field)


def contact_energy(front: Array, penetration: float, field: Field) -> float:
    """Energy of a contact above that of none."""
    innermost = np.full(front.size, first_radius(field))
    # Within the first sample the product falls linearly to zero at the apex.
    core = np.pi * first_radius(field) * np.mean(front_products(innermost, field))
    outside = swept_adhesion(innermost, front, field)
    return _elastic_energy(front, penetration) - outside - float(core)


def _elastic_energy(front: Array, penetration: float) -> float:
    """Elastic energy of a front: rings of a smooth sphere, and the line."""
    # No energy is released or stored where an edge in compression advances.
    open_edge = np.maximum(front, math.sqrt(max(penetration, 0.0)))
    return float(np.mean(jkr.elastic_energy(open_edge, penetration))) + line_energy(front)
