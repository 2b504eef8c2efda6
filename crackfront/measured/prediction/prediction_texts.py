"""Numbers of surfaces and predictions as texts."""

from __future__ import annotations

import math

from crackfront.analysis.estimate import Estimate
from crackfront.surfaces.written_units import prefixed

ENERGY = "J/m2"
"""Unit of works of adhesion and of e_el in texts."""

_WITH_PREFIXES = ("m", "N", "Pa", ENERGY)


def estimate_text(unit: str, estimate: Estimate[float]) -> str:
    """A number with its interval and unit, and with an SI prefix where this is common."""
    unit = unit.replace("J m-2", ENERGY)
    has_interval = math.isfinite(estimate.low) and estimate.low < estimate.high
    if unit in _WITH_PREFIXES:
        ends = (estimate.low, estimate.high) if has_interval else ()
        return prefixed(unit, estimate.value, *ends)
    value, low, high = (f"{x:.3g}" for x in (estimate.value, estimate.low, estimate.high))
    is_shown = has_interval and {low, high} != {value}
    interval = f" ({low} to {high})" if is_shown else ""
    return f"{value}{interval} {unit}".removesuffix(" 1")


def wavelengths_text(shortest: float, longest: float) -> str:
    """A range of wavelengths (Units: m)."""
    return f"{prefixed('m', shortest)} to {prefixed('m', longest)}"
