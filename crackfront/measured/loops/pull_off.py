"""Pull-off force of a loop."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from crackfront.analysis.estimate import REACH, Estimate, normal_estimate
from crackfront.analysis.steady_adhesion import Rows
from crackfront.core.arrays import Array
from crackfront.surfaces.written_units import prefixed

_NARROWEST = 5
"""Rows of the shortest parabola; it has two more than coefficients."""

_HALF_WIDTHS = 20
"""Half widths of the first parabola in the retraction; one through a tenth of it is smooth."""

_FITS = 1.5
"""Variance about a parabola over the variance of the noise, up to which it fits."""

_AT_ENDS = 9.0
"""Variance of a parabola at its ends, and at its lowest place, over the variance of a mean."""

_SECOND_DIFFERENCES = 6 * 0.455
"""Median of squared second differences of normal noise, over its variance."""


@dataclass(frozen=True, slots=True)
class PullOff:
    """Largest pulling force of the retraction, and the noise of the forces around it."""

    force: Estimate[float]
    """(Units: N)"""
    noise: float
    """Standard deviation. (Units: N)"""


@dataclass(frozen=True, slots=True)
class _Smoothed:
    """Lowest value of a column after smoothing by parabolas."""

    lowest: float
    place: int
    """Place of the lowest value in the column."""
    variance: float
    """Variance of the values about the parabolas near it."""
    noise: float
    """Variance of the noise near it, from second differences."""


def pull_off(force: Array, retraction: Rows, errors: Sequence[Array]) -> PullOff:
    """Largest pulling force, by parabolas through as many rows as they fit within the noise.

    Parameters
    ----------
    force : (n_row,) array
        Normal force of all rows. (Units: N)
    retraction : array of int
        Rows of the retraction.
    errors : sequence of (n_row,) arrays
        Standard errors of the forces, which the interval includes with the noise. (Units: N)
    """
    rows = retraction[np.isfinite(force[retraction])]
    width = max(_NARROWEST, 2 * (rows.size // _HALF_WIDTHS) + 1)
    smoothed = _smoothed(force[rows], width)
    while width > _NARROWEST and smoothed.variance > _FITS * smoothed.noise:
        width = max(_NARROWEST, width // 4 * 2 + 1)
        smoothed = _smoothed(force[rows], width)
    variance = _AT_ENDS * smoothed.variance / width
    variance += sum(float(error[rows[smoothed.place]]) ** 2 for error in errors)
    force_estimate = normal_estimate(-smoothed.lowest, math.sqrt(variance))
    return PullOff(force_estimate, math.sqrt(smoothed.noise))


def least_pull_off(force: Array, rows: Rows, errors: Sequence[Array]) -> Estimate[float]:
    """Lower bound of the pulling force from rows whose force is at the end of its range.

    The interval is open above. Parameters are as for :func:`pull_off`.
    """
    pull = float(np.max(-force[rows]))
    variance = sum(float(np.max(np.abs(error[rows]))) ** 2 for error in errors)
    return Estimate(pull, math.nan, pull - REACH * math.sqrt(variance), math.inf)


def pull_off_sentence(force: Estimate[float], radius: float) -> str:
    """Sentence on the work of adhesion that a pull-off force (Units: N) alone determines.

    `radius` is the radius of the sphere (Units: m). Empty without a pull-off force.
    """
    if not math.isfinite(force.value):
        return ""
    work = force.each(lambda pull: pull / (1.5 * math.pi * radius))
    return (
        "The pull-off force alone, without a modulus, gives a work of adhesion 2 F / (3 pi R) of "
        f"{prefixed('J/m2', work.value, work.low, work.high)} for the retraction."
    )


def _smoothed(values: Array, width: int) -> _Smoothed:
    """Lowest value after smoothing by parabolas through so many rows."""
    smooth = scipy.signal.savgol_filter(values, width, 2)
    place = int(np.argmin(smooth))
    near = slice(max(place - width, 0), place + width)
    differences = np.diff(values, 2, prepend=values[:1], append=values[-1:]) ** 2
    return _Smoothed(
        lowest=float(smooth[place]),
        place=place,
        variance=float(np.mean((values - smooth)[near] ** 2)) * width / (width - 3),
        noise=float(np.median(differences[near])) / _SECOND_DIFFERENCES,
    )
