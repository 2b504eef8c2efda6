"""What is taken off the heights of a scan: polynomials, fitted where they are to be fitted."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from crackfront.topography.options import Detrend

Array = NDArray[np.float64]
Points = NDArray[np.bool_]

_ORDERS = {"center": 0, "height": 1, "slope": 1, "curvature": 2}

_ROUND_OFF = 1e-6
"""Heights left over those taken off, below which they are the digits of the file."""

_SHAPES = ("the mean", "the plane", "the paraboloid")


def order_of(detrend: Detrend) -> int:
    """Order of the polynomial that is taken off."""
    return detrend if isinstance(detrend, int) else _ORDERS[detrend]


def taken_off(detrend: Detrend) -> str:
    """Name of the trend, as in 'the paraboloid'."""
    order = order_of(detrend)
    if detrend == "slope":
        return "the plane of least slope"
    return _SHAPES[order] if order < len(_SHAPES) else f"the polynomial of order {order}"


def levelled(heights: Array, fitted: Points, detrend: Detrend) -> Array:
    """Heights without their trend, which is fitted to some of the points.

    Parameters
    ----------
    heights : (n_x, n_y) or (n_x,) array
        Any number where there is none. (Units: any)
    fitted : array of bool, of the same shape
        Points that the trend is fitted to.
    detrend : {"center", "height", "slope", "curvature"} or int
        The trend.

    Returns
    -------
    array
        Of the same shape and units.

    Raises
    ------
    ValueError
        If the points do not determine the trend, or the heights are it but for round-off.
    """
    terms = [
        term
        for term in itertools.product(range(order_of(detrend) + 1), repeat=heights.ndim)
        if sum(term) <= order_of(detrend)
    ]
    if np.count_nonzero(fitted) < 2 * len(terms):
        raise ValueError(
            f"{np.count_nonzero(fitted)} points are left to fit {taken_off(detrend)}; mask fewer "
            "of them"
        )
    level = heights - np.mean(heights[fitted])
    bases = [
        legvander(np.linspace(-1, 1, count), order_of(detrend)).astype(float)
        for count in heights.shape
    ]
    weights = fitted.astype(float)
    if detrend == "slope":
        trend = _plane_of_least_slope(level, fitted)
    else:
        trend = _polynomial(np.where(fitted, level, 0.0), weights, bases, terms)
    level = level - trend
    level -= np.mean(level[fitted])
    if np.ptp(level[fitted]) <= _ROUND_OFF * np.ptp(heights[fitted]):
        raise ValueError(
            f"the heights are nothing but {taken_off(detrend)} that was taken off; a smooth "
            "surface has no spectrum"
        )
    return level


def _polynomial(
    level: Array, weights: Array, bases: Sequence[Array], terms: Sequence[tuple[int, ...]]
) -> Array:
    """Polynomial of least squares, by normal equations of Legendre polynomials, at all points."""
    size = len(terms)
    moments, right = np.empty((size, size)), np.empty(size)
    for row, one in enumerate(terms):
        right[row] = _projected(level, _product(bases, one))
        for column, other in enumerate(terms[: row + 1]):
            pairs = zip(_product(bases, one), _product(bases, other), strict=True)
            found = _projected(weights, [first * second for first, second in pairs])
            moments[row, column] = moments[column, row] = found
    values = np.linalg.lstsq(moments, right, rcond=None)[0]
    coefficients = np.zeros([base.shape[1] for base in bases])
    for term, value in zip(terms, values, strict=True):
        coefficients[term] = value
    trend = bases[0] @ coefficients
    return np.asarray(trend @ bases[1].T if len(bases) > 1 else trend)


def _product(bases: Sequence[Array], term: tuple[int, ...]) -> list[Array]:
    """Legendre polynomials whose product over the directions is a term."""
    return [base[:, order] for base, order in zip(bases, term, strict=True)]


def _projected(values: Array, factors: Sequence[Array]) -> float:
    """Sum of values times a product of factors along the directions."""
    found = factors[0] @ values
    return float(found @ factors[1] if len(factors) > 1 else found)


def _plane_of_least_slope(level: Array, fitted: Points) -> Array:
    """Plane with the mean slope between neighbouring points, along every direction."""
    trend = np.zeros(level.shape)
    for axis, count in enumerate(level.shape):
        pairs = range(count - 1), range(1, count)
        both = np.logical_and(*(np.take(fitted, points, axis) for points in pairs))
        slope = float(np.mean(np.diff(level, axis=axis)[both])) if both.any() else math.nan
        shape = [1] * level.ndim
        shape[axis] = count
        trend += slope * np.arange(count).reshape(shape)
    return trend
