r"""The self-affine model of a density, with the effect of the instrument.

A density is :math:`P(q) T(q) + N`: a plateau and two power laws P, their attenuation by the
instrument :math:`T = \exp(-(q/q_c)^m)`, and white noise N. The number of modes in each bin decides
the likelihood.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from crackfront.core.arrays import Array
from crackfront.measured.density.densities import Density

N_SHAPE = 5
"""Number of parameters of P: logarithm of the plateau, Hurst exponents at long and at short waves,
logarithms of the wavevectors of the bend between them and of the roll-off."""

_KNEE_SHARPNESS = 6.0
"""Sharpness of bend and roll-off."""

LEAST_DEPARTURE = 0.05
"""Least relative standard deviation of a surface's density from the model."""

BEND = 0.3
"""Prior standard deviation of the difference of the two Hurst exponents."""

_LONGEST_ROLL_OFF = 8.0
"""Longest roll-off over the longest trusted wavelength: four sides of a scan."""

PUPIL = 1.0
"""Exponent m of a circular pupil, whose transfer falls linearly at first."""

GAUSSIAN = 2.0
"""Exponent m of a Gaussian spot."""

SHARPEST = 4.0
"""Exponent m of sharp filters, the largest."""

_EVALUATIONS_FIRST = 30
"""Evaluations of the first fit from each start."""

_EVALUATIONS_LAST = 400
"""Evaluations of the fits that continue from the best minima."""

_UNLIKELY = 6.0
"""Excess of half of the deviance at which a minimum is ignored."""

_DISTINCT = 0.1
"""Difference of parameters at which two minima are distinct."""

_GAIN = 9.0
"""Decrease of half of the deviance by an instrument, over the root of its number of parameters."""

_PROJECTION_NODES = 400
"""Nodes of the quadrature of a projection."""

_PROJECTION_END = 8.0
"""End of this quadrature in arccosh(k / q)."""

_PROJECTION_POINTS = 16
"""Points of the density in a decade, between which the projection interpolates."""


@dataclass(frozen=True, slots=True)
class Instrument:
    """Attenuation of a density by an instrument, and its noise."""

    attenuation: float = math.inf
    """Wavevector q_c with T = 1/e; infinite without attenuation. (Units: 1 / m)"""
    sharpness: float = 2.0
    """Exponent m of the attenuation."""
    noise: float = 0.0
    """Density N of white noise. (Units: as the density)"""

    def loss_wavelength(self, part: float) -> float:
        """Wavelength at which a part of the density is lost; 0 without attenuation (Units: m)."""
        return 2 * math.pi / self.attenuation / (-math.log1p(-part)) ** (1 / self.sharpness)

    def noise_wavelength(self, density: Density, part: float) -> float:
        """Wavelength below which noise adds more than a part to a density, or 0 (Units: m)."""
        quiet = np.flatnonzero(density.value > self.noise * (1 + 1 / part))
        if self.noise == 0 or (quiet.size and quiet[-1] == density.value.size - 1):
            return 0.0
        last = quiet[-1] if quiet.size else 0
        return float(2 * np.pi / density.wavevector[last])

    @property
    def row(self) -> Array:
        """Parameters for models: logarithm of q_c, m, logarithm of the noise."""
        noise = math.log(self.noise) if self.noise else -math.inf
        return np.array([math.log(self.attenuation), self.sharpness, noise])


@dataclass(frozen=True, slots=True)
class DensityModels:
    """Models of densities. A trial has the parameters of P, then those that vary of instruments."""

    densities: list[Density]
    fixed: Array
    """Parameters of the instruments, of which some vary. Shape (n_density, 3)."""
    varied: NDArray[np.bool_]
    """Whether a parameter varies. Shape (n_density, 3)."""

    def instruments(self, trials: Array) -> Array:
        """Parameters of the instruments, (n, n_density, 3)."""
        rows = np.repeat(self.fixed[None], len(trials), axis=0)
        rows[:, self.varied] = trials[:, N_SHAPE:]
        return rows

    def __call__(self, trials: Array) -> Iterator[tuple[Density, Array]]:
        """Every density, and the logarithm of its model for all trials, (n, n_wavevector)."""
        rows, surface = self.instruments(trials), trials[:, :N_SHAPE]
        shapes: dict[tuple[bool, bytes], Array] = {}
        for index, density in enumerate(self.densities):
            # Scans of equal sides and pixels have equal wavevectors.
            key = density.is_profile, density.wavevector.tobytes()
            if key not in shapes:
                shapes[key] = _surface_model(surface, density)
            yield density, _measured_model(shapes[key], rows[:, index], density)


def fitted_instrument(density: Density, bluntest: float = PUPIL) -> Instrument:
    """Instrument that makes a density much likelier than a surface alone.

    Attenuation and noise are left out unless they do. `bluntest` is the smallest exponent m.
    """
    low, high = math.log(density.wavevector[0]), math.log(density.wavevector[-1])
    floor = math.log(float(np.min(density.value)))
    nothing = Instrument().row
    limits = np.array(
        [*shape_limits(low, high), (low, high + 1.0), (bluntest, SHARPEST), (floor - 5, floor + 1)]
    )
    # Which of q_c, m and noise vary, and where q_c begins as a part of the range of wavevectors.
    attempts: list[tuple[list[bool], tuple[float, ...]]] = [
        ([False, False, False], (0.0,)),
        ([True, True, False], (0.5, 0.7, 0.95)),
        ([False, False, True], (0.0,)),
        ([True, True, True], (0.45, 0.75)),
    ]
    best, row, shapes = math.inf, nothing, _first_shapes([(density, nothing)], low, high)
    for varied, parts in attempts:
        gain = _GAIN * sum(varied) ** 0.5
        if best <= gain:  # A deviance is never negative.
            continue
        models = DensityModels([density], nothing[None], np.array([varied]))
        begins = [np.array([low + part * (high - low), GAUSSIAN, floor]) for part in parts]
        starts = [np.array([*shape, *begin[varied]]) for begin in begins for shape in shapes]
        # A surface alone that is so likely needs no instrument, however much likelier it may get.
        enough = 0.0 if any(varied) else _GAIN
        costs, minima = _minima(models, starts, limits[[True] * N_SHAPE + varied], enough)
        if np.min(costs) < best - gain:
            best = float(np.min(costs))
            row = models.instruments(_likely_mean(costs, minima)[None])[0, 0]
    return Instrument(math.exp(row[0]), float(row[1]), math.exp(row[2]))


def shape_limits(low: float, high: float) -> tuple[tuple[float, float], ...]:
    """Bounds of the parameters of P, for logarithms of wavevectors between `low` and `high`."""
    lowest_roll_off = low - math.log(_LONGEST_ROLL_OFF)
    return (-np.inf, np.inf), (0.0, 1.0), (0.0, 1.0), (low, high), (lowest_roll_off, high)


def _first_shapes(
    densities: Sequence[tuple[Density, Array]], low: float, high: float
) -> list[Array]:
    """Parameters of P from which fits begin, for several roll-offs and bends."""
    starts, width = [], high - low
    for roll_off, bend, long, short in (
        (-0.1, 0.67, 0.7, 0.7),
        (0.15, 0.67, 0.7, 0.7),
        (0.45, 0.67, 0.7, 0.7),
        (0.15, 0.87, 0.2, 0.9),
        (0.15, 0.1, 0.95, 0.8),
    ):
        shape = np.array([[0.0, long, short, low + bend * width, low + roll_off * width]])
        levels = []
        for density, instrument in densities:
            model = _measured_model(_surface_model(shape, density), instrument[None], density)[0]
            levels.append(np.average(np.log(density.value) - model, weights=density.modes))
        starts.append(np.array([np.mean(levels), *shape[0, 1:]]))
    return starts


def _minima(
    models: DensityModels, starts: Sequence[Array], limits: Array, enough: float
) -> tuple[Array, Array]:
    """Halves of the deviance at its minima, (n,), and their parameters, (n, n_parameter).

    Several starts may lead to the same minimum. Unlikely minima are left out. A fit with half of
    the deviance `enough` or less ends the search, and is then the only one.
    """

    def residuals(trials: Array) -> Array:
        roots = []
        for density, model in models(trials):
            modes, ratios = weighted_residuals(density, model, LEAST_DEPARTURE)
            deviance = 2 * modes * (np.expm1(ratios) - ratios)
            roots.append(np.sign(ratios) * np.sqrt(np.maximum(deviance, 0)))
        return np.concatenate([*roots, (trials[:, 2:3] - trials[:, 1:2]) / BEND], axis=1)

    def slopes(parameters: Array) -> Array:
        step = np.where(parameters + 1e-5 < limits[:, 1], 1e-5, -1e-5)
        shifted = np.concatenate([parameters[None], parameters + np.diag(step)])
        values = residuals(shifted)
        change = values[1:] - values[0]
        return np.asarray((change / step[:, None]).T)

    def fitted(start: Array, evaluations: int) -> scipy.optimize.OptimizeResult:
        return scipy.optimize.least_squares(
            lambda parameters: residuals(parameters[None])[0],
            np.clip(start, limits[:, 0] + 1e-6, limits[:, 1] - 1e-6),
            slopes,
            bounds=limits.T,
            x_scale="jac",
            max_nfev=evaluations,
        )

    # Valleys of the deviance are flat, so that only fits that may matter run to their ends.
    short = []
    for start in starts:
        short.append(fitted(start, _EVALUATIONS_FIRST))
        if short[-1].cost <= enough:
            return np.array([short[-1].cost]), short[-1].x[None]
    worst = min(fit.cost for fit in short) + _UNLIKELY
    full = [fitted(fit.x, _EVALUATIONS_LAST) for fit in short if fit.cost < worst]
    return np.array([fit.cost for fit in full]), np.array([fit.x for fit in full])


def _likely_mean(costs: Array, minima: Array) -> Array:
    """Mean of minima, (n, n_parameter), by likelihood; minima of equal instruments count once."""
    instruments = minima[:, N_SHAPE:]
    distances = (instruments[:, None] - instruments[None]) / _DISTINCT
    copies = np.exp(-0.5 * np.sum(np.square(distances), axis=2)).sum(axis=1)
    return np.average(minima, axis=0, weights=np.exp(np.min(costs) - costs) / copies)


def _over_knees(surface: Array, wavevector: Array) -> Iterator[Array]:
    """Wavevector over bend, then over roll-off, each to the sharpness, (n, n_wavevector)."""
    # As products they need few exponentials.
    logarithms = np.log(wavevector)
    middle = logarithms[logarithms.size // 2]
    powers = np.exp(_KNEE_SHARPNESS * (logarithms - middle))
    for knee in np.exp(_KNEE_SHARPNESS * (middle - surface[:, 3:])).T:
        yield knee[:, None] * powers


def log_density(surface: Array, wavevector: Array) -> Array:
    """Logarithm of the model P, (n, n_wavevector)."""
    plateau, long, short = surface.T[:3, :, None]
    over_knees = _over_knees(surface, wavevector)
    steeper, beyond = (np.log1p(power) / _KNEE_SHARPNESS for power in over_knees)
    return np.asarray(plateau - (2 + 2 * long) * beyond - 2 * (short - long) * steeper)


def log_density_slopes(surface: Array, wavevector: Array) -> Array:
    """Derivatives of the logarithm of P by its parameters, (n, n_wavevector, 5)."""
    _, long, short = surface.T[:3, :, None]
    over_knees = [*_over_knees(surface, wavevector)]
    steeper, beyond = (np.log1p(power) / _KNEE_SHARPNESS for power in over_knees)
    passed = [power / (1 + power) for power in over_knees]
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
    """Logarithm of the projection of the model, and its derivatives by the parameters of P."""
    waves, weights, power, highest = _scaled_power(surface, wavevector)
    total = power @ weights.T
    parts = np.einsum(
        "nkp,wk->nwp", power[..., None] * log_density_slopes(surface, waves), weights, optimize=True
    )
    return np.log(total) + highest, parts / total[..., None]


def log_projection(surface: Array, wavevector: Array) -> Array:
    """Logarithm of the projection of the model on a line, (n, n_wavevector)."""
    _, weights, power, highest = _scaled_power(surface, wavevector)
    return np.asarray(np.log(power @ weights.T) + highest)


def _scaled_power(surface: Array, wavevector: Array) -> tuple[Array, Array, Array, Array]:
    """Wavevectors k and weights of a projection, k^2 P over its largest value, and ln of that."""
    waves, weights = _projector(tuple(wavevector.tolist()))
    scaled = log_density(surface, waves) + 2 * np.log(waves)
    highest = np.max(scaled, axis=1, keepdims=True)
    return waves, weights, np.exp(scaled - highest), highest


@functools.lru_cache(maxsize=64)
def _projector(wavevector: tuple[float, ...]) -> tuple[Array, Array]:
    """Wavevectors k and the weights of k^2 C(k) in C_1D, (n_wavevector, n), with interpolation."""
    last = math.log(wavevector[-1] / wavevector[0]) + _PROJECTION_END
    count = math.ceil(last / math.log(10) * _PROJECTION_POINTS) + 1
    logarithms = np.linspace(0.0, last, count)
    node, weight = np.polynomial.legendre.leggauss(_PROJECTION_NODES)
    angle = _PROJECTION_END * (1 + node) / 2
    weights = np.zeros((len(wavevector), count))
    for row, wave in zip(weights, wavevector, strict=True):
        k = wave * np.cosh(angle)
        share = weight * _PROJECTION_END / 2 / k / np.pi
        position = np.clip(np.log(k / wavevector[0]) / logarithms[1], 0, count - 1.000001)
        part, first = np.modf(position)
        for index, portion in ((first, 1 - part), (first + 1, part)):
            row += np.bincount(index.astype(int), share * portion, count)
    return wavevector[0] * np.exp(logarithms), weights


def loss_exponent(instrument: Array, wavevector: Array) -> Array:
    """Negative logarithm of the attenuation T, (n, n_wavevector)."""
    return np.asarray(np.exp(instrument[:, 1:2] * (np.log(wavevector) - instrument[:, :1])))


def _surface_model(surface: Array, density: Density) -> Array:
    """Logarithm of P or its projection at the wavevectors of a density, (n, n_wavevector)."""
    model = log_projection if density.is_profile else log_density
    return model(surface, density.wavevector)


def _measured_model(shape: Array, instrument: Array, density: Density) -> Array:
    """Logarithm of P T + N from the logarithm of P, (n, n_wavevector)."""
    # All trials have the same effects of the instrument.
    if math.isfinite(instrument[0, 0]):
        shape = shape - loss_exponent(instrument, density.wavevector)
    if math.isfinite(instrument[0, 2]):
        shape = np.logaddexp(shape, instrument[:, 2:])
    return shape


def weighted_residuals(density: Density, model: Array, departure: float) -> tuple[Array, Array]:
    """Effective modes in the bins, and logarithms of measured over modelled density."""
    modes = 1 / (1 / density.modes + departure**2)
    return modes, np.minimum(np.maximum(np.log(density.value) - model, -30.0), 30.0)


def deviances(density: Density, model: Array, departure: float = LEAST_DEPARTURE) -> Array:
    """Deviance of the bins from a model, for means of exponentially distributed powers."""
    modes, residuals = weighted_residuals(density, model, departure)
    return np.asarray(2 * modes * (np.expm1(residuals) - residuals))
