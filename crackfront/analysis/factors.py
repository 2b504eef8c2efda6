"""Factors k by interpolation in the table, with intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from crackfront.analysis.measured_factors import MeasuredFactors, factor_groups, place_of
from crackfront.analysis.notes import ONSET
from crackfront.analysis.report import PERTURBATION_FACTOR
from crackfront.core.spectrum import SelfAffineSpectrum

Array = NDArray[np.float64]

_POWER = 4
"""Weights fall with this power of the distance."""

BRANCHES = ("approach", "retraction", "both")
"""Whose factor: k_appr, k_retr and k, their mean."""


@dataclass(frozen=True, slots=True)
class Factor:
    """A factor k that is expected.

    Attributes
    ----------
    value : float
        Its value.
    low, high : float
        95% interval: scatter between realisations, numerical error and, by far the largest, the
        difference between spectra, from how far the table predicts each of its own spectra
        without it.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Factors:
    """Factors k that are expected of a surface, and what they rest on.

    Attributes
    ----------
    approach, retraction, both : Factor
        k_appr, k_retr and their mean k.
    spectra : tuple of str
        Measured spectra, that of the largest weight first.
    weights : tuple of float
        Their weights.
    size_octaves : float
        How far the correlation length, relative to the contact, lies outside of the measured
        range; negative below it.
    amplitude_octaves : float
        The same of e_el / w_int.
    near_onset : bool
        Whether k is below half of the largest for such a surface, as where the contact is too
        small and the disorder too weak for full hysteresis.
    """

    approach: Factor
    retraction: Factor
    both: Factor
    spectra: tuple[str, ...]
    weights: tuple[float, ...]
    size_octaves: float
    amplitude_octaves: float
    near_onset: bool


def expected_factors(
    spectrum: SelfAffineSpectrum, elastic_energy: float, contact_radius: float
) -> Factors:
    """Factors k of a surface by the table of measured ones.

    Below the smallest measured amplitude hysteresis sets in somewhere: there the value is that at
    the smallest amplitude and the interval reaches down to zero. Above the largest one the value
    stays, and the interval widens by the trend at the end of the table. For a size outside of the
    table the value follows the trend of all spectra, and the interval widens by as much.

    Parameters
    ----------
    spectrum : SelfAffineSpectrum
        Shape of the spectrum. (Units: reduced lateral length)
    elastic_energy : float
        e_el / w_int, in (0, 1).
    contact_radius : float
        Radius of the contact. (Units: reduced lateral length)

    Raises
    ------
    ValueError
        If e_el is not between 0 and w_int.

    Examples
    --------
    >>> flat = SelfAffineSpectrum(short_cutoff=0.01, roll_off=0.01, hurst=1.0)
    >>> found = expected_factors(flat, elastic_energy=0.05, contact_radius=1.9)
    >>> found.spectra[0], round(found.both.value, 1)
    ('flat-coarse', 2.1)
    """
    if not 0 < elastic_energy < 1:
        raise ValueError(
            f"energy of full conformity is {elastic_energy:.4g} w_int; the factors k need one "
            "between 0 and 1"
        )
    groups = factor_groups()
    here = place_of(spectrum.correlation_length, spectrum.roll_off, contact_radius)
    weights = _weights(here, groups)
    order = np.argsort(-weights)
    energies = [row.elastic_energy for group in groups for row in group]
    sizes = [group[0].place[0] for group in groups]
    outside = _outside(here[0], min(sizes), max(sizes))
    approach, retraction, both = (
        _factor(groups, weights, elastic_energy, branch, outside) for branch in BRANCHES
    )
    largest = max(
        float(weights @ [_at(group, row.elastic_energy, "both") for group in groups])
        for row in groups[0]
    )
    return Factors(
        approach=approach,
        retraction=retraction,
        both=both,
        spectra=tuple(groups[index][0].spectrum for index in order),
        weights=tuple(weights[order].tolist()),
        size_octaves=outside,
        amplitude_octaves=_outside(
            math.log2(elastic_energy), math.log2(min(energies)), math.log2(max(energies))
        ),
        near_onset=both.value < ONSET * largest,
    )


def leave_one_out_error(elastic_energy: float, branch: str) -> float:
    """Root mean square of how far the table misses a spectrum that it does without.

    Parameters
    ----------
    elastic_energy : float
        e_el / w_int.
    branch : str
        A name in :data:`BRANCHES`.
    """
    groups = factor_groups()
    errors = []
    for group in groups:
        others = [other for other in groups if other is not group]
        weights = _weights(group[0].place, others)
        known = [_at(other, elastic_energy, branch) for other in others]
        errors.append(float(weights @ known) - _at(group, elastic_energy, branch))
    return math.sqrt(float(np.mean(np.square(errors))))


def _weights(here: tuple[float, float], groups: Sequence[Sequence[MeasuredFactors]]) -> Array:
    """Weights of spectra at a place; one that lies there has all of it."""
    apart = np.array([math.dist(here, group[0].place) for group in groups])
    inverse = np.maximum(apart, 1e-6) ** -_POWER
    return np.asarray(inverse / inverse.sum())


def _factor(
    groups: Sequence[Sequence[MeasuredFactors]],
    weights: Array,
    energy: float,
    branch: str,
    size_octaves: float,
) -> Factor:
    """Factor of a branch with its interval."""
    known = np.array([_at(group, energy, branch) for group in groups])
    extrapolated = size_octaves * _size_slope(groups, known)
    value = _possible(float(weights @ known) + extrapolated)
    errors = np.array([_at(group, energy, f"{branch}_error") for group in groups])
    numerical = float(weights @ [_at(group, energy, "numerical_error") for group in groups])
    freedom = len(groups) - 1
    reach = float(stdtrit(freedom, 0.975)) * math.hypot(
        leave_one_out_error(energy, branch), float(np.sqrt(weights**2 @ errors**2)), numerical
    )
    lowest = min(group[0].elastic_energy for group in groups)
    beyond = max(0.0, *(math.log2(energy / group[-1].elastic_energy) for group in groups))
    trend = float(weights @ [_last_slope(group, branch) for group in groups])
    reach += beyond * abs(trend) + abs(extrapolated)
    low = 0.0 if energy < lowest else _possible(value - reach)
    return Factor(value, low, _possible(value + reach))


def _possible(factor: float) -> float:
    """A factor within 0 and that of perturbation theory, which no simulation has reached."""
    return min(max(factor, 0.0), float(PERTURBATION_FACTOR))


def _size_slope(groups: Sequence[Sequence[MeasuredFactors]], factors: Array) -> float:
    """Change of a factor per octave of the correlation length, over all spectra."""
    sizes = np.array([group[0].place[0] for group in groups])
    return float(np.polyfit(sizes, factors, 1)[0])


def _at(group: Sequence[MeasuredFactors], energy: float, name: str) -> float:
    """Value of a column at an amplitude; outside of the table that of its end."""
    known = np.log([row.elastic_energy for row in group])
    return float(np.interp(math.log(energy), known, [getattr(row, name) for row in group]))


def _last_slope(group: Sequence[MeasuredFactors], branch: str) -> float:
    """Change of a factor per octave of e_el between the two largest amplitudes."""
    before, last = group[-2:]
    rise: float = getattr(last, branch) - getattr(before, branch)
    return rise / math.log2(last.elastic_energy / before.elastic_energy)


def _outside(value: float, low: float, high: float) -> float:
    """How far a value lies outside of a range; negative below it."""
    return min(value - low, 0.0) + max(value - high, 0.0)
