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
    force, penetration = np.broadcast_arrays(force, penetration)
    root = np.sqrt(np.abs(penetration))
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.asarray(-force / root**3)
        inside = penetration > 0
        pulled = inside & (part > 1)
        into, above = inside & ~pulled, ~inside
        radius = np.empty(part.shape)
        radius[into] = np.cos(np.arccos(np.clip(part[into], -1, 1)) / 3)
        radius[pulled] = np.cosh(np.arccosh(part[pulled]) / 3)
        radius[above] = np.sinh(np.arcsinh(part[above]) / 3)
        radius = 2 * root * radius
    radius = np.where(root > 0, radius, np.cbrt(-2 * force))
    possible = np.where(inside, part >= -1, force < 0)
    return np.where(possible & (radius > 0), radius, np.nan)


def force_at(penetration: Array, work_of_adhesion: Array) -> Array:
    r"""Force of the stable JKR contact at a penetration, of pull-off at any that is lower.

    The root of the radius is the largest root of :math:`s^4 - p s - b = 0`,
    :math:`p^2 = 8 w / 3`, with y of its resolvent, :math:`y^3 + b y - p^2 / 8 = 0`.
    """
    pull_off = jkr.equilibrium_penetration(np.cbrt(work_of_adhesion / 6), work_of_adhesion)
    b = np.maximum(penetration, pull_off)
    p = np.sqrt(8 * work_of_adhesion / 3)
    m = np.sqrt(2 * radius_at(-(p**2) / 16, -b / 3))
    root = (m + np.sqrt(np.maximum(2 * p / m - m**2, 0.0))) / 2
    return jkr.force(root**2, b)
