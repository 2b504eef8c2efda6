"""Reduced units of the model: their names, and their values in SI.

Inside the package R = 1, w_int = 1/pi and E' = 3/4 (Barthel, Maugis; supplement, Sec. I A).
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from enum import StrEnum

from crackfront.core.arguments import check_positive

WORK_OF_ADHESION = 1.0 / math.pi
"""Intrinsic work of adhesion w_int in reduced units."""

CONTACT_MODULUS = 0.75
"""Contact modulus E' in reduced units."""


def plane_strain_modulus(modulus: float, poisson: float) -> float:
    """Contact modulus E' = E / (1 - nu^2) of a body against a rigid one (Units: as the modulus).

    Examples
    --------
    >>> f"{plane_strain_modulus(0.7e6, poisson=0.5):.4g}"
    '9.333e+05'
    """
    return modulus / (1 - poisson**2)


@dataclass(frozen=True, slots=True)
class Scales:
    """Values of the reduced units for one sphere, in SI or any consistent set of units.

    Multiply a reduced quantity by its scale to leave the package, divide to enter it.

    Parameters
    ----------
    radius : float
        Radius R of the sphere. (Units: length)
    work_of_adhesion : float
        Intrinsic work of adhesion w_int. (Units: energy / area)
    contact_modulus : float
        Contact modulus E' = E / (1 - nu^2). (Units: pressure)

    Raises
    ------
    ValueError
        If a parameter is not positive and finite.

    Examples
    --------
    >>> scales = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)
    >>> f"{scales.lateral * 1e6:.1f} um, {scales.vertical * 1e6:.2f} um"
    '62.9 um, 3.16 um'
    >>> f"{scales.force * 1e3:.3f} mN"
    '0.247 mN'
    """

    radius: float
    work_of_adhesion: float
    contact_modulus: float

    def __post_init__(self) -> None:
        check_positive(**asdict(self))

    @property
    def lateral(self) -> float:
        """Lengths along the surface, (3 pi w R^2 / 4E')^(1/3) (Units: length)."""
        cube = 3 * math.pi * self.work_of_adhesion * self.radius**2 / (4 * self.contact_modulus)
        return float(cube ** (1 / 3))

    @property
    def vertical(self) -> float:
        """Penetrations and heights, (9 pi^2 w^2 R / 16E'^2)^(1/3) (Units: length)."""
        return self.lateral**2 / self.radius

    @property
    def force(self) -> float:
        """Forces, pi w R (Units: force)."""
        return math.pi * self.work_of_adhesion * self.radius

    @property
    def energy_per_area(self) -> float:
        """Works of adhesion; 1/pi in reduced units is w_int (Units: energy / area)."""
        return math.pi * self.work_of_adhesion


class ReducedUnit(StrEnum):
    """A unit of what the package computes; its value is the text that files state.

    Examples
    --------
    >>> sphere = Scales(radius=1e-3, work_of_adhesion=0.05, contact_modulus=1e6)
    >>> ReducedUnit.FORCE.value, ReducedUnit.FORCE.si, f"{ReducedUnit.FORCE.scale(sphere):.3g}"
    ('pi w_int R', 'N', '0.000157')
    """

    LATERAL = (
        "reduced lateral length, (3 pi w_int R^2 / 4E')^(1/3)",
        r"(3\pi w_\mathrm{int}R^2/4E')^{1/3}",
        "m",
    )
    VERTICAL = (
        "reduced vertical length, (9 pi^2 w_int^2 R / 16E'^2)^(1/3)",
        r"(9\pi^2 w_\mathrm{int}^2 R/16E'^2)^{1/3}",
        "m",
    )
    FORCE = "pi w_int R", r"\pi w_\mathrm{int} R", "N"
    ADHESION = "w_int", r"w_\mathrm{int}", "J / m^2"
    ENERGY = (
        f"{FORCE[0]} times {VERTICAL[0]}",
        r"(9\pi^5 w_\mathrm{int}^5R^4/16E'^2)^{1/3}",
        "J",
    )
    AREA = f"({LATERAL[0]})^2", r"(3\pi w_\mathrm{int}R^2/4E')^{2/3}", "m^2"

    tex: str
    si: str

    def __new__(cls, text: str, tex: str, si: str) -> ReducedUnit:
        """Unit of a text, a formula in TeX and the unit of SI of the same dimension."""
        unit = str.__new__(cls, text)
        unit._value_, unit.tex, unit.si = text, tex, si
        return unit

    def scale(self, scales: Scales) -> float:
        """Value of the unit in SI for a sphere (Units: as `si`)."""
        match self:
            case ReducedUnit.LATERAL:
                return scales.lateral
            case ReducedUnit.VERTICAL:
                return scales.vertical
            case ReducedUnit.FORCE:
                return scales.force
            case ReducedUnit.ADHESION:
                return scales.work_of_adhesion
            case ReducedUnit.ENERGY:
                return scales.force * scales.vertical
            case ReducedUnit.AREA:
                return scales.lateral**2
