"""The states that a cycle visits, and what it takes to go on from one of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from crackfront.core.solver.relax import Direction, Status

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CycleRecord:
    """The metastable states that a cycle visited, in order.

    Attributes
    ----------
    status : Status
        What ended the cycle; a full cycle ends by losing contact.
    end_penetration : float
        Penetration at which it ended (where contact was lost).
    penetration : (n_step,) array
        Rigid body penetration b. (Units: reduced vertical length)
    direction : (n_step,) int array
        +1 in approach, -1 in retraction.
    mean_radius, min_radius, max_radius, rms_radius : (n_step,) array
        Radius of the front; the last is the rms of its deviation from the mean.
        (Units: reduced lateral length)
    force : (n_step,) array
        Normal force. (Units: pi w_int R)
    contact_area : (n_step,) array
        Area within the front. (Units: reduced lateral length**2)
    apparent_work_of_adhesion : (n_step,) array
        <a G> / <a>, in equilibrium the mean of w_loc along the front. (Units: w_int)
    least_travel : (n_step,) array
        Smallest distance that any site has moved since its branch began.
        (Units: reduced lateral length)
    iterations : (n_step,) int array
        Sweeps of the solver.
    updates : (n_step,) int array
        Updates of single sites.
    residual : (n_step,) array
        Largest force along the motion that is left, relative to w_int per front length.
    dissipated_energy : (n_step,) array or None
        Energy lost in the jumps of each load step, where it was asked for; the first includes that
        of making contact. (Units: pi w_int R times a reduced vertical length)
    pull_off_energy : float or None
        Energy lost when the contact vanishes after the last state; with it the dissipated energies
        sum up to the loop integral of F db. None where energies were not asked for or contact was
        not lost. (Units: as dissipated_energy)
    radius : (n_step, n_angle) array or None
        The fronts, where they were asked for. (Units: reduced lateral length)
    """

    status: Status
    end_penetration: float
    penetration: Array
    direction: NDArray[np.int64]
    mean_radius: Array
    min_radius: Array
    max_radius: Array
    rms_radius: Array
    force: Array
    contact_area: Array
    apparent_work_of_adhesion: Array
    least_travel: Array
    iterations: NDArray[np.int64]
    updates: NDArray[np.int64]
    residual: Array
    dissipated_energy: Array | None = None
    pull_off_energy: float | None = None
    radius: Array | None = None


@dataclass(frozen=True, slots=True)
class CycleState:
    """One metastable state; each field is a row of the record that bears the same name."""

    penetration: float
    direction: Direction
    mean_radius: float
    min_radius: float
    max_radius: float
    rms_radius: float
    force: float
    contact_area: float
    apparent_work_of_adhesion: float
    least_travel: float
    iterations: int
    updates: int
    residual: float


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """What a history needs to go on from its last state.

    Attributes
    ----------
    record : CycleRecord
        All states so far.
    front : (n_angle,) array
        Front of the last state. (Units: reduced lateral length)
    turn : (n_angle,) array
        Front at which its branch began. (Units: reduced lateral length)
    """

    record: CycleRecord
    front: Array
    turn: Array


Keep = Callable[[Callable[[], Checkpoint]], None]
"""What is called at every new state, with a function that makes its checkpoint."""


def recorded_states(record: CycleRecord) -> list[CycleState]:
    """States of a record, one by one."""
    columns = {item.name: getattr(record, item.name).tolist() for item in fields(CycleState)}
    rows = zip(*columns.values(), strict=True)
    return [CycleState(**dict(zip(columns, row, strict=True))) for row in rows]
