"""The law behind k, fitted to measured straight fronts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import least_squares

from crackfront.analysis.law import (
    COEFFICIENTS,
    FINITE_SIZE_EXPONENT,
    LEAST_SIZE,
    TYPICAL_BREADTH,
    Departure,
    Law,
    law_slope,
    law_value,
    model_error,
)
from crackfront.core.arrays import Array
from studies.law.cells import HELD_OUT, LawCell

_START = (3.8, 0.55, 0.05, 0.1, 1.1, 1.35, 1.9, 1.3, 0.15, 0.0)

_SIZES = (LEAST_SIZE, 0.5, 1.0, 2.0, 5.0)
"""Least sizes g of the groups of fronts whose departures from the law are stated."""

_NEAR = 0.8
"""Largest difference of ln g of cells whose scatter is pooled, as few tiles say little of it."""


def fitted_law(cells: Sequence[LawCell]) -> Law:
    """Law of measured cells but those held out, by least squares, from :data:`LEAST_SIZE` on.

    A cell weighs by its own error and the model error together, which is found in the same way as
    the residuals: once with the first guess, then with what they say.
    """
    used = [cell for cell in cells if cell.size >= LEAST_SIZE and cell.spectrum not in HELD_OUT]
    s, g, breadth, k = (
        np.array([getattr(cell, name) for cell in used])
        for name in ("disorder", "size", "breadth", "both")
    )
    places = s, g, breadth
    error = _pooled_error(g, np.array([cell.error for cell in used]))
    coefficients, model = np.array(_START), (0.03, 0.05)
    for _ in range(4):
        spread = np.hypot(error, model_error(coefficients, s, g, breadth, model))

        def residuals(trial: Array, spread: Array = spread) -> Array:
            exponent = trial[-1] if trial.size > len(COEFFICIENTS) else FINITE_SIZE_EXPONENT
            values = law_value(trial[: len(COEFFICIENTS)], s, g, breadth, float(exponent))
            return (values - k) / spread

        solution = least_squares(residuals, coefficients)
        coefficients = solution.x
        model = _likeliest_model(coefficients, places, k, error)
    free = least_squares(residuals, [*coefficients, FINITE_SIZE_EXPONENT])
    # The residuals have unit variance.
    covariance = np.linalg.pinv(free.jac.T @ free.jac)
    relative = law_value(coefficients, s, g, breadth)[g >= 1] / k[g >= 1] - 1
    numerical = [cell.numerical_error / cell.both for cell in used if cell.size >= 1]
    ranges = [(float(values[values > 0].min()), float(values.max())) for values in places]
    return Law(
        coefficients=tuple(coefficients.tolist()),
        covariance=tuple(map(tuple, covariance.tolist())),
        model_factor=model[0],
        model_length=model[1],
        numerical=float(np.sqrt(np.nanmean(np.square(numerical)))),
        exponent=(float(free.x[-1]), float(np.sqrt(covariance[-1, -1]))),
        rms=float(np.sqrt(np.mean(relative**2))),
        worst=float(np.max(np.abs(relative))),
        disorder=ranges[0],
        size=(LEAST_SIZE, ranges[1][1]),
        breadth=ranges[2],
        departures=_departures(cells, coefficients),
    )


def _departures(cells: Sequence[LawCell], coefficients: Array) -> tuple[Departure, ...]:
    """How far all measured cells lie above the law, those held out too, by breadth and size."""
    rows = []
    last, broad = (
        math.nextafter(max(getattr(cell, name) for cell in cells), math.inf)
        for name in ("size", "breadth")
    )
    narrow = min(cell.breadth for cell in cells)
    for narrowest, broadest in pairwise((narrow, TYPICAL_BREADTH, broad)):
        for least, largest in pairwise((*_SIZES, last)):
            group = [
                cell.both / float(law_value(coefficients, cell.disorder, cell.size, cell.breadth))
                for cell in cells
                if least <= cell.size < largest and narrowest <= cell.breadth < broadest
            ]
            relative = np.array(group) - 1
            mean, rms = float(np.mean(relative)), float(np.sqrt(np.mean(relative**2)))
            row = Departure(narrowest, broadest, least, largest, mean, rms, len(group))
            rows.append(row)
    return tuple(rows)


def _pooled_error(size: Array, error: Array) -> Array:
    """Standard errors of cells, each from the median square over cells of about its size.

    A cell of a single tile lacks its own error; if no cell is near, the nearest one counts.
    """
    has_error = np.isfinite(error)
    distance = np.abs(np.log(size[:, None] / size[has_error]))
    near = distance <= np.maximum(_NEAR, distance.min(axis=1, keepdims=True))
    # The median of the squares of normal numbers is 0.455 of their mean.
    return np.array([np.sqrt(np.median(error[has_error][row] ** 2) / 0.455) for row in near])


def _likeliest_model(
    coefficients: Array, places: tuple[Array, Array, Array], k: Array, error: Array
) -> tuple[float, float]:
    """Model errors that make the residuals likeliest."""
    value, slope = law_value(coefficients, *places), law_slope(coefficients, *places)
    residuals = value - k
    grid = np.linspace(0.002, 0.15, 75)
    by_length = error**2 + (grid[:, None] * slope) ** 2
    costs = np.empty((grid.size, grid.size))
    for row, factor in enumerate(grid):
        variance = by_length + (factor * value) ** 2
        costs[row] = np.sum(np.log(variance) + residuals**2 / variance, axis=-1)
    best_factor, best_length = np.unravel_index(np.argmin(costs), costs.shape)
    return float(grid[best_factor]), float(grid[best_length])
