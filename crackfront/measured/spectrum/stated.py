"""Surfaces of which no heights are given, but a spectral density or the numbers of one."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.special import j0, j1

from crackfront.analysis.estimate import Estimate
from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum, TabulatedSpectrum
from crackfront.measured.options import SelfAffineOptions
from crackfront.measured.scan.psd import Psd
from crackfront.measured.spectrum.draws import ORDERS
from crackfront.measured.spectrum.joining import Shares, part_of_energy
from crackfront.measured.spectrum.measured_surface import (
    DOMINANT_SHARE,
    MeasuredSurface,
    RmsMeasure,
    RoughSurface,
)
from crackfront.surfaces.written_units import prefixed

_NOTABLE_SHARE = 0.1
"""Share of e_el in waves missing from the table above which a reservation states it."""

_STEPS, _DIRECTIONS, _FURTHEST = 3, 200, 8.0
"""Steps to the isotropic density, quadrature of a projection, and its end in arccosh(k / q)."""

_DECADES, _LONGER = 100.0, 4.0
"""How far a table is continued to see what it lacks: to shorter and to longer waves."""

_SLOPE_OVER = 4.0
"""Factor in wavelength over which the power law at an end of a table is taken."""

_RISING = -1.0
"""Power of the wavevector from which on a density has no plateau at its longest waves."""

ATOMS = 1e-9
"""Shortest wavelength where none is named (Units: m)."""

_SHOWN_OVER_CUTOFF = 100.0
"""Waves up to this many short cutoffs have their share of e_el stated if no cutoff is named."""

_MOST_ROLL_OFF = 100.0
"""Longest roll-off over the correlation length, or over the short cutoff if this is longer."""

_LAST_WAVE, _POINTS = 300.0, 20_001
"""Wavevector times distance where the integral of an autocorrelation ends, and its points."""


@dataclass(frozen=True, slots=True)
class StatedSurface(RoughSurface):
    """A surface by its spectrum alone, which is taken as exact."""

    origin: str
    """What the spectrum comes from, in words."""
    spectrum: TabulatedSpectrum
    """Isotropic density. (Units: m)"""
    shares: Shares
    """Where e_el comes from."""
    doubts: tuple[str, ...]
    """Sentences on what is assumed or missing."""

    @property
    def scans(self) -> tuple[()]:
        """There are none."""
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
"""What predictions are made for."""


def density_surface(psd: Psd) -> StatedSurface:
    """Surface of a density that another program has made of its heights.

    That of profiles becomes the isotropic density whose projection it is.
    """
    value = _unprojected(psd.wavevector, psd.value) if psd.is_profile else psd.value
    wavelengths = 2 * np.pi / psd.wavevector
    spectrum = TabulatedSpectrum(tuple(wavelengths.tolist()), tuple(value.tolist()))
    total = spectrum.mean_square(0.5)
    long = spectrum.longer_than(spectrum.wavelengths[0] * (1 - 1e-12)).mean_square(0.5) / total
    missing = _shorter(spectrum) / total
    doubts = [*psd.assumptions, *_missing_waves(spectrum, total, missing, long)]
    return _stated(
        f"{psd.path}: {psd.convention}", spectrum, Shares(1 - long, long, missing, long), doubts
    )


def self_affine_surface_of(given: SelfAffineOptions) -> StatedSurface:
    """Surface of numbers of a self-affine spectrum, as of :class:`SelfAffineSpectrum`.

    ValueError, of one sentence, where a number is missing or they contradict each other.
    """
    rms, hurst = given.rms, given.hurst
    needs = "a surface of numbers needs rms and hurst, and one of correlation length and roll-off"
    if given.correlation_length is not None and given.roll_off is not None:
        raise ValueError(f"{needs}; both of these are named")
    is_bounded = given.correlation_length is not None or given.roll_off is not None
    if rms is None or hurst is None or not is_bounded:
        missing = ["rms"] * (rms is None) + ["hurst"] * (hurst is None)
        missing += ["correlation length"] * (not is_bounded)
        raise ValueError(f"{needs}; name {' and '.join(missing)}")
    cutoff, doubts = given.short_cutoff, []
    if cutoff is None:
        if hurst <= 0.5:
            raise ValueError(
                f"the shortest waves decide e_el where the Hurst exponent is {hurst:g}, not above "
                "0.5; name their wavelength as short cutoff, as in 10nm"
            )
        cutoff = ATOMS
    length = given.correlation_length
    roll_off = given.roll_off if length is None else _roll_off(length, hurst, cutoff)
    assert roll_off is not None
    if roll_off < cutoff:
        raise ValueError(
            f"the roll-off, {prefixed('m', roll_off)}, is shorter than the short cutoff, "
            f"{prefixed('m', cutoff)}; name a shorter short cutoff"
        )
    shape = SelfAffineSpectrum(cutoff, roll_off, hurst)
    shape = shape.amplified(rms**2 / shape.mean_square(0.0))
    if given.short_cutoff is None:
        end = min(_SHOWN_OVER_CUTOFF * cutoff, roll_off)
        part = shape.mean_square_between(0.5, cutoff, end) / shape.mean_square(0.5)
        doubts.append(
            f"No short cutoff is named: the power law is continued to {prefixed('m', cutoff)}, "
            f"and waves shorter than {prefixed('m', end)} have {part:.0%} of e_el."
        )
    waves = (roll_off, cutoff) if roll_off > cutoff else (2 * cutoff, cutoff)
    densities = shape.density(2 * np.pi / np.array(waves)).tolist()
    by_length = "" if length is None else f", of a correlation length of {prefixed('m', length)}"
    return _stated(
        f"rms height {prefixed('m', rms)}, roll-off {prefixed('m', roll_off)}{by_length}, H "
        f"{hurst:g}",
        TabulatedSpectrum(waves, tuple(densities)),
        Shares(1.0, 0.0, 0.0, 0.0),
        doubts,
    )


def _projection(wavevector: Array, density: Callable[[Array], Array]) -> Array:
    """Integral of an isotropic density along lines, over k = q cosh(t)."""
    node, weight = np.polynomial.legendre.leggauss(_DIRECTIONS)
    way = _FURTHEST * (1 + node) / 2
    k = wavevector[:, None] * np.cosh(way)
    return np.asarray((density(k) * k) @ (weight * _FURTHEST / 2) / np.pi)


def _unprojected(wavevector: Array, profile: Array) -> Array:
    """Isotropic density of which a density of profiles is the projection.

    By the ratio of a density to its projection, in few steps, as more would amplify its noise: e_el
    is right to 2%. Behind its last value the density goes on as a power law.
    """
    places = np.log(wavevector)
    falling = np.flatnonzero(np.gradient(np.log(profile), places) < _RISING)
    knee = wavevector[falling[0]] if falling.size else wavevector[-1]
    found = np.pi * profile / np.hypot(wavevector, knee)
    for _ in range(_STEPS):
        logarithms = np.log(found)
        slope = min(_end_slope(places, logarithms, last=True), -1.5)

        def density(k: Array, logarithms: Array = logarithms, slope: float = slope) -> Array:
            beyond = np.maximum(np.log(k) - places[-1], 0.0)
            return np.exp(np.interp(np.log(k), places, logarithms) + slope * beyond)

        found = found * profile / _projection(wavevector, density)
    return found


def _end_slope(places: Array, logarithms: Array, *, last: bool) -> float:
    """Power law of a density over its shortest or its longest waves."""
    far = math.log(_SLOPE_OVER)
    near = places > places[-1] - far if last else places < places[0] + far
    if np.count_nonzero(near) < 2:
        near = np.arange(places.size) >= places.size - 2 if last else np.arange(places.size) < 2
    return float(np.polyfit(places[near], logarithms[near], 1)[0])


def _logarithms(spectrum: TabulatedSpectrum) -> tuple[Array, Array]:
    """Logarithms of wavevectors and densities."""
    return np.log(2 * np.pi / np.array(spectrum.wavelengths)), np.log(spectrum.densities)


def _shorter(spectrum: TabulatedSpectrum) -> float:
    """Mean square of the half-derivative of shorter waves, by the power law at the end."""
    last = spectrum.short_cutoff
    slope = _end_slope(*_logarithms(spectrum), last=True)
    end = spectrum.densities[-1]
    tail = TabulatedSpectrum((last, last / _DECADES), (end, end * _DECADES**slope))
    return tail.mean_square_between(0.5, last / _DECADES, last * (1 - 1e-12))


def _missing_waves(
    spectrum: TabulatedSpectrum, total: float, missing: float, long: float
) -> Iterator[str]:
    """Sentences on waves that a table lacks and that matter."""
    first = spectrum.wavelengths[0]
    short, longest = (prefixed("m", end) for end in (spectrum.short_cutoff, first))
    slope = _end_slope(*_logarithms(spectrum), last=False)
    if slope < _RISING:
        longer = TabulatedSpectrum(
            (_LONGER * first, first),
            (spectrum.densities[0] * _LONGER**-slope, spectrum.densities[0]),
        )
        more = longer.mean_square(0.5) / total - long
        if more > _NOTABLE_SHARE:
            yield (
                f"The density rises up to its longest wave, {longest}, and is taken as flat above; "
                f"with a roll-off at {_LONGER:g} times that there would be {part_of_energy(more)} "
                "more; add longer waves."
            )
    if missing > _NOTABLE_SHARE:
        yield (
            f"Waves shorter than {short} are left out: two more decades of the power law would "
            f"add {part_of_energy(missing)}; add shorter waves."
        )


def _roll_off(length: float, hurst: float, cutoff: float) -> float:
    """Roll-off wavelength of a spectrum of a correlation length, all in metres."""

    def excess(logarithm: float) -> float:
        roll_off = max(cutoff, math.exp(logarithm))  # shorter by round-off alone
        return _autocorrelation(length, roll_off, hurst, cutoff) - math.exp(-1)

    longest = _MOST_ROLL_OFF * max(cutoff, length)
    ends = math.log(max(cutoff, length / 2)), math.log(longest)
    if excess(ends[0]) > 0:
        raise ValueError(
            f"waves longer than a cutoff of {prefixed('m', cutoff)} have no correlation length of "
            f"{prefixed('m', length)}; name a shorter short cutoff"
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
    """Autocorrelation of the heights of a self-affine surface over their mean square."""
    knee, end = 2 * math.pi * distance / roll_off, 2 * math.pi * distance / cutoff
    found = knee * float(j1(knee))
    if (last := min(end, knee + _LAST_WAVE)) > knee:
        x = np.linspace(knee, last, _POINTS)
        found += float(np.trapezoid(knee * (x / knee) ** (-1 - 2 * hurst) * j0(x), x))
    shape = SelfAffineSpectrum(cutoff, roll_off, hurst)
    return found / (2 * math.pi * distance**2 * shape.mean_square(0.0))


def _stated(
    origin: str, spectrum: TabulatedSpectrum, shares: Shares, doubts: list[str]
) -> StatedSurface:
    """Surface of a spectrum, whose measures have no interval."""

    def exact(number: float) -> Estimate[float]:
        return Estimate(number, 0.0, number, number)

    half = exact(spectrum.mean_square(0.5))
    return StatedSurface(
        measures=tuple(
            RmsMeasure(
                order,
                exact(math.sqrt(spectrum.mean_square(order))),
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
    )
