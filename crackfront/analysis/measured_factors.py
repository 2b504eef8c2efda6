"""The table of measured factors k."""

from __future__ import annotations

import csv
import functools
import math
from dataclasses import dataclass, fields
from importlib.resources import files
from typing import Any

_ROLL_OFF_OCTAVES = 3.0
"""Octaves of the roll-off that count as much as one of the correlation length: k depends on the
whole surface through the latter, on its long waves only weakly."""


@dataclass(frozen=True, slots=True)
class MeasuredFactors:
    """Factors of one spectrum at one amplitude, means over realisations.

    Attributes
    ----------
    spectrum : str
        Name of the spectrum.
    short_cutoff, roll_off, hurst : float
        Its shape. (Lengths in the reduced lateral unit)
    correlation_length, contact_radius : float
        Of w_loc, and of the contact in the middle of the steady branches.
        (Units: reduced lateral length)
    elastic_energy : float
        e_el measured on the tiles. (Units: w_int)
    realisations : int
        Surfaces.
    approach, retraction, both : float
        k_appr, k_retr and their mean.
    approach_error, retraction_error, both_error : float
        Their standard errors.
    numerical_error : float
        Standard error of k that the numerics leave.
    """

    spectrum: str
    short_cutoff: float
    roll_off: float
    hurst: float
    correlation_length: float
    contact_radius: float
    elastic_energy: float
    realisations: int
    approach: float
    approach_error: float
    retraction: float
    retraction_error: float
    both: float
    both_error: float
    numerical_error: float

    @property
    def place(self) -> tuple[float, float]:
        """Octaves of the correlation length and, weighted, of the roll-off."""
        return place_of(self.correlation_length, self.roll_off, self.contact_radius)


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


@functools.cache
def factor_groups() -> tuple[tuple[MeasuredFactors, ...], ...]:
    """Rows of every spectrum, with increasing amplitude."""
    found: dict[str, list[MeasuredFactors]] = {}
    for row in sorted(measured_factors(), key=lambda row: row.elastic_energy):
        found.setdefault(row.spectrum, []).append(row)
    return tuple(map(tuple, found.values()))


def place_of(correlation_length: float, roll_off: float, radius: float) -> tuple[float, float]:
    """Place of a spectrum among the others.

    Parameters
    ----------
    correlation_length, roll_off, radius : float
        Of w_loc, of the heights, and of the contact. (Units: any of length)

    Returns
    -------
    tuple of float
        Octaves of the two lengths relative to the contact, those of the roll-off weighted less.
    """
    return math.log2(correlation_length / radius), math.log2(roll_off / radius) / _ROLL_OFF_OCTAVES
