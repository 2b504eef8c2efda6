"""Main Fig. 2: a sphere whose work of adhesion varies in concentric rings, a scalar problem."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from crackfront.core import jkr
from crackfront.core.cycle.follow import Load, follow
from crackfront.core.cycle.schedule import LoadSchedule, loads
from crackfront.core.field.fields import RayField, polar_field
from crackfront.core.outcome import Direction, Status
from crackfront.core.records import ADHESION, FORCE, LATERAL, VERTICAL, variable
from crackfront.core.solver.relax import Newton
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.data.section import Count, Positive, Section, refusal
from crackfront.studies.paper.figure import Progress
from crackfront.studies.paper.main_1d import INNERMOST, TOLERANCE

Array = NDArray[np.float64]

_STATE, _LOOP, _CASE = "state", "loop", "case"

_PATH = 257
"""Points between two states at which a fold of the equilibria is looked for."""

Amplitude = Annotated[float, Field(gt=0, lt=1)]


class RingsParameters(Section):
    """What Fig. 2 shows.

    Attributes
    ----------
    amplitude : float
        Amplitude delta of w_loc(a) = 1 + delta sin(2 pi a / d). (Units: w_int)
    wavelengths : tuple of two float
        The long and the short wavelength d. (Units: reduced lateral length)
    max_penetration, step : float
        Penetrations to visit. (Units: reduced vertical length)
    samples : int
        Samples of the field a wavelength.
    case_amplitude : float
        Amplitude of the cases that are compared with numbers known beforehand. (Units: w_int)
    case_wavelengths : tuple of float
        Their wavelengths. (Units: reduced lateral length)
    case_window : tuple of two float
        Penetrations between which their hysteresis is averaged. (Units: reduced vertical length)
    case_step : float
        Distance of these penetrations. (Units: reduced vertical length)
    """

    amplitude: Amplitude
    wavelengths: tuple[Positive, Positive]
    max_penetration: Positive
    step: Positive
    samples: Count
    case_amplitude: Amplitude
    case_wavelengths: tuple[Positive, ...]
    case_window: tuple[Positive, Positive]
    case_step: Positive

    @model_validator(mode="after")
    def _usable(self) -> RingsParameters:
        for name, (low, high) in (
            ("wavelengths", self.wavelengths[::-1]),
            ("case_window", self.case_window),
        ):
            if not low < high:
                order = "decrease" if name == "wavelengths" else "increase"
                raise refusal(f"{name} are {list(getattr(self, name))}; they must {order}")
        if self.samples < 16:
            raise refusal(f"samples is {self.samples}; a ring needs at least 16 of them")
        low, high = self.case_window
        if self.case_step > high - low:
            raise refusal(f"case_step {self.case_step:g} is longer than case_window; lower it")
        return self


@dataclass(frozen=True, slots=True)
class RingLoops:
    """States of the loops, and the mean hysteresis of the cases."""

    amplitude: float = variable("amplitude of the work of adhesion", ADHESION)
    wavelength: Array = variable("wavelength of the rings", LATERAL, _LOOP)
    loop: NDArray[np.int64] = variable("index of the loop", "1", _STATE)
    direction: NDArray[np.int64] = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", VERTICAL, _STATE)
    radius: Array = variable("contact radius", LATERAL, _STATE)
    force: Array = variable("normal force", FORCE, _STATE)
    adhesion: Array = variable("energy release rate of the front", ADHESION, _STATE)
    jump: NDArray[np.int64] = variable("1 where an instability led to the state", "1", _STATE)
    case_amplitude: float = variable("amplitude of the cases", ADHESION)
    case_lowest: float = variable("lowest penetration of the averages", VERTICAL)
    case_highest: float = variable("highest penetration of the averages", VERTICAL)
    case_wavelength: Array = variable("wavelength of a case", LATERAL, _CASE)
    case_approach: Array = variable("mean work of adhesion in approach", ADHESION, _CASE)
    case_retraction: Array = variable("mean work of adhesion in retraction", ADHESION, _CASE)

    def branch(self, loop: int, direction: int) -> NDArray[np.bool_]:
        """States of one branch of a loop."""
        return (self.loop == loop) & (self.direction == direction)


def ring_adhesion(radius: ArrayLike, amplitude: float, wavelength: float) -> Array:
    """Work of adhesion of the rings, 1 + delta sin(2 pi a / d).

    Parameters
    ----------
    radius : array_like
        Distance from the apex. (Units: reduced lateral length)
    amplitude : float
        delta. (Units: w_int)
    wavelength : float
        d. (Units: reduced lateral length)

    Returns
    -------
    array
        Work of adhesion. (Units: w_int)
    """
    return np.asarray(1 + amplitude * np.sin(2 * np.pi * np.asarray(radius) / wavelength))


def ring_penetration(radius: ArrayLike, amplitude: float, wavelength: float) -> Array:
    """Penetration at which a front on the rings is in equilibrium, stable or not.

    Parameters
    ----------
    radius, amplitude, wavelength
        As in :func:`ring_adhesion`.

    Returns
    -------
    array
        b_eq(a). (Units: reduced vertical length)
    """
    return jkr.equilibrium_penetration(radius, ring_adhesion(radius, amplitude, wavelength))


def ring_loops(parameters: RingsParameters, progress: Progress) -> RingLoops:
    """Approach and retraction on rings of both wavelengths, and the cases.

    Parameters
    ----------
    parameters : RingsParameters
        What to compute.
    progress : callable
        Called with a line for every loop.
    """
    loops = []
    for index, wavelength in enumerate(parameters.wavelengths):
        states = _loop(parameters, wavelength)
        loops.append(np.column_stack([np.full(len(states), index), states]))
        progress(f"rings of {wavelength:g}: {len(states)} states, {states[:, 3].sum():g} jumps")
    loop, direction, penetration, radius, jump = np.concatenate(loops).T
    cases = [_mean_adhesion(parameters, wavelength) for wavelength in parameters.case_wavelengths]
    progress(f"{len(cases)} cases with an amplitude of {parameters.case_amplitude:g}")
    means = np.array(cases)
    return RingLoops(
        amplitude=parameters.amplitude,
        wavelength=np.array(parameters.wavelengths),
        loop=loop.astype(np.int64),
        direction=direction.astype(np.int64),
        penetration=penetration,
        radius=radius,
        force=jkr.force(radius, penetration),
        adhesion=jkr.apparent_work_of_adhesion(radius, penetration),
        jump=jump.astype(np.int64),
        case_amplitude=parameters.case_amplitude,
        case_lowest=parameters.case_window[0],
        case_highest=parameters.case_window[1],
        case_wavelength=np.array(parameters.case_wavelengths),
        case_approach=means[:, 0],
        case_retraction=means[:, 1],
    )


def _loop(parameters: RingsParameters, wavelength: float) -> Array:
    """Rows of direction, penetration, radius and jump of a whole loop."""
    amplitude = parameters.amplitude
    schedule = LoadSchedule(parameters.max_penetration, parameters.step)
    field = _rings(amplitude, wavelength, parameters.max_penetration, parameters.samples)
    rows = []
    for direction, penetration, before, after in _states(field, loads(schedule)):
        passed = ring_penetration(np.linspace(before, after, _PATH), amplitude, wavelength)
        jump = bool(np.any(direction * np.diff(passed) < 0))
        rows.append((direction, penetration, after, jump))
    return np.array(rows, dtype=float)


def _mean_adhesion(parameters: RingsParameters, wavelength: float) -> tuple[float, float]:
    """Means over the window of the works of adhesion in approach and retraction."""
    amplitude, (low, high) = parameters.case_amplitude, parameters.case_window
    count = round((high - low) / parameters.case_step)
    window = low + (high - low) * (np.arange(count) + 0.5) / count
    # From there on every front of the retraction rests on a ring that it had not reached before.
    outermost = jkr.equilibrium_radius(high, 1 + amplitude) + wavelength
    turn = float(jkr.equilibrium_penetration(outermost, 1 - amplitude))
    visited = [
        *(Load(float(b), 1) for b in [*window, turn]),
        *(Load(float(b), -1) for b in window[::-1]),
    ]
    field = _rings(amplitude, wavelength, turn, parameters.samples)
    radius = np.array([state[-1] for state in _states(field, visited)])
    adhesion = ring_adhesion(radius, amplitude, wavelength)
    return float(adhesion[:count].mean()), float(adhesion[count + 1 :].mean())


def _states(
    field: RayField, visited: Iterable[Load]
) -> Iterator[tuple[Direction, float, float, float]]:
    """Direction, penetration, radius before and after, until contact is lost."""
    for step in follow(field, np.array([INNERMOST]), visited, Newton(TOLERANCE)):
        load = step.load
        if step.status is Status.LOST_CONTACT:
            return
        if step.status is not Status.CONVERGED:
            raise RuntimeError(f"no state at penetration {load.value}: {step.status.value}")
        yield load.direction, load.value, float(step.before[0]), float(step.front[0])


def _rings(amplitude: float, wavelength: float, penetration: float, samples: int) -> RayField:
    """Rings as far as a front may get at a penetration."""
    largest = jkr.equilibrium_radius(penetration, 1 + amplitude) + wavelength
    count = math.ceil((largest - INNERMOST) / wavelength * samples)
    radius = np.linspace(INNERMOST, largest, count)
    adhesion = WORK_OF_ADHESION * ring_adhesion(radius, amplitude, wavelength)
    return polar_field(radius, adhesion, "cubic")
