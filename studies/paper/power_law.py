"""Power laws with a cut-off, by maximum likelihood: of one sample, or of several that scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize, minimize_scalar

from crackfront.analysis.estimate import REACH
from crackfront.core.arrays import Array
from studies.paper.figure import Integers

_FEWEST = 20
"""Fewest values to which a law is fitted."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(100)
"""Gauss rule of the integral that normalises the density."""

_N_BOOTSTRAP = 400
"""Samples of a bootstrap."""

_N_JOINT_BOOTSTRAP = 200
"""Samples of a bootstrap of the joint law, whose fits take longer."""

Samples = Sequence[tuple[Array, Integers]]
"""Values and their counts, of each sample."""


@dataclass(frozen=True, slots=True)
class PowerLaw:
    r"""Density proportional to :math:`s^{-\tau} e^{-s/c}` above a smallest value."""

    exponent: float  # tau
    low: float  # its 95% interval, by a bootstrap over the values
    high: float
    cutoff: float  # c, in the units of the values
    smallest: float  # where the law begins
    n_value: int  # values above it

    @property
    def decades(self) -> float:
        """Decades between the smallest value and the cut-off."""
        return float(np.log10(self.cutoff / self.smallest))

    def density(self, values: ArrayLike) -> Array:
        """Density at values above the smallest, normalised there."""
        scaled = np.asarray(values, dtype=float) / self.smallest
        rate = self.smallest / self.cutoff
        log = -self.exponent * np.log(scaled) - rate * scaled - _log_norm(self.exponent, rate)
        return np.exp(log) / self.smallest


def truncated_power_law(values: Array, smallest: float, rng: np.random.Generator) -> PowerLaw:
    """Power law with exponential cut-off that makes values from a smallest one on most likely.

    The bootstrap takes the values as independent. A ValueError says if fewer than 20 lie above the
    smallest.

    References
    ----------
    .. [1] Clauset, Shalizi, Newman, SIAM Rev. 51, 661 (2009).
    """
    used = _above(values, smallest)
    exponent, cutoff = best = _most_likely(used)
    resampled = [_most_likely(rng.choice(used, used.size), best)[0] for _ in range(_N_BOOTSTRAP)]
    low, high = _interval(exponent, resampled)
    return PowerLaw(exponent, low, high, cutoff * smallest, smallest, int(used.size))


def exponent_and_cutoff(values: Array, smallest: float) -> tuple[float, float]:
    """Exponent and cut-off of :func:`truncated_power_law`, without the interval."""
    exponent, cutoff = _most_likely(_above(values, smallest))
    return exponent, cutoff * smallest


def _above(values: Array, smallest: float) -> Array:
    """Values from the smallest on, in units of it."""
    used = values[values >= smallest] / smallest
    if used.size < _FEWEST:
        raise ValueError(
            f"{used.size} values lie above {smallest:g}; a power law needs {_FEWEST}, so lower the "
            "smallest or take more surfaces"
        )
    return used


def _interval(exponent: float, resampled: Sequence[float]) -> tuple[float, float]:
    """95% interval of an exponent, from the exponents of bootstrap samples.

    It assumes a normal distribution: quantiles of some hundred samples scatter twice as much.
    """
    reach = REACH * float(np.std(resampled, ddof=1))
    return exponent - reach, exponent + reach


def _most_likely(scaled: Array, start: tuple[float, float] | None = None) -> tuple[float, float]:
    """Exponent and cut-off for values in units of the smallest."""
    # The likelihood knows the values through these two means alone.
    mean_log, mean = float(np.mean(np.log(scaled))), float(np.mean(scaled))
    exponent, cutoff = start or (1.3, float(np.max(scaled)))

    def surprise(point: Array) -> float:
        rate = float(np.exp(-point[1]))
        return point[0] * mean_log + rate * mean + _log_norm(float(point[0]), rate)

    solution = minimize(
        surprise,
        [exponent, np.log(cutoff)],
        method="Nelder-Mead",
        bounds=[(0.0, 5.0), (0.0, np.log(1e4 * np.max(scaled)))],
        options={"xatol": 1e-4, "fatol": 1e-9},
    )
    return float(solution.x[0]), float(np.exp(solution.x[1]))


def _log_norm(exponent: float, rate: float) -> float:
    """Logarithm of the integral of x^-exponent e^(-rate x) from 1 to infinity."""
    # In u = log x the integrand is smooth; beyond e^-40 nothing is left of it.
    reach = np.log(1 + 40 / rate)
    u = reach * (1 + _NODES) / 2
    integrand = np.exp((1 - exponent) * u - rate * np.exp(u))
    return float(np.log(reach / 2 * (_WEIGHTS @ integrand)))


@dataclass(frozen=True, slots=True)
class JointPowerLaw:
    r"""Density of several samples that differ by the scale of their cut-off alone.

    .. math:: p(s) \propto s^{-\tau} \exp\left[C \sqrt{s / s_m}
              - \frac{B}{4} \left(\frac{s}{s_m}\right)^\delta\right]

    above a smallest value, the cut-off of avalanches of an elastic line: before it ends, the
    density lies above its power law (Rosso, Le Doussal, Wiese, Phys. Rev. B 80, 144204, 2009).
    """

    exponent: float  # tau
    low: float  # its 95% interval, by a bootstrap over the values
    high: float
    shoulder: float  # C
    tail: float  # B
    steepness: float  # delta
    scales: Array  # s_m of each sample, as of `cutoff_scale`
    smallest: float  # where the law begins
    n_value: Integers  # values of each sample above it
    later: float  # tau of the law that begins at twice the smallest

    @property
    def scatter(self) -> float:
        """Half of the interval of the bootstrap."""
        return (self.high - self.low) / 2

    @property
    def shift(self) -> float:
        """What tau owes to where the law begins: its change if that is at twice the smallest."""
        # Scaling is reached little by little; one or two decades do not show where.
        return abs(self.later - self.exponent)

    def density(self, values: ArrayLike, sample: int) -> Array:
        """Density of a sample at values above the smallest, normalised there."""
        scale = float(self.scales[sample])
        natural = np.array([self.exponent, self.shoulder, self.tail / 4])
        places, weights = _rule(self.smallest, scale)
        norm = weights @ np.exp(natural @ _statistics(places, scale, self.steepness))
        statistics = _statistics(np.asarray(values, dtype=float), scale, self.steepness)
        return np.asarray(np.exp(natural @ statistics) / norm)


def cutoff_scale(values: Array, counts: Integers | int = 1) -> float:
    """Scale <s^2> / 2 <s> of the cut-off of a power law of exponent below 2.

    Small values hardly matter; `counts` says how often each value occurs.
    """
    return float(np.sum(counts * values**2) / np.sum(counts * values) / 2)


_STEEPNESS = (1.0, 1.5)
"""Range of delta: 1 in mean field, 1.06 of a line of long range and 1.11 of one of short range to
first order. Few values tell it from C, and both from tau, only within such a range."""

_BINS_A_DECADE = 200
"""Bins of values for the joint law: their width moves no exponent by 0.001."""


def joint_power_law(
    samples: Sequence[Array], smallest: float, rng: np.random.Generator
) -> JointPowerLaw:
    """Power law with the same exponent and shape of the cut-off that makes all samples most likely.

    Values below the smallest decide the scale alone, and the bootstrap takes values as independent.
    A ValueError says if fewer than 20 of a sample lie above the smallest.
    """
    n_value = np.array([np.sum(sample >= smallest) for sample in samples])
    if n_value.min() < _FEWEST:
        raise ValueError(
            f"{n_value.min()} values of a sample lie above {smallest:g}; a power law needs "
            f"{_FEWEST}, so lower the smallest or take more values"
        )
    binned = [_binned(sample, smallest) for sample in samples]
    best = _most_likely_joint(binned, smallest)
    resampled = []
    for _ in range(_N_JOINT_BOOTSTRAP):
        drawn = [(values, rng.multinomial(n.sum(), n / n.sum())) for values, n in binned]
        resampled.append(_most_likely_joint(drawn, smallest).exponent)
    low, high = _interval(best.exponent, resampled)
    shape = best.shoulder, 4 * best.quarter, best.steepness
    upper = [_binned(sample, 2 * smallest) for sample in samples]
    later = _most_likely_joint(upper, 2 * smallest).exponent
    return JointPowerLaw(best.exponent, low, high, *shape, best.scales, smallest, n_value, later)


def _binned(sample: Array, smallest: float) -> tuple[Array, Integers]:
    """Geometric middles of filled bins, one edge of which is the smallest, and their counts."""
    place = np.floor(_BINS_A_DECADE * np.log10(sample / smallest))
    filled, counts = np.unique(place, return_counts=True)
    return smallest * 10 ** ((filled + 0.5) / _BINS_A_DECADE), counts


class _JointParameters(NamedTuple):
    """Most likely parameters of the joint distribution."""

    scales: Array
    """Cutoff scale of each sample."""
    exponent: float
    """tau."""
    shoulder: float
    """C."""
    quarter: float
    """B / 4."""
    steepness: float
    """delta."""


def _most_likely_joint(samples: Samples, smallest: float) -> _JointParameters:
    """Most likely parameters for binned samples."""
    scales = np.array([cutoff_scale(*sample) for sample in samples])
    used = [(values[values >= smallest], counts[values >= smallest]) for values, counts in samples]

    def surprise(steepness: float) -> float:
        return _natural_parameters(used, scales, smallest, steepness)[0]

    options = {"bounds": _STEEPNESS, "method": "bounded", "options": {"xatol": 1e-2}}
    steepness = float(minimize_scalar(surprise, **options).x)
    _, natural = _natural_parameters(used, scales, smallest, steepness)
    exponent, shoulder, quarter = natural.tolist()
    return _JointParameters(scales, exponent, shoulder, quarter, steepness)


class _SampleLikelihood(NamedTuple):
    """What the likelihood of the joint law takes from a sample, at one delta."""

    observed: Array
    """Sums of the statistics over all values, (3,)."""
    statistics: Array
    """Statistics at the places of a quadrature, (3, n)."""
    weights: Array
    """Weights of the quadrature, (n,)."""
    n_value: int


def _natural_parameters(
    samples: Samples, scales: Array, smallest: float, steepness: float
) -> tuple[float, Array]:
    """Least surprise, and (tau, C, B/4) there, for one delta: an exponential family."""
    likelihoods = []
    for (values, counts), scale in zip(samples, scales, strict=True):
        observed = _statistics(values, scale, steepness) @ counts
        places, weights = _rule(smallest, scale)
        statistics = _statistics(places, scale, steepness)
        likelihoods.append(_SampleLikelihood(observed, statistics, weights, int(counts.sum())))
    return _least_surprise(likelihoods)


def _least_surprise(likelihoods: Sequence[_SampleLikelihood]) -> tuple[float, Array]:
    """Least surprise and its natural parameters, by Newton steps that are halved if too long."""
    natural = np.array(_NATURAL_START)
    surprise, slope, curvature = _surprise(natural, likelihoods)
    for _ in range(_N_NEWTON):
        step = np.linalg.solve(curvature, slope)
        gain = float(step @ slope)
        if gain < _GAIN:
            break
        # The surprise is convex: halving a step that overshoots ends.
        length = 1.0
        trial = _surprise(natural - length * step, likelihoods)
        while trial[0] > surprise - 0.1 * length * gain:
            length /= 2
            trial = _surprise(natural - length * step, likelihoods)
        natural = natural - length * step
        surprise, slope, curvature = trial
    return surprise, natural


def _surprise(
    natural: Array, likelihoods: Sequence[_SampleLikelihood]
) -> tuple[float, Array, Array]:
    """Negative logarithm of the likelihood of all samples, its gradient and its curvature."""
    surprise, slope, curvature = 0.0, np.zeros(3), np.zeros((3, 3))
    for observed, statistics, weights, count in likelihoods:
        exponent = natural @ statistics
        share = weights * np.exp(exponent - exponent.max())
        total = share.sum()
        mean = statistics @ share / total
        square = (statistics * share) @ statistics.T / total
        surprise += count * (np.log(total) + exponent.max()) - natural @ observed
        slope += count * mean - observed
        curvature += count * (square - np.outer(mean, mean))
    return surprise, slope, curvature


_NATURAL_START = (1.3, 0.2, 0.3)
"""First guess of tau, C and B / 4."""

_N_NEWTON = 100
"""Limit on Newton steps."""

_GAIN = 1e-8
"""Fall of the surprise in a Newton step below which they end."""

_FURTHEST = 1e3
"""End of the integral that normalises the joint law, over the scale."""


def _statistics(values: Array, scale: float, steepness: float) -> Array:
    """What tau, C and B/4 multiply in the logarithm of the density, (3, n)."""
    scaled = values / scale
    return np.array([-np.log(values), np.sqrt(scaled), -(scaled**steepness)])


def _rule(smallest: float, scale: float) -> tuple[Array, Array]:
    """Places and weights of an integral from the smallest value on, Gauss in the logarithm."""
    reach = np.log(_FURTHEST * scale / smallest)
    places = smallest * np.exp(reach * (1 + _NODES) / 2)
    return places, _WEIGHTS * reach / 2 * places
