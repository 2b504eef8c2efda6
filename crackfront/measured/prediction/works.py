"""Works of adhesion of a surface under a sphere, by the law of k: w_int - e_el -+ k e_el."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy

from crackfront.analysis.estimate import REACH, UNKNOWN, Estimate, product
from crackfront.analysis.law import spectral_breadth
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.validity import Excess, front_excess
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.measured.prediction.conditions import LARGEST_ENERGY, zero_load_radius
from crackfront.measured.spectrum.stated import Surface
from crackfront.surfaces.written_units import prefixed

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
    """Factors k at some e_el and w_int, and the excess of the crack front's hysteresis."""

    work_of_adhesion: float
    energy: float
    """w_int and e_el. (Units: J / m^2)"""
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


def adhesion_by_law(surface: Surface, scales: Scales, adhesion_error: float = 0.0) -> AdhesionByLaw:
    """Works of adhesion by the law of k, with k divided by the excess of the front.

    The intervals include the uncertainties of k and of the excess, the change of both with e_el
    within its interval, and the standard error of w_int (Units: J / m^2). ValueError as in
    :func:`energy_of_theory`, or if the interval of w_int reaches zero.
    """
    energy = energy_of_theory(surface, scales)
    central = _factors_at(surface, scales, energy.value)
    by_energy = _varied_by_energy(surface, scales, energy)
    by_adhesion = _varied_by_adhesion(surface, scales, energy.value, adhesion_error)
    return AdhesionByLaw(
        energy=energy,
        factors=central.factors,
        excess=central.excess,
        w_appr=_branch("approach", -1.0, central, by_energy, by_adhesion),
        w_retr=_branch("retraction", 1.0, central, by_energy, by_adhesion),
        hysteresis=_hysteresis(central, by_energy, by_adhesion, is_corrected=True),
        front_hysteresis=_hysteresis(central, by_energy, by_adhesion, is_corrected=False),
    )


def _factors_at(surface: Surface, scales: Scales, energy: float) -> _FactorsAtEnergy:
    """Factors of a surface that is scaled to an e_el (Units: J / m^2)."""
    relative = min(energy / scales.work_of_adhesion, LARGEST_ENERGY)
    shape = reduced_spectrum(surface.spectrum, scales)
    spectrum = shape.amplified(relative / shape.elastic_energy)
    radius = zero_load_radius(scales) / scales.lateral
    breadth = _breadth(surface.spectrum)
    factors = sphere_factors("roughness", spectrum, relative, radius, breadth)
    excess = front_excess(relative, factors.size)
    return _FactorsAtEnergy(scales.work_of_adhesion, energy, factors, excess)


@functools.lru_cache(maxsize=16)
def _breadth(spectrum: TabulatedSpectrum) -> float:
    """Breadth of a spectrum, which is the same in all units and at all amplitudes."""
    return spectral_breadth("roughness", spectrum)


def _varied_by_energy(
    surface: Surface, scales: Scales, energy: Estimate[float]
) -> list[_FactorsAtEnergy]:
    """Factors at values of e_el within its interval; none if e_el is exact."""
    least = max(energy.low, _LEAST_ENERGY * energy.value)
    if not energy.high > least:
        return []
    values = np.geomspace(least, energy.high, _ENERGIES)
    return [_factors_at(surface, scales, float(value)) for value in values]


def _varied_by_adhesion(
    surface: Surface, scales: Scales, energy: float, error: float
) -> list[_FactorsAtEnergy]:
    """Factors at both ends of the interval of w_int; none if it is exact."""
    if error == 0:
        return []
    w_int, reach = scales.work_of_adhesion, REACH * error
    if reach >= w_int:
        raise ValueError(
            f"the work of adhesion is {prefixed('J/m2', w_int)} with a standard error of "
            f"{prefixed('J/m2', error)}, so that its interval reaches zero; give an error below "
            f"{prefixed('J/m2', w_int / REACH)}"
        )
    ends = (replace(scales, work_of_adhesion=end) for end in (w_int - reach, w_int + reach))
    return [_factors_at(surface, end, energy) for end in ends]


def _branch(
    name: str, sign: float, central: _FactorsAtEnergy, *varied: Sequence[_FactorsAtEnergy]
) -> Estimate[float]:
    """Work of adhesion w_int - e_el + sign k e_el of a branch, with its independent causes."""

    def work(factor: float, at_energy: _FactorsAtEnergy) -> float:
        return at_energy.work_of_adhesion + (sign * factor - 1) * at_energy.energy

    def corrected_factor(at_energy: _FactorsAtEnergy) -> Estimate[float]:
        return at_energy.corrected(getattr(at_energy.factors, name).factor)

    factor = corrected_factor(central)
    return _in_quadrature(
        work(factor.value, central),
        [work(end, central) for end in (factor.low, factor.high)],
        *(
            [work(corrected_factor(point).value, point) for point in points]
            for points in varied
            if points
        ),
    )


def _hysteresis(
    central: _FactorsAtEnergy, *varied: Sequence[_FactorsAtEnergy], is_corrected: bool
) -> Estimate[float]:
    """Hysteresis 2 k e_el, with relative errors of independent causes in quadrature.

    The excess of the crack front is divided out if `is_corrected`.
    """

    def factor_at(at_energy: _FactorsAtEnergy) -> Estimate[float]:
        factor = at_energy.factors.both
        return at_energy.corrected(factor) if is_corrected else factor

    def logarithm(factor: float, energy: float) -> float:
        return _log(2 * factor * energy)

    factor = factor_at(central)
    by_factor = [logarithm(end, central.energy) for end in (factor.low, factor.high)]
    by_cause = [
        [logarithm(factor_at(point).value, point.energy) for point in points]
        for points in varied
        if points
    ]
    value = math.log(2 * factor.value * central.energy)
    return _in_quadrature(value, by_factor, *by_cause).each(math.exp)


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
