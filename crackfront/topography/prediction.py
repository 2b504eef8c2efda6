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
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.tile import zero_load_radius

_MOST_ANISOTROPY = 1.25
_MOST_UNMEASURED = 0.1
_MOST_CONTINUED = 0.5
"""Ratio of slopes and parts of e_el from which on they are doubts."""

_EDGE, _MATTERS = 0.05, 0.1
"""Distance of a Hurst exponent from 0 and from 1 below which it is at the edge of what is fitted,
and part of e_el that is continued from which on that matters."""


@dataclass(frozen=True, slots=True)
class Prediction:
    """Adhesion that is predicted, in SI units, and the factors k that it rests on.

    The intervals of the works of adhesion hold those of k and of e_el.
    """

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


def reduced_spectrum(spectrum: TabulatedSpectrum, scales: Scales) -> TabulatedSpectrum:
    """A spectrum of heights in metres in reduced units: its `elastic_energy` is e_el / w_int."""
    unit = (scales.vertical * scales.lateral) ** 2
    return spectrum.in_units(scales.lateral).amplified(1 / unit)


def predicted(surface: MeasuredSurface, scales: Scales) -> Prediction:
    """Prediction for a surface under a sphere, of scales in SI units.

    Raises
    ------
    ValueError
        If no contact conforms, e_el >= w_int.
    """
    factors = _factors(surface, scales)
    k_appr, k_retr, k = (
        replace(factor, standard_error=math.nan)
        for factor in (factors.approach.factor, factors.retraction.factor, factors.both)
    )
    adhesion = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    appr = _linear(adhesion, energy, k_appr, -1.0, -1.0)
    retr = _linear(adhesion, energy, k_retr, -1.0, 1.0)
    hysteresis = _linear(0.0, energy, k, 0.0, 2.0)
    return Prediction(
        factors=factors,
        radius=scales.radius,
        contact_modulus=scales.contact_modulus,
        work_of_adhesion=adhesion,
        contact_radius=zero_load_radius(scales),
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
        pull_off_force=_forces(retr, jkr.pull_off_force(), scales),
        pull_off_force_held=_forces(
            retr, float(jkr.equilibrium_force(jkr.pull_off_radius())), scales
        ),
        pull_off_force_smooth=-jkr.pull_off_force() * scales.force,
        paper_factor=PAPER_FACTOR,
        paper_w_appr=adhesion - (1 + PAPER_FACTOR) * energy.value,
        paper_w_retr=adhesion - (1 - PAPER_FACTOR) * energy.value,
    )


def _factors(surface: MeasuredSurface, scales: Scales) -> SphereFactors:
    """Factors k that the law gives for a surface."""
    shape = reduced_spectrum(surface.joint.spectrum, scales)
    energy = shape.elastic_energy
    if not energy < 1:
        raise ValueError(
            f"e_el is {energy:.3g} w_int, so that no contact conforms fully and the theory does "
            "not apply; a softer sphere, a stronger adhesion or a smoother surface would"
        )
    radius = zero_load_radius(scales) / scales.lateral
    return sphere_factors("roughness", shape, energy, radius)


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


def _forces(retraction: Estimate[float], reduced: float, scales: Scales) -> Estimate[float]:
    """Pull-off forces, positive; by JKR they are linear in the work of adhesion."""
    slope = -reduced * scales.force / scales.work_of_adhesion
    return retraction.each(lambda adhesion: slope * adhesion)


def prediction_notes(surface: MeasuredSurface, prediction: Prediction) -> Iterator[str]:
    """What a reader of a prediction must know, one sentence each."""
    yield from surface_notes(surface, prediction.contact_radius)
    yield from _factor_notes(prediction)
    yield validity_sentence()
    if prediction.w_appr.value <= 0:
        yield (
            "w_appr is not positive: the sphere is not drawn into contact, it has to be pressed on."
        )


def surface_notes(surface: MeasuredSurface, contact_radius: float | None = None) -> Iterator[str]:
    """Treatments of the measurements, against the radius of a contact (Units: m)."""
    for one in surface.scans:
        item = one.measurement
        if item.missing > 0:
            yield f"{item.path}: {item.missing:.2%} of the points were missing and interpolated."
        if item.is_line:
            yield (
                f"{item.path} is a line scan: its density is that of an isotropic surface with "
                "this projection."
            )
        elif max(item.pixels) > 1.001 * min(item.pixels):
            yield f"{item.path}: the pixels are oblong; its density covers what both sides resolve."
        for axis in one.band.stripes:
            yield (
                f"{item.path}: waves along {'xy'[axis]} alone have another density than all "
                "others, as of rows that are shifted or levelled one by one; they are left out."
            )
        if contact_radius is not None and min(item.size) < 2 * contact_radius:
            yield (
                f"{item.path} is smaller than the contact ({1e6 * min(item.size):.3g} um against "
                f"{2e6 * contact_radius:.3g} um across): it stands for the whole surface by its "
                "spectrum."
            )


def surface_doubts(surface: MeasuredSurface) -> Iterator[str]:
    """What makes a spectrum doubtful, one sentence each."""
    joint = surface.joint
    for index, one in enumerate(surface.scans):
        path, ratio, level = one.measurement.path, one.band.anisotropy, joint.density.levels[index]
        if max(ratio, 1 / ratio) > _MOST_ANISOTROPY:
            yield (
                f"{path}: the rms slope along x is {ratio:.2g} times that along y; the theory is "
                "for isotropic surfaces."
            )
        if joint.density.disagrees(index):
            yield (
                f"{path} disagrees with the other scans: its density is {level.value:.2g} "
                f"({level.low:.2g} to {level.high:.2g}) times theirs where they overlap; the "
                "intervals hold that."
            )
    if joint.shares.continued > _MOST_CONTINUED:
        yield (
            f"{joint.shares.continued:.0%} of e_el is not measured but continued by a model; look "
            "at the figure, and add a scan of the waves that are missing."
        )
    hurst, _, _ = joint.fit.hurst
    if min(hurst, 1 - hurst) < _EDGE and joint.shares.continued > _MATTERS:
        yield (
            f"The Hurst exponent of the shortest waves, {hurst:.2g}, is at the edge of what is "
            f"fitted, 0 to 1: the model that continues {joint.shares.continued:.0%} of e_el may "
            "not be what the surface is."
        )
    if not joint.fit.has_roll_off:
        yield (
            "The density shows no plateau within the trusted wavelengths: it is taken as flat "
            f"above, longer waves would add about {joint.shares.missing_long:.0%} to e_el, and its "
            "interval holds roll-offs of up to four sides of the scan; add a larger scan."
        )
    if joint.shares.missing_short > _MOST_UNMEASURED:
        yield (
            "Waves shorter than the points hold are left out: two more decades of the power law "
            f"would add {joint.shares.missing_short:.0%} to e_el; add a finer scan."
        )


def _factor_notes(prediction: Prediction) -> Iterator[str]:
    """Where the factors come from, and where they are weak."""
    factors = prediction.factors
    yield (
        "k is that of a straight front on springs of the length L_kappa, by the law that was "
        "fitted to simulations of such fronts; its interval holds the errors of both."
    )
    _, largest = shipped_law().size
    if factors.size > largest:
        yield (
            f"Size g {factors.size:.3g} is above the largest that was measured ({largest:.3g}): k "
            "follows the finite-size exponent of the elastic line from there."
        )
