"""The sphere and the machine of a measured loop."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from crackfront.surfaces.written_units import prefixed

Segment = Literal["approach", "retract"] | None
"""Branch that is evaluated alone; None for both."""


@dataclass(frozen=True, slots=True)
class Rig:
    """Sphere and machine, in SI units; ValueError if a number is impossible."""

    radius: float
    """Radius of the sphere. (Units: m)"""
    contact_modulus: float | None = None
    """Contact modulus E' = E / (1 - nu^2); None to fit it. (Units: Pa)"""
    modulus_error: float = 0.0
    """Standard error of the modulus, relative."""
    radius_error: float = 0.0
    """Standard error of the radius of the sphere, relative."""
    stiffness: float | None = None
    """Stiffness of the machine; None if it is infinite or not needed. (Units: N/m)"""
    window: tuple[float, float] | None = None
    """Contact radii over which both works are averaged; None to choose them. (Units: m)"""
    segment: Segment = None
    """Branch that is evaluated alone; None for both."""

    def __post_init__(self) -> None:
        for name in ("radius", "contact_modulus", "stiffness"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}; it must be positive and finite")
        if self.segment not in (None, "approach", "retract"):
            raise ValueError(f"segment is {self.segment!r}; choose approach or retract")
        for name in ("modulus_error", "radius_error"):
            if not 0 <= getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it is relative, 0 to 1")
        if self.modulus_error > 0 and self.contact_modulus is None:
            raise ValueError(
                f"the error of the modulus is {self.modulus_error:g}, and no modulus is given; a "
                "fitted one has the error of its fit, so give a modulus or leave the error out"
            )
        if self.window is not None and not 0 <= self.window[0] < self.window[1] < math.inf:
            ends = " to ".join(prefixed("m", end) for end in self.window)
            raise ValueError(f"window is {ends}; give a smaller and a larger contact radius")
