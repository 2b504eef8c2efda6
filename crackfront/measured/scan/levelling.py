"""Trends that are taken off the heights of a scan: polynomials, fitted to some of its points."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.measured.options import Detrend

PointMask = NDArray[np.bool_]

_ORDERS = {"center": 0, "height": 1, "slope": 1, "curvature": 2}

_ROUND_OFF = 1e-6
"""Heights left over those taken off, below which they are the digits of the file."""

_SHAPES = ("the mean", "the plane", "the paraboloid")


def trend_order(detrend: Detrend) -> int:
    """Order of the polynomial that is taken off."""
    return detrend if isinstance(detrend, int) else _ORDERS[detrend]


def trend_name(detrend: Detrend) -> str:
    """Name of the trend, as in 'the paraboloid'."""
    order = trend_order(detrend)
    if detrend == "slope":
        return "the plane of least slope"
    return _SHAPES[order] if order < len(_SHAPES) else f"the polynomial of order {order}"


def levelled(heights: Array, fitted: PointMask, detrend: Detrend) -> Array:
    """Heights without their trend, which is fitted to some of the points; they may have any unit.

    ValueError if these points do not determine the trend, or the heights are the trend but for
    round-off.
    """
    n_term = math.comb(trend_order(detrend) + heights.ndim, heights.ndim)
    if np.count_nonzero(fitted) < 2 * n_term:
        raise ValueError(
            f"{np.count_nonzero(fitted)} points are left to fit {trend_name(detrend)}; mask fewer "
            "of them"
        )
    level = heights - np.mean(heights[fitted])
    if detrend == "slope":
        level -= _plane_of_least_slope(level, fitted)
    else:
        level -= polynomial(level, fitted, trend_order(detrend))
    level -= np.mean(level[fitted])
    if np.ptp(level[fitted]) <= _ROUND_OFF * np.ptp(heights[fitted]):
        raise ValueError(
            f"the heights are nothing but {trend_name(detrend)} that was taken off; a smooth "
            "surface lacks a spectrum"
        )
    return level


def polynomial(heights: Array, fitted: PointMask, order: int) -> Array:
    """Polynomial of an order at all points, by least squares over those that it is fitted to."""
    columns = (len(heights), -1)  # A line is a map with one column.
    points = fitted.reshape(columns)
    along, across = (
        legvander(np.linspace(-1, 1, count), min(order, count - 1)) for count in points.shape
    )
    used = np.add.outer(np.arange(along.shape[1]), np.arange(across.shape[1])) <= order
    sums = along.T @ np.where(points, heights.reshape(columns), 0.0) @ across
    pairs = [np.einsum("ni,nj->nij", base, base) for base in (along, across)]
    moments = np.einsum("xik,xy,yjl->ijkl", pairs[0], points.astype(float), pairs[1], optimize=True)
    coefficients = np.zeros(used.shape)
    coefficients[used] = np.linalg.lstsq(moments[used][:, used], sums[used], rcond=None)[0]
    return np.asarray((along @ coefficients @ across.T).reshape(heights.shape))


def _plane_of_least_slope(level: Array, fitted: PointMask) -> Array:
    """Plane with the mean slope between neighbouring points, along every direction."""
    slopes = []
    for axis in range(level.ndim):
        rows, is_used = np.moveaxis(level, axis, 0), np.moveaxis(fitted, axis, 0)
        is_pair = is_used[1:] & is_used[:-1]
        slopes.append(np.mean(np.diff(rows, axis=0)[is_pair]) if is_pair.any() else math.nan)
    places = np.ogrid[tuple(map(slice, level.shape))]
    return np.asarray(sum(slope * place for slope, place in zip(slopes, places, strict=True)))
