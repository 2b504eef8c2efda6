"""The prediction for a measured surface by the law w = w_int - e_el -+ k e_el."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.analysis.law import shipped_law
from crackfront.analysis.law_spheres import SphereFactors
from crackfront.analysis.validity import Excess
from crackfront.core import jkr
from crackfront.core.units import Scales
from crackfront.core.variables import variable
from crackfront.measured.options import PredictionOptions
from crackfront.measured.prediction.conditions import theory_verdict, zero_load_radius
from crackfront.measured.prediction.next_scan import measure_next
from crackfront.measured.prediction.prediction_texts import ENERGY, estimate_text, wavelengths_text
from crackfront.measured.prediction.remarks import Remark, Verdict, remark_text
from crackfront.measured.prediction.surface_remarks import disagreements
from crackfront.measured.prediction.works import (
    AdhesionByLaw,
    adhesion_by_law,
    implied_work_of_adhesion,
    least_work_of_adhesion,
)
from crackfront.measured.spectrum.stated import StatedSurface, Surface
from crackfront.surfaces.written_units import prefixed


@dataclass(frozen=True, slots=True)
class Prediction:
    """Adhesion that is predicted for a surface, in SI units.

    The intervals of the works of adhesion include the uncertainties of k, of e_el, and of the ratio
    by which the front's hysteresis is divided.
    """

    surface: Surface
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

    @property
    def none_is_expected(self) -> bool:
        """Whether the contact is too small for hysteresis by the law of k."""
        return self.size < shipped_law().size[0]

    def __repr__(self) -> str:
        """The page that the command `crackfront predict` prints."""
        return prediction_page(self)


def prediction_page(prediction: Prediction) -> str:
    """The most important numbers, their reservations, and the next measurement, as a page."""
    surface, e_el = prediction.surface, prediction.e_el
    hysteresis = estimate_text(ENERGY, prediction.hysteresis)
    if prediction.none_is_expected:
        smallest = shipped_law().size[0]
        hysteresis += f"; none expected: g {prediction.size:.2g} is below {smallest:.2g}"
    pull_off = estimate_text("N", prediction.pull_off_force)
    smooth = prefixed("N", prediction.pull_off_force_smooth)
    relative = e_el.value / prediction.work_of_adhesion
    recorded = surface.conformity_energy(prediction.contact_modulus, surface.recorded)
    waves = wavelengths_text(surface.shortest, surface.longest)
    rows = [
        ("hysteresis", hysteresis),
        ("w_appr", estimate_text(ENERGY, prediction.w_appr)),
        ("w_retr", estimate_text(ENERGY, prediction.w_retr)),
        ("pull-off force", f"{pull_off}; smooth sphere {smooth}"),
    ]
    if math.isfinite(prediction.implied_work_of_adhesion.value):
        implied = estimate_text(ENERGY, prediction.implied_work_of_adhesion)
        rows.append(("w_int by pull-off", implied))
    rows.append(("e_el", f"{estimate_text(ENERGY, e_el)} = {relative:.3g} w_int"))
    if isinstance(surface, StatedSurface):
        rms = prefixed("m", surface.measures[0].rms.value)
        rows.append(("rms height", f"{rms}; waves from {waves}"))
    else:
        energy = prefixed(ENERGY, recorded.value)
        rows.append(("as recorded", f"{energy}; trusted waves from {waves}"))
    conflicts = [*disagreements(surface)]
    reservations = prediction.verdict.with_severity("undecided", "reservation")
    further = [remark for remark in reservations if remark not in conflicts]
    return "\n".join(
        [
            *map(remark_text, conflicts),
            *(f"{name:18}{text}" for name, text in rows),
            f"{prediction.verdict.heading}. {prediction.excess.sentence}",
            *map(remark_text, _repelled_remarks(prediction.w_appr)),
            *map(remark_text, further),
            remark_text(measure_next(surface)),
            "Quasi-static: rate, viscoelasticity, ageing and the preload do not enter.",
            "Intervals are 95% intervals; --long prints all results.",
        ]
    )


def _law_remarks(adhesion: AdhesionByLaw) -> Iterator[Remark]:
    """Remarks on the law of k, on its correction, and on a negative w_appr."""
    factors = adhesion.factors
    if factors.warning:
        sentence = f"The law of k was not measured there: {factors.warning}."
        yield Remark("k", "reservation", sentence)
    yield Remark(
        "k",
        "note",
        "k is calculated for a straight front on springs of the length L_kappa, by a law that was "
        "fitted to simulations of such fronts; its interval includes the errors of both.",
    )
    _, largest = shipped_law().size
    if factors.size > largest:
        yield Remark(
            "k",
            "note",
            f"Size g {factors.size:.3g} is above the largest that was measured ({largest:.3g}): k "
            "follows the finite-size exponent of the elastic line from there.",
        )
    yield Remark("hysteresis", "note", adhesion.excess.sentence)
    yield from _repelled_remarks(adhesion.w_appr)


def _repelled_remarks(w_appr: Estimate[float]) -> Iterator[Remark]:
    """Note on the meaning of a negative w_appr, if the interval includes it."""
    if w_appr.low <= 0:
        word = "is not" if w_appr.value <= 0 else "may not be"
        yield Remark(
            "w_appr",
            "note",
            f"w_appr {word} positive: there the sphere is not drawn into contact but has to be "
            "pressed on, and the theory ends.",
        )


def _pull_off_remarks(
    implied: Estimate[float], pull_off: float, least_adhesion: float
) -> Iterator[Remark]:
    """Remark if a measured pull-off force does not determine w_int."""
    if not math.isfinite(implied.value):
        sentence = (
            f"No w_int with which the theory applies gives the measured pull-off force of "
            f"{prefixed('N', pull_off)}: check the force, the radius and the modulus."
        )
        yield Remark("w_int by pull-off", "reservation", sentence)
    elif implied.low <= least_adhesion:
        sentence = (
            f"The interval of w_int by pull-off begins at {prefixed('J/m2', implied.low)}, "
            "below which the theory does not apply: smaller values are not excluded."
        )
        yield Remark("w_int by pull-off", "note", sentence)


def check_and_predict(
    surface: Surface, scales: Scales, options: PredictionOptions
) -> tuple[Verdict, Prediction | None]:
    """Whether the theory applies under a sphere, and the prediction if it does."""
    verdict = theory_verdict(surface, scales, options.range)
    if verdict.outcome == "does not apply":
        return verdict, None
    prediction = predicted(surface, scales, options.range, options.pull_off)
    return prediction.verdict, prediction


def predicted(
    surface: Surface,
    scales: Scales,
    attraction_range: float | None = None,
    pull_off: float | None = None,
) -> Prediction:
    """Prediction for a surface under a sphere, with scales in SI units.

    By default the range of attraction (Units: m) is the range of van der Waals forces. With a
    measured pull-off force (Units: N) the prediction includes the w_int that the force implies.
    ValueError if the theory cannot be evaluated because e_el is above w_int.
    """
    adhesion = adhesion_by_law(surface, scales)
    energy, factors, w_retr = adhesion.energy, adhesion.factors, adhesion.w_retr
    radius, w_int = zero_load_radius(scales), scales.work_of_adhesion
    # By JKR, pull-off forces are linear in the work of adhesion.
    at_load = -jkr.pull_off_force() * scales.force / w_int
    unstable_force = float(jkr.equilibrium_force(jkr.pull_off_radius()))
    at_displacement = -unstable_force * scales.force / w_int
    implied, remarks = UNKNOWN, [*_law_remarks(adhesion)]
    if pull_off is not None:
        implied = implied_work_of_adhesion(surface, scales, pull_off / at_load)
        remarks += _pull_off_remarks(implied, pull_off, least_work_of_adhesion(surface, scales))
    return Prediction(
        surface=surface,
        verdict=theory_verdict(surface, scales, attraction_range, remarks),
        factors=factors,
        excess=adhesion.excess,
        radius=scales.radius,
        contact_modulus=scales.contact_modulus,
        work_of_adhesion=w_int,
        contact_radius=radius,
        e_el=energy,
        w_rms=2 * math.sqrt(energy.value * w_int),
        correlation_length=surface.spectrum.correlation_length,
        l_kappa=factors.spring * scales.lateral,
        larkin_length=factors.larkin_length * scales.lateral,
        size=factors.size,
        negative_share=factors.approach.negative_share,
        k_appr=replace(factors.approach.factor, standard_error=math.nan),
        k_retr=replace(factors.retraction.factor, standard_error=math.nan),
        front_excess=adhesion.excess.ratio,
        front_hysteresis=adhesion.front_hysteresis,
        w_appr=adhesion.w_appr,
        w_retr=w_retr,
        hysteresis=adhesion.hysteresis,
        pull_off_force=w_retr.each(lambda work: at_load * work),
        pull_off_force_held=w_retr.each(lambda work: at_displacement * work),
        pull_off_force_smooth=-jkr.pull_off_force() * scales.force,
        implied_work_of_adhesion=implied,
    )
