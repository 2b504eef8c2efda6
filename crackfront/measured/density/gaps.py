"""Missing points of a scan: what their interpolation takes from its density, given back.

Surrogate surfaces, random ones with the density of the scan, have the same points missing and
interpolated. The ratio of their densities before and after is what the interpolation took away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.fft import fftfreq, irfftn, rfftfreq, rfftn

from crackfront.core.arrays import Array
from crackfront.measured.density.densities import Density, Periodogram, periodogram
from crackfront.measured.scan.library import library_scan
from crackfront.measured.scan.reading import Measurement, interpolated

_POINTS, _MOST = 2**20, 16
"""Points of all surrogates together, and their largest number."""

_SEED = 20240229
"""Seed of the surrogates, which are thus the same every time."""

Pairs = Sequence[tuple[Array, Array]]


def surrogate_pairs(measurement: Measurement) -> Pairs:
    """Surrogates of a scan, whole and with its missing points interpolated; none if it has none."""
    if measurement.gaps is None:
        return ()
    heights, density = measurement.heights, periodogram(measurement).density()
    *others, last = zip(heights.shape, measurement.pixels, strict=True)
    waves = np.ix_(*(fftfreq(*one) for one in others), rfftfreq(*last))
    wavevector = 2 * np.pi * np.sqrt(np.asarray(sum(one**2 for one in waves)))
    amplitude = np.sqrt(_interpolated_in_logarithms(density, density.value, wavevector))
    chance = np.random.default_rng(_SEED)
    number = min(max(_POINTS // heights.size, 1), _MOST)
    wholes = [
        irfftn(amplitude * rfftn(chance.standard_normal(heights.shape)), heights.shape)
        for _ in range(number)
    ]
    return [(whole, _filled(measurement, whole)) for whole in wholes]


def restored_periodogram(
    measurement: Measurement,
    pairs: Pairs,
    heights: Array | None = None,
    window: str = "hann",
    *,
    is_profile: bool = False,
) -> Periodogram:
    """Periodogram of a measurement, with the power that the interpolation of points took away."""
    waves = periodogram(measurement, heights, window, is_profile=is_profile)
    if not pairs:
        return waves
    whole, filled = (
        [periodogram(measurement, one, window, is_profile=is_profile).density() for one in column]
        for column in zip(*pairs, strict=True)
    )
    before, after = (np.sum([one.value for one in column], axis=0) for column in (whole, filled))
    return replace(
        waves,
        power=waves.power * _interpolated_in_logarithms(whole[0], before / after, waves.wavevector),
        # The ratio has the noise of as many modes as its surrogates.
        dependence=waves.dependence * (1 + 1 / len(pairs)),
    )


def _interpolated_in_logarithms(density: Density, values: Array, wavevector: Array) -> Array:
    """Positive values of the bins of a density at other wavevectors."""
    least = np.finfo(float).tiny
    places = np.log(np.maximum(wavevector, density.wavevector[0]))
    logarithms = np.log(np.maximum(values, least))
    return np.exp(np.interp(places, np.log(density.wavevector), logarithms))


def _filled(measurement: Measurement, heights: Array) -> Array:
    """Heights with the missing points of a measurement interpolated."""
    gaps = np.zeros(heights.shape, bool) if measurement.gaps is None else measurement.gaps
    holed = np.ma.array(heights, mask=gaps)
    level = library_scan(holed, measurement.size, periodic=measurement.periodic)
    return np.asarray(np.ma.getdata(interpolated(level).heights()), dtype=float)
