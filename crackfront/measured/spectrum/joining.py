"""One density of all scans of a surface with its scatter, and the spectrum that continues it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from crackfront.analysis.estimate import Estimate, normal_estimate, quantiles
from crackfront.core.arrays import Array
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.measured.density.bands import NYQUIST, Scan
from crackfront.measured.density.densities import Density, bin_numbers
from crackfront.measured.spectrum import draws as sampling
from crackfront.measured.spectrum.draws import (
    Draws,
    SpectrumSampler,
    batches,
    drawn,
)
from crackfront.measured.spectrum.fit import Fit, quadrature_of

_CONTINUED_BINS = 6
"""Points a decade of a continuation."""

_FLAT = 32.0
"""How far beyond the longest waves a continuation goes: all roll-offs that are looked for."""

_DECADES = 2
"""Decades below the pixels over which the model is continued, to see what is missing."""

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
    continued_long: float
    """Part in waves longer than all that are measured, which the model continues."""


def part_of_energy(part: float) -> str:
    """A part of e_el as a share, or as a multiple where it is more than all of it.

    Examples
    --------
    >>> part_of_energy(0.7), part_of_energy(122.68)
    ('70% of e_el', '123 times e_el')
    """
    return f"{part:.0%} of e_el" if part < 1 else f"{part:.3g} times e_el"


@dataclass(frozen=True, slots=True)
class JointSpectrum:
    """Spectrum of a surface, measured where it can be and continued beyond."""

    spectrum: TabulatedSpectrum
    """Measured over the bands; by the model to the shortest wave that pixels and instrument hold,
    and to the plateau. (Units: m)"""
    recorded: TabulatedSpectrum
    """As measured, and below the band what the finest scan holds down to its pixels, without its
    noise but as weak as its instrument made it. (Units: m)"""
    extended: TabulatedSpectrum
    """The spectrum with two more decades of shorter waves, by the model. (Units: m)"""
    draws: Draws
    """Spectra that agree as well with what was measured."""
    density: JointDensity
    fit: Fit
    shares: Shares

    @property
    def shortest(self) -> float:
        """Shortest wavelength that is measured (Units: m)."""
        return float(2 * np.pi / self.density.wavevector[-1])

    @property
    def longest(self) -> float:
        """Longest wavelength that is measured (Units: m)."""
        return float(2 * np.pi / self.density.wavevector[0])


def joint_spectrum(
    scans: Sequence[Scan], seed: int | None = None, numbers: Sequence[int] | None = None
) -> JointSpectrum:
    """Spectrum of all scans of a surface, refused where their densities do not determine one.

    The seed is that of the draws, and the numbers are of batches of these; where none are given,
    those of :mod:`crackfront.measured.spectrum.draws`. Intervals hardly depend on either.
    """
    model, quadrature = quadrature_of([(one.fitted, one.band.instrument) for one in scans])
    states = batches(model, quadrature, seed)
    first = next(states)
    fit = first.fit
    trusted = [one.trusted for one in scans]
    isotropic = [
        replace(
            item,
            value=np.exp(quantiles(fit.isotropic(item, index), fit.weight, 0.5)),
            is_profile=False,
        )
        for index, item in enumerate(trusted)
    ]
    scatter, levels = _levels(isotropic)
    density = JointDensity(*_joined(isotropic, scatter), scatter, levels)
    end = min(one.band.end for one in scans)
    spectrum = _continued(density, fit, end)
    rest = _below_bands(scans, fit)
    finest = min(end, *(one.band.shortest_end for one in scans))
    sampler = SpectrumSampler(
        scans,
        trusted,
        scatter,
        model.departure,
        density.wavevector,
        density.value,
        rest,
        np.sort(np.append(density.wavevector, _gaps(density.wavevector, fit.lowest, finest))),
    )
    extended = _extended(spectrum, fit)
    return JointSpectrum(
        spectrum=spectrum,
        extended=extended,
        recorded=_recorded(density, rest),
        draws=drawn(sampler, itertools.chain([first], states), numbers or sampling.BATCHES),
        density=density,
        fit=fit,
        shares=_shares(spectrum, extended, density.wavevector),
    )


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


def _joined(densities: Sequence[Density], scatter: float) -> tuple[Array, Array, Array]:
    """Wavevectors, densities and their relative errors, of all scans."""
    places = np.concatenate([bin_numbers(one.wavevector) for one in densities])
    values = np.concatenate([one.value for one in densities])
    wavevector = np.log(np.concatenate([one.wavevector for one in densities]))
    modes = np.concatenate([one.modes for one in densities])
    weight = 1 / (1 / modes + scatter**2)
    _, index = np.unique(places, return_inverse=True)
    total = np.bincount(index, weight)
    logarithm, value = (np.bincount(index, weight * part) / total for part in (wavevector, values))
    return np.exp(logarithm), value, np.asarray(total**-0.5)


def _below_bands(scans: Sequence[Scan], fit: Fit) -> Density:
    """Density of the finest scan between all trusted waves and its noise, which is subtracted."""

    def fineness(item: tuple[int, Scan]) -> tuple[float, float]:
        return max(item[1].measurement.pixels), item[1].band.shortest.wavelength

    index, one = min(enumerate(scans), key=fineness)
    shortest = min(other.band.shortest.wavelength for other in scans) / (1 + 1e-6)
    last = max(NYQUIST * max(one.measurement.pixels), one.band.noise_limit)
    rest = one.density.within(last, shortest)
    if not rest.value.size:
        return replace(rest, is_profile=False)
    logarithms = fit.isotropic(rest, index, restored=False)
    return replace(rest, value=np.exp(np.median(logarithms, axis=0)), is_profile=False)


def _recorded(density: JointDensity, rest: Density) -> TabulatedSpectrum:
    """Table of measured values and of what lies below their waves."""
    shorter = rest.wavevector > density.wavevector[-1]
    waves = 2 * np.pi / np.append(density.wavevector, rest.wavevector[shorter])
    values = np.append(density.value, rest.value[shorter])
    return TabulatedSpectrum(tuple(waves.tolist()), tuple(values.tolist()))


def _continued(density: JointDensity, fit: Fit, end: float) -> TabulatedSpectrum:
    """Table of what is measured, continued over gaps, to longer waves, and to an end."""
    extra = _gaps(density.wavevector, fit.lowest, end)
    every = np.concatenate([density.wavevector, extra])
    table = np.concatenate([density.value, fit.median(extra)])
    order = np.argsort(every)
    return TabulatedSpectrum(
        tuple((2 * np.pi / every[order]).tolist()), tuple(table[order].tolist())
    )


def _gaps(wavevector: Array, lowest: float, end: float) -> Array:
    """Wavevectors in the gaps between others, below them, and to an end (Units: 1 / m)."""
    last = max(2 * math.pi / end, float(wavevector[-1]) * (1 + 1e-6))
    found = [np.array([lowest / _FLAT])]
    for one, other in pairwise([lowest / _FLAT, *wavevector.tolist(), last]):
        number = math.ceil(math.log10(other / one) * _CONTINUED_BINS)
        if number > 1:
            found.append(one * (other / one) ** (np.arange(1, number) / number))
    return np.concatenate([*found, [last]])


def _extended(spectrum: TabulatedSpectrum, fit: Fit) -> TabulatedSpectrum:
    """A spectrum with two more decades of shorter waves."""
    finer = np.geomspace(1, 10**_DECADES, 20)[1:] * 2 * np.pi / spectrum.short_cutoff
    return TabulatedSpectrum(
        (*spectrum.wavelengths, *(2 * np.pi / finer).tolist()),
        (*spectrum.densities, *fit.median(finer).tolist()),
    )


def _shares(spectrum: TabulatedSpectrum, extended: TabulatedSpectrum, wavevector: Array) -> Shares:
    """Where e_el comes from."""
    total = spectrum.mean_square(0.5)
    # Neighbours further apart than this have a continuation between them.
    apart = np.diff(np.log10(wavevector)) > 1 / _CONTINUED_BINS
    groups = np.split(2 * np.pi / wavevector, np.flatnonzero(apart) + 1)
    parts = [spectrum.mean_square_between(0.5, group[-1], group[0]) for group in groups]
    # Round-off may not leave less than nothing to the continuation.
    measured = min(sum(parts) / total, 1.0)
    beyond = extended.mean_square_between(0.5, extended.short_cutoff, spectrum.short_cutoff)
    longest = max(2 * np.pi / float(wavevector[0]), spectrum.short_cutoff)
    longer = spectrum.longer_than(longest).mean_square(0.5)
    return Shares(measured, 1 - measured, beyond / total, longer / total)
