"""One approach and retraction, from first contact to pull-off."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crackfront.core import jkr
from crackfront.core.cycle.history import FrontHistory
from crackfront.core.cycle.record import Checkpoint, CycleRecord, CycleState, Keep
from crackfront.core.cycle.schedule import LoadSchedule, loads
from crackfront.core.field.kinds import Field, first_radius, last_radius, n_angle
from crackfront.core.field.rays import front_adhesion
from crackfront.core.solver.relax import Status
from crackfront.core.units import WORK_OF_ADHESION


def run_cycle(
    field: Field,
    schedule: LoadSchedule,
    *,
    tolerance: float = 1e-8,
    max_sweeps: int = 10_000_000,
    solver: str = "newton",
    record_fronts: bool = False,
    record_energy: bool = False,
    progress: Callable[[CycleState], None] | None = None,
    resume: Checkpoint | None = None,
    keep: Keep | None = None,
) -> CycleRecord:
    """Quasi-static approach from first contact to the largest penetration, and back to pull-off.

    Parameters
    ----------
    field : Field
        Work of adhesion along the rays.
    schedule : LoadSchedule
        Penetrations to visit.
    tolerance : float, optional
        Largest force along the motion that may be left, relative to w_int per front length.
    max_sweeps : int, optional
        Limit on the sweeps of one load step.
    solver : str, optional
        A name in :data:`crackfront.core.solver.relax.SOLVERS`.
    record_fronts : bool, optional
        Keep every front, not only its measures.
    record_energy : bool, optional
        Compute the energy that each load step dissipates.
    progress : callable, optional
        Called with every state as it is found.
    resume : Checkpoint, optional
        State of an earlier run of the same cycle to go on from, to the same result bit for bit.
    keep : callable, optional
        Called at every new state with a function that makes its checkpoint.

    Returns
    -------
    CycleRecord
        All states in equilibrium, and what ended the cycle.

    Raises
    ------
    ValueError
        If a smooth sphere would already outgrow the field at the largest penetration, the field
        begins too far outside to make contact in, or the solver is unknown.
    """
    refuse_outgrown(field, schedule.max_penetration)
    _refuse_untouched(field)
    history = FrontHistory(
        field,
        np.full(n_angle(field), first_radius(field)),
        tolerance=tolerance,
        max_sweeps=max_sweeps,
        solver=solver,
        record_fronts=record_fronts,
        record_energy=record_energy,
        progress=progress,
        resume=resume,
        keep=keep,
    )
    for penetration, direction in loads(schedule):
        if history.follow(penetration, direction) is not Status.CONVERGED:
            break
    return history.record()


def refuse_outgrown(field: Field, max_penetration: float) -> None:
    """Raise if a smooth sphere is larger than the field before its load is fully applied."""
    smooth = jkr.equilibrium_radius(max_penetration)
    if smooth >= last_radius(field):
        raise ValueError(
            f"contact outgrows the field: a smooth sphere at penetration {max_penetration} has "
            f"radius {smooth:.4g}, the field ends at {last_radius(field):.4g}; enlarge the field "
            "or lower the penetration"
        )


def _refuse_untouched(field: Field) -> None:
    """Raise if the innermost circle of a field is too large for contact to be made in it."""
    radius = first_radius(field)
    needed = float(jkr.apparent_work_of_adhesion(radius, 0.0))
    adhesion = front_adhesion(np.full(n_angle(field), radius), field) / WORK_OF_ADHESION
    # A circle that needs next to no adhesion is the first touch, whatever is found there.
    if needed > max(float(np.mean(adhesion)), 1e-3):
        raise ValueError(
            f"field begins at radius {radius:.4g}, where a contact at penetration 0 needs a mean "
            f"work of adhesion of {needed:.4g} w_int but finds {np.mean(adhesion):.4g}; "
            "add samples at smaller radii"
        )
