"""Models of a surface and its instruments, fitted to the densities of all scans."""

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

_ROLL_OFF_DECAY = 2.0
"""Decay length of the prior of ln(roll-off) beyond the fitted waves."""

_LOSS_BOUNDS = (1e-3, 8.0)
"""Bounds of -ln(T) at the last wavevector of a density."""

_NOISE_RANGE = 1.0
"""Largest distance of the logarithm of the noise from its first estimate."""

_LEAST_CURVATURE = -2.0
"""Lower bound of ln(measured over model) in the curvature of the deviance, which vanishes below."""

_FIRST_HURST = np.array([0.7, 0.7])
"""Hurst exponents at long and short waves with which fits begin."""

INTERVAL = (0.025, 0.5, 0.975)
"""Quantiles at the lower end, median and upper end of an interval."""


@dataclass(frozen=True, slots=True)
class Fit:
    """Models that agree with the densities: n weighted states over their parameters."""

    surface: Array
    """Parameters of P. Shape (n, 5)."""
    instruments: Array
    """Logarithm of q_c, m and logarithm of the noise of every density. Shape (n, n_density, 3)."""
    weight: Array
    """Weights of the states; their sum is 1. Shape (n,)."""
    lowest: float
    """Lowest fitted wavevector. (Units: 1 / m)"""
    misfit: float
    """Least deviance per degree of freedom; about 1 if statistics is the only error."""

    def logarithms(self, wavevector: Array) -> Array:
        """Logarithm of C for every state, (n, n_wavevector)."""
        return log_density(self.surface, wavevector)

    def median(self, wavevector: Array) -> Array:
        """Median of C (Units: m^4)."""
        return np.exp(quantiles(self.logarithms(wavevector), self.weight, 0.5))

    def projected_density(self, wavevector: Array) -> Array:
        """Median of C_1D of lines (Units: m^3)."""
        return np.exp(quantiles(log_projection(self.surface, wavevector), self.weight, 0.5))

    def isotropic(self, density: Density, index: int, *, restored: bool = True) -> Array:
        """Logarithm of C from a measured density, for every state, (n, n_wavevector).

        The noise of instrument number `index` is subtracted. Its attenuation is corrected if
        `restored`. C_1D is converted by the model's ratio of C to its projection.
        """
        instrument = self.instruments[:, index]
        clean = density.value - np.exp(instrument[:, 2:])
        # Noise is a small part of trusted waves, but limits by the user may include more of it.
        least_part = 0.1 if restored else 1e-3
        logarithm = np.log(np.maximum(clean, least_part * density.value))
        if restored:
            logarithm += loss_exponent(instrument, density.wavevector)
        if density.is_profile:
            logarithm += self.logarithms(density.wavevector)
            logarithm -= log_projection(self.surface, density.wavevector)
        return logarithm

    @property
    def roll_off(self) -> Estimate[float]:
        """Median of the roll-off with its 95% interval (Units: m)."""
        return self._estimate(2 * np.pi / np.exp(self.surface[:, 4]))

    @property
    def hurst(self) -> Estimate[float]:
        """Median of the Hurst exponent at the shortest waves with its 95% interval."""
        return self._estimate(self.surface[:, 2])

    @property
    def plateau(self) -> Estimate[float]:
        """Median of C on the plateau with its 95% interval (Units: m^4)."""
        return self._estimate(np.exp(self.surface[:, 0]))

    @property
    def has_roll_off(self) -> bool:
        """Whether the 95% interval of the roll-off is within the fitted waves."""
        return bool(self.roll_off.high < 2 * np.pi / self.lowest)

    def _estimate(self, values: Array) -> Estimate[float]:
        """Median over the states with its 95% interval."""
        low, middle, high = quantiles(values, self.weight, INTERVAL).tolist()
        return Estimate(middle, math.nan, low, high)


@dataclass(frozen=True, slots=True)
class Continuation:
    """The likelihood of models of one surface and the instruments of its densities.

    It has the interface `Likelihood` of `spectrum.quadrature`. The outer
    parameters are the logarithm of the roll-off's wavevector, the position of the bend between it
    and the highest wavevector, and the sharpness of the first instrument with attenuation. The
    inner parameters are the two Hurst exponents, the other parameters of instruments that vary,
    and the logarithm of the plateau. The model is nearly linear in the inner parameters, because
    the loss at the last wavevector of a density replaces q_c.

    Trials have the parameters of P, then the parameters of instruments that vary.
    """

    models: DensityModels
    departure: float
    """Standard deviation of the logarithm of a density from the model, for any number of modes."""
    limits: Array
    """Limits of the parameters of P and of instruments that vary. Shape (5 + n_varied, 2)."""
    begin: Array
    """First values of parameters of instruments that vary. Shape (n_varied,)."""

    @property
    def _losses(self) -> list[tuple[int, float]]:
        """Columns of the losses in trials, and logarithms of the last wavevectors."""
        varied, densities = self.models.varied, self.models.densities
        first = N_SHAPE + np.cumsum(varied.sum(axis=1)) - varied.sum(axis=1)
        return [
            (int(first[index]), math.log(densities[index].wavevector[-1]))
            for index in np.flatnonzero(varied[:, 0])
        ]

    @property
    def _inner(self) -> list[int]:
        """Columns of the inner parameters in trials."""
        instruments = range(N_SHAPE, N_SHAPE + len(self.begin))
        return [1, 2, *(column for column in instruments if column not in self._outer), 0]

    @property
    def _outer(self) -> list[int]:
        """Columns of the outer parameters in trials."""
        return [4, 3, *(loss + 1 for loss, _ in self._losses[:1])]

    @property
    def inner(self) -> Array:
        """Limits of the inner parameters; the last one is unlimited."""
        return self.limits[self._inner]

    @property
    def outer(self) -> Array:
        """Limits of the outer parameters; the position of the bend is relative."""
        limits = self.limits[self._outer]
        limits[1] = 0.0, 1.0
        return limits

    def start(self, outer: Array) -> Array:
        """First inner parameters; the plateau is the mean of the plateaus of all densities."""
        begin = np.array([0.0, *_FIRST_HURST, 0.0, 0.0, *self.begin])
        inner = np.repeat(begin[None, self._inner], len(outer), axis=0)
        levels = [
            np.average(np.log(density.value) - model, axis=1, weights=density.modes)
            for density, model in self.models(self.trials(inner, outer))
        ]
        inner[:, -1] = np.mean(levels, axis=0)
        return inner

    def value(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance, including the priors."""
        trials, total = self.trials(inner, outer), self._prior(inner, outer)
        for density, model in self.models(trials):
            total += deviances(density, model, self.departure).sum(axis=1) / 2
        return total

    def expansion(self, inner: Array, outer: Array) -> tuple[Array, Array, Array]:
        """Half of the deviance, including the priors, its slopes and its curvature."""
        trials, total = self.trials(inner, outer), self._prior(inner, outer)
        size = inner.shape[1] + outer.shape[1]
        slopes, information = np.zeros((len(inner), size)), np.zeros((len(inner), size, size))
        for index, density in enumerate(self.models.densities):
            model, derivatives = self._derivatives(trials, index)
            derivatives = self._by_inner_and_outer(derivatives, outer)
            modes, residuals = weighted_residuals(density, model, self.departure)
            total += np.sum(modes * (np.expm1(residuals) - residuals), axis=1)
            slopes -= np.einsum("nw,nwp->np", modes * np.expm1(residuals), derivatives)
            # Exact for a linear model. Far above the data the curvature would be too small.
            curvature = modes * np.exp(np.maximum(residuals, _LEAST_CURVATURE))
            information += np.swapaxes(derivatives, 1, 2) @ (curvature[..., None] * derivatives)
        bend_prior = np.zeros(size)
        bend_prior[:2] = -1 / BEND, 1 / BEND
        slopes += (inner[:, 1] - inner[:, 0])[:, None] / BEND * bend_prior
        information += np.outer(bend_prior, bend_prior)
        return total, slopes, information

    def trials(self, inner: Array, outer: Array) -> Array:
        """Trials from inner and outer parameters, (n, 5 + n_varied)."""
        trials = np.empty((len(inner), len(self.limits)))
        trials[:, self._inner], trials[:, self._outer] = inner, outer
        lowest_bend = self._lowest_bend(outer)
        trials[:, 3] = lowest_bend + outer[:, 1] * (self.limits[3, 1] - lowest_bend)
        for column, last in self._losses:
            trials[:, column] = last - np.log(trials[:, column]) / trials[:, column + 1]
        return trials

    def _lowest_bend(self, outer: Array) -> Array:
        """Logarithm of the lowest wavevector of the bend: the roll-off, or the lowest fitted."""
        return np.maximum(outer[:, 0], self.limits[3, 0])

    def _prior(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance of the priors, for the Hurst exponents and the roll-off."""
        beyond = np.maximum(self.limits[3, 0] - outer[:, 0], 0.0)
        return ((inner[:, 1] - inner[:, 0]) / BEND) ** 2 / 2 + beyond / _ROLL_OFF_DECAY

    def _by_inner_and_outer(self, derivatives: Array, outer: Array) -> Array:
        """Derivatives by inner and outer parameters, from those by the parameters of trials."""
        moves_with_roll_off = outer[:, 0] > self.limits[3, 0]
        by_bend = derivatives[..., 3].copy()
        derivatives[..., 4] += by_bend * (moves_with_roll_off * (1 - outer[:, 1]))[:, None]
        derivatives[..., 3] = by_bend * (self.limits[3, 1] - self._lowest_bend(outer))[:, None]
        return derivatives[..., [*self._inner, *self._outer]]

    def _derivatives(self, trials: Array, index: int) -> tuple[Array, Array]:
        """Model of a density, and its derivatives by trials, with losses in place of q_c."""
        density, models = self.models.densities[index], self.models
        instrument = models.instruments(trials)[:, index]
        surface = trials[:, :N_SHAPE]
        if density.is_profile:
            model, by_surface = log_projection_with_slopes(surface, density.wavevector)
        else:
            model = log_density(surface, density.wavevector)
            by_surface = log_density_slopes(surface, density.wavevector)
        by_instrument = np.zeros((*model.shape, 3))
        if math.isfinite(models.fixed[index, 0]):
            loss = loss_exponent(instrument, density.wavevector)
            model = model - loss
            # By the loss at the last wavevector, and by the sharpness at constant loss there.
            by_instrument[..., 0] = -loss / loss[:, -1:]
            by_instrument[..., 1] = -loss * np.log(density.wavevector / density.wavevector[-1])
        if math.isfinite(models.fixed[index, 2]):
            noisy = np.logaddexp(model, instrument[:, 2:])
            part = np.exp(model - noisy)[..., None]
            by_surface, by_instrument = by_surface * part, by_instrument * part
            by_instrument[..., 2] = 1 - part[..., 0]
            model = noisy
        derivatives = np.zeros((*model.shape, trials.shape[1]))
        derivatives[..., :N_SHAPE] = by_surface
        varied = models.varied[index]
        first = N_SHAPE + int(models.varied[:index].sum())
        derivatives[..., first : first + int(varied.sum())] = by_instrument[..., varied]
        return model, derivatives


def likelihood_with_quadrature(
    densities: Sequence[tuple[Density, Instrument]],
) -> tuple[Continuation, Quadrature]:
    """Likelihood of models of one surface and its instruments, and its quadrature.

    Each density comes with its instrument. ValueError if they do not determine a spectrum.
    """
    model = _continuation(densities, LEAST_DEPARTURE)
    quadrature = Quadrature(model)
    departure = _departure(model, *quadrature.likeliest)
    if departure == LEAST_DEPARTURE:
        return model, quadrature
    model = replace(model, departure=departure)
    return model, Quadrature(model)


def _departure(model: Continuation, inner: Array, outer: Array) -> float:
    """Standard deviation of densities from the likeliest model, in excess of their statistics.

    By the method of DerSimonian, Laird, Control. Clin. Trials 7, 177 (1986).
    """
    pairs = list(model.models(model.trials(inner[None], outer[None])))
    modes = np.concatenate([density.modes for density, _ in pairs])
    residuals = np.concatenate(
        [np.log(density.value) - logarithms[0] for density, logarithms in pairs]
    )
    excess = float(np.sum(modes * residuals**2)) - max(modes.size - inner.size - outer.size, 1)
    freedom = float(np.sum(modes) - np.sum(modes**2) / np.sum(modes))
    return math.sqrt(max(excess / freedom, LEAST_DEPARTURE**2))


def _continuation(
    densities: Sequence[tuple[Density, Instrument]], departure: float
) -> Continuation:
    """Likelihood of models of one surface and of the instruments of its densities."""
    count = sum(density.value.size for density, _ in densities)
    if count < 5 or not all(np.all(density.value > 0) for density, _ in densities):
        raise ValueError(
            f"{count} values of a density do not determine a spectrum; use a larger or finer scan"
        )
    low = math.log(min(float(density.wavevector[0]) for density, _ in densities))
    high = math.log(max(float(density.wavevector[-1]) for density, _ in densities))
    fixed = np.array([instrument.row for _, instrument in densities])
    varied = np.isfinite(fixed)
    varied[:, 1] &= varied[:, 0]
    begin, bounds = fixed.copy(), np.empty((*fixed.shape, 2))
    last = np.array([float(density.wavevector[-1]) for density, _ in densities])
    begin[:, 0] = (last * np.exp(-fixed[:, 0])) ** fixed[:, 1]
    bounds[:, 0], bounds[:, 1] = _LOSS_BOUNDS, (PUPIL, SHARPEST)
    bounds[:, 2] = fixed[:, 2:] + np.array([-_NOISE_RANGE, _NOISE_RANGE])
    models = DensityModels([density for density, _ in densities], fixed, varied)
    limits = np.array([*shape_limits(low, high), *bounds[varied]])
    return Continuation(models, departure, limits, np.clip(begin[varied], *limits[N_SHAPE:].T))


def fit_to_states(model: Continuation, quadrature: Quadrature, states: States) -> Fit:
    """Models of the states of a quadrature."""
    trials = model.trials(states.inner, states.outer)
    best = quadrature.likeliest
    least = 2 * float(model.value(best[0][None], best[1][None])[0])
    count = sum(density.value.size for density in model.models.densities)
    return Fit(
        surface=trials[:, :N_SHAPE],
        instruments=model.models.instruments(trials),
        weight=states.weight,
        lowest=math.exp(model.limits[3, 0]),
        misfit=least / max(count - trials.shape[1], 1),
    )
