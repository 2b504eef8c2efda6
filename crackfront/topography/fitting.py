r"""The self-affine model that continues measured densities, and what instruments do to it.

A density is fitted by :math:`P(q) T(q) + N`: a plateau and two power laws P, their attenuation by
the instrument :math:`T = \exp(-(q/q_c)^m)`, and white noise N. All fits are of the likelihood of
the modes in each bin.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import expit

from crackfront.analysis.estimate import Estimate, quantiles
from crackfront.topography.densities import Density
from crackfront.topography.levelling import Array
from crackfront.topography.quadrature import Quadrature, States

N_SHAPE = 5
"""Parameters of P: logarithm of the plateau, Hurst exponents at longer and at shorter waves,
logarithms of the wavevectors of bend and roll-off."""

_KNEE = 6.0
"""Sharpness of the knees of the model."""

_LEAST_DEPARTURE = 0.05
"""Least relative departure of a surface from the model, which no number of modes takes away."""

_BEND = 0.3
"""Standard deviation that is expected of the difference of the two Hurst exponents."""

_BEYOND, _FAR = 8.0, 2.0
"""How far beyond the longest trusted wavelength a roll-off is looked for, four sides of a scan, and
the logarithm of the factor by which one beyond it is less likely by e."""

_SHARPNESS = (1.0, 4.0)
"""Exponents m: of a circular pupil, whose transfer falls linearly at first, to sharp filters."""

_LOSS, _NOISE = (1e-3, 8.0), 1.0
"""Losses at the last wavevector in a fit of all, exponents of the attenuation, and how far the
logarithm of the noise goes from where it was seen."""

_LEAST_CURVATURE = -2.0
"""Logarithm of data over model down to which the curvature of the deviance is taken as it is."""

_GAIN = 9.0
"""What half of the deviance must fall by for an instrument to be seen in a density."""

_DIRECTIONS, _FURTHEST, _POINTS = 400, 8.0, 16
"""Quadrature of the projection, its end in ln(k / q), and the points a decade of the density."""

_ROUGH = np.array([0.7, 0.7])
"""Hurst exponents of longer and of shorter waves with which fits begin."""


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
        return _logarithm(self.surface, wavevector)

    def median(self, wavevector: Array) -> Array:
        """Median of C (Units: m^4)."""
        return np.exp(quantiles(self.logarithms(wavevector), self.weight, 0.5))

    def projected_density(self, wavevector: Array) -> Array:
        """Median of C_1D of lines (Units: m^3)."""
        return np.exp(quantiles(_projection(self.surface, wavevector), self.weight, 0.5))

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
        cost, parameters = _likeliest(models, starts, limits[[True] * N_SHAPE + varied])
        if not any(varied):
            shapes = [parameters, shapes[-1]]
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


@dataclass(frozen=True, slots=True)
class Continuation:
    """The distribution of the models of one surface and of the instruments of its densities.

    The outer parameters of the quadrature are the logarithm of the wavevector of the roll-off, the
    place of the bend between it and the highest wavevector, and the sharpness of the first
    instrument that takes waves away. The inner ones are the Hurst exponents, what else varies of
    instruments, and the logarithm of the plateau, in which the model is nearly linear: in place of
    q_c stands the loss at the last wavevector of a density.
    """

    models: _Models
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
        """Inner parameters to begin with, the plateau that which densities have on average."""
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
            total += _deviances(item, model, self.departure).sum(axis=1) / 2
        return total

    def expansion(self, inner: Array, outer: Array) -> tuple[Array, Array, Array]:
        """Half of the deviance with the priors, its slopes and its curvature."""
        trials, total = self.trials(inner, outer), self._prior(inner, outer)
        size = inner.shape[1] + outer.shape[1]
        slopes, information = np.zeros((len(inner), size)), np.zeros((len(inner), size, size))
        for index, item in enumerate(self.models.densities):
            model, changes = self._changes(trials, index)
            changes = self._of_coordinates(changes, outer)
            modes, apart = _apart(item, model, self.departure)
            total += np.sum(modes * (np.expm1(apart) - apart), axis=1)
            slopes -= np.einsum("nw,nwp->np", modes * np.expm1(apart), changes)
            # Exact where the model is linear; where it is far above the data it says nothing.
            curvature = modes * np.exp(np.maximum(apart, _LEAST_CURVATURE))
            information += np.swapaxes(changes, 1, 2) @ (curvature[..., None] * changes)
        pull = np.zeros(size)
        pull[:2] = -1 / _BEND, 1 / _BEND
        slopes += (inner[:, 1] - inner[:, 0])[:, None] / _BEND * pull
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
        """Where the roll-off is the least bend, and that bend."""
        return outer[:, 0] > self.limits[3, 0], np.maximum(outer[:, 0], self.limits[3, 0])

    def _prior(self, inner: Array, outer: Array) -> Array:
        """Half of the deviance from what is expected of any surface."""
        beyond = np.maximum(self.limits[3, 0] - outer[:, 0], 0.0)
        return ((inner[:, 1] - inner[:, 0]) / _BEND) ** 2 / 2 + beyond / _FAR

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
            model, shape = _projected_changes(surface, item.wavevector)
        else:
            model, shape = _logarithm(surface, item.wavevector), _slopes(surface, item.wavevector)
        own = np.zeros((*model.shape, 3))
        if math.isfinite(models.seen[index, 0]):
            loss = _loss(instrument, item.wavevector)
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
    model = _continuation(densities, _LEAST_DEPARTURE)
    quadrature = Quadrature(model)
    departure = _departure(model, *quadrature.likeliest)
    if departure == _LEAST_DEPARTURE:
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
    return math.sqrt(max(excess / freedom, _LEAST_DEPARTURE**2))


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
    around[:, 0], around[:, 1] = _LOSS, _SHARPNESS
    around[:, 2] = seen[:, 2:] + np.array([-_NOISE, _NOISE])
    models = _Models([item for item, _ in densities], seen, varied)
    limits = np.array([*_limits(low, high), *around[varied]])
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


def _limits(low: float, high: float) -> tuple[tuple[float, float], ...]:
    """Bounds of the parameters of P where logarithms of wavevectors lie between two numbers."""
    return ((-np.inf, np.inf), (0.0, 1.0), (0.0, 1.0), (low, high), (low - math.log(_BEYOND), high))


def _first_shapes(
    densities: Sequence[tuple[Density, Array]], low: float, high: float
) -> list[Array]:
    """Parameters of P from which fits begin, for three roll-offs, and one with a late bend."""
    found, width = [], high - low
    for part, place, long, short in (
        (-0.1, 0.67, 0.7, 0.7),
        (0.15, 0.67, 0.7, 0.7),
        (0.45, 0.67, 0.7, 0.7),
        (0.15, 0.87, 0.2, 0.9),
    ):
        shape = np.array([[0.0, long, short, low + place * width, low + part * width]])
        models = [_seen(_shape(shape, item), row[None], item)[0] for item, row in densities]
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


def _slopes(surface: Array, wavevector: Array) -> Array:
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


def _projected_changes(surface: Array, wavevector: Array) -> tuple[Array, Array]:
    """Logarithm of the projection of the model, and its change with each parameter of P."""
    waves, weights = _projector(tuple(wavevector.tolist()))
    scaled = _logarithm(surface, waves) + 2 * np.log(waves)
    highest = np.max(scaled, axis=1, keepdims=True)
    power = np.exp(scaled - highest)
    total = power @ weights.T
    parts = np.einsum(
        "nkp,wk->nwp", power[..., None] * _slopes(surface, waves), weights, optimize=True
    )
    return np.log(total) + highest, parts / total[..., None]


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


def _shape(surface: Array, density: Density) -> Array:
    """Logarithm of what a density of the surface is, (n, n_wavevector)."""
    form = _projection if density.is_profile else _logarithm
    return form(surface, density.wavevector)


def _seen(shape: Array, instrument: Array, density: Density) -> Array:
    """Logarithm of what an instrument makes of a density, (n, n_wavevector)."""
    # What one trial sees of its instrument, all do.
    if math.isfinite(instrument[0, 0]):
        shape = shape - _loss(instrument, density.wavevector)
    if math.isfinite(instrument[0, 2]):
        shape = np.logaddexp(shape, instrument[:, 2:])
    return shape


def _apart(density: Density, model: Array, departure: float) -> tuple[Array, Array]:
    """Modes in the bins, fewer as surfaces depart from models, and logarithms of value to model."""
    modes = 1 / (1 / density.modes + departure**2)
    return modes, np.clip(np.log(density.value) - model, -30.0, 30.0)


def _deviances(density: Density, model: Array, departure: float = _LEAST_DEPARTURE) -> Array:
    """Deviance of the bins from a model, as of means of exponentially distributed powers."""
    modes, apart = _apart(density, model, departure)
    return np.asarray(2 * modes * (np.expm1(apart) - apart))
