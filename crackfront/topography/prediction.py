"""What the law w = w_int - e_el -+ k e_el predicts for a measured surface, and where it applies."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol

from scipy.optimize import brentq

from crackfront.analysis.estimate import Estimate, product
from crackfront.analysis.law import shipped_law
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.validity import Excess, front_excess
from crackfront.core import jkr
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.core.variables import variable
from crackfront.topography.cautions import scan_notes
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.options import PredictionOptions
from crackfront.topography.tile import zero_load_radius
from crackfront.topography.verdict import LARGEST_ENERGY, Verdict, verdict


@dataclass(frozen=True, slots=True)
class Prediction:
    """Adhesion that is predicted for a surface, in SI units.

    The intervals of the works of adhesion hold those of k, of e_el, and of what the front's
    hysteresis is divided by.
    """

    surface: MeasuredSurface
    verdict: Verdict
    factors: SphereFactors
    excess: Excess
    radius: float = variable("radius of the sphere", "m")
    contact_modulus: float = variable("contact modulus E'", "Pa")
    work_of_adhesion: float = variable("intrinsic work of adhesion w_int", "J m-2")
    contact_radius: float = variable("radius of the smooth contact at zero load", "m")
    e_el: Estimate[float] = variable("energy of full conformity", "J m-2")
    w_rms: float = variable("rms of the local work of adhesion, 2 sqrt(e_el w_int)", "J m-2")
    correlation_length: float = variable("correlation length of the local work of adhesion", "m")
    l_kappa: float = variable("length of the springs that hold the edge, L_kappa", "m")
    larkin_length: float = variable("Larkin length", "m")
    size: float = variable("g, L_kappa over the Larkin length", "1")
    negative_share: float = variable("part of the surface where w_loc is negative", "1")
    k_appr: Estimate[float] = variable("factor k of the approach, of the front", "1")
    k_retr: Estimate[float] = variable("factor k of the retraction, of the front", "1")
    front_excess: Estimate[float] = variable("what the front's hysteresis is divided by", "1")
    front_hysteresis: Estimate[float] = variable("w_retr - w_appr of the front itself", "J m-2")
    w_appr: Estimate[float] = variable("work of adhesion of the approach", "J m-2")
    w_retr: Estimate[float] = variable("work of adhesion of the retraction", "J m-2")
    hysteresis: Estimate[float] = variable("w_retr - w_appr", "J m-2")
    pull_off_force: Estimate[float] = variable("pull-off force at a given load", "N")
    pull_off_force_held: Estimate[float] = variable("pull-off force at a given displacement", "N")
    pull_off_force_smooth: float = variable("pull-off force of a smooth surface at a load", "N")
    implied_work_of_adhesion: Estimate[float] = variable(
        "w_int that a measured pull-off force implies", "J m-2"
    )

    def __repr__(self) -> str:
        """The page that the command `crackfront predict` prints."""
        from crackfront.topography.report import prediction_page

        return prediction_page(self)


def prediction_notes(prediction: Prediction) -> Iterator[str]:
    """Treatments of the measurements, where k comes from, and where the numbers are weak."""
    yield from scan_notes(prediction.surface.scans, prediction.contact_radius)
    yield (
        "k is that of a straight front on springs of the length L_kappa, by the law that was "
        "fitted to simulations of such fronts; its interval holds the errors of both."
    )
    _, largest = shipped_law().size
    if prediction.size > largest:
        yield (
            f"Size g {prediction.size:.3g} is above the largest that was measured "
            f"({largest:.3g}): k follows the finite-size exponent of the elastic line from there."
        )
    yield prediction.excess.sentence
    yield from repelled_note(prediction)


def repelled_note(prediction: Prediction) -> Iterator[str]:
    """What a w_appr that is not positive means, where its interval holds one."""
    if prediction.w_appr.low <= 0:
        reach = "is not" if prediction.w_appr.value <= 0 else "may not be"
        yield (
            f"w_appr {reach} positive: there the sphere is not drawn into contact but has to be "
            "pressed on, and the theory ends."
        )


@dataclass(frozen=True, slots=True)
class Adhesions:
    """Works of adhesion (Units: J / m^2)."""

    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]


class FrontWorks(Protocol):
    """Works of adhesion of simulated fronts (Units: J / m^2)."""

    @property
    def w_appr(self) -> Estimate[float]:
        """That of the approach."""

    @property
    def w_retr(self) -> Estimate[float]:
        """That of the retraction."""

    @property
    def hysteresis(self) -> Estimate[float]:
        """Their difference."""


def corrected_works(found: FrontWorks, prediction: Prediction) -> Adhesions:
    """Works of adhesion of fronts, divided as the prediction divides its own.

    What lies on either side of w_int - e_el is divided; without an interval of the ratio, which
    stands in the prediction.
    """
    middle = prediction.work_of_adhesion - prediction.e_el.value
    ratio = prediction.excess.ratio.value
    appr, retr = (
        work.each(lambda number: middle + (number - middle) / ratio)
        for work in (found.w_appr, found.w_retr)
    )
    return Adhesions(appr, retr, found.hysteresis.each(lambda number: number / ratio))


def reduced_spectrum(spectrum: TabulatedSpectrum, scales: Scales) -> TabulatedSpectrum:
    """A spectrum of heights in metres in reduced units: its `elastic_energy` is e_el / w_int."""
    unit = (scales.vertical * scales.lateral) ** 2
    return spectrum.in_units(scales.lateral).amplified(1 / unit)


class _Works(NamedTuple):
    """Works of adhesion of a surface under a sphere, and what they come from."""

    energy: Estimate[float]  # e_el (J / m^2)
    factors: SphereFactors
    excess: Excess
    appr: Estimate[float]
    retr: Estimate[float]


def surface_spectrum(surface: MeasuredSurface, scales: Scales) -> TabulatedSpectrum:
    """The spectrum of a surface in reduced units, with the e_el of :func:`energy_of_theory`."""
    shape = reduced_spectrum(surface.joint.spectrum, scales)
    energy = energy_of_theory(surface, scales).value / scales.work_of_adhesion
    return shape.amplified(energy / shape.elastic_energy)


def energy_of_theory(surface: MeasuredSurface, scales: Scales) -> Estimate[float]:
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


def judged(
    surface: MeasuredSurface, scales: Scales, given: PredictionOptions
) -> tuple[Verdict, Prediction | None]:
    """Whether the theory applies under a sphere, and the prediction where it does."""
    ruling = verdict(surface, scales, given.range)
    if ruling.outcome == "does not apply":
        return ruling, None
    found = predicted(surface, scales, given.range, given.pull_off)
    return found.verdict, found


def predicted(
    surface: MeasuredSurface,
    scales: Scales,
    attraction_range: float | None = None,
    pull_off: float | None = None,
) -> Prediction:
    """Prediction for a surface under a sphere, of scales in SI units.

    The range of attraction (Units: m) is that of van der Waals forces where none is given. A
    measured pull-off force (Units: N) gives the w_int that it implies. ValueError if no contact
    conforms.
    """
    energy, factors, excess, appr, retr = _works(surface, scales)
    radius, adhesion = zero_load_radius(scales), scales.work_of_adhesion
    front = product(factors.both, energy).each(lambda work: 2 * work)
    # By JKR, pull-off forces are linear in the work of adhesion.
    at_load, at_displacement = (
        -reduced * scales.force / adhesion
        for reduced in (jkr.pull_off_force(), float(jkr.equilibrium_force(jkr.pull_off_radius())))
    )
    implied = Estimate(*[math.nan] * 4)
    if pull_off is not None:
        implied = _implied_work_of_adhesion(surface, scales, pull_off / at_load)
    return Prediction(
        surface=surface,
        verdict=verdict(surface, scales, attraction_range, factors),
        factors=factors,
        excess=excess,
        radius=scales.radius,
        contact_modulus=scales.contact_modulus,
        work_of_adhesion=adhesion,
        contact_radius=radius,
        e_el=energy,
        w_rms=2 * math.sqrt(energy.value * adhesion),
        correlation_length=surface.joint.spectrum.correlation_length,
        l_kappa=factors.spring * scales.lateral,
        larkin_length=factors.larkin_length * scales.lateral,
        size=factors.size,
        negative_share=factors.approach.negative_share,
        k_appr=replace(factors.approach.factor, standard_error=math.nan),
        k_retr=replace(factors.retraction.factor, standard_error=math.nan),
        front_excess=excess.ratio,
        front_hysteresis=front,
        w_appr=appr,
        w_retr=retr,
        hysteresis=product(front, _inverse(excess.ratio)),
        pull_off_force=retr.each(lambda work: at_load * work),
        pull_off_force_held=retr.each(lambda work: at_displacement * work),
        pull_off_force_smooth=-jkr.pull_off_force() * scales.force,
        implied_work_of_adhesion=implied,
    )


def _works(surface: MeasuredSurface, scales: Scales) -> _Works:
    """Works of adhesion by the law of k, divided by what the front has more than others."""
    adhesion, energy = scales.work_of_adhesion, energy_of_theory(surface, scales)
    relative = energy.value / adhesion
    radius = zero_load_radius(scales) / scales.lateral
    factors = sphere_factors("roughness", surface_spectrum(surface, scales), relative, radius)
    excess = front_excess(relative, factors.size)
    appr, retr = (
        _linear(adhesion, energy, product(branch.factor, _inverse(excess.ratio)), sign)
        for branch, sign in ((factors.approach, -1.0), (factors.retraction, 1.0))
    )
    return _Works(energy, factors, excess, appr, retr)


def _implied_work_of_adhesion(
    surface: MeasuredSurface, scales: Scales, measured: float
) -> Estimate[float]:
    """The w_int at which the predicted w_retr is the measured one; NaN if none (Units: J / m^2)."""
    energy = surface.conformity_energy(scales.contact_modulus)
    least = 1.001 * max(energy.low, energy.value * LARGEST_ENERGY)

    def solved(end: str) -> float:
        def apart(adhesion: float) -> float:
            works = _works(surface, replace(scales, work_of_adhesion=adhesion))
            return float(getattr(works.retr, end)) - measured

        most = 10 * max(measured, least)
        if apart(least) * apart(most) > 0:
            return math.nan
        return float(brentq(apart, least, most, rtol=1e-4))

    # Its interval ends where those of predictions do.
    return Estimate(solved("value"), math.nan, solved("high"), solved("low"))


def _inverse(number: Estimate[float]) -> Estimate[float]:
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
