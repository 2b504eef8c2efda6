"""Radius, force and penetration of a JKR contact, two of which give the third, in reduced units.

These relations are valid for an edge at any radius, in equilibrium or not, and so everywhere
between approach and retraction. Source: supplement, Sec. I A.
"""

from __future__ import annotations

import numpy as np

from crackfront.core import jkr
from crackfront.core.arrays import Array


def penetration_at(radius: Array, force: Array) -> Array:
    """Penetration b of an edge at radius a under a force, F = a^3 + 3/2 a (b - a^2)."""
    return np.asarray(radius**2 + (force - radius**3) / (1.5 * radius))


def radius_at(force: Array, penetration: Array) -> Array:
    r"""Radius of the edge at a force and a penetration, the largest root of a^3 - 3 a b + 2 F = 0.

    NaN where the force is larger than the force of Hertz, :math:`b^{3/2}`, which no edge has.
    """
    # Roots of a depressed cubic: of three real ones the largest, or the only one.
    root = np.sqrt(np.abs(penetration))
    with np.errstate(divide="ignore", invalid="ignore"):
        part = -force / root**3
        into = 2 * root * np.cos(np.arccos(np.clip(part, -1, 1)) / 3)
        pulled = 2 * root * np.cosh(np.arccosh(np.maximum(part, 1)) / 3)
        above = 2 * root * np.sinh(np.arcsinh(part) / 3)
    radius = np.where(penetration > 0, np.where(part > 1, pulled, into), above)
    radius = np.where(root > 0, radius, np.cbrt(-2 * force))
    possible = np.where(penetration > 0, part >= -1, force < 0)
    return np.where(possible & (radius > 0), radius, np.nan)


def force_at(penetration: Array, work_of_adhesion: float) -> Array:
    r"""Force of the stable JKR contact at a penetration, of pull-off at any that is lower.

    The root of the radius is the largest root of :math:`s^4 - p s - b = 0`,
    :math:`p^2 = 8 w / 3`, with y of its resolvent, :math:`y^3 + b y - p^2 / 8 = 0`.
    """
    b = np.maximum(penetration, jkr.pull_off_penetration(work_of_adhesion))
    p = np.sqrt(8 * work_of_adhesion / 3)
    m = np.sqrt(2 * radius_at(np.full(b.shape, -(p**2) / 16), -b / 3))
    root = (m + np.sqrt(np.maximum(2 * p / m - m**2, 0.0))) / 2
    return jkr.force(root**2, b)
