"""The front at first contact, and checks that the field is large enough."""

from __future__ import annotations

import numpy as np

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.field.fields import Field, first_place, last_place
from crackfront.core.field.rays import front_adhesion
from crackfront.core.units import WORK_OF_ADHESION


def first_touch(field: Field) -> Array:
    """Front at first contact, a circle (Units: reduced lateral length)."""
    return np.full(field.geometry.n_site, first_place(field))


def check_field_size(field: Field, max_penetration: float) -> None:
    """Raise if a smooth sphere is larger than the field before its load is fully applied."""
    smooth = jkr.equilibrium_radius(max_penetration)
    if smooth >= last_place(field):
        raise ValueError(
            f"contact outgrows the field: a smooth sphere at penetration {max_penetration} has "
            f"radius {smooth:.4g}, the field ends at {last_place(field):.4g}; enlarge the field "
            "or lower the penetration"
        )


def checked_touch(field: Field, max_penetration: float) -> Array:
    """Front at first contact, on a field that is large enough and begins inside it.

    Raises
    ------
    ValueError
        As :func:`crackfront.core.cycle.run.run_cycle`.
    """
    check_field_size(field, max_penetration)
    radius = first_place(field)
    needed = float(jkr.apparent_work_of_adhesion(radius, 0.0))
    adhesion = front_adhesion(first_touch(field), field) / WORK_OF_ADHESION
    # A circle that needs next to no adhesion is the first touch, whatever is found there.
    if needed > max(float(np.mean(adhesion)), 1e-3):
        raise ValueError(
            f"field begins at radius {radius:.4g}, where a contact at penetration 0 needs a mean "
            f"work of adhesion of {needed:.4g} w_int but finds {np.mean(adhesion):.4g}; "
            "add samples at smaller radii"
        )
    return first_touch(field)
