"""The crack front on the heights of a case, and states that it and boundary elements share."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fftfreq, irfft2, rfft2, rfftfreq

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.cycle.energy import contact_energy
from crackfront.core.cycle.record import Recorder
from crackfront.core.cycle.run import first_touch, refuse_outgrown, run_cycle
from crackfront.core.field.fields import RayField, polar_field
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.outcome import Direction, Status
from crackfront.core.solver.relax import Newton
from crackfront.core.units import WORK_OF_ADHESION
from studies.boundary_elements.cycle import N_ANGLE, BoundaryCycle
from studies.boundary_elements.parameters import BranchSchedule, Case
from studies.boundary_elements.rotated import adhesion_on_rays, rotated_field

Array = NDArray[np.float64]

_TOLERANCE = 1e-6
"""Force that a front may leave, relative to w_int per front length."""


@dataclass(frozen=True, slots=True)
class FrontCycle:
    """A cycle of the crack front on the heights of a case.

    Attributes
    ----------
    states : ContactState
        Its states.
    radius : (n_step, N_ANGLE) array
        Their fronts at the angles of the boundary elements' perimeters, by their Fourier series.
        (Units: reduced lateral length)
    energy : (n_step,) array
        Energies of the contacts above that of none. (Units: pi w_int R times a reduced vertical
        length)
    end : float
        Penetration at which it lost contact. (Units: reduced vertical length)
    rotated : bool
        Whether the crack turned with the angle.
    mapping_seconds, cycle_seconds : float
        Processor time of the field and of the cycle. (Units: s)
    """

    states: ContactState[Any]
    radius: Array
    energy: Array
    end: float
    rotated: bool
    mapping_seconds: float
    cycle_seconds: float


States = BoundaryCycle | ContactState[Any]
"""What tells penetrations and directions, state by state."""


def front_cycle(
    case: Case,
    n_angle: int,
    spacing: float,
    *,
    rotated: bool = True,
    zone: float = 0.0,
    squared: bool = False,
) -> FrontCycle:
    """Cycle of the crack front on the heights of a case.

    The field is that of :func:`studies.boundary_elements.rotated.rotated_field`.

    Parameters
    ----------
    case : Case
        Heights and loads.
    n_angle, spacing, rotated
        As of :func:`studies.boundary_elements.rotated.rotated_field`.
    zone : float, optional
        Length of the cohesive zone, over which the edge feels the mean of the heights: they count
        by exp(-q zone / 2). The energy of full conformity is that of the heights themselves.
        (Units: reduced lateral length)
    squared : bool, optional
        Whether the energy release rate has the square of the stress intensity of the roughness
        where it acts, in place of its mean e_el (SI I C).

    Raises
    ------
    ValueError
        If the front fails, or loses contact within the steady parts of its branches.
    """
    began = time.process_time()
    heights = case.heights()
    if zone > 0 or squared:
        field = _changed_field(heights, case.pixel, n_angle, spacing, zone, squared)
    else:
        field = rotated_field(heights, case.pixel, n_angle, spacing, case.side / 2, rotated=rotated)
    mapped = time.process_time()
    recorder, solver = Recorder(fronts=True), Newton(_TOLERANCE)
    if isinstance(case.schedule, BranchSchedule):
        refuse_outgrown(field, case.schedule.max_penetration)
        recorder.run(field, first_touch(field), case.schedule.loads(), solver)
        record, expected = recorder.record(), Status.CONVERGED
    else:
        record = run_cycle(field, case.schedule, solver, recorder)
        expected = Status.LOST_CONTACT
    ended = time.process_time()
    if record.status is not expected:
        raise ValueError(
            f"{case.label}: at penetration {record.end_load:.6g} the front "
            f"{record.status.value}; raise n_angle or lower the spacing"
        )
    fronts = np.asarray(record.fronts)
    modes = np.fft.rfft(fronts, norm="forward")
    radius = np.fft.irfft(modes, n=N_ANGLE, norm="forward")
    energy = [
        contact_energy(front, load, field)
        for front, load in zip(fronts, record.states.penetration.tolist(), strict=True)
    ]
    return FrontCycle(
        states=record.states,
        radius=radius,
        energy=np.array(energy),
        end=record.end_load,
        rotated=rotated,
        mapping_seconds=mapped - began,
        cycle_seconds=ended - mapped,
    )


def _changed_field(
    heights: Array, pixel: float, n_angle: int, spacing: float, zone: float, squared: bool
) -> RayField:
    """Field of a front with a cohesive zone, or with the square of the stress intensity."""
    along = 2 * np.pi * fftfreq(len(heights), pixel)
    across = 2 * np.pi * rfftfreq(len(heights), pixel)
    weight = np.exp(-0.5 * zone * np.hypot(along[:, None], across))
    averaged = irfft2(weight * rfft2(heights), s=heights.shape)
    n_sample = math.ceil(len(heights) * pixel / 2 / spacing)
    angles = 2 * np.pi * np.arange(n_angle) / n_angle
    values = adhesion_on_rays(averaged, pixel, angles, spacing, n_sample)
    # -sqrt(2 w_int / E') K, whose square is 4 w_int times the K^2 / 2 E' of mean e_el.
    values -= (1 - rough_adhesion(averaged, pixel).e_el) * WORK_OF_ADHESION
    e_el = rough_adhesion(heights, pixel).e_el * WORK_OF_ADHESION
    lowering = values**2 / (4 * WORK_OF_ADHESION) if squared else e_el
    values += WORK_OF_ADHESION - lowering
    return polar_field(spacing * np.arange(1.0, n_sample + 1), values, "cubic")


def shared_states(one: States, other: States) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices, in both, of the states that two cycles share, in the order of the first."""
    asked, known = (
        [
            (round(penetration, 9), direction)
            for penetration, direction in zip(
                states.penetration.tolist(), states.direction.tolist(), strict=True
            )
        ]
        for states in (one, other)
    )
    place = {key: number for number, key in enumerate(known)}
    pairs = [(number, place[key]) for number, key in enumerate(asked) if key in place]
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    return first, second


def force_error(found: FrontCycle, exact: FrontCycle) -> float:
    """Rms difference of two cycles' forces where they share a state (Units: pi w_int R)."""
    one, other = shared_states(found.states, exact.states)
    return float(np.sqrt(np.mean((found.states.force[one] - exact.states.force[other]) ** 2)))


def perimeter_at(penetration: float, direction: Direction, states: States, radius: Array) -> Array:
    """Perimeter of the state of one branch at a penetration, of all perimeters of a cycle.

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
