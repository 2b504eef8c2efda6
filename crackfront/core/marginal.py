"""Fields that are not Gaussian: the distribution of their values in addition to their spectrum.

The magnitudes of all modes stay, and their phases are changed until the values are distributed as
requested: the iterative amplitude-adjusted Fourier transform.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.fft import irfft2, rfft2
from scipy.special import ndtr, ndtri

from crackfront.core.arguments import nearest_name
from crackfront.core.arrays import Array

_MOST_STEPS = 200
"""Steps after which the phases are taken as they are."""

_LEAST_GAIN = 3e-4
"""Approach to the distribution by one step, in rms of the values, below which steps end."""

_MOST_SCORE, _N_SCORE = 6.0, 2001
"""Range of the normal scores at which quantiles are computed, and their number; others follow by
interpolation."""


@dataclass(frozen=True, slots=True)
class Marginal:
    """Distribution of the values of a field, whatever their mean and variance.

    Parameters
    ----------
    distribution : str
        Name of a continuous distribution in `scipy.stats`.
    parameters : tuple of (str, float)
        Its shape parameters by their names, in alphabetical order.

    Raises
    ------
    ValueError
        If the distribution is unknown, a parameter is missing, unknown or out of range, or the
        variance is not finite.

    References
    ----------
    .. [1] Schreiber, Schmitz, Phys. Rev. Lett. 77, 635 (1996).

    Examples
    --------
    >>> pits = Marginal("pearson3", (("skew", -1.0),))
    >>> values = pits.quantiles(10_000)
    >>> round(float(np.mean(values**3)), 2)
    -1.0
    """

    distribution: str
    parameters: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        names, stated = self._parameter_names(), dict(self.parameters)
        for name in stated:
            if name not in names:
                hint = nearest_name(name, names, "its parameters are") if names else "it has none"
                raise ValueError(f"{self.distribution} lacks a parameter {name}; {hint}")
        if missing := [name for name in names if name not in stated]:
            raise ValueError(
                f"parameter {', '.join(missing)} of {self.distribution} is missing; add it"
            )
        with np.errstate(all="ignore"):
            variance = float(self._frozen.var())
        if not 0 < variance < math.inf:
            values = ", ".join(f"{name} {value:g}" for name, value in self.parameters) or "this"
            raise ValueError(
                f"{self.distribution} with {values} lacks a finite variance; choose values with one"
            )

    def quantiles(self, count: int) -> Array:
        """So many values at equal steps of probability, increasing, of mean 0 and variance 1."""
        scores = ndtri((np.arange(count) + 0.5) / count)
        values = np.interp(scores, *_quantiles_at_scores(self))
        values -= np.mean(values)
        return np.asarray(values / np.std(values))

    def _parameter_names(self) -> tuple[str, ...]:
        """Names of the shape parameters; ValueError if the distribution is unknown."""
        distributions = _distributions()
        if self.distribution not in distributions:
            near = difflib.get_close_matches(self.distribution, distributions, n=1)
            hint = f"did you mean {near[0]}?" if near else "pearson3 has any skewness"
            raise ValueError(
                f"scipy.stats lacks a continuous distribution {self.distribution!r}; {hint}"
            )
        shapes = distributions[self.distribution].shapes
        return tuple(name.strip() for name in shapes.split(",")) if shapes else ()

    @property
    def _frozen(self) -> Any:
        """The distribution of `scipy.stats` with its parameters."""
        return _distributions()[self.distribution](**dict(self.parameters))


@functools.cache
def _distributions() -> Mapping[str, Any]:
    """Continuous distributions of scipy.stats by their names."""
    # The import takes half a second, and most sweeps have Gaussian surfaces.
    from scipy import stats

    return dict(inspect.getmembers(stats, lambda item: isinstance(item, stats.rv_continuous)))


@functools.cache
def _quantiles_at_scores(marginal: Marginal) -> tuple[Array, Array]:
    """Normal scores, and the quantiles of a distribution at their probabilities."""
    scores = np.linspace(-_MOST_SCORE, _MOST_SCORE, _N_SCORE)
    return scores, np.asarray(marginal._frozen.ppf(ndtr(scores)))


def field_of_marginal(field: Array, marginal: Marginal) -> Array:
    """A field with the spectrum of another one, (n_x, n_y), and values of a distribution.

    The magnitudes of all modes are as before, to round-off. The distribution is approximate: how
    close it comes depends on the spectrum and the number of modes.
    """
    magnitudes, rms = np.abs(rfft2(field)), float(np.std(field))
    quantiles = rms * marginal.quantiles(field.size)
    values, distance = field, math.inf
    for _ in range(_MOST_STEPS):
        order = np.argsort(values, axis=None, kind="stable")
        before, distance = distance, float(np.std(values.ravel()[order] - quantiles)) / rms
        if before - distance < _LEAST_GAIN:
            break
        ranked = np.empty(field.size)
        ranked[order] = quantiles
        modes = rfft2(ranked.reshape(field.shape))
        sizes = np.abs(modes)
        # A mode that is exactly zero gets the phase 0.
        phases = np.where(sizes > 0, modes, 1.0) / np.where(sizes > 0, sizes, 1.0)
        values = irfft2(magnitudes * phases, s=field.shape)
    return np.asarray(values)
