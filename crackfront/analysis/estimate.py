"""Numbers with intervals, from few realisations: resampling, Student's t, combinations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import astuple, dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from crackfront.core.arrays import Array

Mapped = TypeVar("Mapped")
FloatOrArray = TypeVar("FloatOrArray", float, Array)

if TYPE_CHECKING:
    from typing_extensions import TypeVar as DefaultTypeVar

    Number = DefaultTypeVar("Number", default=Array)
else:
    Number = TypeVar("Number")

_CONFIDENCE = 0.95
"""Confidence of every interval."""

REACH = 1.96
"""Standard errors in half of a 95% interval of the normal distribution."""


@dataclass(frozen=True, slots=True)
class Estimate(Generic[Number]):
    """A number, or an array of numbers, with its uncertainty."""

    value: Number
    """Point estimate; NaN if the data are not sufficient."""
    standard_error: Number
    """NaN if the data are not sufficient (one realisation), or give only an interval."""
    low: Number
    """Lower end of the 95% interval; NaN if the data are not sufficient."""
    high: Number
    """Upper end of the 95% interval; NaN if the data are not sufficient."""

    def each(self, function: Callable[[Number], Mapped]) -> Estimate[Mapped]:
        """Apply a function, such as an index or a change of units, to all four entries."""
        return Estimate(*map(function, (self.value, self.standard_error, self.low, self.high)))

    def at(self: Estimate, index: Any) -> Estimate:
        """The estimates at an index of their arrays."""
        return self.each(lambda values: values[index])

    def where(self: Estimate, condition: NDArray[np.bool_]) -> Estimate:
        """The estimates where a condition is true, NaN elsewhere."""
        return self.each(lambda values: np.where(condition, values, np.nan))


UNKNOWN: Estimate[float] = Estimate(math.nan, math.nan, math.nan, math.nan)
"""Estimate of a number that the data do not determine."""


def exact_estimate(value: float) -> Estimate[float]:
    """Estimate of a number without an error."""
    return Estimate(value, 0.0, value, value)


def quantiles(values: Array, weight: Array, part: ArrayLike) -> Array:
    """Weighted quantiles along the first axis; the result has the axis of `part` first.

    Examples
    --------
    >>> quantiles(np.array([3.0, 1.0, 2.0]), np.array([0.5, 0.25, 0.25]), (0.3, 0.9)).tolist()
    [2.0, 3.0]
    """
    parts = np.asarray(part, float)
    return np.asarray(np.quantile(values, parts, axis=0, weights=weight, method="inverted_cdf"))


def with_error(value: float, error: float) -> str:
    """Number and error with equal decimals, two digits of the error; six digits if it is tiny.

    Examples
    --------
    >>> with_error(0.795242, 0.0256), with_error(2.0314, 0.0042), with_error(60.3, 10.05)
    ('0.795 ± 0.026', '2.0314 ± 0.0042', '60 ± 10')
    >>> with_error(2.0, 1e-9), with_error(0.0, 1e-9)
    ('2 ± 1e-09', '0 ± 1e-09')
    """
    if not 1e-6 * max(1.0, abs(value)) < error < np.inf:
        return f"{value:.6g} ± {error:.2g}"
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


MISSING = "-"
"""Text in place of a missing number."""


def with_interval(estimate: Estimate[Any]) -> str:
    """Value and 95% interval of a number as text; :data:`MISSING` for NaN."""
    value, _, low, high = astuple(estimate)
    if not np.isfinite(value):
        return MISSING
    if not np.isfinite(low):
        return f"{value:.2f} (no interval)"
    return f"{value:.2f} ({low:.2f} to {high:.2f})"


def normal_estimate(value: FloatOrArray, standard_error: FloatOrArray) -> Estimate[FloatOrArray]:
    """Estimate with the 95% interval of the normal distribution."""
    reach = REACH * standard_error
    return Estimate(value, standard_error, value - reach, value + reach)


def product(*factors: Estimate[float]) -> Estimate[float]:
    """Product of independent positive numbers, whose relative intervals add in quadrature.

    Examples
    --------
    >>> uncertain, exact = Estimate(2.0, math.nan, 1.0, 4.0), Estimate(3.0, math.nan, 3.0, 3.0)
    >>> result = product(uncertain, exact)
    >>> result.low, result.value, result.high
    (3.0, 6.0, 12.0)
    """
    value = math.prod(factor.value for factor in factors)
    above = math.hypot(*(math.log(factor.high / factor.value) for factor in factors))
    low = 0.0
    if all(factor.low > 0 for factor in factors):
        below = math.hypot(*(math.log(factor.value / factor.low) for factor in factors))
        low = value * math.exp(-below)
    return Estimate(value, math.nan, low, value * math.exp(above))


def student_estimate(value: ArrayLike, standard_error: ArrayLike, freedom: ArrayLike) -> Estimate:
    """Estimate with the 95% interval of Student's t, arrays of the common shape.

    Without a degree of freedom, error and interval are NaN. With one degree, the interval is NaN
    because it would extend 13 standard errors to both sides.
    """
    numbers = (np.asarray(number, dtype=float) for number in (value, standard_error))
    centre, error, degrees = np.broadcast_arrays(*numbers, freedom)
    defined = np.isfinite(error) & (degrees >= 1)
    error, degrees = np.where(defined, error, np.nan), np.where(defined, degrees, 1)
    reach = np.where(degrees > 1, error * stdtrit(degrees, (1 + _CONFIDENCE) / 2), np.nan)
    return Estimate(*map(np.array, (centre, error, centre - reach, centre + reach)))


def mean_estimate(values: Array) -> tuple[Estimate, NDArray[np.int64]]:
    """Mean over the last axis without NaN, and the number of its values.

    The standard error is the bootstrap's, which has a closed form for a mean.
    """
    count = np.asarray(np.count_nonzero(np.isfinite(values), axis=-1))
    error = finite_std(values) / np.sqrt(np.maximum(count, 1))
    return student_estimate(finite_mean(values), error, count - 1), count


def resample_counts(n_sample: int, n_realisation: int, rng: np.random.Generator) -> Array:
    """Number of times that each bootstrap sample contains each realisation.

    A sample has n - 1 of n realisations, drawn with replacement. The variance of a mean between
    such samples is unbiased; samples of n realisations would underestimate it by (n - 1) / n
    (McCarthy, Snowden, Vital and Health Statistics 2, 95, 1985). The shape is
    (n_sample, n_realisation); two realisations or more are needed.
    """
    drawn = rng.integers(n_realisation, size=(n_sample, n_realisation - 1))
    # One bincount for all samples takes a fifth of the time of multinomial draws.
    drawn += n_realisation * np.arange(n_sample)[:, None]
    counts = np.bincount(drawn.ravel(), minlength=n_sample * n_realisation)
    return counts.reshape(n_sample, n_realisation).astype(float)


def finite_std(draws: Array) -> Array:
    """Standard deviation over the last axis without NaN; NaN with fewer than two values."""
    square = finite_sum((draws - finite_mean(draws)[..., None]) ** 2)
    freedom = np.count_nonzero(np.isfinite(draws), axis=-1) - 1
    return np.asarray(np.sqrt(ratio_or_nan(square, freedom)))


def finite_sum(values: Array) -> Array:
    """Sum over the last axis without NaN."""
    return np.asarray(np.sum(values, axis=-1, where=np.isfinite(values)))


def finite_mean(values: Array) -> Array:
    """Mean over the last axis without NaN."""
    return ratio_or_nan(finite_sum(values), np.count_nonzero(np.isfinite(values), axis=-1))


def combination(parts: Estimate, freedom: ArrayLike, coefficients: Array) -> Estimate:
    """Linear combination of independent estimates, arrays without dimensions.

    All three have the shape (n,); `freedom` has the degrees of freedom of the standard errors.
    Parts with a coefficient of zero are left out, even if they are NaN. The result is NaN if all
    are left out. Its degrees of freedom follow Welch and Satterthwaite.
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


def ratio_or_nan(numerator: ArrayLike, denominator: ArrayLike) -> Array:
    """Quotient, NaN where the denominator is not positive."""
    above, below = np.broadcast_arrays(np.asarray(numerator, float), np.asarray(denominator, float))
    return np.divide(above, below, out=np.full(above.shape, np.nan), where=below > 0)


def least_squares_slope(abscissa: Array, ordinate: Array) -> tuple[Array, Array]:
    """Least-squares slopes of lines along the last axis, with equal weights and without NaN.

    A slope is NaN with fewer than two distinct abscissas. Also returns the sum of squared
    deviations of the abscissas from their mean: the weight of a line if several share a slope.
    """
    finite = np.isfinite(abscissa) & np.isfinite(ordinate)
    centre = finite_mean(np.where(finite, abscissa, np.nan))
    deviation = np.where(finite, abscissa - centre[..., None], 0.0)
    spread = np.sum(deviation**2, axis=-1)
    resolved = np.where(np.count_nonzero(finite, axis=-1) > 1, spread, 0.0)
    return ratio_or_nan(np.sum(deviation * ordinate, axis=-1, where=finite), resolved), resolved
