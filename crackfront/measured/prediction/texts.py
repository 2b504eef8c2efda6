"""Numbers of surfaces and predictions as texts."""

from __future__ import annotations

import math

from crackfront.analysis.estimate import Estimate
from crackfront.surfaces.written_units import prefixed

ENERGY = "J/m2"
"""Unit of works of adhesion and of e_el, as texts have it."""

_WITH_PREFIXES = ("m", "N", "Pa", ENERGY)


def estimate_text(unit: str, found: Estimate[float]) -> str:
    """A number with its interval, if it has one; powers of lengths have no prefix."""
    unit = unit.replace("J m-2", ENERGY)
    has_interval = math.isfinite(found.low) and found.low < found.high
    if unit in _WITH_PREFIXES:
        return prefixed(unit, found.value, *((found.low, found.high) if has_interval else ()))
    interval = f" ({found.low:.3g} to {found.high:.3g})" if has_interval else ""
    return f"{found.value:.3g}{interval} {unit}".removesuffix(" 1")


def wavelengths_text(shortest: float, longest: float) -> str:
    """A range of wavelengths (Units: m)."""
    return f"{prefixed('m', shortest)} to {prefixed('m', longest)}"
