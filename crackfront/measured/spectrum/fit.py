"""Models of one surface and its instruments that agree with all densities of its scans."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crackfront.analysis.estimate import Estimate, quantiles
from crackfront.core.arrays import Array
from crackfront.measured.density.densities import Density
from crackfront.measured.density.self_affine import (
    BEND,
    LEAST_DEPARTURE,
    N_SHAPE,
    PUPIL,
    SHARPEST,
    DensityModels,
    Instrument,
    deviances,
    log_density,
    log_density_slopes,
    log_projection,
    log_projection_with_slopes,
    loss_exponent,
    shape_limits,
    weighted_residuals,
)
from crackfront.measured.spectrum.quadrature import Quadrature, States

_FAR = 2.0
"""Logarithm of the factor by which a roll-off beyond the fitted waves is less likely by e."""

_LOSS, _NOISE = (1e-3, 8.0), 1.0
"""Bounds of the attenuation's exponent at the last wavevector of a density, and largest distance of
the logarithm of the noise from its first estimate."""

_LEAST_CURVATURE = -2.0
"""Logarithm of data over model down to which the curvature of the deviance is taken as it is."""

_ROUGH = np.array([0.7, 0.7])
"""Hurst exponents of longer and of shorter waves with which fits begin."""


@dataclass(frozen=True, slots=True)
class Fit:
    """Models that agree with densities, states of a quadrature over their parameters."""

    surface: Array
    """Parameters of P. Shape (n, 5)."""
    instruments: Array
    """Logarithm of q_c, m and logarithm of the noise of every density. Shape (n, n_density, 3)."""
    weight: Array
    """Weight of every state; their sum is 1. Shape (n,)."""
    lowest: float
    """Lowest wavevector that is fitted. (Units: 1 / m)"""
    misfit: float
    """Least deviance per degree of freedom; 1 where only the number of modes makes noise."""

    def logarithms(self, wavevector: Array) -> Array:
        """Logarithm of C of every state, (n, n_wavevector)."""
        return log_density(self.surface, wavevector)

    def median(self, wavevector: Array) -> Array:
        """Median of C (Units: m^4)."""
        return np.exp(quantiles(self.logarithms(wavevector), self.weight, 0.5))

    def projected_density(self, wavevector: Array) -> Array:
        """Median of C_1D of lines (Units: m^3)."""
        return np.exp(quantiles(log_projection(self.surface, wavevector), self.weight, 0.5))

    def isotropic(self, density: Density, index: int, *, restored: bool = True) -> Array:
        """Logarithm of C of every state where a density was measured, (n, n_wavevector).

        The measured value without the noise, over the transfer of its instrument unless it is not
        to be restored; of a line by the ratio of the model to its projection.
        """
        instrument = self.instruments[:, index]
        clean = density.value - np.exp(instrument[:, 2:])
        # Noise is a small part of what is trusted; named limits may trust more.
        found = np.log(np.maximum(clean, (0.1 if restored else 1e-3) * density.value))
        if restored:
            found += loss_exponent(instrument, density.wavevector)
        if density.is_profile:
            found += self.logarithms(density.wavevector)
            found -= log_projection(self.surface, density.wavevector)
        return found

    @property
    def roll_off(self) -> Estimate[float]:
        """Median of the roll-off with its 95% interval (Units: m)."""
        return self._estimate(2 * np.pi / np.exp(self.surface[:, 4]))

    @property
    def hurst(self) -> Estimate[float]:
        """Median of the Hurst exponent of the shortest waves with its 95% interval."""
        return self._estimate(self.surface[:, 2])

    @property
    def plateau(self) -> Estimate[float]:
        """Median of C on the plateau with its 95% interval (Units: m^4)."""
        return self._estimate(np.exp(self.surface[:, 0]))

    @property
    def has_roll_off(self) -> bool:
        """Whether the plateau is seen: the roll-off is certainly among the fitted waves."""
        return bool(self.roll_off.high < 2 * np.pi / self.lowest)

    def _estimate(self, values: Array) -> Estimate[float]:
        """Median of a number of every state with its 95% interval."""
        low, middle, high = quantiles(values, self.weight, (0.025, 0.5, 0.975)).tolist()
        return Estimate(middle, math.nan, low, high)


@dataclass(frozen=True, slots=True)
class Continuation:
    """The distribution of the models of one surface and of the instruments of its densities.

    The outer parameters of the quadrature are the logarithm of the wavevector of the roll-off, the
    place of the bend between it and the highest wavevector, and the sharpness of the first
    instrument that takes waves away. The inner ones are the Hurst exponents, what else varies of
    instruments, and the logarithm of the plateau, in which the model is nearly linear: in place of
    q_c stands the loss at the last wavevector of a density.
    """

    models: DensityModels
    departure: float
    """Standard deviation of the logarithm of a density from the model, with any number of modes."""
    limits: Array
    """Of the parameters of P, and of those of instruments that vary. Shape (5 + n_varied, 2)."""
    begin: Array
    """Parameters of instruments that vary, where they were seen. Shape (n_varied,)."""

    @property
    def _lossy(self) -> list[tuple[int, float]]:
        """Columns of the losses in trials, and the logarithms of the wavevectors where they are."""
        varied, items = self.models.varied, self.models.densities
        first = N_SHAPE + np.cumsum(varied.sum(axis=1)) - varied.sum(axis=1)
        lossy = np.flatnonzero(varied[:, 0])
        return [(int(first[one]), math.log(items[one].wavevector[-1])) for one in lossy]

    @property
    def _inner(self) -> list[int]:
        """Columns of the inner parameters in trials."""
        instruments = range(N_SHAPE, N_SHAPE + len(self.begin))
        return [1, 2, *(one for one in instruments if one not in self._outer), 0]

    @property
    def _outer(self) -> list[int]:
        """Columns of the outer parameters in trials."""
        return [4, 3, *(first + 1 for first, _ in self._lossy[:1])]

    @property
    def inner(self) -> Array:
        """Limits of the inner parameters, the last of which has none."""
        return self.limits[self._inner]

    @property
    def outer(self) -> Array:
        """Limits of the outer parameters; of the bend it is a place between two ends."""
        found = self.limits[self._outer]
        found[1] = 0.0, 1.0
        return found

    def start(self, outer: Array) -> Array:
        """First inner parameters; the plateau is the mean of those that the densities give."""
        begin = np.array([0.0, *_ROUGH, 0.0, 0.0, *self.begin])
        inner = np.repeat(begin[None, self._inner], len(outer), axis=0)
        levels = [
            np.average(np.log(item.value) - model, axis=1, weights=item.modes)
            for item, model in self.models(self.trials(inner, outer))
        ]
        inner[:, -1] = np.mean(levels, axis=0)
        return inner

    def value(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance, with the priors."""
        trials, total = self.trials(inner, outer), self._prior(inner, outer)
        for item, model in self.models(trials):
            total += deviances(item, model, self.departure).sum(axis=1) / 2
        return total

    def expansion(self, inner: Array, outer: Array) -> tuple[Array, Array, Array]:
        """Half of the deviance with the priors, its slopes and its curvature."""
        trials, total = self.trials(inner, outer), self._prior(inner, outer)
        size = inner.shape[1] + outer.shape[1]
        slopes, information = np.zeros((len(inner), size)), np.zeros((len(inner), size, size))
        for index, item in enumerate(self.models.densities):
            model, changes = self._changes(trials, index)
            changes = self._of_coordinates(changes, outer)
            modes, apart = weighted_residuals(item, model, self.departure)
            total += np.sum(modes * (np.expm1(apart) - apart), axis=1)
            slopes -= np.einsum("nw,nwp->np", modes * np.expm1(apart), changes)
            # Exact where the model is linear; where it is far above the data it says nothing.
            curvature = modes * np.exp(np.maximum(apart, _LEAST_CURVATURE))
            information += np.swapaxes(changes, 1, 2) @ (curvature[..., None] * changes)
        pull = np.zeros(size)
        pull[:2] = -1 / BEND, 1 / BEND
        slopes += (inner[:, 1] - inner[:, 0])[:, None] / BEND * pull
        information += np.outer(pull, pull)
        return total, slopes, information

    def trials(self, inner: Array, outer: Array) -> Array:
        """Parameters of P and of instruments, (n, 5 + n_varied)."""
        found = np.empty((len(inner), len(self.limits)))
        found[:, self._inner], found[:, self._outer] = inner, outer
        _, least = self._bend(outer)
        found[:, 3] = least + outer[:, 1] * (self.limits[3, 1] - least)
        for column, last in self._lossy:
            found[:, column] = last - np.log(found[:, column]) / found[:, column + 1]
        return found

    def _bend(self, outer: Array) -> tuple[Array, Array]:
        """Whether the roll-off is the lower limit of the bend, and this limit."""
        return outer[:, 0] > self.limits[3, 0], np.maximum(outer[:, 0], self.limits[3, 0])

    def _prior(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance from what is expected of any surface."""
        beyond = np.maximum(self.limits[3, 0] - outer[:, 0], 0.0)
        return ((inner[:, 1] - inner[:, 0]) / BEND) ** 2 / 2 + beyond / _FAR

    def _of_coordinates(self, changes: Array, outer: Array) -> Array:
        """Changes with inner and outer parameters, of those with P and instruments."""
        held, least = self._bend(outer)
        bend = changes[..., 3].copy()
        changes[..., 4] += bend * (held * (1 - outer[:, 1]))[:, None]
        changes[..., 3] = bend * (self.limits[3, 1] - least)[:, None]
        return changes[..., [*self._inner, *self._outer]]

    def _changes(self, trials: Array, index: int) -> tuple[Array, Array]:
        """Model of a density, and its changes with the parameters of trials."""
        item, models = self.models.densities[index], self.models
        instrument = models.instruments(trials)[:, index]
        surface = trials[:, :N_SHAPE]
        if item.is_profile:
            model, shape = log_projection_with_slopes(surface, item.wavevector)
        else:
            model, shape = (
                log_density(surface, item.wavevector),
                log_density_slopes(surface, item.wavevector),
            )
        own = np.zeros((*model.shape, 3))
        if math.isfinite(models.seen[index, 0]):
            loss = loss_exponent(instrument, item.wavevector)
            model = model - loss
            # With the loss at the last wavevector, and with the sharpness at that loss.
            own[..., 0] = -loss / loss[:, -1:]
            own[..., 1] = -loss * np.log(item.wavevector / item.wavevector[-1])
        if math.isfinite(models.seen[index, 2]):
            noisy = np.logaddexp(model, instrument[:, 2:])
            part = np.exp(model - noisy)[..., None]
            shape, own = shape * part, own * part
            own[..., 2] = 1 - part[..., 0]
            model = noisy
        changes = np.zeros((*model.shape, trials.shape[1]))
        changes[..., :N_SHAPE] = shape
        varied = models.varied[index]
        first = N_SHAPE + int(models.varied[:index].sum())
        changes[..., first : first + int(varied.sum())] = own[..., varied]
        return model, changes


def quadrature_of(
    densities: Sequence[tuple[Density, Instrument]],
) -> tuple[Continuation, Quadrature]:
    """Models of one surface and its instruments with a departure that they show, and their states.

    ValueError if the densities do not determine a spectrum.
    """
    model = _continuation(densities, LEAST_DEPARTURE)
    quadrature = Quadrature(model)
    departure = _departure(model, *quadrature.likeliest)
    if departure == LEAST_DEPARTURE:
        return model, quadrature
    model = replace(model, departure=departure)
    return model, Quadrature(model)


def _departure(model: Continuation, inner: Array, outer: Array) -> float:
    """Standard deviation of densities from the likeliest model beyond the noise of their modes.

    That of DerSimonian, Laird, Control. Clin. Trials 7, 177 (1986).
    """
    pairs = list(model.models(model.trials(inner[None], outer[None])))
    modes = np.concatenate([item.modes for item, _ in pairs])
    apart = np.concatenate([np.log(item.value) - found[0] for item, found in pairs])
    excess = float(np.sum(modes * apart**2)) - max(modes.size - inner.size - outer.size, 1)
    freedom = float(np.sum(modes) - np.sum(modes**2) / np.sum(modes))
    return math.sqrt(max(excess / freedom, LEAST_DEPARTURE**2))


def _continuation(
    densities: Sequence[tuple[Density, Instrument]], departure: float
) -> Continuation:
    """Models of one surface and of the instruments that are seen in its densities."""
    count = sum(item.value.size for item, _ in densities)
    if count < 5 or not all(np.all(item.value > 0) for item, _ in densities):
        raise ValueError(
            f"{count} values of a density do not determine a spectrum; use a larger or finer scan"
        )
    low = math.log(min(float(item.wavevector[0]) for item, _ in densities))
    high = math.log(max(float(item.wavevector[-1]) for item, _ in densities))
    seen = np.array([instrument.row for _, instrument in densities])
    varied = np.isfinite(seen)
    varied[:, 1] &= varied[:, 0]
    begin, around = seen.copy(), np.empty((*seen.shape, 2))
    last = np.array([float(item.wavevector[-1]) for item, _ in densities])
    begin[:, 0] = (last * np.exp(-seen[:, 0])) ** seen[:, 1]
    around[:, 0], around[:, 1] = _LOSS, (PUPIL, SHARPEST)
    around[:, 2] = seen[:, 2:] + np.array([-_NOISE, _NOISE])
    models = DensityModels([item for item, _ in densities], seen, varied)
    limits = np.array([*shape_limits(low, high), *around[varied]])
    return Continuation(models, departure, limits, np.clip(begin[varied], *limits[N_SHAPE:].T))


def fit_of(model: Continuation, quadrature: Quadrature, states: States) -> Fit:
    """Models of the states of a quadrature."""
    trials = model.trials(states.inner, states.outer)
    best = quadrature.likeliest
    least = 2 * float(model.value(best[0][None], best[1][None])[0])
    count = sum(item.value.size for item in model.models.densities)
    return Fit(
        surface=trials[:, :N_SHAPE],
        instruments=model.models.instruments(trials),
        weight=states.weight,
        lowest=math.exp(model.limits[3, 0]),
        misfit=least / max(count - trials.shape[1], 1),
    )
