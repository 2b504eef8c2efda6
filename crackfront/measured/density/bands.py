"""The trusted wavelengths of a scan, determined from its density, and further findings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crackfront.measured.density.densities import (
    Density,
    Periodogram,
    anisotropy,
    energy_share,
    gap_weight,
    periodic_part,
    stripes,
    unevenness,
)
from crackfront.measured.density.gaps import Pairs, restored_periodogram, surrogate_pairs
from crackfront.measured.density.self_affine import GAUSSIAN, Instrument, fitted_instrument
from crackfront.measured.scan.levelling import polynomial
from crackfront.measured.scan.reading import Measurement
from crackfront.surfaces.written_units import prefixed

End = Literal["shortest", "longest"]

Cause = Literal["pixels", "resolution", "tip", "noise", "levelling", "form", "named"]
"""Cause of an end of a band: the points of the scan or the resolution in its file, a density that
falls faster than for any surface, the radius of the tip, white noise, the levelling, form that the
levelling left, or the user."""

_SHORTEST_FOR_INSTRUMENT = 2.5
"""Shortest wave of the density from which the instrument is determined. (Units: points)"""

_TRUSTED_LOSS = 0.2
"""Largest part of the density that the instrument removes from trusted waves; it is restored."""

_TRUSTED_NOISE = 0.2
"""Largest noise in trusted waves, relative to the density; it is subtracted."""

_FITTED_LOSS = 0.85
"""Largest part of the density that the instrument removes from waves that are fitted."""

_FITTED_NOISE = 1.0
"""Largest noise in waves that are fitted, relative to the density."""

NYQUIST = 2.0
"""Shortest wave that points resolve. (Units: points)"""

_BLUNTEST = 32.0
"""Longest wave at which an optic may remove :data:`_TRUSTED_LOSS`. (Units: points)

A density that falls at longer waves is a property of the surface.
"""

_CLIFF_RATIO = 0.1
"""Ratio of densities on both sides of an abrupt fall."""

_CLIFF_BINS = 2
"""Width of an abrupt fall. (Units: bins)"""

_CLIFF_MODES = 8
"""Modes that each bin of an abrupt fall must have."""

_FORM_RATIO = 2.0
"""Largest change of a trusted density by another window or levelling."""

_FORM_BINS = 16
"""Bins at the longest waves in which windows and levellings are compared."""

_FINER = 2.0
"""Nyquist wavelength over the shortest wavelength at which a random spectrum may end."""

_FEWEST_OCTAVES = 1
"""Smallest width of a band. (Units: octaves)"""

_FEWEST_BINS = 2
"""Smallest number of values of the density in a band."""

_FEWEST_FOR_INSTRUMENT = 8
"""Smallest number of values of the density: the number of parameters of P and the instrument."""

MOST_PERIODIC = 0.25
"""Part of e_el in a single wave above which a surface is not random."""

_FORM_ORDER = 3
"""Order of the polynomial that is removed to test the levelling."""


@dataclass(frozen=True, slots=True)
class BandLimit:
    """An end of the trusted wavelengths, and its cause."""

    end: End
    cause: Cause
    wavelength: float
    """Units: m."""


@dataclass(frozen=True, slots=True)
class Band:
    """Trusted wavelengths of a scan, and further findings in its density."""

    shortest: BandLimit
    longest: BandLimit
    """Ends of the band: the longest of the lower limits and the shortest of the upper limits."""
    limits: tuple[BandLimit, ...]
    """All limits, including both ends."""
    stripes: tuple[int, ...]
    """Axes along which the map is shifted or levelled row by row; these waves are left out."""
    stripes_share: float
    """Part of e_el within the band in these waves; 0 without stripes."""
    anisotropy: tuple[float, float]
    """Largest rms slope of a map over the rms slope perpendicular to it, and its angle from x; 1
    and 0 for lines. (Units: 1, degree)"""
    periodic: tuple[float, float]
    """Part of e_el in one wave, for example of grooves, and its wavelength; zeros without one.
    (Units: 1, m)"""
    instrument: Instrument
    noise_limit: float
    """Wavelength below which noise is more than half of the density, or 0. (Units: m)"""
    shortest_fitted: float
    """Shortest wavelength to which the model is fitted. (Units: m)"""
    end: float
    """Wavelength at which the spectrum ends, because of the points or the instrument. (Units: m)"""
    shortest_end: float
    longest_end: float
    """Range of wavelengths at which a random spectrum may end. (Units: m)"""

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
    """A measurement with its waves, its density and its trusted band."""

    measurement: Measurement
    waves: Periodogram
    density: Density
    """Isotropic density of a map without its stripes, or C_1D of a line, at all wavelengths."""
    alternatives: tuple[Density, ...]
    """The density with another window, and after subtraction of a cubic polynomial."""
    unevenness: float
    """Relative standard error of e_el because parts of the scan differ."""
    band: Band
    """The trusted wavelengths."""
    profile: Density
    """C_1D of the lines along x over the band."""
    missing_weight: float
    """Part of the window's weight that lies on missing points."""

    @property
    def trusted_measurement(self) -> Measurement:
        """The measurement with the lower end of the band as its shortest wavelength."""
        return replace(self.measurement, shortest=self.band.shortest.wavelength)

    @property
    def trusted(self) -> Density:
        """The density over its band."""
        return self.density.within(*self.band.wavelengths)

    @property
    def fitted(self) -> Density:
        """The density at the waves to which the model is fitted."""
        return self.density.within(self.band.shortest_fitted, self.band.longest.wavelength)


def analysed_scan(
    measurement: Measurement,
    shortest: float | None = None,
    longest: float | None = None,
    *,
    has_common_band: bool = False,
) -> Scan:
    """A measurement with its density and its trusted band.

    Parameters
    ----------
    measurement : Measurement
        Heights of a map or a line.
    shortest, longest : float, optional
        Ends of the band, in place of those that the density shows. (Units: m)
    has_common_band : bool, optional
        Whether the ends are for several scans; then points and levelling may narrow the band.

    Returns
    -------
    Scan
        The measurement with its density and its band.

    Raises
    ------
    ValueError
        If `shortest` is below two points, or the band is narrower than an octave or has fewer than
        two values of the density.
    """
    pixel = max(measurement.pixels)
    if shortest is not None and not has_common_band and shortest < NYQUIST * pixel * (1 - 1e-9):
        raise ValueError(
            f"{measurement.path}: --shortest is {prefixed('m', shortest)}, and points at a "
            f"distance of {prefixed('m', pixel)} resolve waves from "
            f"{prefixed('m', NYQUIST * pixel)}; name that or more"
        )
    pairs = surrogate_pairs(measurement)
    waves = restored_periodogram(measurement, pairs)
    periodic = periodic_part(waves, measurement.shortest, measurement.longest)
    # Grooves along an axis look like rows that the instrument has shifted, but are real.
    may_have_stripes = not measurement.is_line and periodic[0] < MOST_PERIODIC
    stripe_axes = stripes(waves, measurement.shortest) if may_have_stripes else ()
    striped = None
    if stripe_axes:
        striped = np.any([waves.near_axis(axis) for axis in stripe_axes], axis=0)
    density = waves.density(striped)
    alternatives = () if measurement.periodic else _alternatives(measurement, pairs, striped)
    short_waves = _short_waves(measurement, density)
    lower = list(_lower_limits(measurement, short_waves))
    upper = list(_upper_limits(measurement, density, alternatives))
    # Points and levelling, the first limits, also narrow a band that is named for several scans.
    if shortest is not None:
        lower = [BandLimit("shortest", "named", shortest), *(lower[:1] if has_common_band else ())]
    if longest is not None:
        upper = [BandLimit("longest", "named", longest), *(upper[:1] if has_common_band else ())]
    low, high = _ends(measurement, density, lower, upper)
    stripes_share = 0.0
    if striped is not None:
        stripes_share = energy_share(waves, striped, low.wavelength, high.wavelength)
    ends = _spectrum_ends(measurement, short_waves, low, high)
    has_model = shortest is None or low.cause in ("tip", "resolution", "noise")
    band = Band(
        shortest=low,
        longest=high,
        limits=(lower[0], upper[0], *lower[1:], *upper[1:]),
        stripes=stripe_axes,
        stripes_share=stripes_share,
        anisotropy=(1.0, 0.0) if measurement.is_line else anisotropy(waves, low.wavelength),
        periodic=periodic,
        instrument=short_waves.instrument if has_model else Instrument(),
        noise_limit=short_waves.noise_limit,
        shortest_fitted=ends.shortest_fitted,
        end=ends.end,
        shortest_end=ends.shortest,
        longest_end=ends.longest,
    )
    profiles = restored_periodogram(measurement, pairs, is_profile=True)
    return Scan(
        measurement=measurement,
        waves=waves,
        density=density,
        alternatives=alternatives,
        unevenness=unevenness(measurement),
        band=band,
        profile=profiles.density().within(*band.wavelengths),
        missing_weight=gap_weight(measurement),
    )


class _ShortWaves(NamedTuple):
    """What limits the short waves of a scan."""

    density: Density
    """Density of the waves that points and filters resolve."""
    fall: tuple[float, float]
    """Wavelengths on both sides of an abrupt fall of the density, or zeros. (Units: m)"""
    instrument: Instrument

    @property
    def noise_limit(self) -> float:
        """Wavelength below which noise is more than half of the density, or 0 (Units: m)."""
        return self.instrument.noise_wavelength(self.density, _FITTED_NOISE)


def _short_waves(measurement: Measurement, density: Density) -> _ShortWaves:
    """Limits of the short waves of a scan, from its density."""
    shortest = _SHORTEST_FOR_INSTRUMENT * max(measurement.pixels)
    fall = _abrupt_fall(density.within(shortest, measurement.longest))
    resolved = density.within(max(fall[0], shortest), measurement.longest)
    return _ShortWaves(resolved, fall, _instrument(measurement, resolved))


class _SpectrumEnds(NamedTuple):
    """Wavelengths at which the fit and the spectrum of a scan end (Units: m)."""

    shortest_fitted: float
    end: float
    shortest: float
    longest: float


def _spectrum_ends(
    measurement: Measurement, short_waves: _ShortWaves, low: BandLimit, high: BandLimit
) -> _SpectrumEnds:
    """Ends of the fit and of the spectrum of a scan with a trusted band."""
    behind_fall = short_waves.fall[1]
    shortest_fitted, longest = low.wavelength, high.wavelength
    end = max(behind_fall, NYQUIST * max(measurement.pixels))
    shortest = min(end / _FINER, low.wavelength)
    least = max(short_waves.fall[0], short_waves.noise_limit, measurement.shortest)
    if low.cause == "tip":
        # A tip only weakens shorter waves, so that the spectrum ends with the pixels.
        longest = least
    elif low.cause in ("resolution", "noise"):
        shortest_fitted = max(least, short_waves.instrument.loss_wavelength(_FITTED_LOSS))
        end = max(end, behind_fall or shortest_fitted)
    return _SpectrumEnds(shortest_fitted, min(end, low.wavelength), shortest, longest)


def _instrument(measurement: Measurement, resolved: Density) -> Instrument:
    """Attenuation and noise of the instrument; attenuation by the tip of a probe does not count."""
    if resolved.value.size < _FEWEST_FOR_INSTRUMENT:
        return Instrument()
    instrument, longest = fitted_instrument(resolved), _BLUNTEST * max(measurement.pixels)
    if not measurement.tip_radius and instrument.loss_wavelength(_TRUSTED_LOSS) > longest:
        # A Gaussian spot may look blunter than it is.
        instrument = fitted_instrument(resolved, GAUSSIAN)
    if measurement.tip_radius or instrument.loss_wavelength(_TRUSTED_LOSS) > longest:
        # Surfaces that are steeper at short waves look like an attenuation.
        return replace(instrument, attenuation=math.inf)
    return instrument


def _ends(
    measurement: Measurement,
    density: Density,
    lower: Sequence[BandLimit],
    upper: Sequence[BandLimit],
) -> tuple[BandLimit, BandLimit]:
    """The innermost limits; ValueError if too few waves lie between them."""
    low = max(lower, key=lambda limit: limit.wavelength)
    high = min(upper, key=lambda limit: limit.wavelength)
    short, long = (prefixed("m", limit.wavelength) for limit in (low, high))
    if high.wavelength < 2**_FEWEST_OCTAVES * low.wavelength:
        raise ValueError(
            f"{measurement.path}: only waves from {short} ({low.cause}) to {long} ({high.cause}) "
            "can be trusted, less than an octave; use a better scan, or name "
            "--shortest and --longest"
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
    measurement: Measurement, pairs: Pairs, left_out: NDArray[np.bool_] | None
) -> tuple[Density, Density]:
    """Densities with another window, and after subtraction of a cubic polynomial."""
    heights, gaps = measurement.heights, measurement.gaps
    form = polynomial(heights, np.full(heights.shape, True) if gaps is None else ~gaps, _FORM_ORDER)
    window = restored_periodogram(measurement, pairs, window="blackman")
    levelled = restored_periodogram(measurement, pairs, heights - form)
    return window.density(left_out), levelled.density(left_out)


def _upper_limits(
    measurement: Measurement, density: Density, alternatives: Sequence[Density]
) -> Iterator[BandLimit]:
    """Longest wavelengths of the band by all causes."""
    yield BandLimit("longest", "levelling", measurement.longest)
    if form_limit := _form_limit(density, alternatives, measurement.longest):
        yield BandLimit("longest", "form", form_limit)


def _lower_limits(measurement: Measurement, short_waves: _ShortWaves) -> Iterator[BandLimit]:
    """Shortest wavelengths of the band by all causes."""
    yield BandLimit("shortest", "pixels", measurement.shortest)
    instrument = short_waves.instrument
    causes: dict[Cause, float] = {
        "resolution": max(short_waves.fall[0], instrument.loss_wavelength(_TRUSTED_LOSS)),
        "tip": measurement.tip_wavelength,
        "noise": instrument.noise_wavelength(short_waves.density, _TRUSTED_NOISE),
    }
    for cause, wavelength in causes.items():
        if wavelength > NYQUIST * max(measurement.pixels):
            yield BandLimit("shortest", cause, wavelength)


def _abrupt_fall(density: Density) -> tuple[float, float]:
    """Wavelengths on both sides of an abrupt fall of a density, for example by a filter, or 0."""
    values, least = density.value, np.minimum(density.modes[:-1], density.modes[1:])
    if values.size <= _CLIFF_BINS:
        return 0.0, 0.0
    low, high = values[:-_CLIFF_BINS], values[_CLIFF_BINS:]
    falls = np.flatnonzero((high < _CLIFF_RATIO * low) & (least[1:] > _CLIFF_MODES))
    if not falls.size:
        return 0.0, 0.0
    first = falls[0]
    before, behind = (2 * np.pi / density.wavevector[first : first + 2]).tolist()
    return before, behind


def _form_limit(density: Density, alternatives: Sequence[Density], longest: float) -> float:
    """Longest wavelength at which window and levelling hardly matter; 0 if this is the longest."""
    if not alternatives:
        return 0.0
    bins = np.flatnonzero(density.wavevector >= 2 * math.pi / longest * (1 - 1e-9))[:_FORM_BINS]
    changes = [
        np.abs(np.log(alternative.value[bins] / density.value[bins]))
        for alternative in alternatives
    ]
    agree = np.max(changes, axis=0) < math.log(_FORM_RATIO)
    first = int(np.argmax(agree)) if np.any(agree) else bins.size - 1
    return float(2 * math.pi / density.wavevector[bins[first]]) if first else 0.0
