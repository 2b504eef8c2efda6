"""What the law w = w_int - e_el -+ k e_el predicts for a measured surface under a sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from crackfront.analysis.factors import Factor, Factors, expected_factors
from crackfront.analysis.report import PAPER_FACTOR
from crackfront.core import jkr
from crackfront.core.records import variable
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import Scales
from crackfront.topography.measures import Surface
from crackfront.topography.tile import zero_load_radius

REACH = 1.96
"""Standard errors in half of a 95% interval."""


@dataclass(frozen=True, slots=True)
class Prediction:
    """Adhesion that is predicted, in SI units; `low` and `high` end 95% intervals.

    The intervals of the works of adhesion hold those of k and of e_el.
    """

    radius: float = variable("radius of the sphere", "m")
    contact_modulus: float = variable("contact modulus E'", "Pa")
    work_of_adhesion: float = variable("intrinsic work of adhesion w_int", "J m-2")
    contact_radius: float = variable("radius of the smooth contact at zero load", "m")
    e_el: float = variable("energy of full conformity", "J m-2")
    e_el_error: float = variable("its standard error", "J m-2")
    w_rms: float = variable("rms of the local work of adhesion, 2 sqrt(e_el w_int)", "J m-2")
    correlation_length: float = variable("correlation length of the local work of adhesion", "m")
    k_appr: float = variable("factor k of the approach", "1")
    k_appr_low: float = variable("lower end of its interval", "1")
    k_appr_high: float = variable("upper end of its interval", "1")
    k_retr: float = variable("factor k of the retraction", "1")
    k_retr_low: float = variable("lower end of its interval", "1")
    k_retr_high: float = variable("upper end of its interval", "1")
    w_appr: float = variable("work of adhesion of the approach", "J m-2")
    w_appr_low: float = variable("lower end of its interval", "J m-2")
    w_appr_high: float = variable("upper end of its interval", "J m-2")
    w_retr: float = variable("work of adhesion of the retraction", "J m-2")
    w_retr_low: float = variable("lower end of its interval", "J m-2")
    w_retr_high: float = variable("upper end of its interval", "J m-2")
    hysteresis: float = variable("w_retr - w_appr", "J m-2")
    hysteresis_low: float = variable("lower end of its interval", "J m-2")
    hysteresis_high: float = variable("upper end of its interval", "J m-2")
    pull_off_force: float = variable("pull-off force at a given load", "N")
    pull_off_force_low: float = variable("smaller end of its interval", "N")
    pull_off_force_high: float = variable("larger end of its interval", "N")
    pull_off_force_held: float = variable("pull-off force at a given displacement", "N")
    pull_off_force_held_low: float = variable("smaller end of its interval", "N")
    pull_off_force_held_high: float = variable("larger end of its interval", "N")
    pull_off_force_smooth: float = variable("pull-off force of a smooth surface at a load", "N")
    paper_factor: float = variable("factor k of the paper", "1")
    paper_w_appr: float = variable("work of adhesion of the approach by that factor", "J m-2")
    paper_w_retr: float = variable("work of adhesion of the retraction by that factor", "J m-2")


@dataclass(frozen=True, slots=True)
class Range:
    """A number with the ends of its 95% interval."""

    value: float
    low: float
    high: float


def reduced_spectrum(spectrum: SelfAffineSpectrum, scales: Scales) -> SelfAffineSpectrum:
    """A spectrum of heights in metres as the model takes it.

    Parameters
    ----------
    spectrum : SelfAffineSpectrum
        Lengths in metres.
    scales : Scales
        The scene.

    Returns
    -------
    SelfAffineSpectrum
        The same in reduced units, so that its `elastic_energy` is e_el / w_int.
    """
    plateau = spectrum.plateau / (scales.vertical * scales.lateral) ** 2
    return SelfAffineSpectrum(
        spectrum.short_cutoff / scales.lateral,
        spectrum.roll_off / scales.lateral,
        spectrum.hurst,
        plateau,
    )


def surface_factors(surface: Surface, scales: Scales) -> Factors:
    """Factors k that are expected of a surface.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    scales : Scales
        The scene, in SI units.

    Raises
    ------
    ValueError
        If no contact conforms, e_el >= w_int.
    """
    shape = reduced_spectrum(surface.fitted.spectrum, scales)
    energy = shape.elastic_energy
    if not energy < 1:
        raise ValueError(
            f"e_el is {energy:.3g} w_int, so that no contact conforms fully and the theory does "
            "not apply; a softer sphere, a stronger adhesion or a smoother surface would"
        )
    return expected_factors(shape, energy, zero_load_radius(scales) / scales.lateral)


def predicted(surface: Surface, scales: Scales, factors: Factors) -> Prediction:
    """Prediction for a surface.

    Parameters
    ----------
    surface : Surface
        A measured surface.
    scales : Scales
        The scene, in SI units.
    factors : Factors
        Factors k of the surface.
    """
    adhesion = scales.work_of_adhesion
    energy = surface.conformity_energy(scales.contact_modulus)
    e_el, error = energy.value, REACH * energy.error
    appr = _range(adhesion - e_el, -e_el, factors.approach, (1 + factors.approach.value) * error)
    retr = _range(adhesion - e_el, e_el, factors.retraction, (factors.retraction.value - 1) * error)
    hysteresis = _range(0.0, 2 * e_el, factors.both, 2 * factors.both.value * error)
    at_load = _forces(retr, jkr.pull_off_force(), scales)
    held = _forces(retr, float(jkr.equilibrium_force(jkr.pull_off_radius())), scales)
    return Prediction(
        radius=scales.radius,
        contact_modulus=scales.contact_modulus,
        work_of_adhesion=adhesion,
        contact_radius=zero_load_radius(scales),
        e_el=e_el,
        e_el_error=energy.error,
        w_rms=2 * math.sqrt(e_el * adhesion),
        correlation_length=surface.fitted.spectrum.correlation_length,
        **_named("k_appr", factors.approach),
        **_named("k_retr", factors.retraction),
        **_named("w_appr", appr),
        **_named("w_retr", retr),
        **_named("hysteresis", replace(hysteresis, low=max(0.0, hysteresis.low))),
        **_named("pull_off_force", at_load),
        **_named("pull_off_force_held", held),
        pull_off_force_smooth=-jkr.pull_off_force() * scales.force,
        paper_factor=PAPER_FACTOR,
        paper_w_appr=adhesion - (1 + PAPER_FACTOR) * e_el,
        paper_w_retr=adhesion - (1 - PAPER_FACTOR) * e_el,
    )


def _range(centre: float, slope: float, factor: Factor, reach: float) -> Range:
    """`centre + slope k` with the interval of k and, in quadrature, another reach."""
    value = centre + slope * factor.value
    ends = sorted((centre + slope * factor.low, centre + slope * factor.high))
    low, high = value - ends[0], ends[1] - value
    return Range(value, value - math.hypot(low, reach), value + math.hypot(high, reach))


def _forces(retraction: Range, reduced: float, scales: Scales) -> Range:
    """Pull-off forces, positive; by JKR they are linear in the work of adhesion."""
    slope = -reduced * scales.force / scales.work_of_adhesion
    return Range(slope * retraction.value, slope * retraction.low, slope * retraction.high)


def _named(name: str, found: Range | Factor) -> dict[str, float]:
    """Fields of a number with an interval."""
    return {name: found.value, f"{name}_low": found.low, f"{name}_high": found.high}
