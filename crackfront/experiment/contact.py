"""Radius, force and penetration of a JKR contact, two of which give the third, in reduced units.

Where the edge rests somewhere between approach and retraction, these relations hold as well: they
are those of a sphere whose edge is at a radius, not of an edge in equilibrium. Source: supplement,
Sec. I A.
"""

from __future__ import annotations

import numpy as np

from crackfront.core.arrays import Array


def penetration_at(radius: Array, force: Array) -> Array:
    """Penetration b of an edge at radius a under a force, F = a^3 + 3/2 a (b - a^2)."""
    return np.asarray(radius**2 + (force - radius**3) / (1.5 * radius))


def radius_at(force: Array, penetration: Array) -> Array:
    r"""Radius of the edge at a force and a penetration, the largest root of a^3 - 3 a b + 2 F = 0.

    NaN where the force is larger than that of Hertz, :math:`b^{3/2}`, which no edge has.
    """
    # Roots of a depressed cubic: of three real ones the largest, or the only one.
    root = np.sqrt(np.abs(penetration))
    with np.errstate(divide="ignore", invalid="ignore"):
        part = -force / root**3
        into = 2 * root * np.cos(np.arccos(np.clip(part, -1, 1)) / 3)
        pulled = 2 * root * np.cosh(np.arccosh(np.maximum(part, 1)) / 3)
        above = 2 * root * np.sinh(np.arcsinh(part) / 3)
    found = np.where(penetration > 0, np.where(part > 1, pulled, into), above)
    found = np.where(root > 0, found, np.cbrt(-2 * force))
    possible = np.where(penetration > 0, part >= -1, force < 0)
    return np.where(possible & (found > 0), found, np.nan)
