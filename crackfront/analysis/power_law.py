"""Power laws with an exponential cut-off, by maximum likelihood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

Array = NDArray[np.float64]

_FEWEST = 20
"""Values from which a law is told."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(100)
"""Gauss rule of the integral that normalises the density."""

_N_BOOTSTRAP = 200


@dataclass(frozen=True, slots=True)
class PowerLaw:
    r"""Density proportional to :math:`s^{-\tau} e^{-s/c}` above a smallest value.

    Attributes
    ----------
    exponent, low, high : float
        tau and its 95% interval, by a bootstrap over the values.
    cutoff : float
        c. (Units: those of the values)
    smallest : float
        Where the law begins. (Units: those of the values)
    n_value : int
        Values above it.
    """

    exponent: float
    low: float
    high: float
    cutoff: float
    smallest: float
    n_value: int

    def density(self, values: ArrayLike) -> Array:
        """Density at values above the smallest, normalised there."""
        scaled = np.asarray(values, dtype=float) / self.smallest
        rate = self.smallest / self.cutoff
        log = -self.exponent * np.log(scaled) - rate * scaled - _log_norm(self.exponent, rate)
        return np.exp(log) / self.smallest


def truncated_power_law(values: Array, smallest: float, rng: np.random.Generator) -> PowerLaw:
    """Power law with exponential cut-off that makes values most likely.

    Parameters
    ----------
    values : (n,) array
        Sizes; those below the smallest have no part. (Units: any)
    smallest : float
        Where the law begins. (Units: those of the values)
    rng : numpy.random.Generator
        Source of the bootstrap, which takes the values as independent.

    Raises
    ------
    ValueError
        If fewer than 20 values lie above the smallest.

    References
    ----------
    .. [1] Clauset, Shalizi, Newman, SIAM Rev. 51, 661 (2009).
    """
    used = values[values >= smallest] / smallest
    if used.size < _FEWEST:
        raise ValueError(
            f"{used.size} values lie above {smallest:g}; a power law needs {_FEWEST}, so lower the "
            "smallest or take more surfaces"
        )
    exponent, cutoff = _most_likely(used)
    again = [
        _most_likely(rng.choice(used, used.size), (exponent, cutoff))[0]
        for _ in range(_N_BOOTSTRAP)
    ]
    low, high = np.quantile(again, [0.025, 0.975])
    return PowerLaw(exponent, float(low), float(high), cutoff * smallest, smallest, int(used.size))


def _most_likely(scaled: Array, start: tuple[float, float] | None = None) -> tuple[float, float]:
    """Exponent and cut-off for values in units of the smallest."""
    # The likelihood knows the values through these two means alone.
    mean_log, mean = float(np.mean(np.log(scaled))), float(np.mean(scaled))
    exponent, cutoff = start or (1.3, float(np.max(scaled)))

    def surprise(point: Array) -> float:
        rate = float(np.exp(-point[1]))
        return point[0] * mean_log + rate * mean + _log_norm(float(point[0]), rate)

    found = minimize(
        surprise,
        [exponent, np.log(cutoff)],
        method="Nelder-Mead",
        bounds=[(0.0, 5.0), (0.0, np.log(1e4 * np.max(scaled)))],
        options={"xatol": 1e-4, "fatol": 1e-9},
    )
    return float(found.x[0]), float(np.exp(found.x[1]))


def _log_norm(exponent: float, rate: float) -> float:
    """Logarithm of the integral of x^-exponent e^(-rate x) from 1 to infinity."""
    # In u = log x the integrand is smooth; beyond e^-40 nothing is left of it.
    reach = np.log(1 + 40 / rate)
    u = reach * (1 + _NODES) / 2
    integrand = np.exp((1 - exponent) * u - rate * np.exp(u))
    return float(np.log(reach / 2 * (_WEIGHTS @ integrand)))
