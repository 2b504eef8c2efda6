"""Works of adhesion of a surface under a sphere, by the law of k: w_int - e_el -+ k e_el."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from crackfront.analysis.estimate import Estimate, product
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.validity import Excess, front_excess
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.measured.prediction.conditions import LARGEST_ENERGY, zero_load_radius
from crackfront.measured.spectrum.stated import Surface

_ENERGIES = 5
"""Energies within the interval of e_el at which the law is evaluated: k falls with e_el, so that
w_retr has a maximum."""

_LEAST_ENERGY = 1e-3
"""Least of these energies over e_el, where the interval reaches zero."""


class Works(NamedTuple):
    """Works of adhesion of a surface under a sphere, and what they come from (Units: J / m^2)."""

    energy: Estimate[float]
    factors: SphereFactors
    excess: Excess
    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]
    front_hysteresis: Estimate[float]
    """That of the front itself."""


class _Kept(NamedTuple):
    """The factors of a surface of some e_el, divided by what the front has more than others."""

    energy: float
    """Units: J / m^2."""
    factors: SphereFactors
    excess: Excess

    def of(self, factor: Estimate[float]) -> Estimate[float]:
        """One of the factors, divided."""
        return product(factor, _inverse(self.excess.ratio))


def surface_spectrum(surface: Surface, scales: Scales) -> TabulatedSpectrum:
    """The spectrum of a surface in reduced units, with the e_el of :func:`energy_of_theory`."""
    shape = reduced_spectrum(surface.spectrum, scales)
    energy = energy_of_theory(surface, scales).value / scales.work_of_adhesion
    return shape.amplified(energy / shape.elastic_energy)


def energy_of_theory(surface: Surface, scales: Scales) -> Estimate[float]:
    """The e_el of a surface where the theory applies, at most the largest for which it does.

    Units: J / m^2, as scales in SI units. ValueError if even the least is larger than w_int.
    """
    energy, adhesion = surface.conformity_energy(scales.contact_modulus), scales.work_of_adhesion
    if not energy.low < adhesion:
        raise ValueError(
            f"e_el is {energy.value / adhesion:.3g} w_int, so that no contact conforms fully and "
            "the theory does not apply; a softer sphere, a stronger adhesion or a smoother "
            "surface would"
        )
    value = min(energy.value, LARGEST_ENERGY * adhesion)
    return replace(energy, value=value, low=min(energy.low, value))


def reduced_spectrum(spectrum: TabulatedSpectrum, scales: Scales) -> TabulatedSpectrum:
    """A spectrum of heights in metres in reduced units: its `elastic_energy` is e_el / w_int."""
    unit = (scales.vertical * scales.lateral) ** 2
    return spectrum.in_units(scales.lateral).amplified(1 / unit)


def works(surface: Surface, scales: Scales) -> Works:
    """Works of adhesion by the law of k, divided by what the front has more than others.

    Their intervals hold those of k and of the divisor, and what both and e_el are at other e_el
    within its interval.
    """
    adhesion, energy = scales.work_of_adhesion, energy_of_theory(surface, scales)
    radius = zero_load_radius(scales) / scales.lateral
    shape = reduced_spectrum(surface.spectrum, scales)

    def kept(value: float) -> _Kept:
        relative = min(value / adhesion, LARGEST_ENERGY)
        spectrum = shape.amplified(relative / shape.elastic_energy)
        factors = sphere_factors("roughness", spectrum, relative, radius)
        return _Kept(value, factors, front_excess(relative, factors.size))

    here, least = kept(energy.value), max(energy.low, _LEAST_ENERGY * energy.value)
    others = []
    if energy.high > least:
        others = [kept(float(one)) for one in np.geomspace(least, energy.high, _ENERGIES)]

    def branch(name: str, sign: float) -> Estimate[float]:
        """Work of adhesion w_int - e_el + sign k e_el."""

        def work(factor: float, energy: float) -> float:
            return adhesion + (sign * factor - 1) * energy

        factor = here.of(getattr(here.factors, name).factor)
        return _in_quadrature(
            work(factor.value, energy.value),
            [work(end, energy.value) for end in (factor.low, factor.high)],
            [work(one.of(getattr(one.factors, name).factor).value, one.energy) for one in others],
        )

    def hysteresis(divided: Callable[[_Kept], Estimate[float]]) -> Estimate[float]:
        """2 k e_el, whose relative intervals add."""
        factor = divided(here)
        return _in_quadrature(
            math.log(2 * factor.value * energy.value),
            [_log(2 * end * energy.value) for end in (factor.low, factor.high)],
            [_log(2 * divided(one).value * one.energy) for one in others],
        ).each(math.exp)

    return Works(
        energy,
        here.factors,
        here.excess,
        branch("approach", -1.0),
        branch("retraction", 1.0),
        hysteresis(lambda one: one.of(one.factors.both)),
        hysteresis(lambda one: one.factors.both),
    )


def least_work_of_adhesion(surface: Surface, scales: Scales) -> float:
    """The w_int below which the theory does not apply (Units: J / m^2)."""
    energy = surface.conformity_energy(scales.contact_modulus)
    return 1.001 * max(energy.low, energy.value / LARGEST_ENERGY)


def implied_work_of_adhesion(surface: Surface, scales: Scales, measured: float) -> Estimate[float]:
    """The w_int at which the predicted w_retr is the measured one; NaN if none (Units: J / m^2).

    Its interval ends at :func:`least_work_of_adhesion`.
    """
    least = least_work_of_adhesion(surface, scales)

    def solved(end: str) -> float:
        def excess_adhesion(adhesion: float) -> float:
            found = works(surface, replace(scales, work_of_adhesion=adhesion))
            return float(getattr(found.w_retr, end)) - measured

        most = 10 * max(measured, least)
        if excess_adhesion(most) < 0:
            return math.nan
        if excess_adhesion(least) > 0:
            return math.nan if end == "value" else least
        return float(scipy.optimize.brentq(excess_adhesion, least, most, rtol=1e-4))

    value = solved("value")
    if not math.isfinite(value):
        return Estimate(*[math.nan] * 4)
    # Its interval ends where those of predictions do.
    return Estimate(value, math.nan, solved("high"), solved("low"))


def _inverse(number: Estimate[float]) -> Estimate[float]:
    """One over a positive number."""
    return Estimate(1 / number.value, math.nan, 1 / number.high, 1 / number.low)


def _log(number: float) -> float:
    """Logarithm of a number that may be zero."""
    return math.log(number) if number > 0 else -math.inf


def _in_quadrature(value: float, *causes: Sequence[float]) -> Estimate[float]:
    """A number with its values by independent causes, whose largest distances are squared."""
    low, high = (
        math.hypot(*(max((sign * (one - value) for one in cause), default=0.0) for cause in causes))
        for sign in (-1, 1)
    )
    return Estimate(value, math.nan, value - low, value + high)
