"""One approach and retraction of a sphere, from first contact to pull-off."""

from __future__ import annotations

from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.touch import checked_touch
from crackfront.core.field.fields import Field
from crackfront.core.solver.relax import Solver


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
        What to record in addition to the curves, observers of every state, and a run to continue.

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
    recorder.run(field, checked_touch(field, schedule.max_penetration), schedule.loads(), solver)
    return recorder.record()
