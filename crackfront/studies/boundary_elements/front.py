"""The crack front on the heights of a case."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.outcome import Direction, Status
from crackfront.core.rotated import rotated_field
from crackfront.core.solver.relax import Newton
from crackfront.studies.boundary_elements.parameters import Case
from crackfront.studies.boundary_elements.perimeter import N_ANGLE

Array = NDArray[np.float64]

_TOLERANCE = 1e-6
"""Force that a front may leave, relative to w_int per front length."""


@dataclass(frozen=True, slots=True)
class FrontCycle:
    """A cycle of the crack front on the heights of a case.

    Attributes
    ----------
    record : CycleRecord
        Its states, with the fronts.
    mapping_seconds, cycle_seconds : float
        Processor time of the field and of the cycle. (Units: s)
    """

    record: CycleRecord
    mapping_seconds: float
    cycle_seconds: float


def front_cycle(case: Case, n_angle: int, spacing: float, *, rotated: bool = True) -> FrontCycle:
    """Cycle of the crack front on the heights of a case.

    Parameters
    ----------
    case : Case
        Surface and load.
    n_angle, spacing, rotated
        As in :func:`crackfront.core.rotated.rotated_field`.

    Raises
    ------
    ValueError
        If the cycle does not end by losing contact.
    """
    began = time.process_time()
    field = rotated_field(
        case.heights(), case.pixel, n_angle, spacing, case.side / 2, rotated=rotated
    )
    mapped = time.process_time()
    record = run_cycle(field, case.schedule, Newton(_TOLERANCE), Recorder(fronts=True))
    if record.status is not Status.LOST_CONTACT:
        raise ValueError(
            f"{case.label}: at penetration {record.end_load:.6g} the front "
            f"{record.status.value}; raise n_angle or lower the spacing"
        )
    return FrontCycle(record, mapped - began, time.process_time() - mapped)


class States(Protocol):
    """What tells which states a cycle visited."""

    @property
    def penetration(self) -> Array:
        """Penetrations, state by state."""

    @property
    def direction(self) -> NDArray[np.int64]:
        """+1 in approach, -1 in retraction."""


def shared_states(one: States, other: States) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices, in both, of the states that two cycles share, in the order of the first."""
    known, asked = (
        [(round(b, 9), d) for b, d in zip(*pair, strict=True)]
        for pair in (
            (other.penetration.tolist(), other.direction.tolist()),
            (one.penetration.tolist(), one.direction.tolist()),
        )
    )
    place = {key: number for number, key in enumerate(known)}
    pairs = [(number, place[key]) for number, key in enumerate(asked) if key in place]
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return first, second


def force_error(found: CycleRecord, exact: CycleRecord) -> float:
    """Rms difference of two cycles' forces where they share a state (Units: pi w_int R)."""
    one, other = shared_states(found.states, exact.states)
    return float(np.sqrt(np.mean((found.states.force[one] - exact.states.force[other]) ** 2)))


def on_rays(radius: Array | None) -> Array:
    """Fronts at the angles of the boundary elements' perimeters, by their Fourier series.

    Parameters
    ----------
    radius : (n_step, n_angle) array
        Fronts. (Units: reduced lateral length)
    """
    if radius is None:
        raise ValueError("the cycle holds no fronts; record them")
    modes = np.fft.rfft(radius, norm="forward")
    return np.asarray(np.fft.irfft(modes, n=N_ANGLE, norm="forward"))


def perimeter_at(penetration: float, direction: Direction, states: States, radius: Array) -> Array:
    """Perimeter of the state of one branch at a penetration.

    Parameters
    ----------
    penetration : float
        Its penetration. (Units: reduced vertical length)
    direction : {1, -1}
        Its branch.
    states : States
        States of the cycle.
    radius : (n_step, n_angle) array
        Their perimeters. (Units: reduced lateral length)

    Raises
    ------
    ValueError
        If the branch has no such state.
    """
    here = np.isclose(states.penetration, penetration, atol=1e-9) & (states.direction == direction)
    if not np.any(here):
        branch = "approach" if direction > 0 else "retraction"
        raise ValueError(
            f"there is no contact at penetration {penetration:g} in {branch}; raise "
            "shown_penetration"
        )
    return np.asarray(radius[here][0])
