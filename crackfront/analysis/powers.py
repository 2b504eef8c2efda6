"""The fit of k to the disorder s and the size g of the cells of a sweep, as powers of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate, combination, finite_std, student_estimate
from crackfront.core.arrays import Array
from crackfront.core.variables import variable

_N_COEFFICIENT = 3
"""The logarithm of k in the middle of the cells, and the two powers."""

_LARGEST_CONDITION = 50.0
"""Condition of the least squares above which s and g of the cells do not differ: on equal springs g
is proportional to the square of s."""


@dataclass(frozen=True, slots=True)
class PowerFit:
    """Fit of k = k_m (s / s_m)^a (g / g_m)^b to the cells in the range.

    s_m and g_m are geometric means over the cells. All numbers are NaN if the cells do not span s
    and g, and intervals if a spectrum has one realisation.
    """

    factor: Estimate = variable("k_m, at the mean disorder and size of the cells", "1")
    disorder_power: Estimate = variable("power a of k in the disorder s", "1")
    size_power: Estimate = variable("power b of k in the size g", "1")
    disorder: Array = variable("s_m, geometric mean of w_rms / w_int over the cells", "1")
    size: Array = variable("g_m, geometric mean of the size g over the cells", "1")
    law_disorder_power: Array = variable("power a of k by the law, at the same cells", "1")
    law_size_power: Array = variable("power b of k by the law, at the same cells", "1")


def power_fit(
    disorder: Array,
    size: Array,
    factor: Array,
    law_factor: Array,
    draws: Sequence[Array | None],
    freedom: NDArray[np.int64],
) -> PowerFit:
    """Least squares of log k in log s and log g, with equal weights of the cells.

    Arrays are of the shape (n_spectrum, n_amplitude). `draws` has for each spectrum k of its
    bootstrap samples, (n_sample, n_amplitude), or None without scatter; `freedom` are the degrees
    of freedom of its standard errors, (n_spectrum,).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithms = np.log(np.stack([disorder, size, factor, law_factor]))
    used = np.all(np.isfinite(logarithms), axis=0)
    if np.count_nonzero(used) <= _N_COEFFICIENT:
        return _undetermined()
    log_s, log_g, log_k, log_law = logarithms
    mean_s, mean_g, mean_k, mean_law = (float(np.mean(values[used])) for values in logarithms)
    design = np.stack(
        [np.ones(np.count_nonzero(used)), log_s[used] - mean_s, log_g[used] - mean_g], axis=1
    )
    if np.linalg.cond(design) > _LARGEST_CONDITION:
        return _undetermined()
    inverse = np.linalg.pinv(design)
    # Coefficients are sums over the cells of these weights times log k.
    weights = np.zeros((_N_COEFFICIENT, *used.shape))
    weights[:, used] = inverse
    deviation = np.where(used, log_k - mean_k, 0.0)
    middle, disorder_power, size_power = _coefficients(weights, deviation, used, draws, freedom)
    value = middle.each(lambda logarithm: np.exp(logarithm + mean_k))
    _, law_disorder_power, law_size_power = inverse @ (log_law[used] - mean_law)
    return PowerFit(
        factor=replace(value, standard_error=value.value * middle.standard_error),
        disorder_power=disorder_power,
        size_power=size_power,
        disorder=np.asarray(np.exp(mean_s)),
        size=np.asarray(np.exp(mean_g)),
        law_disorder_power=np.asarray(law_disorder_power),
        law_size_power=np.asarray(law_size_power),
    )


def _undetermined() -> PowerFit:
    """Fit whose numbers are all NaN."""
    nothing, missing = student_estimate(np.nan, np.nan, 0), np.array(np.nan)
    return PowerFit(
        factor=nothing,
        disorder_power=nothing,
        size_power=nothing,
        disorder=missing,
        size=missing,
        law_disorder_power=missing,
        law_size_power=missing,
    )


def _coefficients(
    weights: Array,
    deviation: Array,
    used: NDArray[np.bool_],
    draws: Sequence[Array | None],
    freedom: NDArray[np.int64],
) -> list[Estimate]:
    """Coefficients of the least squares, sums of the independent parts of the spectra.

    `weights` have the shape (n_coefficient, n_spectrum, n_amplitude), deviations of log k from its
    mean and `used` cells (n_spectrum, n_amplitude).
    """
    parts = np.sum(weights * deviation, axis=-1)
    errors = np.stack(
        [_errors(drawn, weights[:, index], used[index]) for index, drawn in enumerate(draws)],
        axis=-1,
    )
    present = np.any(used, axis=1).astype(float)
    return [
        combination(student_estimate(part, error, freedom), freedom, present)
        for part, error in zip(parts, errors, strict=True)
    ]


def _errors(draws: Array | None, weights: Array, used: NDArray[np.bool_]) -> Array:
    """Standard errors of what a spectrum adds to the coefficients, (n_coefficient,)."""
    if draws is None:
        return np.full(len(weights), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithms = np.log(draws[:, used])
    # Samples without a positive mean say nothing about its logarithm.
    return finite_std(weights[:, used] @ logarithms[np.all(np.isfinite(logarithms), axis=1)].T)
