"""One approach and retraction of a sphere, from first contact to pull-off."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.field.fields import Field, first_place, last_place
from crackfront.core.field.rays import front_adhesion
from crackfront.core.solver.relax import Solver
from crackfront.core.units import WORK_OF_ADHESION

if TYPE_CHECKING:
    from crackfront.core.cycle.schedule import LoadSchedule

Array = NDArray[np.float64]


def run_cycle(
    field: Field,
    schedule: LoadSchedule,
    solver: Solver | None = None,
    recorder: Recorder | None = None,
) -> CycleRecord:
    """Quasi-static approach from first contact to the largest penetration, and back to pull-off.

    Parameters
    ----------
    field : Field
        Work of adhesion along the rays of a sphere.
    schedule : LoadSchedule
        Penetrations to visit.
    solver : Solver, optional
        How each front is found.
    recorder : Recorder, optional
        What is kept beside the curves, who is told of every state, and where to go on from.

    Returns
    -------
    CycleRecord
        All states in equilibrium, and what ended the cycle.

    Raises
    ------
    ValueError
        If a smooth sphere would already outgrow the field at the largest penetration, or the field
        begins too far outside to make contact in.
    """
    recorder = recorder or Recorder()
    front = checked_touch(field, schedule.max_penetration)
    recorder.run(field, front, schedule.loads(), solver)
    return recorder.record()


def first_touch(field: Field) -> Array:
    """Front of a contact that is just made, a circle (Units: reduced lateral length)."""
    return np.full(field.geometry.n_site, first_place(field))


def refuse_outgrown(field: Field, max_penetration: float) -> None:
    """Raise if a smooth sphere is larger than the field before its load is fully applied."""
    smooth = jkr.equilibrium_radius(max_penetration)
    if smooth >= last_place(field):
        raise ValueError(
            f"contact outgrows the field: a smooth sphere at penetration {max_penetration} has "
            f"radius {smooth:.4g}, the field ends at {last_place(field):.4g}; enlarge the field "
            "or lower the penetration"
        )


def checked_touch(field: Field, max_penetration: float) -> Array:
    """Front of a contact that is just made, on a field that is large enough and begins inside.

    Raises
    ------
    ValueError
        As :func:`run_cycle`.
    """
    refuse_outgrown(field, max_penetration)
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
