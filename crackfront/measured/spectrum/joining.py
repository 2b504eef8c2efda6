"""The joint density of all scans of a surface, and the spectrum that continues it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from crackfront.analysis.estimate import Estimate, exact_estimate, normal_estimate, quantiles
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
from crackfront.measured.spectrum.joint_fit import INTERVAL, Fit, likelihood_with_quadrature

_CONTINUED_BINS = 6
"""Points of a continuation in a decade."""

_LONGEST_CONTINUED = 32.0
"""Longest wave of a continuation over the longest fitted wave: beyond all possible roll-offs."""

ATOMS = 1e-9
"""Shortest wavelength of a continuation: the size of atoms. (Units: m)"""

_SHORTER_WAVES = 100.0
"""Ratio by which the model is continued to shorter waves, to estimate what is missing."""

_LEAST_SHOWN = 1e-4
"""Smallest part of e_el that texts state as a number."""

_DISAGREEMENT_SIGMA = 3.0
"""Significance of the level of a scan that disagrees. (Units: standard errors)"""

_DISAGREEMENT = math.log(1.25)
"""Smallest logarithm of the level of a scan that disagrees."""


@dataclass(frozen=True, slots=True)
class JointDensity:
    """Isotropic density of all scans of a surface over their trusted bands."""

    wavevector: Array
    value: Array
    """Wavevectors of the bins and density there. Shape (n,). (Units: 1 / m and m^4)"""
    error: Array
    """Standard error of the logarithm of the value, with the scatter of scans. Shape (n,)."""
    scatter: float
    """Relative standard deviation of the levels of the scans in excess of their statistics."""
    levels: tuple[Estimate[float], ...]
    """Density of each scan over the density of all others where they overlap, or NaN."""

    def disagrees(self, index: int) -> bool:
        """Whether the level of a scan is significantly different from the others."""
        level = self.levels[index]
        if not math.isfinite(level.value):
            return False
        relative_error = level.standard_error / level.value
        return abs(math.log(level.value)) > max(_DISAGREEMENT, _DISAGREEMENT_SIGMA * relative_error)


@dataclass(frozen=True, slots=True)
class Shares:
    """Contributions to e_el, as parts of it."""

    measured: float
    continued: float
    """Contributions of the measured bands and of the continuation; their sum is 1."""
    missing_short: Estimate[float]
    """Additional e_el of two more decades of shorter waves, but not below atoms: median of the
    models that agree with the data, and the range of 95% of them."""
    continued_long: Estimate[float]
    """Contribution of waves longer than the longest measured one, by the median spectrum, and its
    range in 95% of the spectra that agree with the data."""


def part_of_energy(part: Estimate[float]) -> str:
    """A part of e_el with its range, in per cent, or as a multiple if it is larger than e_el.

    Examples
    --------
    >>> from crackfront.analysis.estimate import exact_estimate
    >>> part_of_energy(exact_estimate(0.7))
    '70% of e_el'
    >>> part_of_energy(Estimate(7.268, math.nan, 0.392, 116.0))
    '7.3 times e_el (0.39 to 120)'
    """
    if part.value < 1:
        text, low, high = (_per_cent(number) for number in (part.value, part.low, part.high))
        text += " of e_el"
    else:
        text, low, high = (f"{_two_digits(x):g}" for x in (part.value, part.low, part.high))
        text += " times e_el"
    return text if low == high else f"{text} ({low} to {high})"


def _per_cent(part: float) -> str:
    """A part in per cent."""
    return f"{_two_digits(100 * part):g}%" if part >= _LEAST_SHOWN else f"under {_LEAST_SHOWN:.2%}"


def _two_digits(number: float) -> float:
    """A number rounded to two significant digits."""
    return float(f"{number:.2g}")


@dataclass(frozen=True, slots=True)
class JointSpectrum:
    """Spectrum of a surface, measured within the trusted bands and continued by the model."""

    spectrum: TabulatedSpectrum
    """Measured over the bands, continued to the shortest wave that pixels and instrument resolve
    and to the plateau. (Units: m)"""
    recorded: TabulatedSpectrum
    """Measured over the bands; below, the density of the finest scan down to its pixels, with its
    noise subtracted but not corrected for its instrument. (Units: m)"""
    extended: TabulatedSpectrum
    """The spectrum with two more decades of shorter waves by the model, but not below atoms.
    (Units: m)"""
    draws: Draws
    """Random spectra that agree with the measurements."""
    density: JointDensity
    fit: Fit
    shares: Shares

    @property
    def shortest(self) -> float:
        """Shortest measured wavelength (Units: m)."""
        return float(2 * np.pi / self.density.wavevector[-1])

    @property
    def longest(self) -> float:
        """Longest measured wavelength (Units: m)."""
        return float(2 * np.pi / self.density.wavevector[0])


def joint_spectrum(
    scans: Sequence[Scan], seed: int | None = None, numbers: Sequence[int] | None = None
) -> JointSpectrum:
    """Spectrum of all scans of a surface.

    The seed and the allowed numbers of batches are for the draws. By default they are `SEED` and
    `BATCHES` of :mod:`crackfront.measured.spectrum.draws`; intervals hardly depend on either.
    ValueError if the densities do not determine a spectrum.
    """
    model, quadrature = likelihood_with_quadrature(
        [(scan.fitted, scan.band.instrument) for scan in scans]
    )
    states = batches(model, quadrature, seed)
    first = next(states)
    fit = first.fit
    trusted = [scan.trusted for scan in scans]
    isotropic = []
    for index, density in enumerate(trusted):
        value = np.exp(quantiles(fit.isotropic(density, index), fit.weight, 0.5))
        isotropic.append(replace(density, value=value, is_profile=False))
    scatter, levels = _levels(isotropic)
    joint = JointDensity(*_joined(isotropic, scatter), scatter, levels)
    end = min(scan.band.end for scan in scans)
    spectrum = _continued(joint, fit, end)
    below_bands = _below_bands(scans, fit)
    finest = min(end, *(scan.band.shortest_end for scan in scans))
    continuation = _gaps(joint.wavevector, fit.lowest, finest)
    sampler = SpectrumSampler(
        scans=scans,
        trusted=trusted,
        scatter=scatter,
        departure=model.departure,
        wavevector=joint.wavevector,
        value=joint.value,
        below_bands=below_bands,
        grid=np.sort(np.append(joint.wavevector, continuation)),
    )
    extended = _extended(spectrum, fit)
    draws = drawn(sampler, itertools.chain([first], states), numbers or sampling.BATCHES)
    measured = _measured_share(spectrum, joint.wavevector)
    return JointSpectrum(
        spectrum=spectrum,
        extended=extended,
        recorded=_recorded(joint, below_bands),
        draws=draws,
        density=joint,
        fit=fit,
        shares=Shares(
            measured=measured,
            continued=1 - measured,
            missing_short=_missing_short(spectrum, extended, fit),
            continued_long=_continued_long(spectrum, joint.wavevector, draws),
        ),
    )


def _levels(densities: Sequence[Density]) -> tuple[float, tuple[Estimate[float], ...]]:
    """Scatter of the levels of scans, and the level of each scan relative to the others."""
    numbers = [bin_numbers(density.wavevector) for density in densities]
    bins = np.unique(np.concatenate(numbers))
    value, modes = np.zeros((2, len(densities), bins.size))
    for row, (density, number) in enumerate(zip(densities, numbers, strict=True)):
        columns = np.searchsorted(bins, number)
        value[row, columns], modes[row, columns] = density.value, density.modes
    rows = range(len(densities))
    logarithms, errors = zip(*(_log_level(value, modes, row) for row in rows), strict=True)
    finite = np.isfinite(logarithms)
    scatter = 0.0
    if np.count_nonzero(finite) > 1:
        # Levels are relative to the other scans, so that two scans show one difference twice.
        overlapping = np.array([logarithms, errors])[:, finite]
        excess = float(np.mean(overlapping[0] ** 2 - overlapping[1] ** 2))
        scatter = math.sqrt(max(0.0, excess) / 2)
    return scatter, tuple(map(_level, logarithms, errors))


def _log_level(value: Array, modes: Array, row: int) -> tuple[float, float]:
    """Logarithm of the level of a scan and its standard error, or NaN without overlap.

    Values and modes have the shape (n_scan, n_bin), with zeros outside the bands.
    """
    other_modes = np.delete(modes, row, axis=0).sum(axis=0)
    other_power = np.delete(value * modes, row, axis=0).sum(axis=0)
    shared = (modes[row] > 0) & (other_modes > 0)
    if not np.any(shared):
        return math.nan, math.nan
    ratios = np.log(value[row, shared] / (other_power[shared] / other_modes[shared]))
    weights = 1 / (1 / modes[row, shared] + 1 / other_modes[shared])
    return float(np.average(ratios, weights=weights)), float(np.sum(weights)) ** -0.5


def _level(logarithm: float, error: float) -> Estimate[float]:
    """Level from its logarithm and the standard error of that logarithm."""
    level = normal_estimate(logarithm, error).each(math.exp)
    return replace(level, standard_error=level.value * error)


def _joined(densities: Sequence[Density], scatter: float) -> tuple[Array, Array, Array]:
    """Wavevectors, values and relative errors of the joint density of all scans."""
    logarithms = np.log(np.concatenate([density.wavevector for density in densities]))
    values = np.concatenate([density.value for density in densities])
    modes = np.concatenate([density.modes for density in densities])
    bins = np.concatenate([bin_numbers(density.wavevector) for density in densities])
    _, index = np.unique(bins, return_inverse=True)
    weight = 1 / (1 / modes + scatter**2)
    total = np.bincount(index, weight)
    wavevector = np.exp(np.bincount(index, weight * logarithms) / total)
    value = np.bincount(index, weight * values) / total
    return wavevector, value, np.asarray(total**-0.5)


def _below_bands(scans: Sequence[Scan], fit: Fit) -> Density:
    """Density of the finest scan below all trusted bands, with its noise subtracted."""

    def fineness(index: int) -> tuple[float, float]:
        scan = scans[index]
        return max(scan.measurement.pixels), scan.band.shortest.wavelength

    index = min(range(len(scans)), key=fineness)
    finest = scans[index]
    longest = min(scan.band.shortest.wavelength for scan in scans) / (1 + 1e-6)
    shortest = max(NYQUIST * max(finest.measurement.pixels), finest.band.noise_limit)
    density = finest.density.within(shortest, longest)
    if not density.value.size:
        return replace(density, is_profile=False)
    logarithms = fit.isotropic(density, index, restored=False)
    return replace(density, value=np.exp(np.median(logarithms, axis=0)), is_profile=False)


def _recorded(density: JointDensity, below_bands: Density) -> TabulatedSpectrum:
    """Table of the joint density, and of the density at shorter waves."""
    shorter = below_bands.wavevector > density.wavevector[-1]
    waves = 2 * np.pi / np.append(density.wavevector, below_bands.wavevector[shorter])
    values = np.append(density.value, below_bands.value[shorter])
    return TabulatedSpectrum(tuple(waves.tolist()), tuple(values.tolist()))


def _continued(density: JointDensity, fit: Fit, end: float) -> TabulatedSpectrum:
    """Table of the joint density, continued over gaps, to longer waves, and to an end."""
    continuation = _gaps(density.wavevector, fit.lowest, end)
    wavevector = np.concatenate([density.wavevector, continuation])
    value = np.concatenate([density.value, fit.median(continuation)])
    order = np.argsort(wavevector)
    wavelengths = 2 * np.pi / wavevector[order]
    return TabulatedSpectrum(tuple(wavelengths.tolist()), tuple(value[order].tolist()))


def _gaps(wavevector: Array, lowest: float, end: float) -> Array:
    """Wavevectors of a continuation: in gaps, at longer waves, and to an end (Units: 1 / m)."""
    first = lowest / _LONGEST_CONTINUED
    last = max(2 * math.pi / end, float(wavevector[-1]) * (1 + 1e-6))
    parts = [np.array([first])]
    for below, above in pairwise([first, *wavevector.tolist(), last]):
        number = math.ceil(math.log10(above / below) * _CONTINUED_BINS)
        if number > 1:
            parts.append(below * (above / below) ** (np.arange(1, number) / number))
    return np.concatenate([*parts, [last]])


def continued_end(end: float) -> float:
    """Shortest wave that may be missing below the end of a spectrum (Units: m)."""
    return min(end, max(end / _SHORTER_WAVES, ATOMS))


def _finer(spectrum: TabulatedSpectrum) -> Array:
    """Wavevectors from the end of a spectrum over the shorter waves that may be missing."""
    end = spectrum.short_cutoff
    return np.geomspace(1, end / continued_end(end), 20) * 2 * np.pi / end


def _extended(spectrum: TabulatedSpectrum, fit: Fit) -> TabulatedSpectrum:
    """A spectrum with the shorter waves that may be missing."""
    if continued_end(spectrum.short_cutoff) == spectrum.short_cutoff:
        return spectrum
    finer = _finer(spectrum)[1:]
    return TabulatedSpectrum(
        (*spectrum.wavelengths, *(2 * np.pi / finer).tolist()),
        (*spectrum.densities, *fit.median(finer).tolist()),
    )


def _measured_share(spectrum: TabulatedSpectrum, wavevector: Array) -> float:
    """Contribution of the measured bands to e_el, for measured wavevectors."""
    # The continuation fills wider gaps than this.
    gaps = np.diff(np.log10(wavevector)) > 1 / _CONTINUED_BINS
    groups = np.split(2 * np.pi / wavevector, np.flatnonzero(gaps) + 1)
    parts = [spectrum.mean_square_between(0.5, group[-1], group[0]) for group in groups]
    # Because of round-off the sum may be above the total.
    return min(sum(parts) / spectrum.mean_square(0.5), 1.0)


def _missing_short(
    spectrum: TabulatedSpectrum, extended: TabulatedSpectrum, fit: Fit
) -> Estimate[float]:
    """Additional e_el of the shorter waves that may be missing, over e_el."""
    if extended is spectrum:
        return exact_estimate(0.0)
    total = spectrum.mean_square(0.5)
    beyond = extended.mean_square_between(0.5, extended.short_cutoff, spectrum.short_cutoff)
    finer = _finer(spectrum)
    ends = (np.full(len(fit.weight), wavevector) for wavevector in finer[[0, -1]])
    first, last = sampling.mean_squares(finer, fit.logarithms(finer), *ends)
    order = sampling.ORDERS.index(0.5)
    return _with_range(beyond / total, (last - first)[order] / total, fit.weight)


def _continued_long(
    spectrum: TabulatedSpectrum, wavevector: Array, draws: Draws
) -> Estimate[float]:
    """Contribution to e_el of waves longer than the measured wavevectors."""
    longest = max(2 * np.pi / float(wavevector[0]), spectrum.short_cutoff)
    longer = spectrum.longer_than(longest).mean_square(0.5) / spectrum.mean_square(0.5)
    total = draws.estimated[sampling.ORDERS.index(0.5)]
    return _with_range(longer, draws.outside[0] / total, draws.weight)


def _with_range(value: float, values: Array, weight: Array) -> Estimate[float]:
    """A number with the 95% range of its values in weighted draws, widened to contain it."""
    low, high = quantiles(values, weight, INTERVAL[::2]).tolist()
    return Estimate(value, math.nan, min(low, value), max(high, value))
