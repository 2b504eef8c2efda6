"""The wavelengths at which a scan can be trusted, found in its density, and what else it shows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from crackfront.measured.density.densities import (
    Density,
    Periodogram,
    anisotropy,
    energy_share,
    periodic_part,
    stripes,
    unevenness,
    weight_of_gaps,
)
from crackfront.measured.density.gaps import Pairs, restored_periodogram, surrogate_pairs
from crackfront.measured.density.self_affine import GAUSSIAN, Instrument, seen_instrument
from crackfront.measured.scan.levelling import polynomial
from crackfront.measured.scan.reading import Measurement
from crackfront.surfaces.written_units import prefixed

End = Literal["shortest", "longest"]

Cause = Literal["pixels", "resolution", "tip", "noise", "levelling", "form", "named"]
"""What ends a band: points or the resolution that the file states, waves that fall faster than
those of any surface, the radius of the tip, a flat density, the levelling, what this left of the
form, or the user."""

_PIXELS = 2.5
"""Points in the shortest wave of the densities in which instruments are looked for."""

_TRUSTED_LOSS, _TRUSTED_NOISE = 0.2, 0.2
"""Parts of the density that the instrument takes away and noise adds, at the end of the trusted
waves; both are corrected."""

_FITTED_LOSS, _FITTED_NOISE = 0.85, 1.0
"""The same at the end of the waves to which a model is fitted."""

NYQUIST = 2.0
"""Points in the shortest wave that pixels hold."""

_BLUNTEST = 32.0
"""Longest wavelength, in points, of which an optic may take a fifth of the density.

A fall at longer waves is that of the surface.
"""

_CLIFF, _CLIFF_BINS, _CLIFF_MODES = 0.1, 2, 8
"""Ratio by which a density ends, over how many bins, and modes that each of these must have."""

_FORM, _FORM_BINS = 2.0, 16
"""Ratio by which window and levelling may change a density, and longest bins that are compared."""

_FINER = 2.0
"""Shortest wave that pixels hold, over the shortest one at which a drawn spectrum may end."""

_FEWEST_OCTAVES, _FEWEST_BINS = 1, 2
"""Octaves that must be left of a band, and values of the density in it."""

_FEWEST_FOR_INSTRUMENT = 8
"""Fewest values of a density to fit an instrument to, one for each parameter of it and of P."""

MOST_PERIODIC = 0.25
"""Part of e_el in one wave from which on a surface is not random."""

_ORDER = 3
"""Order of the polynomials whose removal shows what the levelling changes."""


@dataclass(frozen=True, slots=True)
class BandLimit:
    """An end of the trusted wavelengths, and why it is one."""

    end: End
    cause: Cause
    """Why, one of :data:`Cause`."""
    wavelength: float
    """Where it lies. (Units: m)"""


@dataclass(frozen=True, slots=True)
class Band:
    """Trusted wavelengths of a scan, and what its density shows beside them."""

    shortest: BandLimit
    longest: BandLimit
    """The two ends of the band: the longest of the lower limits, the shortest of the upper ones."""
    limits: tuple[BandLimit, ...]
    """All limits that were found, both ends among them."""
    stripes: tuple[int, ...]
    """Axes along which the map is shifted or levelled row by row; these waves are left out."""
    stripes_share: float
    """Part of e_el within the band that these waves would hold; 0 if none are left out."""
    anisotropy: tuple[float, float]
    """Of a map the largest rms slope over that across it, and its angle from x; 1 and 0 for lines.
    (Units: 1, degree)"""
    periodic: tuple[float, float]
    """Part of e_el in one wave, as of grooves, and its wavelength; 0 if none. (Units: 1, m)"""
    instrument: Instrument
    noise_limit: float
    """Wavelength below which noise is more than half of the density; 0 if nowhere. (Units: m)"""
    shortest_fitted: float
    """Shortest wavelength that is fitted by the model. (Units: m)"""
    end: float
    """Wavelength at which the spectrum ends, by the points or the instrument. (Units: m)"""
    shortest_end: float
    longest_end: float
    """Shortest and longest wavelength at which a drawn spectrum may end. (Units: m)"""

    @property
    def ends(self) -> tuple[BandLimit, BandLimit]:
        """Both ends, the shortest first."""
        return self.shortest, self.longest

    @property
    def wavelengths(self) -> tuple[float, float]:
        """Wavelengths of both ends (Units: m)."""
        return self.shortest.wavelength, self.longest.wavelength


@dataclass(frozen=True, slots=True)
class Scan:
    """A measurement with its waves, its density and the band that can be trusted."""

    measurement: Measurement
    waves: Periodogram
    density: Density
    """Isotropic density of a map without its stripes, C_1D of a line; trusted or not."""
    alternatives: tuple[Density, ...]
    """This density with another window, and with one more order of polynomials taken off."""
    unevenness: float
    """Standard error of the density, as parts of the scan differ, relative."""
    band: Band
    """The trusted wavelengths."""
    profile: Density
    """C_1D of the lines along x over the band."""
    missing_weight: float
    """Part of the window's weight on points that were missing."""

    @property
    def trusted_measurement(self) -> Measurement:
        """The measurement with the shortest wavelength of its band."""
        return replace(self.measurement, shortest=self.band.shortest.wavelength)

    @property
    def trusted(self) -> Density:
        """The density over its band."""
        return self.density.within(*self.band.wavelengths)

    @property
    def fitted(self) -> Density:
        """The density where it is fitted by the model."""
        return self.density.within(self.band.shortest_fitted, self.band.longest.wavelength)


def analysed_scan(
    measurement: Measurement,
    shortest: float | None = None,
    longest: float | None = None,
    *,
    among_others: bool = False,
) -> Scan:
    """A measurement with its density and its trusted band, whose ends may be given (Units: m).

    Ends that are given for several scans do not reach beyond what the points and the levelling of
    each allow. ValueError if the band is narrower than an octave, has too few values of the
    density, or is to begin below two points.
    """
    pixel = max(measurement.pixels)
    if shortest is not None and not among_others and shortest < NYQUIST * pixel * (1 - 1e-9):
        raise ValueError(
            f"{measurement.path}: --shortest is {prefixed('m', shortest)}, and points at a "
            f"distance of {prefixed('m', pixel)} hold waves from {prefixed('m', NYQUIST * pixel)}; "
            "name that or more"
        )
    pairs = surrogate_pairs(measurement)
    waves = restored_periodogram(measurement, pairs)
    periodic = periodic_part(waves, measurement.shortest, measurement.longest)
    # Grooves along an axis are no rows that the instrument has shifted.
    is_map = not measurement.is_line and periodic[0] < MOST_PERIODIC
    striped = stripes(waves, measurement.shortest) if is_map else ()
    without = np.any([waves.near_axis(axis) for axis in striped], axis=0) if striped else None
    density = waves.density(without)
    seen = density.within(_PIXELS * pixel, measurement.longest)
    cliff, behind = _abrupt_fall(seen)
    seen = seen.within(max(cliff, _PIXELS * pixel), measurement.longest)
    instrument = _instrument(measurement, seen)
    lower = list(_lower_limits(measurement, seen, instrument, cliff))
    upper = [BandLimit("longest", "levelling", measurement.longest)]
    alternatives = () if measurement.periodic else _alternatives(measurement, pairs, without)
    if left := _form_limit(density, alternatives, measurement.longest):
        upper.append(BandLimit("longest", "form", left))
    if shortest is not None:
        lower = [BandLimit("shortest", "named", shortest), *lower[: int(among_others)]]
    if longest is not None:
        upper = [BandLimit("longest", "named", longest), *upper[: int(among_others)]]
    low, high = _ends(measurement, density, lower, upper)
    noise_limit = instrument.noise_wavelength(seen, _FITTED_NOISE)
    least = max(cliff, noise_limit, measurement.shortest)
    shortest_fitted, longest_end = low.wavelength, high.wavelength
    last = max(behind, NYQUIST * pixel)
    shortest_end = last / _FINER
    if low.cause == "tip":
        # It leaves the waves below there, though weaker: they end with the pixels.
        longest_end = least
    elif low.cause in ("resolution", "noise"):
        shortest_fitted = max(least, instrument.loss_wavelength(_FITTED_LOSS))
        last = max(last, behind or shortest_fitted)
    elif shortest is not None:
        instrument = Instrument()
    band = Band(
        shortest=low,
        longest=high,
        limits=(lower[0], upper[0], *lower[1:], *upper[1:]),
        stripes=striped,
        stripes_share=0.0
        if without is None
        else energy_share(waves, without, low.wavelength, high.wavelength),
        anisotropy=(1.0, 0.0) if measurement.is_line else anisotropy(waves, low.wavelength),
        periodic=periodic,
        instrument=instrument,
        noise_limit=noise_limit,
        shortest_fitted=shortest_fitted,
        end=min(last, low.wavelength),
        shortest_end=min(shortest_end, low.wavelength),
        longest_end=longest_end,
    )
    profiles = restored_periodogram(measurement, pairs, is_profile=True)
    return Scan(
        measurement,
        waves,
        density,
        alternatives,
        unevenness(measurement),
        band,
        profiles.density().within(*band.wavelengths),
        weight_of_gaps(measurement),
    )


def _instrument(measurement: Measurement, seen: Density) -> Instrument:
    """Instrument that a density shows; what the tip of a probe takes is no attenuation of it."""
    if seen.value.size < _FEWEST_FOR_INSTRUMENT:
        return Instrument()
    found, longest = seen_instrument(seen), _BLUNTEST * max(measurement.pixels)
    if not measurement.tip_radius and found.loss_wavelength(_TRUSTED_LOSS) > longest:
        # A Gaussian spot may look blunter than it is.
        found = seen_instrument(seen, GAUSSIAN)
    if measurement.tip_radius or found.loss_wavelength(_TRUSTED_LOSS) > longest:
        # A surface whose slope grows towards short waves looks like that.
        return replace(found, attenuation=math.inf)
    return found


def _ends(
    measurement: Measurement,
    density: Density,
    lower: Sequence[BandLimit],
    upper: Sequence[BandLimit],
) -> tuple[BandLimit, BandLimit]:
    """The limits that count, refused where hardly any waves lie between them."""
    low = max(lower, key=lambda limit: limit.wavelength)
    high = min(upper, key=lambda limit: limit.wavelength)
    short, long = (prefixed("m", limit.wavelength) for limit in (low, high))
    if high.wavelength < 2**_FEWEST_OCTAVES * low.wavelength:
        raise ValueError(
            f"{measurement.path}: of the waves only those above {short} ({low.cause}) and below "
            f"{long} ({high.cause}) can be trusted, less than an octave; use a better scan, or "
            "name --shortest and --longest"
        )
    count = density.within(low.wavelength, high.wavelength).value.size
    if count < _FEWEST_BINS:
        raise ValueError(
            f"{measurement.path}: its density has {count} values between {short} ({low.cause}) and "
            f"{long} ({high.cause}), too few for a spectrum; use a larger or finer scan, or name "
            "--shortest and --longest within what it resolves"
        )
    return low, high


def _alternatives(
    measurement: Measurement, pairs: Pairs, without: NDArray[np.bool_] | None
) -> tuple[Density, Density]:
    """Densities with another window, and with one more order of polynomials taken off."""
    heights, gaps = measurement.heights, measurement.gaps
    form = polynomial(heights, np.full(heights.shape, True) if gaps is None else ~gaps, _ORDER)
    window = restored_periodogram(measurement, pairs, window="blackman")
    levelled = restored_periodogram(measurement, pairs, heights - form)
    return window.density(without), levelled.density(without)


def _lower_limits(
    measurement: Measurement, seen: Density, instrument: Instrument, cliff: float
) -> Iterator[BandLimit]:
    """Shortest wavelengths to trust by all causes."""
    yield BandLimit("shortest", "pixels", measurement.shortest)
    causes: dict[Cause, float] = {
        "resolution": max(cliff, instrument.loss_wavelength(_TRUSTED_LOSS)),
        "tip": measurement.tip_wavelength,
        "noise": instrument.noise_wavelength(seen, _TRUSTED_NOISE),
    }
    for cause, wavelength in causes.items():
        if wavelength > NYQUIST * max(measurement.pixels):
            yield BandLimit("shortest", cause, wavelength)


def _abrupt_fall(density: Density) -> tuple[float, float]:
    """Wavelengths before and behind an abrupt fall of a density, as of a filter; 0 if none."""
    values, least = density.value, np.minimum(density.modes[:-1], density.modes[1:])
    if values.size <= _CLIFF_BINS:
        return 0.0, 0.0
    low, high = values[:-_CLIFF_BINS], values[_CLIFF_BINS:]
    falls = np.flatnonzero((high < _CLIFF * low) & (least[1:] > _CLIFF_MODES))
    if not falls.size:
        return 0.0, 0.0
    first = falls[0]
    before, behind = (2 * np.pi / density.wavevector[first : first + 2]).tolist()
    return before, behind


def _form_limit(density: Density, alternatives: Sequence[Density], longest: float) -> float:
    """Wavelength down from which a density does not depend on window and levelling; 0 if all do."""
    here = np.flatnonzero(density.wavevector >= 2 * math.pi / longest * (1 - 1e-9))[:_FORM_BINS]
    apart = [np.abs(np.log(other.value[here] / density.value[here])) for other in alternatives]
    if not apart:
        return 0.0
    agree = np.max(apart, axis=0) < math.log(_FORM)
    first = int(np.argmax(agree)) if np.any(agree) else here.size - 1
    return float(2 * math.pi / density.wavevector[here[first]]) if first else 0.0
