"""Works of adhesion of a surface under a sphere, by the law of k: w_int - e_el -+ k e_el."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import scipy

from crackfront.analysis.estimate import Estimate, product
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.validity import Excess, front_excess
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.topography.prediction.conditions import LARGEST_ENERGY, zero_load_radius
from crackfront.topography.spectrum.stated import Surface


class Works(NamedTuple):
    """Works of adhesion of a surface under a sphere, and what they come from."""

    energy: Estimate[float]  # e_el (J / m^2)
    factors: SphereFactors
    excess: Excess
    w_appr: Estimate[float]
    w_retr: Estimate[float]


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
    """Works of adhesion by the law of k, divided by what the front has more than others."""
    adhesion, energy = scales.work_of_adhesion, energy_of_theory(surface, scales)
    relative = energy.value / adhesion
    radius = zero_load_radius(scales) / scales.lateral
    factors = sphere_factors("roughness", surface_spectrum(surface, scales), relative, radius)
    excess = front_excess(relative, factors.size)
    w_appr, w_retr = (
        _linear(adhesion, energy, product(branch.factor, inverse(excess.ratio)), sign)
        for branch, sign in ((factors.approach, -1.0), (factors.retraction, 1.0))
    )
    return Works(energy, factors, excess, w_appr, w_retr)


def implied_work_of_adhesion(surface: Surface, scales: Scales, measured: float) -> Estimate[float]:
    """The w_int at which the predicted w_retr is the measured one; NaN if none (Units: J / m^2)."""
    energy = surface.conformity_energy(scales.contact_modulus)
    least = 1.001 * max(energy.low, energy.value * LARGEST_ENERGY)

    def solved(end: str) -> float:
        def excess_adhesion(adhesion: float) -> float:
            found = works(surface, replace(scales, work_of_adhesion=adhesion))
            return float(getattr(found.w_retr, end)) - measured

        most = 10 * max(measured, least)
        if excess_adhesion(least) * excess_adhesion(most) > 0:
            return math.nan
        return float(scipy.optimize.brentq(excess_adhesion, least, most, rtol=1e-4))

    # Its interval ends where those of predictions do.
    return Estimate(solved("value"), math.nan, solved("high"), solved("low"))


def inverse(number: Estimate[float]) -> Estimate[float]:
    """One over a positive number."""
    return Estimate(1 / number.value, math.nan, 1 / number.high, 1 / number.low)


def _linear(
    adhesion: float, energy: Estimate[float], factor: Estimate[float], sign: float
) -> Estimate[float]:
    """Work of adhesion w_int - e_el + sign k e_el, intervals of k and e_el in quadrature."""
    value = adhesion + (sign * factor.value - 1) * energy.value
    ends = [
        sorted(end - value for end in pair)
        for pair in (
            [adhesion + (sign * end - 1) * energy.value for end in (factor.low, factor.high)],
            [adhesion + (sign * factor.value - 1) * end for end in (energy.low, energy.high)],
        )
    ]
    low, high = (math.hypot(*(one[end] for one in ends)) for end in (0, 1))
    return Estimate(value, math.nan, value - low, value + high)
