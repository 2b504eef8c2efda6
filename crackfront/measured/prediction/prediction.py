"""The prediction for a measured surface by the law w = w_int - e_el -+ k e_el."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from crackfront.analysis.estimate import UNKNOWN, Estimate
from crackfront.analysis.law import shipped_law
from crackfront.analysis.law_spheres import SphereFactors
from crackfront.analysis.validity import Excess
from crackfront.core import jkr
from crackfront.core.adhesion import overlap_share
from crackfront.core.units import Scales
from crackfront.core.variables import variable, variables
from crackfront.core.words import wrapped
from crackfront.measured.options import PredictionOptions
from crackfront.measured.prediction.conditions import theory_verdict, zero_load_radius
from crackfront.measured.prediction.prediction_page import prediction_page
from crackfront.measured.prediction.prediction_remarks import (
    adhesion_error_remarks,
    law_remarks,
    pull_off_remarks,
)
from crackfront.measured.prediction.remarks import Verdict, remark_entries, remark_text
from crackfront.measured.prediction.surface_remarks import is_lower_bound
from crackfront.measured.prediction.works import (
    adhesion_by_law,
    implied_work_of_adhesion,
    least_work_of_adhesion,
)
from crackfront.measured.prediction.works_by_source import works_by_source
from crackfront.measured.spectrum.stated import Surface
from crackfront.simulate.jsonable import to_jsonable

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class Prediction:
    """Adhesion that is predicted for a surface, in SI units.

    The intervals of the works of adhesion include the uncertainties of k, of e_el, of w_int if its
    error is named, and of the ratio by which the front's hysteresis is divided. If the theory does
    not apply, :attr:`reason` says why, and all numbers that need it are NaN.
    """

    surface: Surface
    verdict: Verdict
    factors: SphereFactors | None
    """Factors k of the front; None if the theory does not apply."""
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
    overlap_share: float = variable("part of the front where the solids would overlap", "1")
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
    def applies(self) -> bool:
        """Whether the theory applies, perhaps with reservations, or may apply."""
        return self.verdict.outcome != "does not apply"

    @property
    def reason(self) -> str:
        """Conditions that fail, with changes that would meet them; empty if the theory applies."""
        return " ".join(map(remark_text, self.verdict.with_severity("fails")))

    @property
    def at_least(self) -> bool:
        """Whether shorter waves than the measured ones would add more than 10% to e_el.

        e_el and the hysteresis are then lower bounds, and w_appr is an upper one.
        """
        return is_lower_bound(self.surface)

    @property
    def k(self) -> Estimate[float]:
        """Mean factor k of both branches, of the front."""
        return UNKNOWN if self.factors is None else self.factors.both

    @property
    def none_is_expected(self) -> bool:
        """Whether the contact is too small for hysteresis by the law of k."""
        return self.size < shipped_law().size[0]

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw contact radius against force of both branches, with their 95% intervals.

        Parameters
        ----------
        axes : matplotlib.axes.Axes, optional
            Axes to draw on; by default axes of a new figure.

        Returns
        -------
        matplotlib.axes.Axes
            The axes with the curves; only with the smooth sphere if the theory does not apply.

        Raises
        ------
        TypeError
            If `axes` is of another type.
        """
        from crackfront.plots.force_axes import draw_forces
        from crackfront.plots.style import axes_to_draw_on

        with axes_to_draw_on(axes) as drawn:
            draw_forces(drawn, self.scales, self.w_appr, self.w_retr)
        return drawn

    @property
    def scales(self) -> Scales:
        """The sphere, with scales in SI units."""
        return Scales(self.radius, self.work_of_adhesion, self.contact_modulus)

    def to_dict(self) -> dict[str, Any]:
        """Outcome, remarks and all numbers in SI units, as `crackfront predict --json` has them.

        Returns
        -------
        dict
            Values for JSON. `prediction` has the numbers by name with their intervals and units; it
            is None if the theory does not apply.
        """
        entries: dict[str, Any] = {
            "outcome": self.verdict.outcome,
            "at_least": self.at_least,
            "remarks": remark_entries(self.verdict.remarks),
            "prediction": None,
            "factors": None,
            "excess": None,
            "works_by_source": None,
        }
        if self.factors is not None:
            entries["prediction"] = self.number_entries()
            entries["factors"] = to_jsonable(self.factors)
            entries["excess"] = to_jsonable(self.excess)
            entries["works_by_source"] = to_jsonable(works_by_source(self))
        return entries

    def number_entries(self) -> dict[str, dict[str, Any]]:
        """Numbers by name, with standard errors, intervals, units and long names."""
        entries = {}
        for number in variables(Prediction):
            value = to_jsonable(getattr(self, number.name))
            entry = value if isinstance(value, dict) else {"value": value}
            entries[number.name] = entry | number.attributes
        return entries

    def __repr__(self) -> str:
        """The page that the command `crackfront predict` prints."""
        return wrapped(prediction_page(self))


def check_and_predict(
    surface: Surface, scales: Scales, options: PredictionOptions
) -> tuple[Verdict, Prediction | None]:
    """Whether the theory applies under a sphere, and the prediction if it does."""
    verdict = theory_verdict(surface, scales, options.range, thickness=options.thickness)
    if verdict.outcome == "does not apply":
        return verdict, None
    prediction = predicted(
        surface,
        scales,
        options.range,
        options.pull_off,
        thickness=options.thickness,
        adhesion_error=options.work_of_adhesion_error or 0.0,
    )
    return prediction.verdict, prediction


def prediction_or_reason(
    surface: Surface, scales: Scales, options: PredictionOptions
) -> Prediction:
    """The prediction, whose numbers are NaN if the theory does not apply."""
    verdict, prediction = check_and_predict(surface, scales, options)
    return not_predicted(surface, scales, verdict) if prediction is None else prediction


def not_predicted(surface: Surface, scales: Scales, verdict: Verdict) -> Prediction:
    """The result for a surface to which the theory does not apply, with scales in SI units."""
    energy, w_int = surface.conformity_energy(scales.contact_modulus), scales.work_of_adhesion
    return Prediction(
        surface=surface,
        verdict=verdict,
        factors=None,
        excess=Excess(UNKNOWN, is_measured=False, sentence=""),
        radius=scales.radius,
        contact_modulus=scales.contact_modulus,
        work_of_adhesion=w_int,
        contact_radius=zero_load_radius(scales),
        e_el=energy,
        w_rms=2 * math.sqrt(energy.value * w_int),
        correlation_length=surface.spectrum.correlation_length,
        l_kappa=math.nan,
        larkin_length=math.nan,
        size=math.nan,
        negative_share=math.nan,
        overlap_share=math.nan,
        k_appr=UNKNOWN,
        k_retr=UNKNOWN,
        front_excess=UNKNOWN,
        front_hysteresis=UNKNOWN,
        w_appr=UNKNOWN,
        w_retr=UNKNOWN,
        hysteresis=UNKNOWN,
        pull_off_force=UNKNOWN,
        pull_off_force_held=UNKNOWN,
        pull_off_force_smooth=-jkr.pull_off_force() * scales.force,
        implied_work_of_adhesion=UNKNOWN,
    )


def predicted(
    surface: Surface,
    scales: Scales,
    attraction_range: float | None = None,
    pull_off: float | None = None,
    *,
    thickness: float | None = None,
    adhesion_error: float = 0.0,
) -> Prediction:
    """Prediction for a surface under a sphere, with scales in SI units.

    By default the range of attraction (Units: m) is the range of van der Waals forces. With a
    measured pull-off force (Units: N) the prediction includes the w_int that the force implies.
    The thickness of the soft body (Units: m) is compared with the contact, and the standard error
    of w_int (Units: J / m^2) widens the intervals. ValueError if the theory cannot be evaluated
    because e_el is above w_int.
    """
    adhesion = adhesion_by_law(surface, scales, adhesion_error)
    energy, factors, w_retr = adhesion.energy, adhesion.factors, adhesion.w_retr
    radius, w_int = zero_load_radius(scales), scales.work_of_adhesion
    # By JKR, pull-off forces are linear in the work of adhesion.
    at_load = -jkr.pull_off_force() * scales.force / w_int
    unstable_force = float(jkr.equilibrium_force(jkr.pull_off_radius()))
    at_displacement = -unstable_force * scales.force / w_int
    implied, remarks = UNKNOWN, [*law_remarks(adhesion), *adhesion_error_remarks(adhesion_error)]
    if pull_off is not None:
        implied = implied_work_of_adhesion(surface, scales, pull_off / at_load)
        remarks += pull_off_remarks(implied, pull_off, least_work_of_adhesion(surface, scales))
    return Prediction(
        surface=surface,
        verdict=theory_verdict(surface, scales, attraction_range, remarks, thickness=thickness),
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
        overlap_share=overlap_share(energy.value / w_int),
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
