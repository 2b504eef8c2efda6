"""The smooth adhesive sphere of Johnson, Kendall and Roberts, in reduced units.

The penetration b (units: reduced vertical length) is positive into the half-space, the force F
(units: pi w_int R) is positive when it pushes. The contact radius a is in reduced lateral lengths,
the apparent work of adhesion w of a smooth contact in w_int. All functions that take arrays
broadcast. Source: supplement, Sec. I A.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from crackfront.core.arrays import Array
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION


def stress_intensity(radius: ArrayLike, penetration: ArrayLike) -> Array:
    """Stress intensity factor at the contact edge, K = (a^2 - b) E' / sqrt(pi a).

    It is negative where the edge is in compression. (Units: reduced pressure * length**0.5)
    """
    a = np.asarray(radius, dtype=float)
    return np.asarray((a**2 - penetration) * CONTACT_MODULUS / np.sqrt(np.pi * a))


def energy_release_rate(radius: ArrayLike, penetration: ArrayLike) -> Array:
    r"""Energy release rate of an open edge, G = K^2 / 2E' where K > 0 and 0 elsewhere.

    An edge in compression (a^2 < b) releases nothing when it opens; leaving K^2 there would
    create equilibria that do not exist. (Units: reduced energy / area)

    Examples
    --------
    >>> round(float(energy_release_rate((8 / 3) ** (1 / 3), 0.0) * np.pi), 12)
    1.0
    """
    opening = np.maximum(stress_intensity(radius, penetration), 0.0)
    return np.asarray(opening**2 / (2 * CONTACT_MODULUS))


def force(radius: ArrayLike, penetration: ArrayLike) -> Array:
    """Normal force F = 4/3 E' a^3 + 2 a E' (b - a^2)."""
    a = np.asarray(radius, dtype=float)
    return np.asarray(
        4 / 3 * CONTACT_MODULUS * a**3 + 2 * a * CONTACT_MODULUS * (penetration - a**2)
    )


def stored_energy(radius: ArrayLike, penetration: ArrayLike) -> Array:
    """Elastic energy U = E' (b^2 a - 2 a^3 b / 3 + a^5 / 5).

    Its derivative in b is the force, in a it is 2 pi a G. (Units: reduced force * vertical length)
    """
    a, b = np.asarray(radius, dtype=float), np.asarray(penetration, dtype=float)
    return np.asarray(CONTACT_MODULUS * (b**2 * a - 2 * a**3 * b / 3 + a**5 / 5))


def surface_displacement(distance: ArrayLike, radius: float, penetration: float) -> Array:
    r"""Displacement of the half-space, of the Hertzian contact and the flat punch of JKR.

    Within the contact it follows the sphere, u = b - r^2 / 2, beyond it

    .. math:: u = \frac{1}{\pi} [(2 b - r^2) \arcsin(a / r) + a \sqrt{r^2 - a^2}] .

    It is positive into the half-space. (Units: as b; the distance r from the apex as a)
    """
    r = np.maximum(np.asarray(distance, dtype=float), radius)
    outside = (2 * penetration - r**2) * np.arcsin(radius / r)
    outside = (outside + radius * np.sqrt(r**2 - radius**2)) / np.pi
    conforming = penetration - np.asarray(distance, dtype=float) ** 2 / 2
    return np.where(np.asarray(distance) <= radius, conforming, outside)


def equilibrium_penetration(radius: ArrayLike, work_of_adhesion: ArrayLike = 1.0) -> Array:
    """Penetration b = a^2 - sqrt(8 a w / 3) at which a smooth contact is in equilibrium."""
    a = np.asarray(radius, dtype=float)
    return np.asarray(a**2 - np.sqrt(8 * a * np.asarray(work_of_adhesion) / 3))


def penetration_slope(penetration: float) -> float:
    """Penetration per radius of a stable smooth contact, d(a^2 - sqrt(8a/3)) / da."""
    radius = equilibrium_radius(penetration)
    return 2 * radius - math.sqrt(2 / (3 * radius))


def equilibrium_force(radius: ArrayLike, work_of_adhesion: ArrayLike = 1.0) -> Array:
    """Force of a smooth contact of this radius in equilibrium, F = a^3 - sqrt(6 w a^3)."""
    a = np.asarray(radius, dtype=float)
    return np.asarray(a**3 - np.sqrt(6 * np.asarray(work_of_adhesion) * a**3))


def equilibrium_radius(penetration: float, work_of_adhesion: float = 1.0) -> float:
    """Radius of the stable smooth contact at a penetration.

    ValueError if the penetration is below pull-off, where no contact is stable.

    Examples
    --------
    >>> round(equilibrium_radius(1.0), 12)
    1.783484193282
    """
    smallest, lowest = pull_off_radius(work_of_adhesion), pull_off_penetration(work_of_adhesion)
    if penetration < lowest:
        raise ValueError(
            f"penetration {penetration} is below pull-off ({lowest:.6g}) for a work of adhesion of "
            f"{work_of_adhesion} w_int; no contact is stable there"
        )
    if penetration == lowest:
        return smallest
    # Newton steps from above the root of a convex function go down to it, and end at its rounding.
    pull = math.sqrt(8 * work_of_adhesion / 3)
    radius = smallest + 1.0
    while radius**2 - pull * math.sqrt(radius) < penetration:
        radius *= 2.0
    while True:
        root = math.sqrt(radius)
        lower = radius - (radius**2 - pull * root - penetration) / (2 * radius - pull / (2 * root))
        if not smallest < lower < radius:
            return radius
        radius = lower


def radius_at_force(force: float, work_of_adhesion: float = 1.0) -> float:
    """Radius of the stable smooth contact at a force, the larger root of F = a^3 - sqrt(6 w a^3).

    ValueError if the force is below pull-off, where no contact is stable.

    Examples
    --------
    >>> round(radius_at_force(0.0) ** 3, 12)
    6.0
    """
    if force < pull_off_force(work_of_adhesion):
        raise ValueError(
            f"force {force} is below pull-off ({pull_off_force(work_of_adhesion):.6g}) for a work "
            f"of adhesion of {work_of_adhesion} w_int; no contact is stable there"
        )
    root = (math.sqrt(6 * work_of_adhesion) + math.sqrt(6 * work_of_adhesion + 4 * force)) / 2
    return float(root ** (2 / 3))


def spring(radius: float, work_of_adhesion: float = 1.0) -> float:
    r"""Length of the spring that restores a piece of the edge, L_kappa.

    .. math:: L_\kappa = \frac{w_{int}}{dG/da} = \frac{a}{\sqrt{6 a^3 w} - w}

    Over it the edge is as stiff against a wave as against the penetration, at which it is fixed.
    At and below pull-off, where the edge is unstable, it is infinite.
    (Units: reduced lateral length)

    Examples
    --------
    A third of the radius at zero penetration, a fifth at zero force:

    >>> [round(a / spring(a), 9) for a in ((8 / 3) ** (1 / 3), 6 ** (1 / 3))]
    [3.0, 5.0]
    """
    stiffness = math.sqrt(6 * radius**3 * work_of_adhesion) - work_of_adhesion
    return radius / stiffness if stiffness > 0 else math.inf


def pull_off_radius(work_of_adhesion: float = 1.0) -> float:
    """Radius at which contact is lost at fixed penetration, a^3 = w / 6."""
    return float((work_of_adhesion / 6) ** (1 / 3))


def pull_off_penetration(work_of_adhesion: float = 1.0) -> float:
    """Penetration at which a smooth contact is lost when the penetration is controlled."""
    return float(equilibrium_penetration(pull_off_radius(work_of_adhesion), work_of_adhesion))


def pull_off_force(work_of_adhesion: float = 1.0) -> float:
    """Lowest force of a smooth contact, -3 w / 2 (reached at a^3 = 3 w / 2)."""
    return -1.5 * work_of_adhesion


def apparent_work_of_adhesion(radius: ArrayLike, penetration: ArrayLike) -> Array:
    """Work of adhesion G / w_int that a smooth sphere would need for radius and penetration."""
    return np.asarray(energy_release_rate(radius, penetration) / WORK_OF_ADHESION)
