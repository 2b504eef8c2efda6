r"""The self-affine model that continues measured densities, and what instruments do to it.

A density is fitted by :math:`P(q) T(q) + N`: a plateau and two power laws P, their attenuation by
the instrument :math:`T = \exp(-(q/q_c)^m)`, and white noise N. All fits are of the likelihood of
the modes in each bin.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from crackfront.analysis.estimate import Estimate
from crackfront.topography.densities import Density
from crackfront.topography.levelling import Array

_SHAPE = 5
"""Parameters of P: logarithm of the plateau, Hurst exponents at longer and at shorter waves,
logarithms of the wavevectors of bend and roll-off."""

_KNEE = 6.0
"""Sharpness of the knees of the model."""

_INADEQUACY = 0.05
"""Relative error of the model itself, which no number of modes takes away."""

_BEND = 0.3
"""Standard deviation that is expected of the difference of the two Hurst exponents."""

_BEYOND = 8.0
"""How far beyond the longest trusted wavelength a roll-off is looked for: four sides of a scan."""

_SHARPNESS = (1.0, 4.0)
"""Exponents m: of a circular pupil, whose transfer falls linearly at first, to sharp filters."""

_REACH = (0.7, math.nan, 1.0)
"""How far the logarithms of q_c and of the noise go from where they were seen, in a fit of all."""

_GAIN = 9.0
"""What half of the deviance must fall by for an instrument to be seen in a density."""

_DIRECTIONS, _FURTHEST, _POINTS = 400, 8.0, 16
"""Quadrature of the projection, its end in ln(k / q), and the points a decade of the density."""

_WALKERS, _STEPS, _KEPT = 48, 450, 10
"""Size of the Markov chain, and how many of the states of its second half are kept."""

_SEED = np.random.SeedSequence(20240229, spawn_key=(0x5F17,))
"""Noise of the chain, which is thus the same every time."""


@dataclass(frozen=True, slots=True)
class Instrument:
    """What an instrument does to a density."""

    attenuation: float = math.inf
    """Wavevector q_c where the density is down to 1/e; infinite if not seen. (Units: 1 / m)"""
    sharpness: float = 2.0
    """Exponent m of its fall."""
    noise: float = 0.0
    """Density of white noise; 0 if not seen. (Units: that of the density)"""

    def wavelength(self, part: float) -> float:
        """Wavelength at which a part of the density is lost; 0 where nothing is (Units: m)."""
        return 2 * math.pi / self.attenuation / (-math.log1p(-part)) ** (1 / self.sharpness)

    def noisy(self, density: Density, part: float) -> float:
        """Wavelength below which noise adds more than a part to a density; 0 if nowhere."""
        quiet = np.flatnonzero(density.value > self.noise * (1 + 1 / part))
        if self.noise == 0 or (quiet.size and quiet[-1] == density.value.size - 1):
            return 0.0
        last = quiet[-1] if quiet.size else 0
        return float(2 * np.pi / density.wavevector[last])

    @property
    def row(self) -> Array:
        """Parameters of the model: logarithm of q_c, m, logarithm of the noise."""
        noise = math.log(self.noise) if self.noise else -math.inf
        return np.array([math.log(self.attenuation), self.sharpness, noise])


@dataclass(frozen=True, slots=True)
class Fit:
    """Models that agree with densities, states of a Markov chain."""

    surface: Array
    """Parameters of P. Shape (n, 5)."""
    instruments: Array
    """Logarithm of q_c, m and logarithm of the noise of every density. Shape (n, n_density, 3)."""
    lowest: float
    """Lowest wavevector that is fitted. (Units: 1 / m)"""
    misfit: float
    """Least deviance per degree of freedom; 1 where only the number of modes makes noise."""

    def logarithms(self, wavevector: Array) -> Array:
        """Logarithm of C of every state, (n, n_wavevector)."""
        return _logarithm(self.surface, wavevector)

    def median(self, wavevector: Array) -> Array:
        """Median of C (Units: m^4)."""
        return np.asarray(np.exp(np.median(self.logarithms(wavevector), axis=0)))

    def projected_density(self, wavevector: Array) -> Array:
        """Median of C_1D of lines (Units: m^3)."""
        return np.asarray(np.exp(np.median(_projection(self.surface, wavevector), axis=0)))

    def of_state(self, number: int) -> Callable[[Array], Array]:
        """C of one state (Units: m^4)."""
        surface = self.surface[number : number + 1]
        return lambda wavevector: np.asarray(np.exp(_logarithm(surface, wavevector)[0]))

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
            found += _loss(instrument, density.wavevector)
        if density.is_profile:
            found += self.logarithms(density.wavevector)
            found -= _projection(self.surface, density.wavevector)
        return found

    @property
    def roll_off(self) -> Estimate[float]:
        """Median of the roll-off with its 95% interval (Units: m)."""
        return _median(2 * np.pi / np.exp(self.surface[:, 4]))

    @property
    def hurst(self) -> Estimate[float]:
        """Median of the Hurst exponent of the shortest waves with its 95% interval."""
        return _median(self.surface[:, 2])

    @property
    def plateau(self) -> Estimate[float]:
        """Median of C on the plateau with its 95% interval (Units: m^4)."""
        return _median(np.exp(self.surface[:, 0]))

    @property
    def has_roll_off(self) -> bool:
        """Whether the plateau is seen: the roll-off is certainly among the fitted waves."""
        return bool(self.roll_off.high < 2 * np.pi / self.lowest)


def seen_instrument(density: Density) -> Instrument:
    """What an instrument does to a density, where that falls faster or slower than surfaces do.

    What does not make the density much likelier is not there.
    """
    low, high = (math.log(density.wavevector[end]) for end in (0, -1))
    floor = math.log(float(np.min(density.value)))
    nothing = Instrument().row
    limits = np.array([*_limits(low, high), (low, high + 1.0), _SHARPNESS, (floor - 5, floor + 1)])
    tries: list[tuple[list[bool], list[Array]]] = [
        ([False] * 3, [nothing]),
        ([True, True, False], [np.array([low + p * (high - low), 2, 0]) for p in (0.5, 0.7, 0.95)]),
        ([False, False, True], [np.array([0, 2, floor])]),
        ([True] * 3, [np.array([low + p * (high - low), 2, floor]) for p in (0.45, 0.75)]),
    ]
    best, found, shapes = math.inf, nothing, _first_shapes([(density, nothing)], low, high)
    for varied, begins in tries:
        gain = _GAIN * sum(varied) ** 0.5
        if best <= gain:  # No deviance is negative.
            continue
        models = _Models([density], nothing[None], np.array([varied]))
        starts = [np.array([*shape, *begin[varied]]) for begin in begins for shape in shapes]
        cost, parameters = _likeliest(models, starts, limits[[True] * _SHAPE + varied])
        if not any(varied):
            shapes = [parameters]
        if cost < best - gain:
            best, found = cost, models.instruments(parameters[None])[0, 0]
    return Instrument(math.exp(found[0]), float(found[1]), math.exp(found[2]))


@dataclass(frozen=True, slots=True)
class _Models:
    """Models of densities, of which a trial has the parameters of P and some of instruments."""

    densities: list[Density]
    seen: Array
    """Parameters of the instruments where they do not vary. Shape (n_density, 3)."""
    varied: NDArray[np.bool_]
    """Which of them vary, of the same shape."""

    def instruments(self, trials: Array) -> Array:
        """Parameters of the instruments, (n, n_density, 3)."""
        rows = np.repeat(self.seen[None], len(trials), axis=0)
        rows[:, self.varied] = trials[:, _SHAPE:]
        return rows

    def __call__(self, trials: Array) -> Iterator[tuple[Density, Array]]:
        """Every density, and the logarithm of what it should be, (n, n_wavevector)."""
        rows = self.instruments(trials)
        for index, item in enumerate(self.densities):
            yield item, _model(trials[:, :_SHAPE], rows[:, index], item)


def fitted_model(densities: Sequence[tuple[Density, Instrument]]) -> Fit:
    """Models of one surface and of the instruments that are seen in its densities.

    ValueError if the densities do not determine a spectrum.
    """
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
    begin, reach = seen[varied], np.broadcast_to(_REACH, seen.shape)[varied]
    around = begin[:, None] + np.outer(reach, (-1, 1))
    around[np.isnan(reach)] = _SHARPNESS
    limits = np.array([*_limits(low, high), *around])

    models = _Models([item for item, _ in densities], seen, varied)

    def deviance(trials: Array) -> Array:
        inside = ((trials >= limits[:, 0]) & (trials <= limits[:, 1])).all(axis=1)
        inside &= trials[:, 4] <= trials[:, 3]
        total = ((trials[:, 2] - trials[:, 1]) / _BEND) ** 2
        for item, model in models(trials):
            total += _deviances(item, model).sum(axis=1)
        return np.where(inside, total, np.inf)

    shapes = _first_shapes(list(zip(models.densities, seen, strict=True)), low, high)
    _, start = _likeliest(models, [np.array([*shape, *begin]) for shape in shapes], limits)
    rng = np.random.default_rng(_SEED)
    scale = np.array([0.05, 0.05, 0.05, 0.2, 0.1, *[0.05] * begin.size])
    walkers = start + rng.standard_normal((_WALKERS, start.size)) * scale
    walkers[:, 1:] = np.clip(walkers[:, 1:], limits[1:, 0] + 1e-3, limits[1:, 1] - 1e-3)
    walkers[:, 4] = np.minimum(walkers[:, 4], walkers[:, 3])
    states = _chain(deviance, walkers, rng)
    misfit = float(np.min(deviance(states))) / max(count - start.size, 1)
    return Fit(states[:, :_SHAPE], models.instruments(states), math.exp(low), misfit)


def _limits(low: float, high: float) -> tuple[tuple[float, float], ...]:
    """Bounds of the parameters of P where logarithms of wavevectors lie between two numbers."""
    return ((-np.inf, np.inf), (0.0, 1.0), (0.0, 1.0), (low, high), (low - math.log(_BEYOND), high))


def _first_shapes(
    densities: Sequence[tuple[Density, Array]], low: float, high: float
) -> list[Array]:
    """Parameters of P from which fits begin, for three roll-offs."""
    found = []
    for part in (-0.1, 0.15, 0.45):
        shape = np.array([[0.0, 0.7, 0.7, (low + 2 * high) / 3, low + part * (high - low)]])
        models = [_model(shape, row[None], item)[0] for item, row in densities]
        levels = [
            np.average(np.log(item.value) - model, weights=item.modes)
            for (item, _), model in zip(densities, models, strict=True)
        ]
        found.append(np.array([np.mean(levels), *shape[0, 1:]]))
    return found


def _likeliest(models: _Models, starts: Sequence[Array], limits: Array) -> tuple[float, Array]:
    """Half of the least deviance from some starts, and the parameters that have it."""

    def residuals(trials: Array) -> Array:
        roots = [
            np.sign(np.log(item.value) - model) * np.sqrt(np.maximum(_deviances(item, model), 0))
            for item, model in models(trials)
        ]
        return np.concatenate([*roots, (trials[:, 2:3] - trials[:, 1:2]) / _BEND], axis=1)

    def slopes(parameters: Array) -> Array:
        step = np.where(parameters + 1e-5 < limits[:, 1], 1e-5, -1e-5)
        every = residuals(np.concatenate([parameters[None], parameters + np.diag(step)]))
        return np.asarray(((every[1:] - every[0]) / step[:, None]).T)

    fits = (
        least_squares(
            lambda parameters: residuals(parameters[None])[0],
            np.clip(start, limits[:, 0] + 1e-6, limits[:, 1] - 1e-6),
            slopes,
            bounds=limits.T,
            x_scale="jac",
            max_nfev=40,
        )
        for start in starts
    )
    found = min(fits, key=lambda fit: float(fit.cost))
    return float(found.cost), np.asarray(found.x)


def _logarithm(surface: Array, wavevector: Array) -> Array:
    """Logarithm of the model P, (n, n_wavevector)."""
    plateau, long, short = surface.T[:3, :, None]
    beyond_knees = np.log1p(np.exp(_KNEE * (np.log(wavevector) - surface[:, 3:, None]))) / _KNEE
    steeper, beyond = beyond_knees[:, 0], beyond_knees[:, 1]
    return np.asarray(plateau - (2 + 2 * long) * beyond - 2 * (short - long) * steeper)


def _projection(surface: Array, wavevector: Array) -> Array:
    """Logarithm of the projection of the model on a line, (n, n_wavevector)."""
    waves, weights = _projector(tuple(wavevector.tolist()))
    scaled = _logarithm(surface, waves) + 2 * np.log(waves)
    highest = np.max(scaled, axis=1, keepdims=True)
    return np.asarray(np.log(np.exp(scaled - highest) @ weights.T) + highest)


@functools.lru_cache(maxsize=64)
def _projector(wavevector: tuple[float, ...]) -> tuple[Array, Array]:
    """Wavevectors, and weights of their q^2 C in C_1D, (n_wavevector, n): linear between them."""
    last = math.log(wavevector[-1] / wavevector[0]) + _FURTHEST
    count = math.ceil(last / math.log(10) * _POINTS) + 1
    places = np.linspace(0.0, last, count)
    place, weight = np.polynomial.legendre.leggauss(_DIRECTIONS)
    way = _FURTHEST * (1 + place) / 2
    weights = np.zeros((len(wavevector), count))
    for row, wave in zip(weights, wavevector, strict=True):
        k = wave * np.cosh(way)
        share = weight * _FURTHEST / 2 / k / np.pi
        part, first = np.modf(np.clip(np.log(k / wavevector[0]) / places[1], 0, count - 1.000001))
        for index, portion in ((first, 1 - part), (first + 1, part)):
            row += np.bincount(index.astype(int), share * portion, count)
    return wavevector[0] * np.exp(places), weights


def _loss(instrument: Array, wavevector: Array) -> Array:
    """Negative logarithm of the transfer, (n, n_wavevector)."""
    return np.asarray(np.exp(instrument[:, 1:2] * (np.log(wavevector) - instrument[:, :1])))


def _model(surface: Array, instrument: Array, density: Density) -> Array:
    """Logarithm of what a density should be, (n, n_wavevector)."""
    form = _projection if density.is_profile else _logarithm
    found = form(surface, density.wavevector)
    # What one trial sees of its instrument, all do.
    if math.isfinite(instrument[0, 0]):
        found -= _loss(instrument, density.wavevector)
    if math.isfinite(instrument[0, 2]):
        found = np.logaddexp(found, instrument[:, 2:])
    return found


def _deviances(density: Density, model: Array) -> Array:
    """Deviance of the bins from a model, as of means of exponentially distributed powers."""
    modes = 1 / (1 / density.modes + _INADEQUACY**2)
    apart = np.minimum(np.maximum(np.log(density.value) - model, -30.0), 30.0)
    return np.asarray(2 * modes * (np.expm1(apart) - apart))


def _chain(deviance: Callable[[Array], Array], walkers: Array, rng: np.random.Generator) -> Array:
    """States of an affine-invariant ensemble of walkers, from the second half of its steps."""
    n_walker, n_dim = walkers.shape
    half, kept = n_walker // 2, []
    halves = slice(0, half), slice(half, None)
    cost = deviance(walkers)
    for step in range(_STEPS):
        for part, other in (halves, halves[::-1]):
            stretch = (1 + rng.uniform(size=half)) ** 2 / 2
            anchor = walkers[other][rng.integers(half, size=half)]
            trial = anchor + stretch[:, None] * (walkers[part] - anchor)
            new = deviance(trial)
            gain = (n_dim - 1) * np.log(stretch) - (new - cost[part]) / 2
            accepted = np.log(rng.uniform(size=half)) < gain
            walkers[part] = np.where(accepted[:, None], trial, walkers[part])
            cost[part] = np.where(accepted, new, cost[part])
        if step % (_STEPS // 2 // _KEPT) == 0 and step >= _STEPS // 2:
            kept.append(walkers.copy())
    return np.concatenate(kept[-_KEPT:])


def _median(values: Array) -> Estimate[float]:
    """Median with a 95% interval."""
    low, middle, high = np.quantile(values, (0.025, 0.5, 0.975)).tolist()
    return Estimate(middle, math.nan, low, high)
