"""What must be true of rings: first stopping points, limits, numbers that are known."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from crackfront.core import jkr
from crackfront.studies.paper.figure import Check, close_to
from crackfront.studies.paper.main_1d import INNERMOST
from crackfront.studies.paper.rings import RingLoops, ring_adhesion, ring_penetration

Array = NDArray[np.float64]

_KNOWN = {(0.2, 0.3, 0.7, 0.005): (0.3886, 2e-4), (0.2, 0.3, 0.7, 0.1): (0.238, 1e-3)}
"""Hysteresis with its tolerance, by amplitude, window and wavelength, from a separate program."""

_ROUND_OFF = 1e-9


def rings_checks(loops: RingLoops) -> tuple[Check, ...]:
    """First stopping points, the limit of short wavelengths, the states A and B.

    Parameters
    ----------
    loops : RingLoops
        Data of the figure.
    """
    return (*_loop_checks(loops), *_limit_checks(loops), *_case_checks(loops))


def first_stops(
    penetration: Array, direction: int, start: float, amplitude: float, wavelength: float
) -> Array:
    """Radii at which a front on the rings first rests, from where b_eq(a) first reaches b.

    In approach that is the running maximum of b_eq from the start, in retraction its running
    minimum: its folds are found first, then the root between two of them.

    Parameters
    ----------
    penetration : (n,) array
        Rigid body penetrations b. (Units: reduced vertical length)
    direction : {1, -1}
        Outward or inward.
    start : float
        Radius from which the front moves. (Units: reduced lateral length)
    amplitude, wavelength : float
        Of the rings.

    Returns
    -------
    (n,) array
        Radii; NaN where no rest is left. (Units: reduced lateral length)
    """
    largest = jkr.equilibrium_radius(max(float(np.max(penetration)), 0.0), 1 + amplitude)
    end = largest + wavelength if direction > 0 else INNERMOST
    nodes = _folds(min(start, end), max(start, end), amplitude, wavelength)[::direction]
    reached = direction * ring_penetration(nodes, amplitude, wavelength)
    stops = np.full(penetration.size, np.nan)
    for index, load in enumerate(penetration):
        beyond = np.flatnonzero(reached >= direction * load)
        if beyond.size:
            first = beyond[0]
            stops[index] = (
                nodes[0]
                if first == 0
                else brentq(
                    lambda a, b=load: float(ring_penetration(a, amplitude, wavelength)) - b,
                    nodes[first - 1],
                    nodes[first],
                    xtol=1e-15,
                )
            )
    return stops


def _folds(low: float, high: float, amplitude: float, wavelength: float) -> Array:
    """Ends of an interval and the extrema of b_eq within, increasing."""

    def slope(radius: float) -> float:
        adhesion = float(ring_adhesion(radius, amplitude, wavelength))
        turn = 2 * math.pi / wavelength
        rise = amplitude * turn * math.cos(turn * radius)
        return 2 * radius - math.sqrt(2 / 3) * (adhesion + radius * rise) / math.sqrt(
            radius * adhesion
        )

    grid = np.linspace(low, high, 64 * math.ceil((high - low) / wavelength) + 2)
    sign = np.sign([slope(radius) for radius in grid])
    turns = [
        brentq(slope, grid[i], grid[i + 1], xtol=1e-15)
        for i in np.flatnonzero(sign[:-1] * sign[1:] < 0)
    ]
    return np.array([low, *turns, high])


def _loop_checks(loops: RingLoops) -> Iterator[Check]:
    """Radii, pull-off, and the states A and B of every loop."""
    for index, wavelength in enumerate(loops.wavelength):
        start = INNERMOST
        for direction, name in ((1, "approach"), (-1, "retraction")):
            branch = loops.branch(index, direction)
            radius, penetration = loops.radius[branch], loops.penetration[branch]
            stops = first_stops(penetration, direction, start, loops.amplitude, wavelength)
            start = radius[-1]
            yield close_to(
                f"rings of {wavelength:g}, {name}: radii, first points where b_eq(a) reaches b, "
                "largest difference",
                float(np.max(np.abs(radius - stops))),
                0.0,
                _ROUND_OFF,
                remark="folds and roots of the closed form of b_eq, without the solver",
            )
        folds = _folds(INNERMOST, start, loops.amplitude, wavelength)
        yield close_to(
            f"rings of {wavelength:g}: last penetration, the lowest b_eq, within a load step",
            penetration[-1],
            float(ring_penetration(folds, loops.amplitude, wavelength).min()),
            float(np.max(np.abs(np.diff(penetration)))) * (1 + 1e-9),
        )
        closed = loops.penetration == 0
        inner = loops.radius[loops.branch(index, 1) & closed]
        outer = loops.radius[loops.branch(index, -1) & closed]
        yield Check(
            f"rings of {wavelength:g}: a(A) < a(B) at b = 0",
            "a(A) < a(B)",
            f"{inner[0]:.6f}, {outer[0]:.6f}",
            bool(inner[0] < outer[0]),
        )


def _limit_checks(loops: RingLoops) -> Iterator[Check]:
    """The short rings of the figure against JKR with the extremes of their work of adhesion."""
    index = int(np.argmin(loops.wavelength))
    wavelength = loops.wavelength[index]
    for direction, name in ((1, "approach"), (-1, "retraction")):
        # The steady part: between the first and the last instability, whole rings.
        states = np.flatnonzero(loops.branch(index, direction))
        jumps = states[loops.jump[states] > 0]
        steady = slice(jumps[1], jumps[-1]) if direction > 0 else slice(jumps[0], jumps[-1])
        # In a ring the front goes on from the landing of its jump, S d away, to the extreme.
        extreme = 1 - direction * loops.amplitude
        half = float(np.mean(_stiffness(loops.radius[steady], extreme))) * wavelength / 2
        yield close_to(
            f"rings of {wavelength:g}, {name}: mean work of adhesion, the extreme of the field "
            "and half of the fall S d in a jump",
            float(np.mean(loops.adhesion[steady])),
            extreme + direction * half,
            half * math.sqrt(half / loops.amplitude),
            units="w_int",
            remark="the tolerance is of the next order, as a rounded extreme holds the front",
        )
    states = loops.loop == index
    lowest = float(loops.force[states].min())
    limit = jkr.pull_off_force(1 + loops.amplitude)
    sharpest = float(_stiffness(loops.radius[states].max(), 1 + loops.amplitude))
    reach = jkr.pull_off_force(sharpest * wavelength)
    yield close_to(
        f"rings of {wavelength:g}: pull-off force, -3/2 w_retr or less by the fall S d in a jump",
        lowest,
        limit - reach / 2,
        abs(reach) / 2,
        units="pi w_int R",
    )


def _case_checks(loops: RingLoops) -> Iterator[Check]:
    """Mean hysteresis of the cases, known beforehand or in a limit."""
    delta, low, high = loops.case_amplitude, loops.case_lowest, loops.case_highest
    radii = [jkr.equilibrium_radius(b) for b in np.linspace(low, high, 21)]
    stiffness = float(np.mean(_stiffness(np.array(radii))))
    softest = float(np.min(_stiffness(np.array(radii))))
    for wavelength, approach, retraction in zip(
        loops.case_wavelength, loops.case_approach, loops.case_retraction, strict=True
    ):
        name = f"amplitude {delta:g}, rings of {wavelength:g}: mean hysteresis"
        found = retraction - approach
        known = _KNOWN.get((delta, low, high, float(wavelength)))
        if known is not None:
            remark = f"mean over b from {low:g} to {high:g}; from a program of its own"
            yield close_to(name, found, *known, units="w_int", remark=remark)
        fall = stiffness * wavelength
        if wavelength == loops.case_wavelength.min():
            yield close_to(
                f"{name}, peak to peak less the fall in the jumps, 2 delta - S d",
                found,
                2 * delta - fall,
                fall * math.sqrt(fall / (2 * delta)),
                units="w_int",
                remark=f"the limit d -> 0 is 2 delta = {2 * delta:g}; the tolerance is of the next "
                "order, S d sqrt(S d / 2 delta), as a rounded extreme holds the front",
            )
        critical = 2 * math.pi * delta / softest
        if wavelength > critical:
            remark = f"no instability beyond 2 pi delta / S = {critical:.3f}"
            yield close_to(name, found, 0.0, _ROUND_OFF, units="w_int", remark=remark)


def _stiffness(radius: Array, adhesion: float = 1.0) -> Array:
    """Rise of G at fixed b where it is w, S = sqrt(6 w a) - w / a (Units: w_int / length)."""
    return np.asarray(np.sqrt(6 * adhesion * radius) - adhesion / radius)
