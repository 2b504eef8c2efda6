"""What was found about k, in the sentences that README, fits and reports open with."""

from __future__ import annotations

import math

import scipy

from crackfront.analysis.estimate import with_interval
from crackfront.analysis.law import (
    WEAKEST,
    law_value,
    pinning_factor,
    shipped_law,
    spectral_breadth,
)
from crackfront.core.spectrum import SelfAffineSpectrum

PAPER_FACTOR, PERTURBATION_FACTOR = 3.0, 4.0
"""k of the paper's fit, and of second-order perturbation theory in the limit of weak disorder."""

STRONG = 0.84
"""Disorder s of the paper's experiment, up to which the finding follows k."""


def stated_breadths() -> dict[str, float]:
    """Breadths of the spectra of roughness whose limit of the infinite contact is quoted."""
    stated = {
        "a flat spectrum": SelfAffineSpectrum(1.0, 1.0, 1.0),
        "H = 0.8 over three octaves": SelfAffineSpectrum(1.0, 8.0, 0.8),
    }
    return {name: spectral_breadth("roughness", shape) for name, shape in stated.items()}


def finding(departure: str) -> str:
    """The sentences, with the numbers of the shipped law.

    The departure ends the sentence "The law was measured on straight fronts held by springs". It
    names further fronts and how far their k depart from the law.

    Examples
    --------
    >>> finding("; no sphere was held against it").count(". ")
    7
    """
    s, low, high = crossing()
    weak = pinning_factor(WEAKEST, math.inf).factor
    strong = " and ".join(
        f"{with_interval(pinning_factor(STRONG, math.inf, breadth=breadth).factor)} for {name}"
        for name, breadth in stated_breadths().items()
    )
    return (
        "The factor k of w_retr, w_appr = w_int - e_el ± k e_el is no constant. It falls with the "
        "disorder s = w_rms/w_int and rises with the size g, which is the length on which the "
        "contact holds its edge, divided by the Larkin length of the roughness. In the infinite "
        f"contact k is {with_interval(weak)} at vanishing disorder. At s = {STRONG:g}, that of the "
        f"paper's experiment, it is {strong}. In a finite contact k is smaller. So k is "
        f"{PAPER_FACTOR:g}, as in the paper, only for certain pairs of s and g. They begin at "
        f"g = {least_size():.1f} with vanishing disorder, and end at s = {s:.2f} ({low:.2f} to "
        f"{high:.2f}) in the infinite contact. "
        f"The law was measured on straight fronts held by springs{departure}."
    )


def departure_of_spheres(
    rms: float, n_large: int, n_cell: int, spheres: str = "simulated spheres"
) -> str:
    """End of the finding where spheres, named in words, were held against the law."""
    return (
        f". It was not fitted to spheres. At the {n_large} of {n_cell} spectra and amplitudes that "
        f"have g above 1, k of {spheres} differs from it by {rms:.1%} rms"
    )


def crossing() -> tuple[float, float, float]:
    """Disorder s at which k of the infinite contact is the paper's, and its 95% interval."""

    def excess(s: float, name: str) -> float:
        return float(getattr(pinning_factor(s, math.inf).factor, name)) - PAPER_FACTOR

    # k falls with s: where its lower end is 3 is the lower end of s.
    value, low, high = (
        float(scipy.optimize.brentq(excess, WEAKEST, 1.0, args=(name,)))
        for name in ("value", "low", "high")
    )
    return value, low, high


def least_size() -> float:
    """Size g at which k of vanishing disorder is the paper's; smaller contacts never have it."""
    coefficients = shipped_law().coefficients

    def excess(logarithm: float) -> float:
        return float(law_value(coefficients, 0.0, math.exp(logarithm))) - PAPER_FACTOR

    return math.exp(scipy.optimize.brentq(excess, 0.0, math.log(1e3)))
