"""What the law w = w_int - e_el -+ k e_el predicts for a measured surface, and where it applies."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.law import shipped_law
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.analysis.validity import validity_sentence
from crackfront.core import jkr
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.core.variables import variable
from crackfront.topography.cautions import surface_notes
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.tile import zero_load_radius
from crackfront.topography.verdict import Verdict, verdict


@dataclass(frozen=True, slots=True)
class Prediction:
    """Adhesion that is predicted for a surface, in SI units.

    The intervals of the works of adhesion hold those of k and of e_el.
    """

    surface: MeasuredSurface
    verdict: Verdict
    factors: SphereFactors
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
    k_appr: Estimate[float] = variable("factor k of the approach", "1")
    k_retr: Estimate[float] = variable("factor k of the retraction", "1")
    w_appr: Estimate[float] = variable("work of adhesion of the approach", "J m-2")
    w_retr: Estimate[float] = variable("work of adhesion of the retraction", "J m-2")
    hysteresis: Estimate[float] = variable("w_retr - w_appr", "J m-2")
    pull_off_force: Estimate[float] = variable("pull-off force at a given load", "N")
    pull_off_force_held: Estimate[float] = variable("pull-off force at a given displacement", "N")
    pull_off_force_smooth: float = variable("pull-off force of a smooth surface at a load", "N")
    paper_factor: float = variable("factor k of the paper", "1")
    paper_w_appr: float = variable("work of adhesion of the approach by that factor", "J m-2")
    paper_w_retr: float = variable("work of adhesion of the retraction by that factor", "J m-2")

    def __repr__(self) -> str:
        """The page that the command `crackfront predict` prints."""
        from crackfront.topography.report import report_text

        return report_text(self.surface, ruling=self.verdict, prediction=self)


def prediction_notes(prediction: Prediction) -> Iterator[str]:
    """Treatments of the measurements, where k comes from, and where the numbers are weak."""
    yield from surface_notes(prediction.surface, prediction.contact_radius)
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
    yield validity_sentence()
    if prediction.w_appr.value <= 0:
        yield (
            "w_appr is not positive: the sphere is not drawn into contact, it has to be pressed on."
        )


def reduced_spectrum(spectrum: TabulatedSpectrum, scales: Scales) -> TabulatedSpectrum:
    """A spectrum of heights in metres in reduced units: its `elastic_energy` is e_el / w_int."""
    unit = (scales.vertical * scales.lateral) ** 2
    return spectrum.in_units(scales.lateral).amplified(1 / unit)


def predicted(
    surface: MeasuredSurface, scales: Scales, attraction_range: float | None = None
) -> Prediction:
    """Prediction for a surface under a sphere, of scales in SI units.

    The range of attraction (Units: m) is that of van der Waals forces where none is given.

    Raises
    ------
    ValueError
        If no contact conforms, e_el >= w_int.
    """
    shape, radius = reduced_spectrum(surface.joint.spectrum, scales), zero_load_radius(scales)
    reduced_energy = shape.elastic_energy
    if not reduced_energy < 1:
        raise ValueError(
            f"e_el is {reduced_energy:.3g} w_int, so that no contact conforms fully and the theory "
            "does not apply; a softer sphere, a stronger adhesion or a smoother surface would"
        )
    factors = sphere_factors("roughness", shape, reduced_energy, radius / scales.lateral)
    k_appr, k_retr, k = (
        replace(factor, standard_error=math.nan)
        for factor in (factors.approach.factor, factors.retraction.factor, factors.both)
    )
    adhesion = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    appr = _linear(adhesion, energy, k_appr, -1.0, -1.0)
    retr = _linear(adhesion, energy, k_retr, -1.0, 1.0)
    hysteresis = _linear(0.0, energy, k, 0.0, 2.0)
    # By JKR, pull-off forces are linear in the work of adhesion.
    at_load, at_displacement = (
        -reduced * scales.force / adhesion
        for reduced in (jkr.pull_off_force(), float(jkr.equilibrium_force(jkr.pull_off_radius())))
    )
    return Prediction(
        surface=surface,
        verdict=verdict(surface, scales, attraction_range, factors),
        factors=factors,
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
        k_appr=k_appr,
        k_retr=k_retr,
        w_appr=appr,
        w_retr=retr,
        hysteresis=replace(hysteresis, low=max(0.0, hysteresis.low)),
        pull_off_force=retr.each(lambda work: at_load * work),
        pull_off_force_held=retr.each(lambda work: at_displacement * work),
        pull_off_force_smooth=-jkr.pull_off_force() * scales.force,
        paper_factor=PAPER_FACTOR,
        paper_w_appr=adhesion - (1 + PAPER_FACTOR) * energy.value,
        paper_w_retr=adhesion - (1 - PAPER_FACTOR) * energy.value,
    )


def _linear(
    base: float, energy: Estimate[float], factor: Estimate[float], own: float, slope: float
) -> Estimate[float]:
    """`base + (own + slope k) e_el`, with the intervals of k and of e_el in quadrature."""
    value = base + (own + slope * factor.value) * energy.value
    ends = [
        sorted(end - value for end in pair)
        for pair in (
            [base + (own + slope * end) * energy.value for end in (factor.low, factor.high)],
            [base + (own + slope * factor.value) * end for end in (energy.low, energy.high)],
        )
    ]
    low, high = (math.hypot(*(one[end] for one in ends)) for end in (0, 1))
    return Estimate(value, math.nan, value - low, value + high)
