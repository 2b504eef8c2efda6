"""Changes that would meet a condition of the theory, if such spheres and solids exist."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

from crackfront.core.bounds import Range
from crackfront.core.units import Scales
from crackfront.surfaces.written_units import prefixed

_LARGEST_RADIUS = 1.0
"""Largest radius of a sphere that a remedy names. (Units: m)"""

_MODULI = Range(100.0, 1e12)
"""Contact moduli that a remedy names, from the softest gels to diamond. (Units: Pa)"""

_STRONGEST_ADHESION = 10.0
"""Largest w_int that a remedy names, above all solids. (Units: J / m^2)"""


def lower_energy(scales: Scales, excess: float) -> tuple[str, ...]:
    """Changes, each of which lowers e_el over w_int by a factor."""
    adhesion = scales.work_of_adhesion * excess
    stronger = [f"w_int above {prefixed('J/m2', adhesion)}"]
    return (
        *modulus_beyond("below", scales.contact_modulus, 1 / excess),
        f"a roughness lower by a factor of {math.sqrt(excess):.3g}",
        *(stronger if adhesion <= _STRONGEST_ADHESION else []),
    )


def modulus_beyond(side: Literal["above", "below"], modulus: float, factor: float) -> Iterator[str]:
    """A contact modulus above or below the present one times a factor, if solids have it."""
    needed = modulus * factor
    if _MODULI.least <= needed <= _MODULI.most:
        yield (
            f"a contact modulus E / (1 - nu^2) {side} {prefixed('Pa', needed)}, not "
            f"{prefixed('Pa', modulus)}"
        )


def radius_above(radius: float) -> Iterator[str]:
    """A radius of the sphere above some value, if spheres have it (Units: m)."""
    if radius <= _LARGEST_RADIUS:
        yield f"a radius above {prefixed('m', radius)}"
