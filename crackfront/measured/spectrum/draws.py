"""Spectra that agree as well with what was measured: weighted draws of their mean squares.

A draw has a model of the continuation, a state of its quadrature, and chance for all else: noise of
the modes, levels of scans, window and levelling, ends of the band and of the surface.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from crackfront.analysis.estimate import Estimate, quantiles
from crackfront.core.arrays import Array
from crackfront.measured.density.bands import Scan
from crackfront.measured.density.densities import Density, bin_numbers
from crackfront.measured.spectrum.fit import Continuation, Fit, fit_of
from crackfront.measured.spectrum.quadrature import Quadrature

ORDERS = (0.0, 0.5, 1.0)
"""Orders of the derivatives whose mean squares are drawn: heights, half-derivatives, slopes."""

SEED = 20240229
"""Seed of the draws, which are thus the same every time."""

BATCH, BATCHES = 2**13, (4, 8, 16, 32)
"""Draws of a batch, and numbers of batches at which it is asked whether they are enough."""

SETTLED = 0.006
"""Standard error of the median and of both ends of an interval, as a part of its width, from which
on there are enough draws."""

_BAND_OCTAVES = 0.5
"""By how much the shortest trusted wavelength varies."""

_FIRST_BINS = 3
"""Of how many of the longest bins some are left out."""

_HIDDEN = 0.2
"""Part of a density that a tip takes at most where it ends the band, as much as an optic may."""

GIVEN_BACK = 0.25
"""Largest relative error of the density that is restored for missing points, over their weight."""

_RARE = 1.5
"""Standard error of e_el over the one that the parts of a scan show: a scan holds few of the rare
places that dominate e_el."""

_INTERVAL = (0.025, 0.5, 0.975)
"""Quantiles of the ends of an interval and of its median."""


@dataclass(frozen=True, slots=True)
class Draws:
    """Mean squares of derivatives of spectra that agree as well with what was measured."""

    estimated: Array
    """Of what is measured and continued, by orders as of :data:`ORDERS`. Shape (3, n)."""
    recorded: Array
    """Of what the scans hold. Shape (3, n)."""
    outside: Array
    """Of half-derivatives, in waves longer and shorter than all that is measured. Shape (2, n)."""
    weight: Array
    """Weights of the draws, whose sum is 1. Shape (n,)."""
    wavevector: Array
    """Wavevectors of the interval of the density. Shape (n_wavevector,). (Units: 1 / m)"""
    low: Array
    high: Array
    """The 95% interval of C there. Shape (n_wavevector,). (Units: m^4)"""

    @property
    def effective(self) -> float:
        """Number of draws of equal weight that would say as much."""
        return float(1 / np.sum(self.weight**2))

    def estimate(self, values: Array) -> Estimate[float]:
        """Median of a positive number of every draw, with its 95% interval."""
        low, value, high = quantiles(values, self.weight, _INTERVAL).tolist()
        mean = float(np.sum(self.weight * np.log(values)))
        spread = float(np.sum(self.weight * (np.log(values) - mean) ** 2)) ** 0.5
        return Estimate(value, value * spread, low, high)

    def mean_square(self, order: float) -> Estimate[float]:
        """Mean square of a derivative of what is estimated (Units: m^(2 - 2 order))."""
        return self.estimate(self.estimated[ORDERS.index(order)])

    def recorded_mean_square(self, order: float) -> Estimate[float]:
        """The same of what is recorded."""
        return self.estimate(self.recorded[ORDERS.index(order)])

    @property
    def factor(self) -> float:
        """Factor within which e_el is known: root of the ratio of the ends of its interval."""
        return _factor(self.mean_square(0.5))

    @property
    def factors_with(self) -> tuple[float, float]:
        """As :attr:`factor`, if longer waves than the measured ones were known, or shorter ones."""
        energy = self.estimated[ORDERS.index(0.5)]
        longer, shorter = (
            _factor(self.estimate(energy - part + quantiles(part, self.weight, 0.5)))
            for part in self.outside
        )
        return longer, shorter

    @property
    def unsettled(self) -> float:
        """Largest standard error of the median and the ends of the interval of e_el.

        That of the finite number of draws, in the logarithm, as a part of the width. The variance
        of the weight below an end is the sum over draws of w^2 (1 below the end, else 0, minus the
        part)^2, as of any weighted mean: few heavy draws beyond an end make it uncertain, however
        many draws there are elsewhere.
        """
        logarithm = np.log(self.estimated[1])
        places = quantiles(logarithm, self.weight, _INTERVAL)
        ends = []
        for part, place in zip(_INTERVAL, places, strict=True):
            reach = math.sqrt(np.sum(self.weight**2 * ((logarithm <= place) - part) ** 2))
            near = np.clip([part - reach, part + reach], 0.0, 1.0)
            ends.append(float(np.ptp(quantiles(logarithm, self.weight, near))) / 2)
        width = float(places[-1] - places[0])
        return max(ends) / width if width > 0 else 0.0


def _factor(found: Estimate[float]) -> float:
    """Root of the upper over the lower end of an interval."""
    return math.sqrt(found.high / found.low)


@dataclass(frozen=True, slots=True)
class SpectrumSampler:
    """Draws spectra of a surface: what was measured, varied by all that is not known of it."""

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
    rest: Density
    """What the finest scan holds below all trusted waves."""
    grid: Array
    """Wavevectors of these bins and of the continuation, increasing. (Units: 1 / m)"""

    def spectra(self, fit: Fit, chance: np.random.Generator) -> _Drawn:
        """One draw with each state of a fit."""
        count, n_bin = len(fit.weight), self.wavevector.size
        bins = np.searchsorted(self.grid, self.wavevector * (1 - 1e-12))
        table = fit.logarithms(self.grid)
        power, weight = np.zeros((2, count, n_bin))
        shortest = np.zeros(count)
        places = bin_numbers(self.wavevector)
        for index, (one, item) in enumerate(zip(self.scans, self.trusted, strict=True)):
            here = np.searchsorted(places, bin_numbers(item.wavevector))
            # The mean of what is measured and of what the model says, by their precisions.
            precision = item.modes + self.departure**-2
            logarithm = table[:, bins[here]]
            logarithm += (fit.isotropic(item, index) - logarithm) * item.modes / precision
            logarithm += chance.standard_normal(logarithm.shape) / np.sqrt(precision)
            logarithm += self._changes(one, item, count, chance)
            logarithm += self.scatter * chance.standard_normal((count, 1))
            first = chance.integers(_FIRST_BINS, size=(count, 1))
            octaves = chance.uniform(0, _BAND_OCTAVES, (count, 1))
            highest = 2 * np.pi / one.band.shortest.wavelength * 2**-octaves
            kept = (np.arange(item.value.size) >= first) & (item.wavevector <= highest)
            kept |= ~np.any(kept, axis=1, keepdims=True)
            share = kept / (1 / item.modes + self.scatter**2)
            power[:, here] += share * np.exp(logarithm)
            weight[:, here] += share
            shortest = np.maximum(shortest, np.max(kept * item.wavevector, axis=1))
        known = weight > 0
        found = np.log(np.where(known, power, 1.0) / np.where(known, weight, 1.0))
        hidden = max(one.measurement.log_hidden_energy for one in self.scans) * chance.uniform(
            0, 1, (count, 1)
        )
        table[:, bins] = np.where(known, found + hidden, table[:, bins])
        end = self._end(shortest, chance)
        recorded = np.where(known, found, np.log(self.value))
        beyond = self.rest.wavevector > self.wavevector[-1]
        below = np.broadcast_to(np.log(self.rest.value[beyond]), (count, int(np.sum(beyond))))
        held = np.append(self.wavevector, self.rest.wavevector[beyond])
        ends = (np.full(count, wave) for wave in self.wavevector[[0, -1]])
        estimated, longer, measured = mean_squares(self.grid, table, end, *ends)
        [recorded_squares] = mean_squares(
            held, np.concatenate([recorded, below], axis=1), np.full(count, held[-1])
        )
        return _Drawn(
            estimated=estimated,
            recorded=recorded_squares,
            outside=np.array([longer[1], estimated[1] - measured[1]]),
            table=table,
            end=end,
        )

    @staticmethod
    def _changes(one: Scan, item: Density, count: int, chance: np.random.Generator) -> Array:
        """Changes of the logarithm of a density that all modes share."""
        options = _choices(one, item)
        found = options[chance.integers(len(options), size=count)]
        found += GIVEN_BACK * one.missing_weight * chance.uniform(-1, 1, (count, 1))
        if one.band.shortest.cause == "tip":
            found -= math.log(1 - _HIDDEN) * chance.uniform(0, 1, (count, 1))
        found += _RARE * one.unevenness * chance.standard_normal((count, 1))
        return found

    def _end(self, shortest: Array, chance: np.random.Generator) -> Array:
        """Wavevectors where the surface ends, beyond the last one that is measured."""
        finest = math.log(min(one.band.shortest_end for one in self.scans))
        coarsest = math.log(min(one.band.longest_end for one in self.scans))
        last = np.minimum(np.log(2 * np.pi / shortest), coarsest)
        return 2 * np.pi * np.exp(-chance.uniform(np.minimum(finest, last), last))


@dataclass(frozen=True, slots=True)
class _Drawn:
    """Draws with the states of one fit."""

    estimated: Array
    recorded: Array
    """Mean squares. Shapes (3, n)."""
    outside: Array
    """As of :class:`Draws`. Shape (2, n)."""
    table: Array
    """Logarithms of C on the grid. Shape (n, n_wavevector)."""
    end: Array
    """Wavevectors where the surfaces end. Shape (n,)."""


class Batch(NamedTuple):
    """A batch of states of the continuation of a surface."""

    fit: Fit
    logarithm: Array  # (n,) of their weights, relative to those of all batches
    chance: np.random.Generator  # for all that varies beside them


def batches(model: Continuation, quadrature: Quadrature, seed: int | None) -> Iterator[Batch]:
    """Batches of states without end, the same ones for the same seed."""
    seeds = np.random.SeedSequence(SEED if seed is None else seed, spawn_key=(0xD4A3,))
    while True:
        sequence, chance = map(np.random.default_rng, seeds.spawn(2))
        uniform = scipy.stats.qmc.Sobol(quadrature.n_dimension, rng=sequence).random(BATCH)
        states = quadrature.states(uniform)
        yield Batch(fit_of(model, quadrature, states), states.logarithm, chance)


def drawn(sampler: SpectrumSampler, states: Iterator[Batch], numbers: Sequence[int]) -> Draws:
    """As many draws as the median and the ends of e_el need, in one of some numbers of batches."""
    found: list[_Drawn] = []
    logarithms: list[Array] = []
    for fit, logarithm, chance in states:
        found.append(sampler.spectra(fit, chance))
        logarithms.append(logarithm)
        if len(found) == 1:
            low, high = _interval(sampler.grid, found[0], fit.weight)
        if len(found) not in numbers:
            continue
        weight = np.exp(np.concatenate(logarithms) - np.max(logarithms))
        result = Draws(
            estimated=np.concatenate([one.estimated for one in found], axis=1),
            recorded=np.concatenate([one.recorded for one in found], axis=1),
            outside=np.concatenate([one.outside for one in found], axis=1),
            weight=weight / np.sum(weight),
            wavevector=sampler.grid,
            low=low,
            high=high,
        )
        if len(found) == numbers[-1] or result.unsettled < SETTLED:
            break
    return result


def _interval(grid: Array, found: _Drawn, weight: Array) -> tuple[Array, Array]:
    """The 95% interval of C on a grid, of the draws that do not end before."""
    ends = np.empty((2, grid.size))
    for place, wavevector in enumerate(grid):
        reaching = found.end >= min(wavevector, np.median(found.end))
        ends[:, place] = quantiles(found.table[reaching, place], weight[reaching], (0.025, 0.975))
    low, high = np.exp(ends)
    return low, high


def _choices(one: Scan, density: Density) -> Array:
    """Changes of the logarithm of a density by window and levelling, rows of equal probability.

    What one more order of polynomials takes away may as well be missing already.
    """
    none = np.zeros(density.value.size)
    if not one.alternatives:
        return none[None]
    mine = np.searchsorted(bin_numbers(one.density.wavevector), bin_numbers(density.wavevector))
    window, levelled = (np.log(item.value / one.density.value)[mine] for item in one.alternatives)
    return np.array([none, none, window, levelled, -levelled])


def mean_squares(grid: Array, table: Array, *ends: Array) -> list[Array]:
    """Mean squares of the derivatives of spectra up to ends somewhere on a grid, (3, n) each.

    They are power laws between the points of the grid, and flat below.
    """
    places = np.log(grid)
    growth = np.diff(places)
    slope = np.diff(table, axis=1) / growth
    rows, found = np.arange(len(table)), np.empty((len(ends), len(ORDERS), len(table)))
    for index, order in enumerate(ORDERS):
        power = 2 + 2 * order
        exponent = slope + power
        start = np.exp(table + power * places)
        pieces = start[:, :-1] * _grown(exponent, growth)
        for squares, end in zip(found, ends, strict=True):
            last = np.searchsorted(places, np.log(end), side="right") - 1
            last = np.clip(last, 0, growth.size - 1)
            part = np.clip(np.log(end) - places[last], 0.0, growth[last])
            whole = np.where(np.arange(growth.size) < last[:, None], pieces, 0.0).sum(axis=1)
            whole += start[rows, last] * _grown(exponent[rows, last], part)
            squares[index] = (whole + start[:, 0] / power) / (2 * np.pi)
    return list(found)


def _grown(exponent: Array, length: Array) -> Array:
    """Integral of exp(exponent x) from 0 to a length."""
    near = np.abs(exponent) < 1e-9
    return np.where(near, length, np.expm1(exponent * length) / np.where(near, 1.0, exponent))
