"""What boundary elements are expected to cost before they are run."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from crackfront.core import jkr
from crackfront.core.cycle.schedule import LoadSchedule
from studies.boundary_elements.parameters import BranchSchedule, Case

_STEP_SECONDS = 6e-8
"""Time of a load step over the cube of the points along a side: 4e-8 to 9e-8 were measured from 64
to 512 points, smooth to e_el = 0.18, in steps of 0.01 to 0.1. (Units: s)"""


def expected_seconds(cases: Iterable[Case], folder: Path) -> float:
    """Processor time that cases which a folder does not hold are expected to take, roughly.

    Parameters
    ----------
    cases : iterable of Case
        What is asked for; those that were begun are left out.
    folder : Path
        Where finished load steps are kept.

    Returns
    -------
    float
        Its sum. (Units: s)
    """
    return sum(
        _STEP_SECONDS * case.n_point**3 * _n_load(case.schedule)
        for case in cases
        if not (folder / f"{case.stem}.nc").exists()
    )


def _n_load(schedule: LoadSchedule | BranchSchedule) -> float:
    """Load steps of a schedule; a full cycle ends near the pull-off of a smooth sphere."""
    if isinstance(schedule, BranchSchedule):
        return len([*schedule.loads()])
    return (2 * schedule.max_penetration - jkr.pull_off_penetration()) / schedule.step
