"""Roughness exponents of the fronts, and whether they are those of the theory."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from crackfront.studies.paper.contact import STRONG, WEAK
from crackfront.studies.paper.figure import Check
from crackfront.studies.paper.roughness import RoughnessRecord

Array = NDArray[np.float64]

DEPINNING_EXPONENT, LARKIN_EXPONENT = 0.388, 0.5
"""Roughness exponents of a line with long-range elasticity at its threshold (Rosso and Krauth,
Phys. Rev. E 65, 025101), and where disorder is a perturbation."""

_TOLERANCE = 0.05
"""Largest deviation of an exponent, about that of a crossover within the range of the fit."""


@dataclass(frozen=True, slots=True)
class RoughnessFit:
    """Power law of the spectrum over a range of wavelengths.

    Attributes
    ----------
    exponent : float
        Roughness exponent zeta, mean over the surfaces.
    reach : float
        Half of its 95% interval.
    wavevector, power : (2,) array
        Ends of the line. (Units: 1 / reduced lateral length, and reduced lateral length**3)
    """

    exponent: float
    reach: float
    wavevector: Array
    power: Array


def stiffness_wavevector(record: RoughnessRecord, index: int) -> Array:
    """Wavevector of a straight line of the stiffness of each mode, (n + a dG/da) / a.

    The sphere pulls a front back to its circle, which a straight line does not know; so that
    the spectrum of a front is a power of this stiffness rather than of n alone.
    """
    return (record.mode + record.ring_stiffness[index]) / record.radius[index]


def fitted_roughness(record: RoughnessRecord, index: int) -> RoughnessFit:
    r"""Fit of :math:`C \propto \kappa^{-(1 + 2\zeta)}` with kappa of `stiffness_wavevector`.

    Least squares of the logarithm, each surface by itself, all octaves of the same weight.

    Parameters
    ----------
    record : RoughnessRecord
        Data of the figure.
    index : {0, 1}
        Strong or weak disorder.
    """
    wavelength = 2 * np.pi * record.radius[index] / record.mode
    used = (wavelength >= record.shortest[index]) & (wavelength <= record.longest[index])
    wavevector = stiffness_wavevector(record, index)[used]
    weight = record.mode[used] ** -0.5
    lines = [
        np.polyfit(np.log(wavevector), np.log(power[used]), 1, w=weight)
        for power in record.power[index]
    ]
    slopes, levels = np.array(lines).T
    exponents = -(1 + slopes) / 2
    error = np.std(exponents, ddof=1) / np.sqrt(exponents.size)
    ends = wavevector[[0, -1]]
    return RoughnessFit(
        exponent=float(exponents.mean()),
        reach=float(student.ppf(0.975, exponents.size - 1) * error),
        wavevector=ends,
        power=np.exp(levels.mean() + slopes.mean() * np.log(ends)),
    )


def roughness_checks(record: RoughnessRecord) -> tuple[Check, ...]:
    """Exponents above and below the Larkin length.

    Parameters
    ----------
    record : RoughnessRecord
        Data of the figure.
    """
    strong, weak = (fitted_roughness(record, index) for index in (STRONG, WEAK))
    return (
        _exponent_check(
            record,
            STRONG,
            strong,
            "strong disorder, beyond the Larkin length: depinning exponent",
            DEPINNING_EXPONENT,
        ),
        _exponent_check(
            record,
            WEAK,
            weak,
            "weak disorder, below the Larkin length: perturbation theory",
            LARKIN_EXPONENT,
        ),
        Check(
            "the two exponents differ by more than their intervals",
            f"> {np.hypot(strong.reach, weak.reach):.3f}",
            f"{weak.exponent - strong.exponent:.3f}",
            weak.exponent - strong.exponent > float(np.hypot(strong.reach, weak.reach)),
            "intervals over surfaces alone, not of the choice of the range",
        ),
    )


def _exponent_check(
    record: RoughnessRecord, index: int, fit: RoughnessFit, claim: str, expected: float
) -> Check:
    """One exponent against that of the theory."""
    low, high = record.shortest[index], record.longest[index]
    middle = np.full(2, np.sqrt(low * high))
    halves = [
        fitted_roughness(part, index).exponent
        for part in (replace(record, longest=middle), replace(record, shortest=middle))
    ]
    contained = "contains it" if abs(fit.exponent - expected) <= fit.reach else "leaves it out"
    return Check(
        claim,
        f"{expected} ± {_TOLERANCE}",
        f"{fit.exponent:.3f} ± {fit.reach:.3f}",
        abs(fit.exponent - expected) <= _TOLERANCE,
        f"the 95% interval of {record.power.shape[1]} surfaces {contained}; wavelengths "
        f"{low:.3g} to {high:.3g} ({np.log10(high / low):.2f} decades), their shorter half "
        f"{halves[0]:.3f}, longer half {halves[1]:.3f}; Larkin length "
        f"{record.larkin_length[index]:.3g}; the stiffness of the sphere's circle, "
        f"{record.ring_stiffness[index]:.2g} beside n, is in the abscissa",
    )
