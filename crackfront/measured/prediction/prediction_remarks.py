"""Remarks on the numbers of a prediction, in addition to those on the surface."""

from __future__ import annotations

import math
from collections.abc import Iterator

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.law import shipped_law
from crackfront.measured.prediction.remarks import Remark
from crackfront.measured.prediction.works import AdhesionByLaw
from crackfront.surfaces.written_units import prefixed


def law_remarks(adhesion: AdhesionByLaw) -> Iterator[Remark]:
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
    yield from repelled_remarks(adhesion.w_appr)


def adhesion_error_remarks(error: float) -> Iterator[Remark]:
    """Note on the standard error of w_int, if there is one (Units: J / m^2)."""
    if error > 0:
        sentence = f"The intervals include a standard error of w_int of {prefixed('J/m2', error)}."
        yield Remark("w_int", "note", sentence)


def repelled_remarks(w_appr: Estimate[float]) -> Iterator[Remark]:
    """Note on the meaning of a negative w_appr, if the interval includes it."""
    if w_appr.low <= 0:
        word = "is not" if w_appr.value <= 0 else "may not be"
        yield Remark(
            "w_appr",
            "note",
            f"w_appr {word} positive: there the sphere is not drawn into contact but has to be "
            "pressed on, and the theory ends.",
        )


def pull_off_remarks(
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
