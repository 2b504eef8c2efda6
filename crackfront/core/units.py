"""Reduced units of the model and their one conversion from and to SI.

Inside the package R = 1, w_int = 1/pi and E' = 3/4 (Barthel, Maugis; supplement, Sec. I A).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

WORK_OF_ADHESION = 1.0 / math.pi
"""Intrinsic work of adhesion w_int in reduced units."""

CONTACT_MODULUS = 0.75
"""Contact modulus E' in reduced units."""


@dataclass(frozen=True, slots=True)
class Scales:
    """What one reduced unit is in the units of a scene (SI, or any consistent set).

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
        for name in ("radius", "work_of_adhesion", "contact_modulus"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}; it must be positive and finite")

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
