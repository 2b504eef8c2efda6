"""How much more hysteresis a crack front has than boundary elements on the same surfaces.

`python -m studies boundary-elements validate` computes both, and `numbers --keep` there writes
`validity.csv`. What the front leaves out of linear elasticity is of second order in the disorder,
w_rms over w_int, so that the logarithm of the ratio is fitted by c e_el / w_int.
"""

from __future__ import annotations

import csv
import functools
import io
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from importlib.resources import files
from typing import get_type_hints

import numpy as np

from crackfront.analysis.estimate import REACH, Estimate
from crackfront.core.arrays import Array

_MODEL_ERROR = 0.05
"""Standard error of the logarithm that the form of the law leaves: half of what powers of the
disorder from 2 to 4 differ by between the measured amplitudes."""

_LEAST_PRINTED_RATIO = 1.005
"""Smallest ratio that a printed number shows."""

_EXTRAPOLATION = 0.5
"""Relative standard error of what the law says beyond the measured energies."""


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
    """Hysteresis of the front over that of boundary elements at a vanishing range."""
    error: float
    """Standard error of the logarithm of the ratio, with that of the extrapolation to no range; NaN
    for one surface."""
    surfaces: int
    fine: int
    """Surfaces that are averaged, and those of them on the finest grids."""
    n_point: int
    """Points along a side of the boundary elements' grid."""


@dataclass(frozen=True, slots=True)
class Excess:
    """Hysteresis of the front over that of boundary elements for a surface."""

    ratio: Estimate[float]
    """What the front's hysteresis is divided by, and its interval, which grows beyond the
    amplitudes and sizes that were measured."""
    is_measured: bool
    """Whether the amplitude is among those that were measured."""
    sentence: str
    """Both as a sentence."""


@functools.cache
def shipped_validity() -> tuple[ValidityRow, ...]:
    """Rows of the file that the package ships."""
    return validity_of(files(__package__).joinpath("validity.csv").read_text(encoding="utf-8"))


def validity_of(text: str) -> tuple[ValidityRow, ...]:
    """Rows of a table as of :func:`validity_text`."""
    kinds = get_type_hints(ValidityRow)
    rows = csv.DictReader(io.StringIO(text))
    return tuple(ValidityRow(**{name: kinds[name](row[name]) for name in kinds}) for row in rows)


def validity_text(rows: Sequence[ValidityRow]) -> str:
    """Table of comma-separated values."""
    lines = [",".join(item.name for item in fields(ValidityRow))]
    lines += [",".join(f"{value:.5g}" for value in asdict(row).values()) for row in rows]
    return "\n".join(lines) + "\n"


def excess_coefficient(rows: Sequence[ValidityRow]) -> tuple[float, float]:
    """Coefficient c of the law ln(ratio) = c e_el / w_int, and its standard error.

    Rows of one surface, which have no error, do not count.

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
    apart = np.log(size) - np.average(np.log(size), weights=weight)
    return float(np.sum(weight * apart**2)) ** -0.5


def _columns(rows: Sequence[ValidityRow]) -> Array:
    """Energies, sizes, ratios and errors of the rows that have an error, (4, rows)."""
    known = [row for row in rows if math.isfinite(row.error)]
    return np.array([(r.elastic_energy, r.size, r.ratio, r.error) for r in known]).T


def front_excess(energy: float, size: float, rows: Sequence[ValidityRow] | None = None) -> Excess:
    """Excess of the front at an e_el (Units: w_int) and a size g, by the shipped table or another.

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
    grown = size_error(rows) * math.log(max(1.0, size / largest))
    beyond = _EXTRAPOLATION * slope * max(0.0, energy - strongest)
    logarithm = slope * energy
    reach = REACH * math.hypot(error * energy, grown * energy, beyond, _MODEL_ERROR)
    law = Estimate(logarithm, math.nan, logarithm - reach, logarithm + reach).each(math.exp)
    interval = f"{law.value:.2f} ({law.low:.2f} to {law.high:.2f})"
    sentence = f"A front has {interval} times the hysteresis of boundary elements at this e_el"
    sentence += "; the prediction is divided by this." if law.value >= _LEAST_PRINTED_RATIO else "."
    if grown or beyond:
        sentence += (
            f" Both were compared up to e_el/w_int = {strongest:.2g} and g = {largest:.2g}; here "
            f"they are {energy:.2g} and {size:.3g}, so that the interval is wider."
        )
    return Excess(law, not beyond, sentence)
