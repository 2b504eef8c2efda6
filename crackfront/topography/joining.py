"""One density of all scans of a surface with its scatter, and the spectrum that continues it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from crackfront.analysis.estimate import Estimate, normal_estimate
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.topography.bands import NYQUIST, Scan
from crackfront.topography.densities import Density, bin_numbers
from crackfront.topography.fitting import Fit, fitted_model
from crackfront.topography.levelling import Array

_DRAWS = 400
_SEEDS = [np.random.SeedSequence(20240229, spawn_key=(key,)) for key in (0xD4A3, 0xD4A4)]

_CONTINUED_BINS = 6
"""Points a decade of a continuation."""

_FLAT = 32.0
"""How far beyond the longest waves a continuation goes: all roll-offs that are looked for."""

_BAND_OCTAVES = 0.5
"""By how much the shortest trusted wavelength varies in the draws."""

_FIRST_BINS = 3
"""Of how many of the longest bins some are left out in the draws."""

_DECADES = 2
"""Decades below the pixels over which the model is continued, to see what is missing."""

_MOST_CONTINUED, _MOST_MISSING = 0.5, 1.0
"""Part of e_el that is not recorded, and what two more decades would add to it, above which no
estimate is given but a lower bound."""

_LEVEL_SIGMA, _LEVEL = 3.0, math.log(1.25)
"""Standard errors, and ratio of densities, from which on a scan disagrees with the others."""


@dataclass(frozen=True, slots=True)
class JointDensity:
    """Isotropic density of all scans of a surface over their trusted bands."""

    wavevector: Array
    value: Array
    """Wavevectors of the bins and density there. Shape (n,). (Units: 1 / m and m^4)"""
    error: Array
    """Standard error of the logarithm of the value, with the scatter of scans. Shape (n,)."""
    scatter: float
    """Standard deviation of the levels of the scans beyond what their modes explain, relative."""
    levels: tuple[Estimate[float], ...]
    """Density of every scan over that of the others where they overlap; NaN where none do."""

    def disagrees(self, index: int) -> bool:
        """Whether a scan departs from the others by more than its modes explain."""
        level = self.levels[index]
        if not math.isfinite(level.value):
            return False
        apart = abs(math.log(level.value))
        return apart > max(_LEVEL, _LEVEL_SIGMA * level.standard_error / level.value)


@dataclass(frozen=True, slots=True)
class Shares:
    """Where e_el comes from."""

    measured: float
    continued: float
    """Parts of e_el in the measured bands, and in the continuation; their sum is 1."""
    missing_short: float
    """What two more decades of shorter waves would add by the model, relative to e_el."""
    missing_long: float
    """What longer waves would add by the model where it has not found the plateau, else 0."""


@dataclass(frozen=True, slots=True)
class JointSpectrum:
    """Spectrum of a surface, measured where it can be and continued beyond."""

    estimated: TabulatedSpectrum
    """Measured over the bands; by the model to the shortest wave that pixels and instrument hold,
    and to the plateau where this is seen; else flat above the longest measured wave. (Units: m)"""
    recorded: TabulatedSpectrum
    """As measured, and below the band what the finest scan holds down to its pixels, without its
    noise but as weak as its instrument made it. (Units: m)"""
    draws: tuple[TabulatedSpectrum, ...]
    recorded_draws: tuple[TabulatedSpectrum, ...]
    """Spectra that agree as well with what was measured: noise of the modes, scatter of scans,
    window and levelling, ends of the band, and continuation."""
    is_lower_bound: bool
    """Whether too little of e_el is recorded for an estimate: then what is recorded counts."""
    density: JointDensity
    fit: Fit
    shares: Shares

    @property
    def spectrum(self) -> TabulatedSpectrum:
        """The estimated spectrum, or the recorded one where that is a lower bound (Units: m)."""
        return self.recorded if self.is_lower_bound else self.estimated

    @property
    def shortest(self) -> float:
        """Shortest wavelength that is measured (Units: m)."""
        return float(2 * np.pi / self.density.wavevector[-1])

    @property
    def longest(self) -> float:
        """Longest wavelength that is measured (Units: m)."""
        return float(2 * np.pi / self.density.wavevector[0])

    def estimate(self, quantity: Callable[[TabulatedSpectrum], float]) -> Estimate[float]:
        """Median of a positive quantity over the draws of the spectrum, with its 95% interval.

        That of a lower bound reaches from what is recorded to what the model continues.
        """
        recorded, estimated = self.both(quantity)
        if not self.is_lower_bound:
            return estimated
        return replace(recorded, high=max(recorded.high, estimated.high))

    def both(
        self, quantity: Callable[[TabulatedSpectrum], float]
    ) -> tuple[Estimate[float], Estimate[float]]:
        """A quantity of what is recorded, and of what is estimated, as :meth:`estimate`."""
        found = []
        for spectra in (self.recorded_draws, self.draws):
            drawn = np.array([quantity(item) for item in spectra])
            low, value, high = np.quantile(drawn, (0.025, 0.5, 0.975)).tolist()
            found.append(Estimate(value, value * float(np.std(np.log(drawn))), low, high))
        return found[0], found[1]


def joint_spectrum(scans: Sequence[Scan]) -> JointSpectrum:
    """Spectrum of all scans of a surface, refused where their densities do not determine one."""
    fit = fitted_model([(one.informative, one.band.instrument) for one in scans])
    trusted = [one.trusted for one in scans]
    logarithms = [fit.isotropic(item, index) for index, item in enumerate(trusted)]
    isotropic = [
        replace(item, value=np.exp(np.median(found, axis=0)), is_profile=False)
        for item, found in zip(trusted, logarithms, strict=True)
    ]
    scatter, levels = _levels(isotropic)
    density = JointDensity(*_joined(isotropic, [0.0] * len(scans), scatter), scatter, levels)
    measured, end = (density.wavevector, density.value), min(one.band.end for one in scans)
    longer = spectrum = _continued(*measured, fit.median, fit.lowest, end)
    if not fit.has_roll_off:
        spectrum = _continued(*measured, fit.median, None, end)
    shares = _shares(spectrum, longer, density.wavevector, fit.median)
    rest = _beyond(scans, fit)
    draws, recorded_draws = _draws(scans, trusted, logarithms, scatter, fit, rest)
    return JointSpectrum(
        estimated=spectrum,
        recorded=_recorded(*measured, rest),
        draws=draws,
        recorded_draws=recorded_draws,
        is_lower_bound=_is_unknown(draws, recorded_draws, shares.missing_short),
        density=density,
        fit=fit,
        shares=shares,
    )


def _is_unknown(
    draws: Sequence[TabulatedSpectrum], recorded: Sequence[TabulatedSpectrum], missing: float
) -> bool:
    """Whether e_el is mostly not recorded, by its draws and by what shorter waves would add."""
    whole, part = ([item.mean_square(0.5) for item in every] for every in (draws, recorded))
    measured = float(np.median(part))
    if measured < (1 - _MOST_CONTINUED) * float(np.median(whole)):
        return True
    # What is recorded beyond all draws is no surface.
    return missing > _MOST_MISSING and measured < float(np.quantile(whole, 0.975))


def _levels(densities: Sequence[Density]) -> tuple[float, tuple[Estimate[float], ...]]:
    """Scatter of the levels of scans, and level of each against the others."""
    places = [bin_numbers(one.wavevector) for one in densities]
    bins = np.unique(np.concatenate(places))
    value, modes = np.zeros((2, len(densities), bins.size))
    for row, (one, place) in enumerate(zip(densities, places, strict=True)):
        here = np.searchsorted(bins, place)
        value[row, here], modes[row, here] = one.value, one.modes
    power, found = value * modes, []
    for row in range(len(densities)):
        others, other_power = (np.delete(one, row, axis=0).sum(axis=0) for one in (modes, power))
        shared = (modes[row] > 0) & (others > 0)
        if not np.any(shared):
            found.append((math.nan, math.nan))
            continue
        apart = np.log(value[row, shared] / (other_power[shared] / others[shared]))
        weights = 1 / (1 / modes[row, shared] + 1 / others[shared])
        found.append((float(np.average(apart, weights=weights)), float(np.sum(weights)) ** -0.5))
    known = np.array([pair for pair in found if math.isfinite(pair[0])])
    scatter = 0.0
    if len(known) > 1:
        # A level is that against the others, so that two scans tell the same difference twice.
        excess = float(np.mean(known[:, 0] ** 2 - known[:, 1] ** 2))
        scatter = math.sqrt(max(0.0, excess) / 2)
    return scatter, tuple(
        replace(one.each(math.exp), standard_error=math.exp(one.value) * one.standard_error)
        for one in (normal_estimate(*pair) for pair in found)
    )


def _joined(
    densities: Sequence[Density], levels: Sequence[float], scatter: float
) -> tuple[Array, Array, Array]:
    """Wavevectors, densities and their relative errors, of scans multiplied by exp(level)."""
    places = np.concatenate([bin_numbers(one.wavevector) for one in densities])
    values = np.concatenate(
        [one.value * math.exp(level) for one, level in zip(densities, levels, strict=True)]
    )
    wavevector = np.log(np.concatenate([one.wavevector for one in densities]))
    modes = np.concatenate([one.modes for one in densities])
    weight = 1 / (1 / modes + scatter**2)
    _, index = np.unique(places, return_inverse=True)
    total = np.bincount(index, weight)
    logarithm, value = (np.bincount(index, weight * part) / total for part in (wavevector, values))
    return np.exp(logarithm), value, np.asarray(total**-0.5)


def _beyond(scans: Sequence[Scan], fit: Fit) -> Density:
    """What the finest scan holds below all trusted waves and above its noise, without this."""
    index, one = min(enumerate(scans), key=lambda item: max(item[1].measurement.pixels))
    shortest = min(other.band.shortest.wavelength for other in scans) / (1 + 1e-6)
    last = max(NYQUIST * max(one.measurement.pixels), one.band.drowned)
    rest = one.density.within(last, shortest)
    logarithms = fit.isotropic(rest, index, restored=False)
    return replace(rest, value=np.exp(np.median(logarithms, axis=0)), is_profile=False)


def _recorded(wavevector: Array, value: Array, rest: Density) -> TabulatedSpectrum:
    """Table of measured values and of what lies below their waves."""
    shorter = rest.wavevector > wavevector[-1]
    waves = 2 * np.pi / np.append(wavevector, rest.wavevector[shorter])
    return TabulatedSpectrum(
        tuple(waves.tolist()), tuple(np.append(value, rest.value[shorter]).tolist())
    )


def _continued(
    wavevector: Array,
    value: Array,
    model: Callable[[Array], Array],
    lowest: float | None,
    end: float,
) -> TabulatedSpectrum:
    """Table of values, continued by a model over gaps, to an end, and below `lowest` if given."""
    last = max(2 * math.pi / end, float(wavevector[-1]) * (1 + 1e-6))
    first = [] if lowest is None else [lowest / _FLAT]
    between = []
    for one, other in pairwise([*first, *wavevector.tolist(), last]):
        number = math.ceil(math.log10(other / one) * _CONTINUED_BINS)
        if number > 1:
            between.append(one * (other / one) ** (np.arange(1, number) / number))
    extra = np.concatenate([first, *between, [last]])
    every = np.concatenate([wavevector, extra])
    table = np.concatenate([value, model(extra)])
    order = np.argsort(every)
    return TabulatedSpectrum(
        tuple((2 * np.pi / every[order]).tolist()), tuple(table[order].tolist())
    )


def _shares(
    spectrum: TabulatedSpectrum,
    longer: TabulatedSpectrum,
    wavevector: Array,
    model: Callable[[Array], Array],
) -> Shares:
    """Where e_el comes from; `longer` is the spectrum with the longest waves by the model."""
    total = spectrum.mean_square(0.5)
    # Neighbours further apart than this have a continuation between them.
    apart = np.diff(np.log10(wavevector)) > 1 / _CONTINUED_BINS
    groups = np.split(2 * np.pi / wavevector, np.flatnonzero(apart) + 1)
    parts = [spectrum.mean_square_between(0.5, group[-1], group[0]) for group in groups]
    measured = sum(parts) / total
    finer = np.geomspace(1, 10**_DECADES, 20) * 2 * np.pi / spectrum.short_cutoff
    tail = TabulatedSpectrum(tuple((2 * np.pi / finer).tolist()), tuple(model(finer).tolist()))
    beyond = tail.mean_square_between(0.5, tail.short_cutoff, spectrum.short_cutoff)
    return Shares(measured, 1 - measured, beyond / total, longer.mean_square(0.5) / total - 1)


def _draws(
    scans: Sequence[Scan],
    densities: Sequence[Density],
    logarithms: Sequence[Array],
    scatter: float,
    fit: Fit,
    rest: Density,
) -> tuple[tuple[TabulatedSpectrum, ...], tuple[TabulatedSpectrum, ...]]:
    """Spectra by the states of the fit, continued by the model and by what is recorded."""
    finest = math.log(min(one.band.finest for one in scans))
    coarsest = math.log(min(one.band.coarsest for one in scans))
    rng, apart = map(np.random.default_rng, _SEEDS)
    choices = [_choices(one, density) for one, density in zip(scans, densities, strict=True)]
    hidden = max(one.measurement.hidden for one in scans)
    drawn, recorded = [], []
    for state in rng.integers(len(fit.surface), size=_DRAWS):
        parts = []
        for one, item, options, every in zip(scans, densities, choices, logarithms, strict=True):
            logarithm = every[state] + options[rng.integers(len(options))]
            logarithm = logarithm + rng.standard_normal(item.value.size) / np.sqrt(item.modes)
            logarithm += one.measurement.missing * rng.uniform(0, 1)
            if one.unevenness:
                logarithm += one.unevenness * apart.standard_normal()
            first = rng.integers(_FIRST_BINS)
            highest = 2 * np.pi / one.band.shortest.wavelength * 2 ** -rng.uniform(0, _BAND_OCTAVES)
            kept = (np.arange(item.value.size) >= first) & (item.wavevector <= highest)
            if not np.any(kept):
                kept[:] = True
            parts.append(
                Density(item.wavevector[kept], np.exp(logarithm[kept]), item.modes[kept], False)
            )
        levels = (scatter * rng.standard_normal(len(parts))).tolist()
        wavevector, value, _ = _joined(parts, levels, scatter)
        shortest = min(math.log(2 * np.pi / wavevector[-1]), coarsest)
        last = math.exp(rng.uniform(min(finest, shortest), shortest))
        whole = value * math.exp(hidden * apart.uniform(0, 1)) if hidden else value
        drawn.append(_continued(wavevector, whole, fit.of_state(state), fit.lowest, last))
        recorded.append(_recorded(wavevector, value, rest))
    return tuple(drawn), tuple(recorded)


def _choices(one: Scan, density: Density) -> list[Array]:
    """Logarithms of what other windows and levellings make of a density, relative to it."""
    mine = np.searchsorted(bin_numbers(one.density.wavevector), bin_numbers(density.wavevector))
    others = [np.log(item.value / one.density.value)[mine] for item in one.alternatives]
    # What was chosen counts as much as all else together.
    return [np.zeros(len(mine))] * max(1, len(others)) + others
