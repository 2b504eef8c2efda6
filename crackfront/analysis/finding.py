"""The main result about k, as the sentences at the beginning of fits and reports."""

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

PAPER_FACTOR = 3.0
"""k of the paper's fit."""

PERTURBATION_FACTOR = 4.0
"""k of second-order perturbation theory in the limit of weak disorder."""

STRONG = 0.84
"""Disorder s of the paper's experiment, at which the finding states k."""


def stated_breadths() -> dict[str, float]:
    """Breadths of the spectra of roughness that the finding names."""
    spectra = {
        "a flat spectrum": SelfAffineSpectrum(1.0, 1.0, 1.0),
        "H = 0.8 over three octaves": SelfAffineSpectrum(1.0, 8.0, 0.8),
    }
    return {name: spectral_breadth("roughness", shape) for name, shape in spectra.items()}


def finding(departure: str) -> str:
    """The sentences, with the numbers of the shipped law.

    The departure ends the sentence "The law was measured on straight fronts on springs". It
    says how far k of other contacts departs from the law.

    Examples
    --------
    >>> finding("; it was not compared with spheres").count(". ")
    8
    """
    s, low, high = crossing()
    weak = pinning_factor(WEAKEST, math.inf).factor
    strong = " and ".join(
        f"{with_interval(pinning_factor(STRONG, math.inf, breadth=breadth).factor)} for {name}"
        for name, breadth in stated_breadths().items()
    )
    return (
        "The factor k of w_retr, w_appr = w_int - e_el ± k e_el is not constant. It falls with the "
        "disorder s = w_rms/w_int. It rises with the size g, the length over which the contact "
        "restores its edge divided by the Larkin length of the roughness. In the infinite contact "
        f"k is {with_interval(weak)} at vanishing disorder. At the disorder of the paper's "
        f"experiment, s = {STRONG:g}, it is {strong}. In a finite contact k is smaller. So k is "
        f"{PAPER_FACTOR:g}, as in the paper, only for certain pairs of s and g. They begin at "
        f"g = {least_size():.1f} with vanishing disorder, and end at s = {s:.2f} ({low:.2f} to "
        f"{high:.2f}) in the infinite contact. "
        f"The law was measured on straight fronts on springs{departure}."
    )


def departure_of_spheres(
    rms: float, n_large: int, n_cell: int, spheres: str = "simulated spheres"
) -> str:
    """End of the finding if k of spheres, named in words, was compared with the law."""
    return (
        f". It was not fitted to spheres. For the {n_large} of {n_cell} spectrum-amplitude pairs "
        f"with g > 1, k of {spheres} agrees with it to {rms:.1%} rms"
    )


def crossing() -> tuple[float, float, float]:
    """Disorder s at which k of the infinite contact is 3, and its 95% interval."""

    def excess(s: float, name: str) -> float:
        return float(getattr(pinning_factor(s, math.inf).factor, name)) - PAPER_FACTOR

    # k falls with s, so its lower end gives the lower end of s.
    value, low, high = (
        float(scipy.optimize.brentq(excess, WEAKEST, 1.0, args=(name,)))
        for name in ("value", "low", "high")
    )
    return value, low, high


def least_size() -> float:
    """Size g at which k is 3 at vanishing disorder; in smaller contacts it is less."""
    coefficients = shipped_law().coefficients

    def excess(logarithm: float) -> float:
        return float(law_value(coefficients, 0.0, math.exp(logarithm))) - PAPER_FACTOR

    return math.exp(scipy.optimize.brentq(excess, 0.0, math.log(1e3)))
