"""Surfaces from a spectral density, or from the numbers of a self-affine one, without heights."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.special import j0, j1

from crackfront.analysis.estimate import exact_estimate
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum, TabulatedSpectrum
from crackfront.measured.options import SelfAffineOptions
from crackfront.measured.scan.psd import Psd
from crackfront.measured.spectrum.draws import ORDERS
from crackfront.measured.spectrum.joining import ATOMS, Shares, continued_end, part_of_energy
from crackfront.measured.spectrum.measured_surface import (
    DOMINANT_SHARE,
    MeasuredSurface,
    RmsMeasure,
    RoughSurface,
)
from crackfront.surfaces.written_units import prefixed

_NOTABLE_SHARE = 0.1
"""Smallest part of e_el in missing waves that a reservation states."""

_LEAST_SHARE = 0.01
"""Smallest part of e_el that a reservation states as a number."""

_UNPROJECTION_STEPS = 3
"""Steps to the isotropic density; more would amplify noise."""

_PROJECTION_NODES = 200
"""Nodes of the quadrature of a projection."""

_PROJECTION_END = 8.0
"""End of this quadrature in arccosh(k / q)."""

_LONGER_WAVES = 4.0
"""Ratio by which a table is continued to longer waves, to estimate what is missing."""

_SLOPE_RANGE = 4.0
"""Ratio of the wavelengths from which the power law at an end of a table is determined."""

_STEEPEST_PLATEAU = -1.0
"""Power of the wavevector below which a density still rises at its longest waves."""

_SHOWN_WAVES = 100.0
"""Wavelength over the default short cutoff up to which a reservation states the part of e_el."""

_MOST_ROLL_OFF = 100.0
"""Longest roll-off over the correlation length, or over the short cutoff if this is longer."""

_LAST_WAVE = 300.0
"""End of the integral of an autocorrelation, in wavevector times distance."""

_POINTS = 20_001
"""Points of this integral."""


@dataclass(frozen=True, slots=True)
class StatedSurface(RoughSurface):
    """A surface by its spectrum alone, which is taken as exact."""

    origin: str
    """Source of the spectrum, in words."""
    spectrum: TabulatedSpectrum
    """Isotropic density. (Units: m)"""
    shares: Shares
    """Contributions to e_el."""
    doubts: tuple[str, ...]
    """Sentences on assumptions and missing waves."""
    longest_cutoff: float | None
    """Longest wave that may be the shortest one, if the short cutoff is only assumed; else None.
    (Units: m)"""

    @property
    def scans(self) -> tuple[()]:
        """No scans."""
        return ()

    @property
    def shortest(self) -> float:
        """Shortest wavelength of the spectrum (Units: m)."""
        return self.spectrum.short_cutoff

    @property
    def longest(self) -> float:
        """Longest wavelength before the spectrum is flat (Units: m)."""
        return self.spectrum.wavelengths[0]

    @property
    def checksum(self) -> str:
        """Eight hexadecimal digits of the spectrum."""
        text = repr((self.spectrum.wavelengths, self.spectrum.densities))
        return hashlib.sha256(text.encode()).hexdigest()[:8]


Surface = MeasuredSurface | StatedSurface
"""Surfaces that predictions accept."""


def density_surface(psd: Psd) -> StatedSurface:
    """Surface from a spectral density that another program exported.

    A density of profiles is converted to the isotropic density.
    """
    value = _unprojected(psd.wavevector, psd.value) if psd.is_profile else psd.value
    wavelengths = 2 * np.pi / psd.wavevector
    spectrum = TabulatedSpectrum(tuple(wavelengths.tolist()), tuple(value.tolist()))
    total = spectrum.mean_square(0.5)
    long = spectrum.longer_than(spectrum.wavelengths[0] * (1 - 1e-12)).mean_square(0.5) / total
    missing = _shorter(spectrum) / total
    doubts = [*psd.assumptions, *_missing_waves(spectrum, total, missing, long)]
    shares = Shares(1 - long, long, exact_estimate(missing), exact_estimate(long))
    return _stated(f"{psd.path}: {psd.convention}", spectrum, shares, doubts)


def self_affine_surface_of(options: SelfAffineOptions) -> StatedSurface:
    """Surface with a :class:`SelfAffineSpectrum`.

    ValueError if a number is missing, or the numbers contradict each other.
    """
    rms, hurst, length = options.rms, options.hurst, options.correlation_length
    needs = "a self-affine surface needs rms, hurst, and either a correlation length or a roll-off"
    if length is not None and options.roll_off is not None:
        raise ValueError(f"{needs}; both lengths are named")
    required = {"rms": rms, "hurst": hurst, "correlation length": length or options.roll_off}
    missing = [name for name, value in required.items() if value is None]
    if rms is None or hurst is None or missing:
        raise ValueError(f"{needs}; name {' and '.join(missing)}")
    shape = _self_affine_shape(options, rms, hurst)
    cutoff, roll_off = shape.short_cutoff, shape.roll_off
    waves = (roll_off, cutoff) if roll_off > cutoff else (2 * cutoff, cutoff)
    densities = shape.density(2 * np.pi / np.array(waves)).tolist()
    lengths = f"roll-off {prefixed('m', roll_off)}"
    if length is not None:
        lengths += f", of a correlation length of {prefixed('m', length)}"
    doubts, longest_cutoff = [], None
    if options.short_cutoff is None:
        longest_cutoff = min(_SHOWN_WAVES * cutoff, roll_off)
        doubts = [_default_cutoff_doubt(shape, longest_cutoff)]
    return _stated(
        f"rms height {prefixed('m', rms)}, {lengths}, H {hurst:g}",
        TabulatedSpectrum(waves, tuple(densities)),
        Shares(1.0, 0.0, exact_estimate(0.0), exact_estimate(0.0)),
        doubts,
        longest_cutoff,
    )


def _self_affine_shape(options: SelfAffineOptions, rms: float, hurst: float) -> SelfAffineSpectrum:
    """Spectrum with its rms height; ValueError if the lengths contradict each other (Units: m)."""
    cutoff, length = options.short_cutoff, options.correlation_length
    if cutoff is None:
        if hurst <= 0.5:
            raise ValueError(
                f"the shortest waves decide e_el where the Hurst exponent is {hurst:g}, not above "
                "0.5; name their wavelength as short cutoff, as in 10nm"
            )
        cutoff = ATOMS
    roll_off = options.roll_off if length is None else _roll_off(length, hurst, cutoff)
    assert roll_off is not None
    if roll_off < cutoff:
        raise ValueError(
            f"the roll-off, {prefixed('m', roll_off)}, is shorter than the short cutoff, "
            f"{prefixed('m', cutoff)}; name a shorter short cutoff"
        )
    shape = SelfAffineSpectrum(cutoff, roll_off, hurst)
    return shape.amplified(rms**2 / shape.mean_square(0.0))


def _default_cutoff_doubt(shape: SelfAffineSpectrum, end: float) -> str:
    """Sentence on e_el in waves up to an end, which the default of the cutoff decides."""
    cutoff = shape.short_cutoff
    part = shape.mean_square_between(0.5, cutoff, end) / shape.mean_square(0.5)
    share = f"{part:.0%}" if part >= _LEAST_SHARE else f"under {_LEAST_SHARE:.0%}"
    return (
        f"No short cutoff is named: the power law is continued to {prefixed('m', cutoff)}, "
        f"and waves shorter than {prefixed('m', end)} have {share} of e_el."
    )


def _projection(wavevector: Array, density: Callable[[Array], Array]) -> Array:
    """Integral of an isotropic density along lines, over k = q cosh(t)."""
    node, weight = np.polynomial.legendre.leggauss(_PROJECTION_NODES)
    angle = _PROJECTION_END * (1 + node) / 2
    k = wavevector[:, None] * np.cosh(angle)
    return np.asarray((density(k) * k) @ (weight * _PROJECTION_END / 2) / np.pi)


def _unprojected(wavevector: Array, profile: Array) -> Array:
    """Isotropic density from a density of profiles.

    A few steps correct the density by the ratio of the profile to its projection, so that e_el is
    right to 2%. The density continues after its last value as a power law.
    """
    positions = np.log(wavevector)
    falling = np.flatnonzero(np.gradient(np.log(profile), positions) < _STEEPEST_PLATEAU)
    knee = wavevector[falling[0]] if falling.size else wavevector[-1]
    isotropic = np.pi * profile / np.hypot(wavevector, knee)
    for _ in range(_UNPROJECTION_STEPS):
        logarithms = np.log(isotropic)
        slope = min(_end_slope(positions, logarithms, last=True), -1.5)

        def density(k: Array, logarithms: Array = logarithms, slope: float = slope) -> Array:
            beyond = np.maximum(np.log(k) - positions[-1], 0.0)
            return np.exp(np.interp(np.log(k), positions, logarithms) + slope * beyond)

        isotropic = isotropic * profile / _projection(wavevector, density)
    return isotropic


def _end_slope(positions: Array, logarithms: Array, *, last: bool) -> float:
    """Power of the wavevector in a density over its shortest (`last`) or longest waves."""
    reach = math.log(_SLOPE_RANGE)
    near = positions > positions[-1] - reach if last else positions < positions[0] + reach
    count = max(2, int(np.count_nonzero(near)))
    end = slice(-count, None) if last else slice(count)
    return float(np.polyfit(positions[end], logarithms[end], 1)[0])


def _logarithms(spectrum: TabulatedSpectrum) -> tuple[Array, Array]:
    """Logarithms of wavevectors and of densities."""
    return np.log(2 * np.pi / np.array(spectrum.wavelengths)), np.log(spectrum.densities)


def _shorter(spectrum: TabulatedSpectrum) -> float:
    """Mean square of the half-derivative in missing shorter waves, by a power law."""
    last = spectrum.short_cutoff
    shortest = continued_end(last)
    if shortest == last:
        return 0.0
    slope = _end_slope(*_logarithms(spectrum), last=True)
    end = spectrum.densities[-1]
    tail = TabulatedSpectrum((last, shortest), (end, end * (last / shortest) ** slope))
    return tail.mean_square_between(0.5, shortest, last * (1 - 1e-12))


def _missing_waves(
    spectrum: TabulatedSpectrum, total: float, missing: float, long: float
) -> Iterator[str]:
    """Sentences on missing waves that contribute to e_el."""
    first = spectrum.wavelengths[0]
    short, longest = (prefixed("m", wave) for wave in (spectrum.short_cutoff, first))
    end = prefixed("m", continued_end(spectrum.short_cutoff))
    slope = _end_slope(*_logarithms(spectrum), last=False)
    if slope < _STEEPEST_PLATEAU:
        longer = TabulatedSpectrum(
            (_LONGER_WAVES * first, first),
            (spectrum.densities[0] * _LONGER_WAVES**-slope, spectrum.densities[0]),
        )
        more = longer.mean_square(0.5) / total - long
        if more > _NOTABLE_SHARE:
            yield (
                f"The density rises up to its longest wave, {longest}, and is taken as flat above; "
                f"with a roll-off at {_LONGER_WAVES:g} times this wavelength there would be "
                f"{part_of_energy(exact_estimate(more))} more; add longer waves."
            )
    if missing > _NOTABLE_SHARE:
        yield (
            f"Waves shorter than {short} are left out of all numbers and intervals: down to {end} "
            f"the power law would add {part_of_energy(exact_estimate(missing))}; add shorter waves."
        )


def _roll_off(length: float, hurst: float, cutoff: float) -> float:
    """Roll-off wavelength of a spectrum with a correlation length, all in metres."""

    def excess(logarithm: float) -> float:
        roll_off = max(cutoff, math.exp(logarithm))  # shorter by round-off alone
        return _autocorrelation(length, roll_off, hurst, cutoff) - math.exp(-1)

    longest = _MOST_ROLL_OFF * max(cutoff, length)
    ends = math.log(max(cutoff, length / 2)), math.log(longest)
    if excess(ends[0]) > 0:
        raise ValueError(
            f"waves longer than a cutoff of {prefixed('m', cutoff)} cannot have a correlation "
            f"length of {prefixed('m', length)}; name a shorter short cutoff"
        )
    if excess(ends[1]) < 0:
        raise ValueError(
            f"with a Hurst exponent of {hurst:g} and a short cutoff of {prefixed('m', cutoff)}, a "
            f"correlation length of {prefixed('m', length)} needs a roll-off above "
            f"{prefixed('m', longest)}; name the roll-off in its place, a larger Hurst exponent or "
            "a longer short cutoff"
        )
    return max(cutoff, math.exp(scipy.optimize.brentq(excess, *ends, xtol=1e-10)))


def _autocorrelation(distance: float, roll_off: float, hurst: float, cutoff: float) -> float:
    """Normalised autocorrelation of the heights of a self-affine surface."""
    knee, end = 2 * math.pi * distance / roll_off, 2 * math.pi * distance / cutoff
    integral = knee * float(j1(knee))
    if (last := min(end, knee + _LAST_WAVE)) > knee:
        x = np.linspace(knee, last, _POINTS)
        integral += float(np.trapezoid(knee * (x / knee) ** (-1 - 2 * hurst) * j0(x), x))
    shape = SelfAffineSpectrum(cutoff, roll_off, hurst)
    return integral / (2 * math.pi * distance**2 * shape.mean_square(0.0))


def _stated(
    origin: str,
    spectrum: TabulatedSpectrum,
    shares: Shares,
    doubts: list[str],
    longest_cutoff: float | None = None,
) -> StatedSurface:
    """Surface with an exact spectrum, whose measures have intervals of zero width."""
    half = exact_estimate(spectrum.mean_square(0.5))
    return StatedSurface(
        measures=tuple(
            RmsMeasure(
                order,
                exact_estimate(math.sqrt(spectrum.mean_square(order))),
                *spectrum.dominant_wavelengths(order, DOMINANT_SHARE),
            )
            for order in ORDERS
        ),
        half_derivative=half,
        recorded=half,
        origin=origin,
        spectrum=spectrum,
        shares=shares,
        doubts=tuple(doubts),
        longest_cutoff=longest_cutoff,
    )
