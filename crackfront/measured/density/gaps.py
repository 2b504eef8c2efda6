"""Correction of a density for the interpolation of missing points.

Surrogate surfaces are random and have the density of the scan. The points that miss in the scan are
interpolated in them too. The ratio of their densities before and after is the correction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.fft import irfftn, rfftn

from crackfront.core.arrays import Array
from crackfront.measured.density.densities import Density, Periodogram, frequencies, periodogram
from crackfront.measured.scan.library import library_scan
from crackfront.measured.scan.reading import Measurement, interpolated

_POINTS = 2**20
"""Points of all surrogates together."""

_MOST_SURROGATES = 16
"""Largest number of surrogates."""

_SEED = 20240229
"""Seed of the surrogates, so that results can be repeated."""

Pairs = Sequence[tuple[Array, Array]]
"""Heights of surrogates, whole and with their missing points interpolated."""


def surrogate_pairs(measurement: Measurement) -> Pairs:
    """Surrogates of a scan, whole and interpolated; empty for a scan without missing points."""
    if measurement.gaps is None:
        return ()
    heights, density = measurement.heights, periodogram(measurement).density()
    waves = frequencies(heights.shape, measurement.pixels)
    wavevector = 2 * np.pi * np.sqrt(np.asarray(sum(frequency**2 for frequency in waves)))
    amplitude = np.sqrt(_interpolated_in_logarithms(density, density.value, wavevector))
    rng = np.random.default_rng(_SEED)
    number = min(max(_POINTS // heights.size, 1), _MOST_SURROGATES)
    wholes = [
        irfftn(amplitude * rfftn(rng.standard_normal(heights.shape)), heights.shape)
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
    """Periodogram of a measurement, corrected for the interpolation of missing points."""
    waves = periodogram(measurement, heights, window, is_profile=is_profile)
    if not pairs:
        return waves

    def density(surrogate: Array) -> Density:
        return periodogram(measurement, surrogate, window, is_profile=is_profile).density()

    densities = [(density(whole), density(filled)) for whole, filled in pairs]
    before = np.sum([whole.value for whole, _ in densities], axis=0)
    after = np.sum([filled.value for _, filled in densities], axis=0)
    correction = _interpolated_in_logarithms(densities[0][0], before / after, waves.wavevector)
    return replace(
        waves,
        power=waves.power * correction,
        # The noise of the surrogates adds to the noise of the scan.
        dependence=waves.dependence * (1 + 1 / len(pairs)),
    )


def _interpolated_in_logarithms(density: Density, values: Array, wavevector: Array) -> Array:
    """Values in the bins of a density, interpolated at other wavevectors on logarithmic axes."""
    least = np.finfo(float).tiny
    positions = np.log(np.maximum(wavevector, density.wavevector[0]))
    logarithms = np.log(np.maximum(values, least))
    return np.exp(np.interp(positions, np.log(density.wavevector), logarithms))


def _filled(measurement: Measurement, heights: Array) -> Array:
    """Heights with the missing points of a measurement interpolated."""
    gaps = np.zeros(heights.shape, bool) if measurement.gaps is None else measurement.gaps
    holed = np.ma.array(heights, mask=gaps)
    level = library_scan(holed, measurement.size, periodic=measurement.periodic)
    return np.asarray(np.ma.getdata(interpolated(level).heights()), dtype=float)
