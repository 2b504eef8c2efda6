"""Bounds of the quantities that come from outside."""

from __future__ import annotations

from typing import NamedTuple


class Range(NamedTuple):
    """Smallest and largest value that a quantity may have."""

    least: float
    most: float


NUMBER = Range(1e-15, 1e15)
"""Any positive number: powers of it, as formulas have them, are still numbers."""

COUNT = Range(1, 10**15)
"""Any count."""

PLATEAU = Range(1e-60, 1e15)
"""Densities of heights at long waves, in m^4 or reduced: a polished film has 1e-27 m^4."""

LENGTH = Range(1e-9, 1e9)
"""Lengths in reduced units: from far below an atom on the smallest spheres to far above them."""

PENETRATION = Range(0.0, 1e6)
"""Largest penetrations in reduced units; the contact is then a thousand units wide."""

ADHESION = Range(-1e4, 1e4)
"""Local works of adhesion, in units of w_int, and heights in reduced units."""

DENSITY = Range(1e-3, 1e3)
"""Sites, samples or points per length of a surface."""

PIXELS = Range(2, 1e3)
"""Points of a tile per shortest wavelength; fewer do not resolve it."""

SITES = Range(4, 10**15)
"""Sites of a front; fewer resolve no distortion."""

SEED = Range(0, 2**63 - 1)
"""Seeds that a netCDF file can store as an attribute."""

SI = {
    "m": Range(1e-12, 1e7),
    "Pa": Range(1e-6, 1e14),
    "J/m^2": Range(1e-9, 1e6),
    "N": Range(1e-18, 1e9),
    "N/m": Range(1e-9, 1e12),
}
"""Lengths from below an atom to planets, moduli from below foams to above diamond, and so on."""

POISSON = Range(-0.99, 0.5)
"""Poisson's ratios of isotropic bodies that are not infinitely compressible."""

TOLERANCE = Range(1e-16, 1.0)
"""Force that may be left, relative to w_int per front length."""


def check_within(name: str, value: float, bounds: Range, unit: str = "") -> None:
    """Raise a ValueError that names a number if it is not within its bounds.

    Examples
    --------
    >>> check_within("spring", 1e300, LENGTH)
    Traceback (most recent call last):
    ValueError: spring is 1e+300; it must lie between 1e-09 and 1e+09
    """
    if not bounds.least <= value <= bounds.most:
        unit = f" {unit}" if unit else ""
        raise ValueError(
            f"{name} is {value:g}{unit}; it must lie between {bounds.least:g} and "
            f"{bounds.most:g}{unit}"
        )
