"""Estimates with intervals from few realisations: resampling, Student's t, combinations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

Array = NDArray[np.float64]

CONFIDENCE = 0.95
"""Confidence of every interval."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Values with their uncertainty from the scatter between realisations.

    Attributes
    ----------
    value : array
        Point estimate; NaN where the data give none.
    standard_error : array of the same shape
        NaN where there is one realisation only.
    low, high : array of the same shape
        95% confidence interval; NaN where there is one realisation only.
    """

    value: Array
    standard_error: Array
    low: Array
    high: Array


def student_estimate(value: ArrayLike, standard_error: ArrayLike, freedom: ArrayLike) -> Estimate:
    """Estimate with the interval of Student's t.

    Parameters
    ----------
    value, standard_error, freedom : array_like
        Point estimate, its standard error and the degrees of freedom of the latter; fewer than
        one give no interval.

    Returns
    -------
    Estimate
        Arrays of the common shape.
    """
    centre, error, degrees = np.broadcast_arrays(
        np.asarray(value, dtype=float), np.asarray(standard_error, dtype=float), freedom
    )
    known = np.isfinite(error) & (degrees >= 1)
    reach = np.full(centre.shape, np.nan)
    reach[known] = error[known] * stdtrit(degrees[known], (1 + CONFIDENCE) / 2)
    return Estimate(
        centre.copy(),
        np.where(known, error, np.nan),
        np.asarray(centre - reach),
        np.asarray(centre + reach),
    )


def mean_estimate(values: Array) -> tuple[Estimate, NDArray[np.int64]]:
    """Mean over the last axis with NaN left out, and how many values it has.

    The bootstrap's standard error of a mean is known in closed form and not resampled.

    Parameters
    ----------
    values : (..., n) array
        One value a realisation, NaN where it failed.

    Returns
    -------
    Estimate
        Arrays of shape (...).
    (...) int array
        Number of finite values.
    """
    finite = np.isfinite(values)
    count = np.count_nonzero(finite, axis=-1)
    mean = ratio(np.sum(values, axis=-1, where=finite), count)
    error = scatter(values) / np.sqrt(np.maximum(count, 1))
    return student_estimate(mean, error, count - 1), np.asarray(count)


def resample_counts(n_sample: int, n_realisation: int, rng: np.random.Generator) -> Array:
    """How often each bootstrap sample holds each realisation.

    A sample has n - 1 of n realisations, drawn with replacement: then the variance between
    samples of a mean is that of the mean, without the factor (n - 1) / n of samples of n, which
    is a quarter for four realisations.

    Parameters
    ----------
    n_sample, n_realisation : int
        Number of samples and, at least 2, of realisations.
    rng : numpy.random.Generator
        Source of the draws.

    Returns
    -------
    (n_sample, n_realisation) array
        Counts; each row sums to n_realisation - 1.

    References
    ----------
    .. [1] McCarthy, Snowden, Vital and Health Statistics 2, 95 (1985).
    """
    equal = np.full(n_realisation, 1 / n_realisation)
    return rng.multinomial(n_realisation - 1, equal, size=n_sample).astype(float)


def scatter(draws: Array) -> Array:
    """Standard deviation over the last axis, NaN left out; NaN with fewer than two values."""
    finite = np.isfinite(draws)
    count = np.count_nonzero(finite, axis=-1)
    centre = ratio(np.sum(draws, axis=-1, where=finite), count)
    square = np.sum((draws - centre[..., None]) ** 2, axis=-1, where=finite)
    return np.asarray(np.sqrt(ratio(square, count - 1)))


def combination(parts: Estimate, freedom: ArrayLike, coefficients: Array) -> Estimate:
    """Linear combination of independent estimates.

    Parameters
    ----------
    parts : Estimate
        Estimates of shape (n,).
    freedom : (n,) array_like
        Degrees of freedom of their standard errors.
    coefficients : (n,) array
        Coefficients; parts with zero are left out, NaN included.

    Returns
    -------
    Estimate
        Scalar arrays; the degrees of freedom follow Welch and Satterthwaite. NaN where no
        coefficient differs from zero.
    """
    used = np.flatnonzero(coefficients)
    if used.size == 0:
        return student_estimate(np.nan, np.nan, 0)
    factors = coefficients[used]
    variance = (factors * parts.standard_error[used]) ** 2
    degrees = np.maximum(np.asarray(freedom)[used], 1)
    total = np.sum(variance)
    spread = np.sum(variance**2 / degrees)
    joint = total**2 / spread if spread > 0 else np.sum(degrees)
    return student_estimate(np.sum(factors * parts.value[used]), np.sqrt(total), joint)


def ratio(numerator: ArrayLike, denominator: ArrayLike) -> Array:
    """Quotient, NaN where the denominator is not positive."""
    above, below = np.broadcast_arrays(
        np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    )
    return np.divide(above, below, out=np.full(above.shape, np.nan), where=below > 0)


def slope(abscissa: Array, ordinate: Array) -> tuple[Array, Array]:
    """Least-squares slope of a straight line along the last axis, NaN left out.

    Parameters
    ----------
    abscissa, ordinate : (..., n) array
        Points of equal weight.

    Returns
    -------
    slope : (...) array
        NaN with fewer than two distinct abscissas.
    spread : (...) array
        Sum of squared deviations of the abscissas from their mean; the weight of the slope when
        several lines share one.
    """
    finite = np.isfinite(abscissa) & np.isfinite(ordinate)
    count = np.count_nonzero(finite, axis=-1)
    centre = ratio(np.sum(abscissa, axis=-1, where=finite), count)
    deviation = np.where(finite, abscissa - centre[..., None], 0.0)
    spread = np.sum(deviation**2, axis=-1)
    resolved = np.where(count > 1, spread, 0.0)
    return ratio(np.sum(deviation * ordinate, axis=-1, where=finite), resolved), resolved
