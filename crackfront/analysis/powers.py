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
    middle = np.array([np.mean(values[used]) if np.any(used) else np.nan for values in logarithms])
    s, g, _, law = (values[used] - mean for values, mean in zip(logarithms, middle, strict=True))
    design = np.stack([np.ones(s.size), s, g], axis=1)
    if s.size <= _N_COEFFICIENT or np.linalg.cond(design) > _LARGEST_CONDITION:
        nothing = student_estimate(np.nan, np.nan, 0)
        missing = np.array(np.nan)
        return PowerFit(nothing, nothing, nothing, missing, missing, missing, missing)
    # Coefficients are sums over the cells of these weights times log k.
    weights = np.zeros((_N_COEFFICIENT, *used.shape))
    weights[:, used] = np.linalg.pinv(design)
    parts = np.sum(weights * np.where(used, logarithms[2] - middle[2], 0.0), axis=-1)
    errors = np.stack(
        [_errors(drawn, weights[:, index], used[index]) for index, drawn in enumerate(draws)],
        axis=-1,
    )
    present = np.any(used, axis=1).astype(float)
    logarithm, *powers = (
        combination(student_estimate(*row, freedom), freedom, present)
        for row in zip(parts, errors, strict=True)
    )
    value = logarithm.each(lambda values: np.exp(values + middle[2]))
    by_law = np.linalg.pinv(design) @ law
    return PowerFit(
        factor=replace(value, standard_error=value.value * logarithm.standard_error),
        disorder_power=powers[0],
        size_power=powers[1],
        disorder=np.asarray(np.exp(middle[0])),
        size=np.asarray(np.exp(middle[1])),
        law_disorder_power=np.asarray(by_law[1]),
        law_size_power=np.asarray(by_law[2]),
    )


def _errors(draws: Array | None, weights: Array, used: NDArray[np.bool_]) -> Array:
    """Standard errors of what a spectrum adds to the coefficients, (n_coefficient,)."""
    if draws is None:
        return np.full(len(weights), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithms = np.log(draws[:, used])
    # Samples without a positive mean say nothing about its logarithm.
    return finite_std(weights[:, used] @ logarithms[np.all(np.isfinite(logarithms), axis=1)].T)
