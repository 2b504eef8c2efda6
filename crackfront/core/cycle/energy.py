"""The energy that a front loses when it moves."""

from __future__ import annotations

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.field.fields import Field, first_place
from crackfront.core.field.rays import front_products, swept_adhesion


def dissipated_energy(before: Array, after: Array, load: float, field: Field) -> float:
    """Energy that is lost when a front moves at a fixed load: the fall of the total energy.

    A quasi-static move loses energy, except in approach where the sphere closes an edge in
    compression over places that repel (w_loc < 0): there it may be negative, by no more than the
    integral of -w_loc over those places. Both fronts lie inside the field.
    (Units: pi w_int R times a reduced vertical length)
    """
    elastic = field.geometry.stored_energy
    return elastic(before, load) - elastic(after, load) + swept_adhesion(before, after, field)


def contact_energy(front: Array, load: float, field: Field) -> float:
    """Energy of a contact, relative to no contact."""
    innermost = np.full(front.size, first_place(field))
    # Within the first sample the product falls linearly to zero at the apex.
    core = np.pi * first_place(field) * np.mean(front_products(innermost, field))
    outside = swept_adhesion(innermost, front, field)
    return float(field.geometry.stored_energy(front, load) - outside - core)
