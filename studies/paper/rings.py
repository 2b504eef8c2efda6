"""Rings of a work of adhesion about the apex of a sphere, on which a front is one radius."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load, Step, follow
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.field.fields import RayField
from crackfront.core.geometry.sphere import polar_field
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Newton
from crackfront.core.units import WORK_OF_ADHESION

INNERMOST = 1e-3
"""Radius at which contact is made."""

_TOLERANCE = 1e-13
"""Force that may be left on a circle, relative to w_int: next to pull-off it is soft."""

_PATH = 257
"""Points between two states at which a fold of the equilibria is looked for."""


class Rings(NamedTuple):
    """Rings of w_loc(a) = 1 + delta sin(2 pi a / d), delta in w_int, d in reduced lengths."""

    amplitude: float
    wavelength: float

    def adhesion(self, radius: ArrayLike) -> Array:
        """Work of adhesion at a distance from the apex (Units: w_int)."""
        phase = 2 * np.pi * np.asarray(radius) / self.wavelength
        return np.asarray(1 + self.amplitude * np.sin(phase))

    def penetration(self, radius: ArrayLike) -> Array:
        """Penetration b_eq(a) at which a front is in equilibrium, stable or not."""
        return jkr.equilibrium_penetration(radius, self.adhesion(radius))

    def outermost(self, penetration: float) -> float:
        """Radius that no front gets beyond at a penetration."""
        return jkr.equilibrium_radius(penetration, 1 + self.amplitude) + self.wavelength

    def field(self, penetration: float, samples: int) -> RayField:
        """Field as far as a front may get at a penetration, with so many samples a wavelength."""
        largest = self.outermost(penetration)
        count = math.ceil((largest - INNERMOST) / self.wavelength * samples)
        radius = np.linspace(INNERMOST, largest, count)
        return polar_field(radius, WORK_OF_ADHESION * self.adhesion(radius), "cubic")

    def loop(self, schedule: LoadSchedule, samples: int) -> Array:
        """Rows of direction, penetration, radius and jump (0 or 1) of a whole loop."""
        rows = []
        for step in circle_steps(self.field(schedule.max_penetration, samples), schedule.loads()):
            penetration, direction, _ = step.load
            passed = self.penetration(np.linspace(step.before[0], step.front[0], _PATH))
            jump = np.any(direction * np.diff(passed) < 0)
            rows.append((direction, penetration, step.front[0], jump))
        return np.array(rows, dtype=float)

    def mean_adhesion(self, low: float, high: float, count: int, samples: int) -> Array:
        """Means of the works of adhesion in approach and retraction, at so many penetrations."""
        window = low + (high - low) * (np.arange(count) + 0.5) / count
        # From there on every front of the retraction rests on a ring not reached before.
        turn = float(jkr.equilibrium_penetration(self.outermost(high), 1 - self.amplitude))
        visited = [Load(float(b), 1) for b in [*window, turn]]
        visited += [Load(float(b), -1) for b in window[::-1]]
        steps = circle_steps(self.field(turn, samples), visited)
        adhesion = self.adhesion([step.front[0] for step in steps])
        return np.array([adhesion[:count].mean(), adhesion[count + 1 :].mean()])

    def draw(self, axes: Axes, reach: float) -> None:
        """Draw the half at negative y from above, and the scale of its greys."""
        along, across = np.linspace(-reach, reach, 801), np.linspace(-reach, 0, 401)
        image = axes.imshow(
            self.adhesion(np.hypot(*np.meshgrid(along, across))),
            extent=(-reach, reach, -reach, 0),
            cmap="Greys",
            vmin=1 - 1.5 * self.amplitude,
            vmax=1 + 2 * self.amplitude,
            interpolation="bilinear",
            origin="lower",
        )
        bar = axes.inset_axes((1.03, 0.0, 0.03, 1.0))
        axes.figure.colorbar(image, cax=bar, label=r"$w_\mathrm{loc}/w_\mathrm{int}$")
        bar.set_ylim(1 - self.amplitude, 1 + self.amplitude)


def circle_steps(
    field: RayField, loads: Iterable[Load], start: float = INNERMOST
) -> Iterator[Step]:
    """Steps of a circular front on one ray, from a radius until contact is lost.

    A RuntimeError says if a step ends otherwise. (Units: reduced lateral length)
    """
    for step in follow(field, np.array([start]), loads, Newton(_TOLERANCE)):
        if step.status is Status.LOST_CONTACT:
            return
        if step.status is not Status.CONVERGED:
            raise RuntimeError(f"no state at penetration {step.load.value}: {step.status.value}")
        yield step


def first_stops(rings: Rings, penetration: Array, direction: int, start: float) -> Array:
    """Radii at which a front on the rings first rests, by the closed form of b_eq.

    In approach that is where the running maximum of b_eq from the start reaches each penetration,
    in retraction its running minimum: its folds are found first, then the root between two of them.

    They are (n_load,) as the penetrations, NaN where no rest is left. (Units: reduced lengths)
    """
    largest = max(float(np.max(penetration)), 0.0)
    end = rings.outermost(largest) if direction > 0 else INNERMOST
    nodes = folds(rings, min(start, end), max(start, end))[::direction]
    reached = direction * rings.penetration(nodes)
    stops = np.full(penetration.size, np.nan)
    for index, load in enumerate(penetration):
        beyond = np.flatnonzero(reached >= direction * load)
        if beyond.size and (first := beyond[0]) > 0:
            between = nodes[first - 1], nodes[first]
            stops[index] = brentq(
                lambda a, b=load: float(rings.penetration(a)) - b, *between, xtol=1e-15
            )
        elif beyond.size:
            stops[index] = nodes[0]
    return stops


def folds(rings: Rings, low: float, high: float) -> Array:
    """Ends of an interval of radii and the extrema of b_eq within, increasing."""

    def slope(radius: float) -> float:
        adhesion = float(rings.adhesion(radius))
        turn = 2 * math.pi / rings.wavelength
        rise = rings.amplitude * turn * math.cos(turn * radius)
        root = math.sqrt(radius * adhesion)
        return 2 * radius - math.sqrt(2 / 3) * (adhesion + radius * rise) / root

    grid = np.linspace(low, high, 64 * math.ceil((high - low) / rings.wavelength) + 2)
    sign = np.sign([slope(radius) for radius in grid])
    turns = [
        brentq(slope, grid[i], grid[i + 1], xtol=1e-15)
        for i in np.flatnonzero(sign[:-1] * sign[1:] < 0)
    ]
    return np.array([low, *turns, high])


def steady_stiffness(radius: Array, adhesion: float = 1.0) -> Array:
    """Rise of G at fixed b where it is w, S = sqrt(6 w a) - w / a (Units: w_int / length)."""
    return np.asarray(np.sqrt(6 * adhesion * radius) - adhesion / radius)
