"""The law behind k, fitted to measured straight fronts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

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
"""First guess of the coefficients."""

_MODEL_START = (0.03, 0.05)
"""First guess of the model errors of ln k and ln g."""

_ROUNDS = 4
"""Fits, each with the model errors of the one before; they do not change any more."""

_SIZES = (LEAST_SIZE, 0.5, 1.0, 2.0, 5.0)
"""Least sizes g of the groups of fronts whose departures from the law are stated."""

_NEAR = 0.8
"""Largest difference of ln g of cells whose scatter is pooled, as few tiles say little of it."""


class _Fronts(NamedTuple):
    """Measured fronts to which the law is fitted, (n_cell,) each."""

    disorder: Array
    size: Array
    breadth: Array
    factor: Array
    error: Array
    """Standard error of the factor k over tiles."""

    @property
    def places(self) -> tuple[Array, Array, Array]:
        """Arguments of the law: s, g and breadth."""
        return self.disorder, self.size, self.breadth


def fitted_law(cells: Sequence[LawCell]) -> Law:
    """Law of measured cells but those held out, by least squares, from :data:`LEAST_SIZE` on.

    A cell weighs by its own error and the model error together. The first fit assumes model errors,
    and each further one estimates them from the residuals of the fit before.
    """
    used = [cell for cell in cells if cell.size >= LEAST_SIZE and cell.spectrum not in HELD_OUT]
    fronts = _fronts(used)
    coefficients, model = np.array(_START), _MODEL_START
    for _ in range(_ROUNDS):
        spread = np.hypot(fronts.error, model_error(coefficients, *fronts.places, model))
        coefficients = least_squares(_residuals, coefficients, args=(fronts, spread)).x
        model = _likeliest_model(coefficients, fronts)
    start = [*coefficients, FINITE_SIZE_EXPONENT]
    free = least_squares(_residuals, start, args=(fronts, spread))
    # The residuals have unit variance.
    covariance = np.linalg.pinv(free.jac.T @ free.jac)
    large = fronts.size >= 1
    relative = (law_value(coefficients, *fronts.places) / fronts.factor - 1)[large]
    numerical = [cell.numerical_error / cell.both for cell in used if cell.size >= 1]
    return Law(
        coefficients=tuple(coefficients.tolist()),
        covariance=tuple(map(tuple, covariance.tolist())),
        model_factor=model[0],
        model_length=model[1],
        numerical=float(np.sqrt(np.nanmean(np.square(numerical)))),
        exponent=(float(free.x[-1]), float(np.sqrt(covariance[-1, -1]))),
        rms=float(np.sqrt(np.mean(relative**2))),
        worst=float(np.max(np.abs(relative))),
        disorder=_positive_range(fronts.disorder),
        size=(LEAST_SIZE, float(fronts.size.max())),
        breadth=_positive_range(fronts.breadth),
        departures=_departures(cells, coefficients),
    )


def _fronts(cells: Sequence[LawCell]) -> _Fronts:
    """Columns of cells, with pooled errors."""
    disorder, size, breadth, factor, error = (
        np.array([getattr(cell, name) for cell in cells])
        for name in ("disorder", "size", "breadth", "both", "error")
    )
    return _Fronts(disorder, size, breadth, factor, _pooled_error(size, error))


def _residuals(trial: Array, fronts: _Fronts, spread: Array) -> Array:
    """Departures of the law from k over their spread; a last, further entry is the exponent."""
    exponent = trial[-1] if trial.size > len(COEFFICIENTS) else FINITE_SIZE_EXPONENT
    values = law_value(trial[: len(COEFFICIENTS)], *fronts.places, float(exponent))
    return np.asarray((values - fronts.factor) / spread)


def _positive_range(values: Array) -> tuple[float, float]:
    """Smallest value above zero, and the largest value."""
    return float(values[values > 0].min()), float(values.max())


def _departures(cells: Sequence[LawCell], coefficients: Array) -> tuple[Departure, ...]:
    """How far all measured cells lie above the law, those held out too, by breadth and size."""
    sizes = [*_SIZES, _just_above(cell.size for cell in cells)]
    breadths = [
        min(cell.breadth for cell in cells),
        TYPICAL_BREADTH,
        _just_above(cell.breadth for cell in cells),
    ]
    rows = []
    for narrowest, broadest in pairwise(breadths):
        for least, largest in pairwise(sizes):
            ratios = [
                cell.both / float(law_value(coefficients, cell.disorder, cell.size, cell.breadth))
                for cell in cells
                if least <= cell.size < largest and narrowest <= cell.breadth < broadest
            ]
            relative = np.array(ratios) - 1
            mean, rms = float(np.mean(relative)), float(np.sqrt(np.mean(relative**2)))
            rows.append(Departure(narrowest, broadest, least, largest, mean, rms, len(ratios)))
    return tuple(rows)


def _just_above(values: Iterable[float]) -> float:
    """The next number above all values: the open end of a range that contains them."""
    return math.nextafter(max(values), math.inf)


def _pooled_error(size: Array, error: Array) -> Array:
    """Standard errors of cells, each from the median square over cells of about its size.

    A cell of a single tile lacks its own error; if no cell is near, the nearest one counts.
    """
    has_error = np.isfinite(error)
    distance = np.abs(np.log(size[:, None] / size[has_error]))
    near = distance <= np.maximum(_NEAR, distance.min(axis=1, keepdims=True))
    # The median of the squares of normal numbers is 0.455 of their mean.
    return np.array([np.sqrt(np.median(error[has_error][row] ** 2) / 0.455) for row in near])


def _likeliest_model(coefficients: Array, fronts: _Fronts) -> tuple[float, float]:
    """Model errors that make the residuals likeliest."""
    value = law_value(coefficients, *fronts.places)
    slope = law_slope(coefficients, *fronts.places)
    residuals = value - fronts.factor
    grid = np.linspace(0.002, 0.15, 75)
    by_length = fronts.error**2 + (grid[:, None] * slope) ** 2
    costs = np.empty((grid.size, grid.size))
    for row, factor in enumerate(grid):
        variance = by_length + (factor * value) ** 2
        costs[row] = np.sum(np.log(variance) + residuals**2 / variance, axis=-1)
    best_factor, best_length = np.unravel_index(np.argmin(costs), costs.shape)
    return float(grid[best_factor]), float(grid[best_length])
