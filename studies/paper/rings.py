"""Equilibria of a front on rings of high and low work of adhesion, in closed form."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from crackfront.core import jkr
from studies.paper.figure import Array

INNERMOST = 1e-3
"""Radius at which contact is made."""


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


def first_stops(rings: Rings, penetration: Array, direction: int, start: float) -> Array:
    """Radii at which a front on the rings first rests; NaN where no rest is left.

    In approach (direction 1) that is where the running maximum of b_eq from the start reaches each
    penetration, in retraction (-1) its running minimum: its folds are found first, then the root
    between two of them. All lengths are reduced.
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
    """Ends of an interval and the extrema of b_eq within, increasing."""

    def slope(radius: float) -> float:
        adhesion = float(rings.adhesion(radius))
        turn = 2 * math.pi / rings.wavelength
        rise = rings.amplitude * turn * math.cos(turn * radius)
        return 2 * radius - math.sqrt(2 / 3) * (adhesion + radius * rise) / math.sqrt(
            radius * adhesion
        )

    grid = np.linspace(low, high, 64 * math.ceil((high - low) / rings.wavelength) + 2)
    sign = np.sign([slope(radius) for radius in grid])
    turns = [
        brentq(slope, grid[i], grid[i + 1], xtol=1e-15)
        for i in np.flatnonzero(sign[:-1] * sign[1:] < 0)
    ]
    return np.array([low, *turns, high])
