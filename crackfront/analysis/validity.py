"""Ratio of the hysteresis of a crack front to boundary elements on the same surfaces.

`python -m studies boundary-elements validate` computes both, and `numbers --keep` there writes
`validity.csv`. The crack front neglects terms of linear elasticity that are of second order in the
disorder w_rms / w_int. The logarithm of the ratio is therefore fitted by c e_el / w_int.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from crackfront.analysis.csv_records import csv_rows
from crackfront.analysis.estimate import REACH, Estimate
from crackfront.core.arrays import Array

_MODEL_ERROR = 0.05
"""Standard error of ln(ratio) due to the form of the law: half of the difference between laws with
powers of the disorder from 2 to 4, at the measured amplitudes."""

_LEAST_PRINTED_RATIO = 1.005
"""Smallest ratio that differs from 1 when it is printed with two decimals."""

_EXTRAPOLATION = 0.5
"""Relative standard error of the part of ln(ratio) that is extrapolated in energy."""


@dataclass(frozen=True, slots=True)
class ValidityRow:
    """Both models at one spectrum and amplitude, by w_retr - w_appr."""

    roll_off: float
    """Roll-off wavelength over the shortest; 1 for a flat spectrum."""
    hurst: float
    """Hurst exponent."""
    elastic_energy: float
    """Energy of full conformity. (Units: w_int)"""
    size: float
    """g, L_kappa over the Larkin length."""
    ratio: float
    """Hysteresis of the front over boundary elements at a vanishing range of attraction."""
    error: float
    """Standard error of ln(ratio), including the extrapolation to a vanishing range of attraction;
    NaN for one surface."""
    surfaces: int
    """Surfaces that are averaged."""
    fine: int
    """Surfaces on the finest grids."""
    n_point: int
    """Points along a side of the boundary elements' grid."""


@dataclass(frozen=True, slots=True)
class Excess:
    """Ratio of the front's hysteresis to boundary elements, for one surface."""

    ratio: Estimate[float]
    """The ratio, whose interval grows outside the measured amplitudes and sizes."""
    is_measured: bool
    """Whether the amplitude is within the measured range."""
    sentence: str
    """The ratio in words, and a warning outside the measured range."""


@functools.cache
def shipped_validity() -> tuple[ValidityRow, ...]:
    """Rows of `validity.csv`."""
    text = files(__package__).joinpath("validity.csv").read_text(encoding="utf-8")
    return csv_rows(text, ValidityRow)


def excess_coefficient(rows: Sequence[ValidityRow]) -> tuple[float, float]:
    """Coefficient c of the law ln(ratio) = c e_el / w_int, and its standard error.

    Rows without an error, from one surface, do not count.

    Examples
    --------
    >>> rows = [ValidityRow(1, 1, e, 1, math.exp(2 * e), 0.1, 4, 4, 512) for e in (0.1, 0.2)]
    >>> c, error = excess_coefficient(rows)
    >>> round(c, 12), round(error, 3)
    (2.0, 0.447)
    """
    energy, _, ratio, error = _columns(rows)
    information = float(np.sum((energy / error) ** 2))
    return float(np.sum(energy * np.log(ratio) / error**2)) / information, information**-0.5


def size_error(rows: Sequence[ValidityRow]) -> float:
    """Standard error of the slope of c in ln g; the law sets this slope to zero.

    Examples
    --------
    >>> rows = [ValidityRow(1, 1, 0.1, size, 1.2, 0.1, 4, 4, 512) for size in (1.0, math.e)]
    >>> round(size_error(rows), 3)
    1.414
    """
    energy, size, _, error = _columns(rows)
    weight = (energy / error) ** 2
    deviation = np.log(size) - np.average(np.log(size), weights=weight)
    return float(np.sum(weight * deviation**2)) ** -0.5


def _columns(rows: Sequence[ValidityRow]) -> Array:
    """Energies, sizes, ratios and errors of the rows with an error, (4, n_row)."""
    finite = [row for row in rows if math.isfinite(row.error)]
    return np.array([(row.elastic_energy, row.size, row.ratio, row.error) for row in finite]).T


def front_excess(energy: float, size: float, rows: Sequence[ValidityRow] | None = None) -> Excess:
    """Excess of the front at an e_el (Units: w_int) and a size g, by the shipped or another table.

    Examples
    --------
    >>> rows = [ValidityRow(1, 1, 0.1, size, 1.2, 0.01, 4, 4, 512) for size in (0.3, 1.0)]
    >>> front_excess(0.1, 1.0, rows).sentence.split(" times")[0]
    'A front has 1.20 (1.09 to 1.32)'
    >>> round(front_excess(0.1, 100.0, rows).ratio.high, 2)
    1.39
    """
    rows = shipped_validity() if rows is None else rows
    slope, error = excess_coefficient(rows)
    strongest = max(row.elastic_energy for row in rows)
    largest = max(row.size for row in rows)
    size_uncertainty = size_error(rows) * math.log(max(1.0, size / largest))
    extrapolated = _EXTRAPOLATION * slope * max(0.0, energy - strongest)
    logarithm = slope * energy
    errors = error * energy, size_uncertainty * energy, extrapolated, _MODEL_ERROR
    reach = REACH * math.hypot(*errors)
    law = Estimate(logarithm, math.nan, logarithm - reach, logarithm + reach).each(math.exp)
    interval = f"{law.value:.2f} ({law.low:.2f} to {law.high:.2f})"
    sentence = f"A front has {interval} times the hysteresis of boundary elements at this e_el"
    sentence += "; the prediction is divided by this." if law.value >= _LEAST_PRINTED_RATIO else "."
    if size_uncertainty or extrapolated:
        sentence += (
            f" Both were compared up to e_el/w_int = {strongest:.2g} and g = {largest:.2g}; here "
            f"they are {energy:.2g} and {size:.3g}, so that the interval is wider."
        )
    return Excess(law, not extrapolated, sentence)
