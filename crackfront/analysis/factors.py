"""Factors k by interpolation in the table of measured ones, with intervals."""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from crackfront.analysis.estimate import Estimate
from crackfront.analysis.report import ONSET, PERTURBATION_FACTOR
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.variables import ADHESION, LATERAL, variable

Array = NDArray[np.float64]

BRANCHES = ("approach", "retraction", "both")
"""Whose factor: k_appr, k_retr and k, their mean."""

_POWER = 4
"""Weights fall with this power of the distance."""

_ROLL_OFF_OCTAVES = 3.0
"""Octaves of the roll-off that count as much as one of the correlation length: k depends on the
whole surface through the latter, on its long waves only weakly."""


@dataclass(frozen=True, slots=True)
class MeasuredFactors:
    """Factors of one spectrum at one amplitude, means over realisations: a row of `factors.csv`."""

    spectrum: str = variable("name of the spectrum", "1")
    short_cutoff: float = variable("shortest wavelength", LATERAL)
    roll_off: float = variable("roll-off wavelength", LATERAL)
    hurst: float = variable("Hurst exponent", "1")
    correlation_length: float = variable("correlation length of w_loc", LATERAL)
    contact_radius: float = variable("radius in the middle of the steady branches", LATERAL)
    elastic_energy: float = variable("e_el measured on the tiles", ADHESION)
    realisations: int = variable("surfaces", "1")
    approach: float = variable("k_appr", "1")
    approach_error: float = variable("standard error of k_appr", "1")
    retraction: float = variable("k_retr", "1")
    retraction_error: float = variable("standard error of k_retr", "1")
    both: float = variable("k, the mean of the two", "1")
    both_error: float = variable("standard error of k", "1")
    numerical_error: float = variable("standard error of k that the numerics leave", "1")

    @property
    def place(self) -> tuple[float, float]:
        """Octaves of the correlation length and, weighted, of the roll-off."""
        return _place(self.correlation_length, self.roll_off, self.contact_radius)


@dataclass(frozen=True, slots=True)
class Factors:
    """Factors k that are expected of a surface, and what they rest on.

    Attributes
    ----------
    approach, retraction, both : Estimate of a number
        k_appr, k_retr and their mean k. The 95% intervals hold scatter between realisations,
        numerical error and, by far the largest, the difference between spectra, from how far the
        table predicts each of its own spectra without it; there is no standard error.
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

    approach: Estimate[float]
    retraction: Estimate[float]
    both: Estimate[float]
    spectra: tuple[str, ...]
    weights: tuple[float, ...]
    size_octaves: float
    amplitude_octaves: float
    near_onset: bool


@functools.cache
def measured_factors() -> tuple[MeasuredFactors, ...]:
    """Rows of `factors.csv`."""
    text = files("crackfront.analysis").joinpath("factors.csv").read_text(encoding="utf-8")
    return tuple(
        MeasuredFactors(**{item.name: _TYPES[str(item.type)](row[item.name]) for item in _FIELDS})
        for row in csv.DictReader(text.splitlines())
    )


_FIELDS = fields(MeasuredFactors)
_TYPES: dict[str, type[Any]] = {"str": str, "int": int, "float": float}


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
    groups = _groups()
    here = _place(spectrum.correlation_length, spectrum.roll_off, contact_radius)
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

    At e_el / w_int, for a name in :data:`BRANCHES`.
    """
    groups = _groups()
    errors = []
    for group in groups:
        others = [other for other in groups if other is not group]
        weights = _weights(group[0].place, others)
        known = [_at(other, elastic_energy, branch) for other in others]
        errors.append(float(weights @ known) - _at(group, elastic_energy, branch))
    return math.sqrt(float(np.mean(np.square(errors))))


@functools.cache
def _groups() -> tuple[tuple[MeasuredFactors, ...], ...]:
    """Rows of every spectrum, with increasing amplitude."""
    found: dict[str, list[MeasuredFactors]] = {}
    for row in sorted(measured_factors(), key=lambda row: row.elastic_energy):
        found.setdefault(row.spectrum, []).append(row)
    return tuple(map(tuple, found.values()))


def _place(correlation_length: float, roll_off: float, radius: float) -> tuple[float, float]:
    """Octaves of two lengths relative to the contact, those of the roll-off weighted less."""
    return math.log2(correlation_length / radius), math.log2(roll_off / radius) / _ROLL_OFF_OCTAVES


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
) -> Estimate[float]:
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
    return Estimate(value, math.nan, low, _possible(value + reach))


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
