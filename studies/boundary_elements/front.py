"""The crack front on the heights of a case, and states that it and boundary elements share."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.touch import checked_touch
from crackfront.core.field.fields import RayField
from crackfront.core.geometry.sphere import ContactState, polar_field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Newton
from studies.boundary_elements.cases import Case
from studies.boundary_elements.cycle import N_ANGLE, BoundaryCycle
from studies.boundary_elements.rotated import adhesion_on_rays

States = BoundaryCycle | ContactState[Any]

_TOLERANCE = 1e-6
"""Force that a front may leave, relative to w_int per front length."""


@dataclass(frozen=True, slots=True)
class FrontCycle:
    """A cycle of the crack front on the heights of a case."""

    states: ContactState[Any]
    radius: Array  # fronts at the angles of the perimeters, (n_step, N_ANGLE) (reduced lateral)
    field: RayField  # work of adhesion along its rays
    end: float  # penetration at which it lost contact (reduced vertical length)
    rotated: bool  # whether its crack turned with the angle
    seconds: float


def front_cycle(case: Case, n_angle: int, spacing: float, *, rotated: bool = True) -> FrontCycle:
    """Cycle of a crack front of so many sites, from samples along rays a spacing apart.

    A ValueError says if it fails, or loses contact within the steady parts of its branches.
    """
    began = time.process_time()
    angles = 2 * np.pi * np.arange(n_angle) / n_angle
    heights, n_sample = case.heights(), math.ceil(case.side / 2 / spacing)
    values = adhesion_on_rays(heights, case.pixel, angles, spacing, n_sample, rotated=rotated)
    field = polar_field(spacing * np.arange(1.0, n_sample + 1), values, "cubic")
    recorder = Recorder(fronts=True)
    start = checked_touch(field, case.loads.max_penetration)
    recorder.run(field, start, case.loads.loads(0.0), Newton(_TOLERANCE))
    record, ended = recorder.record(), time.process_time()
    if record.status is not (Status.CONVERGED if case.loads.steady else Status.LOST_CONTACT):
        raise ValueError(
            f"{case.label}: at penetration {record.end_load:.6g} the front "
            f"{record.status.value}; raise n_angle or lower the spacing"
        )
    fronts = np.asarray(record.fronts)
    return FrontCycle(
        states=record.states,
        radius=np.fft.irfft(np.fft.rfft(fronts, norm="forward"), n=N_ANGLE, norm="forward"),
        field=field,
        end=record.end_load,
        rotated=rotated,
        seconds=ended - began,
    )


def shared_states(
    first_states: States, second_states: States
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices, in both, of the states that two cycles share, in the order of the first."""
    first_loads, second_loads = (
        list(zip(np.round(states.penetration, 9).tolist(), states.direction.tolist(), strict=True))
        for states in (first_states, second_states)
    )
    place = {key: number for number, key in enumerate(second_loads)}
    pairs = [(number, place[key]) for number, key in enumerate(first_loads) if key in place]
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return first, second


def shown_states(case: Case, states: States) -> list[int]:
    """Indices of the states at the shown penetration, in approach and in retraction."""
    shown, indices = case.loads.shown_penetration, []
    for direction, branch in ((1, "approach"), (-1, "retraction")):
        at = np.isclose(states.penetration, shown, atol=1e-9) & (states.direction == direction)
        if not np.any(at):
            raise ValueError(
                f"{case.label}: the sphere is not in contact at penetration {shown:g} in {branch}; "
                "raise shown_penetration"
            )
        indices.append(int(np.argmax(at)))
    return indices
