"""Works of adhesion of a surface under a sphere, by the law of k: w_int - e_el -+ k e_el."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from crackfront.analysis.estimate import UNKNOWN, Estimate, product
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.validity import Excess, front_excess
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.measured.prediction.conditions import LARGEST_ENERGY, zero_load_radius
from crackfront.measured.spectrum.stated import Surface

_ENERGIES = 5
"""Values of e_el within its interval at which the law is evaluated; w_retr has a maximum there."""

_LEAST_ENERGY = 1e-3
"""Smallest of these values over e_el, if the interval reaches zero."""


class AdhesionByLaw(NamedTuple):
    """Works of adhesion of a surface under a sphere by the law of k (Units: J / m^2)."""

    energy: Estimate[float]
    """e_el."""
    factors: SphereFactors
    excess: Excess
    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]
    front_hysteresis: Estimate[float]
    """Hysteresis of the crack front, before the division by the excess."""


class _FactorsAtEnergy(NamedTuple):
    """Factors k at some e_el, and the excess of the crack front's hysteresis."""

    energy: float
    """Units: J / m^2."""
    factors: SphereFactors
    excess: Excess

    def corrected(self, factor: Estimate[float]) -> Estimate[float]:
        """A factor k divided by the excess."""
        return product(factor, _inverse(self.excess.ratio))


def surface_spectrum(surface: Surface, scales: Scales) -> TabulatedSpectrum:
    """Spectrum of a surface in reduced units, with the e_el of :func:`energy_of_theory`."""
    shape = reduced_spectrum(surface.spectrum, scales)
    energy = energy_of_theory(surface, scales).value / scales.work_of_adhesion
    return shape.amplified(energy / shape.elastic_energy)


def energy_of_theory(surface: Surface, scales: Scales) -> Estimate[float]:
    """The e_el of a surface, limited to the range of the theory (Units: J / m^2).

    Scales are in SI units. ValueError if the whole interval of e_el is above w_int.
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
    """A spectrum from metres to reduced units; its `elastic_energy` is then e_el / w_int."""
    unit = (scales.vertical * scales.lateral) ** 2
    return spectrum.in_units(scales.lateral).amplified(1 / unit)


def adhesion_by_law(surface: Surface, scales: Scales) -> AdhesionByLaw:
    """Works of adhesion by the law of k, with k divided by the excess of the front.

    The intervals include the uncertainties of k and of the excess, and the change of both with
    e_el within its interval. ValueError as in :func:`energy_of_theory`.
    """
    w_int, energy = scales.work_of_adhesion, energy_of_theory(surface, scales)
    radius = zero_load_radius(scales) / scales.lateral
    shape = reduced_spectrum(surface.spectrum, scales)

    def factors_at(value: float) -> _FactorsAtEnergy:
        relative = min(value / w_int, LARGEST_ENERGY)
        spectrum = shape.amplified(relative / shape.elastic_energy)
        factors = sphere_factors("roughness", spectrum, relative, radius)
        return _FactorsAtEnergy(value, factors, front_excess(relative, factors.size))

    central, least = factors_at(energy.value), max(energy.low, _LEAST_ENERGY * energy.value)
    varied = []
    if energy.high > least:
        values = np.geomspace(least, energy.high, _ENERGIES)
        varied = [factors_at(float(value)) for value in values]

    def branch(name: str, sign: float) -> Estimate[float]:
        """Work of adhesion w_int - e_el + sign k e_el of a branch."""

        def work(factor: float, energy: float) -> float:
            return w_int + (sign * factor - 1) * energy

        def factor_of(at_energy: _FactorsAtEnergy) -> Estimate[float]:
            return at_energy.corrected(getattr(at_energy.factors, name).factor)

        factor = factor_of(central)
        return _in_quadrature(
            work(factor.value, energy.value),
            [work(end, energy.value) for end in (factor.low, factor.high)],
            [work(factor_of(at_energy).value, at_energy.energy) for at_energy in varied],
        )

    def hysteresis(factor_of: Callable[[_FactorsAtEnergy], Estimate[float]]) -> Estimate[float]:
        """Hysteresis 2 k e_el, with relative errors in quadrature."""
        factor = factor_of(central)
        return _in_quadrature(
            math.log(2 * factor.value * energy.value),
            [_log(2 * end * energy.value) for end in (factor.low, factor.high)],
            [_log(2 * factor_of(at_energy).value * at_energy.energy) for at_energy in varied],
        ).each(math.exp)

    return AdhesionByLaw(
        energy=energy,
        factors=central.factors,
        excess=central.excess,
        w_appr=branch("approach", -1.0),
        w_retr=branch("retraction", 1.0),
        hysteresis=hysteresis(lambda at_energy: at_energy.corrected(at_energy.factors.both)),
        front_hysteresis=hysteresis(lambda at_energy: at_energy.factors.both),
    )


def least_work_of_adhesion(surface: Surface, scales: Scales) -> float:
    """Smallest w_int at which the theory applies (Units: J / m^2)."""
    energy = surface.conformity_energy(scales.contact_modulus)
    return 1.001 * max(energy.low, energy.value / LARGEST_ENERGY)


def implied_work_of_adhesion(surface: Surface, scales: Scales, measured: float) -> Estimate[float]:
    """The w_int at which the predicted w_retr agrees with a measured one (Units: J / m^2).

    Its interval ends at :func:`least_work_of_adhesion`. NaN if no w_int agrees.
    """
    least = least_work_of_adhesion(surface, scales)

    def solved(end: str) -> float:
        def excess_adhesion(adhesion: float) -> float:
            predicted = adhesion_by_law(surface, replace(scales, work_of_adhesion=adhesion))
            return float(getattr(predicted.w_retr, end)) - measured

        most = 10 * max(measured, least)
        if excess_adhesion(most) < 0:
            return math.nan
        if excess_adhesion(least) > 0:
            return math.nan if end == "value" else least
        return float(scipy.optimize.brentq(excess_adhesion, least, most, rtol=1e-4))

    value = solved("value")
    if not math.isfinite(value):
        return UNKNOWN
    # A larger w_int gives a larger w_retr, so that the upper end of w_retr gives the lower end.
    return Estimate(value, math.nan, solved("high"), solved("low"))


def _inverse(number: Estimate[float]) -> Estimate[float]:
    """Inverse of a positive number."""
    return Estimate(1 / number.value, math.nan, 1 / number.high, 1 / number.low)


def _log(number: float) -> float:
    """Logarithm of a number that may be zero."""
    return math.log(number) if number > 0 else -math.inf


def _in_quadrature(value: float, *causes: Sequence[float]) -> Estimate[float]:
    """A number whose interval adds the largest deviations by independent causes in quadrature."""
    below = [max((value - changed for changed in cause), default=0.0) for cause in causes]
    above = [max((changed - value for changed in cause), default=0.0) for cause in causes]
    return Estimate(value, math.nan, value - math.hypot(*below), value + math.hypot(*above))
