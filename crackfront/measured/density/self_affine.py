r"""The self-affine model of a density, and what an instrument does to it.

A density is :math:`P(q) T(q) + N`: a plateau and two power laws P, their attenuation by the
instrument :math:`T = \exp(-(q/q_c)^m)`, and white noise N. What is likely follows from the modes in
each bin.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import expit

from crackfront.core.arrays import Array
from crackfront.measured.density.densities import Density

N_SHAPE = 5
"""Parameters of P: logarithm of the plateau, Hurst exponents at longer and at shorter waves,
logarithms of the wavevectors of bend and roll-off."""

_KNEE = 6.0
"""Sharpness of the knees of the model."""

LEAST_DEPARTURE = 0.05
"""Least relative departure of a surface from the model, which no number of modes takes away."""

BEND = 0.3
"""Standard deviation that is expected of the difference of the two Hurst exponents."""

_BEYOND = 8.0
"""How far beyond the longest trusted wavelength a roll-off is looked for: four sides of a scan."""

PUPIL, GAUSSIAN, SHARPEST = 1.0, 2.0, 4.0
"""Exponents m: of a circular pupil, whose transfer falls linearly at first, of a Gaussian spot, and
of sharp filters."""

_SHORT, _LONG = 30, 400
"""Evaluations of fits from several starts, and of the best one."""

_UNLIKELY, _DISTINCT = 6.0, 0.1
"""Excess of half of the deviance from which a minimum is left out, and difference of a parameter
from which two minima are distinct."""

_GAIN = 9.0
"""Fall of half of the deviance, over the root of the parameters, that shows an instrument."""

_DIRECTIONS, _FURTHEST, _POINTS = 400, 8.0, 16
"""Quadrature of the projection, its end in ln(k / q), and the points a decade of the density."""


@dataclass(frozen=True, slots=True)
class Instrument:
    """What an instrument does to a density."""

    attenuation: float = math.inf
    """Wavevector q_c where the density is down to 1/e; infinite if not seen. (Units: 1 / m)"""
    sharpness: float = 2.0
    """Exponent m of its fall."""
    noise: float = 0.0
    """Density of white noise; 0 if not seen. (Units: that of the density)"""

    def loss_wavelength(self, part: float) -> float:
        """Wavelength at which a part of the density is lost; 0 where nothing is (Units: m)."""
        return 2 * math.pi / self.attenuation / (-math.log1p(-part)) ** (1 / self.sharpness)

    def noise_wavelength(self, density: Density, part: float) -> float:
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
class DensityModels:
    """Models of densities, of which a trial has the parameters of P and some of instruments."""

    densities: list[Density]
    seen: Array
    """Parameters of the instruments where they do not vary. Shape (n_density, 3)."""
    varied: NDArray[np.bool_]
    """Which of them vary, of the same shape."""

    def instruments(self, trials: Array) -> Array:
        """Parameters of the instruments, (n, n_density, 3)."""
        rows = np.repeat(self.seen[None], len(trials), axis=0)
        rows[:, self.varied] = trials[:, N_SHAPE:]
        return rows

    def __call__(self, trials: Array) -> Iterator[tuple[Density, Array]]:
        """Every density, and the logarithm of what it should be, (n, n_wavevector)."""
        rows, surface = self.instruments(trials), trials[:, :N_SHAPE]
        shapes: dict[tuple[bool, bytes], Array] = {}
        for index, item in enumerate(self.densities):
            # Scans of equal sides and pixels have equal wavevectors.
            key = item.is_profile, item.wavevector.tobytes()
            if key not in shapes:
                shapes[key] = _shape(surface, item)
            yield item, _seen(shapes[key], rows[:, index], item)


def seen_instrument(density: Density, bluntest: float = PUPIL) -> Instrument:
    """Instrument whose attenuation and noise make a density much likelier than a surface alone.

    An effect that does not is left out. The exponents of attenuations begin at the bluntest.
    """
    low, high = (math.log(density.wavevector[end]) for end in (0, -1))
    floor = math.log(float(np.min(density.value)))
    nothing = Instrument().row
    limits = np.array(
        [*shape_limits(low, high), (low, high + 1.0), (bluntest, SHARPEST), (floor - 5, floor + 1)]
    )
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
        models = DensityModels([density], nothing[None], np.array([varied]))
        starts = [np.array([*shape, *begin[varied]]) for begin in begins for shape in shapes]
        costs, minima = _minima(models, starts, limits[[True] * N_SHAPE + varied])
        if np.min(costs) < best - gain:
            best = float(np.min(costs))
            found = models.instruments(_by_likelihood(costs, minima)[None])[0, 0]
    return Instrument(math.exp(found[0]), float(found[1]), math.exp(found[2]))


def shape_limits(low: float, high: float) -> tuple[tuple[float, float], ...]:
    """Bounds of the parameters of P where logarithms of wavevectors lie between two numbers."""
    return ((-np.inf, np.inf), (0.0, 1.0), (0.0, 1.0), (low, high), (low - math.log(_BEYOND), high))


def _first_shapes(
    densities: Sequence[tuple[Density, Array]], low: float, high: float
) -> list[Array]:
    """Parameters of P from which fits begin: for three roll-offs, with a late and an early bend."""
    found, width = [], high - low
    for part, place, long, short in (
        (-0.1, 0.67, 0.7, 0.7),
        (0.15, 0.67, 0.7, 0.7),
        (0.45, 0.67, 0.7, 0.7),
        (0.15, 0.87, 0.2, 0.9),
        (0.15, 0.1, 0.95, 0.8),
    ):
        shape = np.array([[0.0, long, short, low + place * width, low + part * width]])
        models = [_seen(_shape(shape, item), row[None], item)[0] for item, row in densities]
        levels = [
            np.average(np.log(item.value) - model, weights=item.modes)
            for (item, _), model in zip(densities, models, strict=True)
        ]
        found.append(np.array([np.mean(levels), *shape[0, 1:]]))
    return found


def _minima(models: DensityModels, starts: Sequence[Array], limits: Array) -> tuple[Array, Array]:
    """Halves of the deviance at its minima, (n,), and their parameters, (n, n_parameter).

    Several starts may have found the same one. Minima that are much less likely are left out.
    """

    def residuals(trials: Array) -> Array:
        roots = [
            np.sign(np.log(item.value) - model) * np.sqrt(np.maximum(deviances(item, model), 0))
            for item, model in models(trials)
        ]
        return np.concatenate([*roots, (trials[:, 2:3] - trials[:, 1:2]) / BEND], axis=1)

    def slopes(parameters: Array) -> Array:
        step = np.where(parameters + 1e-5 < limits[:, 1], 1e-5, -1e-5)
        every = residuals(np.concatenate([parameters[None], parameters + np.diag(step)]))
        return np.asarray(((every[1:] - every[0]) / step[:, None]).T)

    def fitted(start: Array, evaluations: int) -> scipy.optimize.OptimizeResult:
        return scipy.optimize.least_squares(
            lambda parameters: residuals(parameters[None])[0],
            np.clip(start, limits[:, 0] + 1e-6, limits[:, 1] - 1e-6),
            slopes,
            bounds=limits.T,
            x_scale="jac",
            max_nfev=evaluations,
        )

    # Short fits, and those that may matter to their ends: valleys of the deviance are flat.
    short = [fitted(start, _SHORT) for start in starts]
    worst = min(fit.cost for fit in short) + _UNLIKELY
    found = [fitted(fit.x, _LONG) for fit in short if fit.cost < worst]
    return np.array([fit.cost for fit in found]), np.array([fit.x for fit in found])


def _by_likelihood(costs: Array, minima: Array) -> Array:
    """Mean of minima, (n, n_parameter), by likelihood; those of one instrument count once."""
    instruments = minima[:, N_SHAPE:]
    apart = (instruments[:, None] - instruments[None]) / _DISTINCT
    copies = np.exp(-0.5 * np.sum(np.square(apart), axis=2)).sum(axis=1)
    return np.average(minima, axis=0, weights=np.exp(np.min(costs) - costs) / copies)


def log_density(surface: Array, wavevector: Array) -> Array:
    """Logarithm of the model P, (n, n_wavevector)."""
    plateau, long, short = surface.T[:3, :, None]
    beyond_knees = np.log1p(np.exp(_KNEE * (np.log(wavevector) - surface[:, 3:, None]))) / _KNEE
    steeper, beyond = beyond_knees[:, 0], beyond_knees[:, 1]
    return np.asarray(plateau - (2 + 2 * long) * beyond - 2 * (short - long) * steeper)


def log_density_slopes(surface: Array, wavevector: Array) -> Array:
    """Change of the logarithm of P with each of its parameters, (n, n_wavevector, 5)."""
    _, long, short = surface.T[:3, :, None]
    place = _KNEE * (np.log(wavevector) - surface[:, 3:, None])
    steeper, beyond = np.moveaxis(np.logaddexp(0, place) / _KNEE, 1, 0)
    passed = np.moveaxis(expit(place), 1, 0)
    return np.stack(
        [
            np.ones_like(beyond),
            2 * (steeper - beyond),
            -2 * steeper,
            2 * (short - long) * passed[0],
            (2 + 2 * long) * passed[1],
        ],
        axis=2,
    )


def log_projection_with_slopes(surface: Array, wavevector: Array) -> tuple[Array, Array]:
    """Logarithm of the projection of the model, and its change with each parameter of P."""
    waves, weights = _projector(tuple(wavevector.tolist()))
    scaled = log_density(surface, waves) + 2 * np.log(waves)
    highest = np.max(scaled, axis=1, keepdims=True)
    power = np.exp(scaled - highest)
    total = power @ weights.T
    parts = np.einsum(
        "nkp,wk->nwp", power[..., None] * log_density_slopes(surface, waves), weights, optimize=True
    )
    return np.log(total) + highest, parts / total[..., None]


def log_projection(surface: Array, wavevector: Array) -> Array:
    """Logarithm of the projection of the model on a line, (n, n_wavevector)."""
    waves, weights = _projector(tuple(wavevector.tolist()))
    scaled = log_density(surface, waves) + 2 * np.log(waves)
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


def loss_exponent(instrument: Array, wavevector: Array) -> Array:
    """Negative logarithm of the transfer, (n, n_wavevector)."""
    return np.asarray(np.exp(instrument[:, 1:2] * (np.log(wavevector) - instrument[:, :1])))


def _shape(surface: Array, density: Density) -> Array:
    """Logarithm of what a density of the surface is, (n, n_wavevector)."""
    form = log_projection if density.is_profile else log_density
    return form(surface, density.wavevector)


def _seen(shape: Array, instrument: Array, density: Density) -> Array:
    """Logarithm of what an instrument makes of a density, (n, n_wavevector)."""
    # What one trial sees of its instrument, all do.
    if math.isfinite(instrument[0, 0]):
        shape = shape - loss_exponent(instrument, density.wavevector)
    if math.isfinite(instrument[0, 2]):
        shape = np.logaddexp(shape, instrument[:, 2:])
    return shape


def weighted_residuals(density: Density, model: Array, departure: float) -> tuple[Array, Array]:
    """Modes in the bins, fewer as surfaces depart from models, and logarithms of value to model."""
    modes = 1 / (1 / density.modes + departure**2)
    return modes, np.clip(np.log(density.value) - model, -30.0, 30.0)


def deviances(density: Density, model: Array, departure: float = LEAST_DEPARTURE) -> Array:
    """Deviance of the bins from a model, as of means of exponentially distributed powers."""
    modes, apart = weighted_residuals(density, model, departure)
    return np.asarray(2 * modes * (np.expm1(apart) - apart))
