"""How a relaxation ends: a status with its sentence, and the front that was reached."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Direction = Literal[1, -1]
"""+1 lets the front advance, as a contact that grows does; -1 lets it recede."""


class DefectError(RuntimeError):
    """A solver found that its result is wrong: a defect of the program, not of the machine."""


class Status(enum.Enum):
    """How a relaxation or a cycle ended; the value is the sentence that says it."""

    CONVERGED = "the front is in equilibrium to the tolerance"
    LOST_CONTACT = "contact was lost: no equilibrium is left at this penetration"
    STEADY = "the steady parts of both branches have been measured"
    LEFT_FIELD_OUTWARD = (
        "the front left the sampled field outward; enlarge the field or reduce the largest load"
    )
    LEFT_FIELD_INWARD = (
        "the front left the sampled field inward; add samples further inside to the field"
    )
    STEP_LIMIT = (
        "the solver reached its limit of sweeps before the tolerance; raise max_sweeps or the "
        "tolerance"
    )
    ROUND_OFF = (
        "the front stands still above the tolerance, because the field rises too steeply for the "
        "digits of the places of its sites; raise the tolerance"
    )


@dataclass(frozen=True, slots=True)
class Relaxation:
    """Outcome of one relaxation."""

    front: NDArray[np.float64]
    """Places of the sites at the end. (Units: reduced lateral length)"""
    status: Status
    sweeps: int
    """Sweeps over the front, counted in pairs of FFTs."""
    updates: int
    """Updates of single sites."""
    residual: float
    """Largest force along the motion that is left, relative to w_int per front length."""
