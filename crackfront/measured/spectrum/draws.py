"""Random spectra that agree with the measurements, as weighted draws of their mean squares.

Each draw has a state of the quadrature for the continuation and random numbers for the rest: noise
of the modes, levels of scans, window and levelling, ends of the band and of the spectrum.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from crackfront.analysis.estimate import Estimate, quantiles
from crackfront.core.arrays import Array
from crackfront.measured.density.bands import Scan
from crackfront.measured.density.densities import Density, bin_numbers
from crackfront.measured.spectrum.joint_fit import (
    INTERVAL,
    Continuation,
    Fit,
    fit_to_states,
)
from crackfront.measured.spectrum.quadrature import Quadrature

ORDERS = (0.0, 0.5, 1.0)
"""Orders of the derivatives whose mean squares are drawn: heights, half-derivatives, slopes."""

SEED = 20240229
"""Seed of the draws, so that results can be repeated."""

BATCH = 2**13
"""Draws in a batch."""

BATCHES = (4, 8, 16, 32)
"""Numbers of batches after which the draws may be sufficient."""

SETTLED = 0.006
"""Largest standard error of an interval's ends and median if draws are sufficient. (Units: width of
the interval)"""

_BAND_OCTAVES = 0.5
"""Range over which the shortest trusted wavelength varies. (Units: octaves)"""

_FIRST_BINS = 3
"""Draws start at one of so many bins at the longest waves."""

_LOST_AT_TIP = 0.2
"""Largest part of the density that the tip removes at the end of a band, as for an optic."""

_BLOCK = 2**9
"""Spectra that are integrated at once, so that their numbers stay in the cache."""

RESTORATION_ERROR = 0.25
"""Largest relative error of a density due to missing points, over their weight in the window."""

_RARE_PLACES = 1.5
"""Standard error of e_el over the scatter of the parts of a scan.

A scan has too few of the rare places that dominate e_el.
"""


@dataclass(frozen=True)
class Draws:
    """Mean squares of derivatives for n random spectra that agree with the measurements."""

    estimated: Array
    """Mean squares of measured and continued spectra, for the :data:`ORDERS`. Shape (3, n)."""
    recorded: Array
    """Mean squares of the recorded waves, for the :data:`ORDERS`. Shape (3, n)."""
    outside: Array
    """Mean squares of half-derivatives in waves longer and shorter than measured. Shape (2, n)."""
    weight: Array
    """Weights of the draws; their sum is 1. Shape (n,)."""
    wavevector: Array
    """Wavevectors of `low` and `high`. Shape (n_wavevector,). (Units: 1 / m)"""
    low: Array
    high: Array
    """Ends of the 95% interval of C. Shape (n_wavevector,). (Units: m^4)"""

    @property
    def effective(self) -> float:
        """Effective number of draws: as precise as so many draws of equal weight."""
        return float(1 / np.sum(self.weight**2))

    def estimate(self, values: Array) -> Estimate[float]:
        """Median over the draws of a positive number, with its 95% interval."""
        low, value, high = quantiles(values, self.weight, INTERVAL).tolist()
        mean = float(np.sum(self.weight * np.log(values)))
        spread = float(np.sum(self.weight * (np.log(values) - mean) ** 2)) ** 0.5
        return Estimate(value, value * spread, low, high)

    def mean_square(self, order: float) -> Estimate[float]:
        """Mean square of a derivative of the spectrum (Units: m^(2 - 2 order))."""
        return self.estimate(self.estimated[ORDERS.index(order)])

    def recorded_mean_square(self, order: float) -> Estimate[float]:
        """Mean square of a derivative of the recorded waves (Units: m^(2 - 2 order))."""
        return self.estimate(self.recorded[ORDERS.index(order)])

    @cached_property
    def factor(self) -> float:
        """Uncertainty factor of e_el: root of the ratio of the ends of its interval."""
        return _factor(self.mean_square(0.5))

    @cached_property
    def factors_if_known(self) -> tuple[float, float]:
        """As :attr:`factor`, if waves longer or shorter than the measured ones were known."""
        return self._factor_if_known(self.outside[0]), self._factor_if_known(self.outside[1])

    def _factor_if_known(self, part: Array) -> float:
        """As :attr:`factor`, if a part of the mean square of half-derivatives were known."""
        exact = float(quantiles(part, self.weight, 0.5))
        return _factor(self.estimate(self.estimated[ORDERS.index(0.5)] - part + exact))

    @cached_property
    def unsettled(self) -> float:
        """Largest standard error of the median and the ends of the interval of ln(e_el).

        The error is due to the finite number of draws. (Units: width of the interval) The variance
        of the weight below a quantile is the sum over draws of w^2 (b - p)^2, where p is the
        probability and b is 1 below the quantile, else 0: few heavy draws beyond an end make it
        uncertain, however many draws there are elsewhere.
        """
        logarithm = np.log(self.estimated[1])
        ends = quantiles(logarithm, self.weight, INTERVAL)
        errors = []
        for probability, end in zip(INTERVAL, ends, strict=True):
            below = logarithm <= end
            error = math.sqrt(np.sum(self.weight**2 * (below - probability) ** 2))
            probabilities = np.clip([probability - error, probability + error], 0.0, 1.0)
            errors.append(float(np.ptp(quantiles(logarithm, self.weight, probabilities))) / 2)
        width = float(ends[-1] - ends[0])
        return max(errors) / width if width > 0 else 0.0


def _factor(interval: Estimate[float]) -> float:
    """Root of the ratio of the ends of an interval."""
    return math.sqrt(interval.high / interval.low)


@dataclass(frozen=True, slots=True)
class SpectrumSampler:
    """Draws spectra of a surface: the measured ones, varied by all their uncertainties."""

    scans: Sequence[Scan]
    trusted: Sequence[Density]
    """Density of each scan over its band."""
    scatter: float
    """Standard deviation of the logarithms of the levels of scans."""
    departure: float
    """Standard deviation of the logarithm of the density of the surface from the model."""
    wavevector: Array
    value: Array
    """Joint density of all scans. Shape (n_bin,). (Units: 1 / m and m^4)"""
    below_bands: Density
    """Density of the finest scan below all trusted bands."""
    grid: Array
    """Wavevectors of the joint density and of its continuation, increasing. (Units: 1 / m)"""

    def spectra(self, fit: Fit, rng: np.random.Generator) -> _Drawn:
        """One draw for each state of a fit."""
        count, n_bin = len(fit.weight), self.wavevector.size
        on_grid = np.searchsorted(self.grid, self.wavevector * (1 - 1e-12))
        table = fit.logarithms(self.grid)
        power, weight = np.zeros((2, count, n_bin))
        shortest = np.zeros(count)
        numbers = bin_numbers(self.wavevector)
        for index, (scan, density) in enumerate(zip(self.scans, self.trusted, strict=True)):
            bins = np.searchsorted(numbers, bin_numbers(density.wavevector))
            model = table[:, on_grid[bins]]
            logarithm = self._logarithms(fit, index, model, rng)
            used = _used_bins(scan, density, count, rng)
            share = used / (1 / density.modes + self.scatter**2)
            power[:, bins] += share * np.exp(logarithm)
            weight[:, bins] += share
            shortest = np.maximum(shortest, np.max(used * density.wavevector, axis=1))
        measured = weight > 0
        joint = np.log(np.where(measured, power, 1.0) / np.where(measured, weight, 1.0))
        most_hidden = max(scan.measurement.log_hidden_energy for scan in self.scans)
        hidden = most_hidden * rng.uniform(0, 1, (count, 1))
        table[:, on_grid] = np.where(measured, joint + hidden, table[:, on_grid])
        end = self._ends(shortest, rng)
        first, last = (np.full(count, wave) for wave in self.wavevector[[0, -1]])
        estimated, longer, up_to_last = mean_squares(self.grid, table, end, first, last)
        return _Drawn(
            estimated=estimated,
            recorded=self._recorded(np.where(measured, joint, np.log(self.value))),
            outside=np.array([longer[1], estimated[1] - up_to_last[1]]),
            table=table,
            end=end,
        )

    def _logarithms(self, fit: Fit, index: int, model: Array, rng: np.random.Generator) -> Array:
        """Logarithms of C of one scan with its uncertainties, (n, n_wavevector).

        The model has the logarithms of C at the same wavevectors.
        """
        scan, density = self.scans[index], self.trusted[index]
        count = len(model)
        # Mean of measurement and model, weighted by their precisions.
        precision = density.modes + self.departure**-2
        logarithm = model + (fit.isotropic(density, index) - model) * density.modes / precision
        logarithm += rng.standard_normal(logarithm.shape) / np.sqrt(precision)
        logarithm += _common_changes(scan, density, count, rng)
        logarithm += self.scatter * rng.standard_normal((count, 1))
        return np.asarray(logarithm)

    def _recorded(self, joint: Array) -> Array:
        """Mean squares of the recorded waves from logarithms of the joint density, (3, n)."""
        count = len(joint)
        shorter = self.below_bands.wavevector > self.wavevector[-1]
        below = np.log(self.below_bands.value[shorter])
        table = np.concatenate([joint, np.broadcast_to(below, (count, below.size))], axis=1)
        wavevector = np.append(self.wavevector, self.below_bands.wavevector[shorter])
        [squares] = mean_squares(wavevector, table, np.full(count, wavevector[-1]))
        return squares

    def _ends(self, shortest: Array, rng: np.random.Generator) -> Array:
        """Wavevectors at which spectra end, at or beyond the last measured one, (n,)."""
        finest = math.log(min(scan.band.shortest_end for scan in self.scans))
        coarsest = math.log(min(scan.band.longest_end for scan in self.scans))
        last = np.minimum(np.log(2 * np.pi / shortest), coarsest)
        return 2 * np.pi * np.exp(-rng.uniform(np.minimum(finest, last), last))


def _used_bins(
    scan: Scan, density: Density, count: int, rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Bins of the density within a random band for each draw, at least one, (count, n_bin)."""
    first = rng.integers(_FIRST_BINS, size=(count, 1))
    octaves = rng.uniform(0, _BAND_OCTAVES, (count, 1))
    highest = 2 * np.pi / scan.band.shortest.wavelength * 2**-octaves
    used = (np.arange(density.value.size) >= first) & (density.wavevector <= highest)
    return used | ~np.any(used, axis=1, keepdims=True)


def _common_changes(scan: Scan, density: Density, count: int, rng: np.random.Generator) -> Array:
    """Random changes of the logarithm of a density that its bins share, (count, n_bin)."""
    options = _choices(scan, density)
    changes = options[rng.integers(len(options), size=count)]
    changes += RESTORATION_ERROR * scan.missing_weight * rng.uniform(-1, 1, (count, 1))
    if scan.band.shortest.cause == "tip":
        changes -= math.log(1 - _LOST_AT_TIP) * rng.uniform(0, 1, (count, 1))
    changes += _RARE_PLACES * scan.unevenness * rng.standard_normal((count, 1))
    return changes


@dataclass(frozen=True, slots=True)
class _Drawn:
    """Draws for the states of one fit, with mean squares as in :class:`Draws`."""

    estimated: Array
    recorded: Array
    outside: Array
    table: Array
    """Logarithms of C on the grid. Shape (n, n_wavevector)."""
    end: Array
    """Wavevectors at which the spectra end. Shape (n,)."""


class Batch(NamedTuple):
    """A batch of states of the continuation of a surface."""

    fit: Fit
    logarithm: Array
    """Logarithms of their weights, comparable between batches. Shape (n,)."""
    rng: np.random.Generator
    """For everything else that varies."""


def batches(model: Continuation, quadrature: Quadrature, seed: int | None) -> Iterator[Batch]:
    """Endless batches of states, the same for the same seed."""
    seeds = np.random.SeedSequence(SEED if seed is None else seed, spawn_key=(0xD4A3,))
    while True:
        sequence, rng = map(np.random.default_rng, seeds.spawn(2))
        uniform = scipy.stats.qmc.Sobol(quadrature.n_dimension, rng=sequence).random(BATCH)
        states = quadrature.states(uniform)
        yield Batch(fit_to_states(model, quadrature, states), states.logarithm, rng)


def drawn(sampler: SpectrumSampler, states: Iterator[Batch], numbers: Sequence[int]) -> Draws:
    """Draws in the first of some numbers of batches that settles the interval of e_el."""
    parts: list[_Drawn] = []
    logarithms: list[Array] = []
    for fit, logarithm, rng in states:
        parts.append(sampler.spectra(fit, rng))
        logarithms.append(logarithm)
        if len(parts) == 1:
            low, high = _interval(sampler.grid, parts[0], fit.weight)
        if len(parts) not in numbers:
            continue
        weight = np.exp(np.concatenate(logarithms) - np.max(logarithms))
        draws = Draws(
            estimated=np.concatenate([part.estimated for part in parts], axis=1),
            recorded=np.concatenate([part.recorded for part in parts], axis=1),
            outside=np.concatenate([part.outside for part in parts], axis=1),
            weight=weight / np.sum(weight),
            wavevector=sampler.grid,
            low=low,
            high=high,
        )
        if len(parts) == numbers[-1] or draws.unsettled < SETTLED:
            break
    return draws


def _interval(grid: Array, draws: _Drawn, weight: Array) -> tuple[Array, Array]:
    """Ends of the 95% interval of C on a grid, from the spectra that reach each wavevector."""
    ends = np.empty((2, grid.size))
    median_end = np.median(draws.end)
    for column, wavevector in enumerate(grid):
        reaching = draws.end >= min(wavevector, median_end)
        values = draws.table[reaching, column]
        ends[:, column] = quantiles(values, weight[reaching], INTERVAL[::2])
    low, high = np.exp(ends)
    return low, high


def _choices(scan: Scan, density: Density) -> Array:
    """Changes of the logarithm of a density by window and levelling, as equally probable rows.

    A levelling may have removed as much too much as another order of polynomials would remove.
    """
    unchanged = np.zeros(density.value.size)
    if not scan.alternatives:
        return unchanged[None]
    bins = np.searchsorted(bin_numbers(scan.density.wavevector), bin_numbers(density.wavevector))
    window, levelled = (
        np.log(alternative.value / scan.density.value)[bins] for alternative in scan.alternatives
    )
    return np.array([unchanged, unchanged, window, levelled, -levelled])


def mean_squares(grid: Array, table: Array, *ends: Array) -> list[Array]:
    """Mean squares of the derivatives of n spectra up to some wavevectors, (3, n) for each end.

    The table has logarithms of C, (n, n_wavevector). Spectra are power laws between the points of
    the grid and constant at lower wavevectors.
    """
    results = np.empty((len(ends), len(ORDERS), len(table)))
    for first in range(0, len(table), _BLOCK):
        block = slice(first, first + _BLOCK)
        results[..., block] = _mean_squares(grid, table[block], [end[block] for end in ends])
    return list(results)


def _mean_squares(grid: Array, table: Array, ends: Sequence[Array]) -> Array:
    """Mean squares as :func:`mean_squares`, for few spectra, (n_end, 3, n)."""
    logarithms = np.log(grid)
    steps = np.diff(logarithms)
    slope, density = np.diff(table, axis=1) / steps, np.exp(table)
    end = np.log(ends)
    last = np.clip(np.searchsorted(logarithms, end, side="right") - 1, 0, steps.size - 1)
    part = np.clip(end - logarithms[last], 0.0, steps[last])
    rows, results = np.arange(len(table)), np.empty((len(ORDERS), *end.shape))
    whole = np.zeros_like(table)
    for squares, order in zip(results, ORDERS, strict=True):
        power = 2 + 2 * order
        exponent, start = slope + power, density * grid**power
        pieces = start[:, :-1] * _exponential_integral(exponent, steps)
        np.cumsum(pieces, axis=1, out=whole[:, 1:])
        rest = start[rows, last] * _exponential_integral(exponent[rows, last], part)
        squares[:] = (whole[rows, last] + rest + start[:, 0] / power) / (2 * np.pi)
    return np.swapaxes(results, 0, 1)


def _exponential_integral(exponent: Array, length: Array) -> Array:
    """Integral of exp(exponent x) from 0 to a length."""
    near = np.abs(exponent) < 1e-9
    return np.where(near, length, np.expm1(exponent * length) / np.where(near, 1.0, exponent))
