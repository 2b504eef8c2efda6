"""Spectral densities of measurements, by the library, and the modes behind each value."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fftfreq, fftn
from scipy.signal import get_window
from scipy.special import digamma, polygamma

from crackfront.topography.instruments import surface_library
from crackfront.topography.reading import Measurement

Array = NDArray[np.float64]

_BINS_PER_DECADE = 20

_NEIGHBOURS = 2
"""Distance in modes up to which the window makes their noise dependent."""


@dataclass(frozen=True, slots=True)
class Density:
    """Density in bins of trusted wavevectors.

    Attributes
    ----------
    wavevector : (n,) array
        Geometric means of the wavevectors in the bins, increasing. (Units: 1 / m)
    value : (n,) array
        Isotropic density C of a map, C_1D of lines. (Units: m^4 or m^3)
    modes : (n,) array
        Independent modes that the value is the mean of, one or more.
    own_modes : (n,) array
        Those that no other bin shares; the window makes neighbours in wavevector dependent.
    is_profile : bool
        Whether it is C_1D.
    """

    wavevector: Array
    value: Array
    modes: Array
    own_modes: Array
    is_profile: bool

    @property
    def logarithm(self) -> Array:
        """Logarithm of the value without the bias that a mean of few exponential numbers has."""
        return np.asarray(np.log(self.value) - digamma(self.modes) + np.log(self.modes))

    @property
    def logarithm_error(self) -> Array:
        """Standard error of :attr:`logarithm` as if bins were independent of each other."""
        return np.asarray(np.sqrt(polygamma(1, self.modes) * self.modes / self.own_modes))


def isotropic_density(measurement: Measurement) -> Density:
    """Isotropic density of a map over its trusted wavevectors.

    Raises
    ------
    ValueError
        If it is a line scan.
    """
    if measurement.is_line:
        raise ValueError(f"{measurement.path} is a line scan, which has no density of a map")
    level = topography(measurement)
    library = surface_library()
    n_x, n_y = measurement.heights.shape
    window = library.FFTTricks.get_window_2D("hann", n_x, n_y, measurement.size)
    wavevectors = level.wavevectors_norm2()
    return _density(measurement, level.power_spectrum_from_area, wavevectors, window)


def profile_density(measurement: Measurement) -> Density:
    """Density of a line scan, or mean of those of the lines along x of a map."""
    level = topography(measurement)
    count = measurement.heights.shape[0]
    wavevectors = 2 * np.pi * np.abs(fftfreq(count, measurement.pixels[0]))
    window = get_window("hann", count)
    # The lines of a map are not independent: the modes of one are counted.
    return _density(measurement, level.power_spectrum_from_profile, wavevectors, window)


def topography(measurement: Measurement) -> Any:
    """A measurement as an object of the library, in metres."""
    library = surface_library()
    kind = library.UniformLineScan if measurement.is_line else library.Topography
    return kind(measurement.heights, measurement.size, periodic=measurement.periodic, unit="m")


def _density(
    measurement: Measurement,
    spectrum: Callable[..., tuple[Array, Array]],
    wavevectors: Array,
    window: Array,
) -> Density:
    """Density in logarithmic bins that hold a mode or more."""
    ends = 2 * np.pi / measurement.longest, 2 * np.pi / measurement.shortest
    count = max(2, math.ceil(math.log10(ends[1] / ends[0]) * _BINS_PER_DECADE))
    edges = np.geomspace(*ends, count + 1)
    _, values = spectrum(reliable=False, collocation=edges)
    place = np.digitize(wavevectors, edges) - 1
    inside = (place >= 0) & (place < count)
    modes = np.bincount(place[inside], minlength=count)
    logarithms = np.bincount(place[inside], np.log(wavevectors[inside]), minlength=count)
    known = (modes > 0) & ~np.ma.getmaskarray(values)
    shared = whole = np.ones(count)
    if not measurement.periodic:
        shared = _shared(np.where(inside, place, -1), window, modes)
        whole = np.full(count, np.mean(window**4) / np.mean(window**2) ** 2)
    # Every wave stands twice in a two-sided transform.
    independent = np.maximum(modes[known] / shared[known] / 2, 1.0)
    return Density(
        wavevector=np.exp(logarithms[known] / modes[known]),
        value=np.ma.getdata(values)[known],
        modes=independent,
        own_modes=np.minimum(modes[known] / whole[known] / 2, independent),
        is_profile=spectrum.__name__.endswith("profile"),
    )


def _shared(place: NDArray[np.int64], window: Array, modes: NDArray[np.int64]) -> Array:
    """How many modes of a bin stand for one independent mode of it.

    Under a window the noise of two modes correlates by the transform of its square at their
    distance; only pairs within a bin make its mean noisier.
    """
    correlation = np.abs(fftn(window**2)) ** 2
    correlation /= correlation.flat[0]
    pairs = np.zeros(modes.size)
    reach = range(-_NEIGHBOURS, _NEIGHBOURS + 1)
    for shift in itertools.product(reach, repeat=window.ndim):
        if shift < (0,) * window.ndim:
            continue  # each pair once
        weight = correlation[shift] * (2.0 if any(shift) else 1.0)
        together = (place >= 0) & (place == np.roll(place, shift, axis=tuple(range(window.ndim))))
        pairs += weight * np.bincount(place[together], minlength=modes.size)
    return pairs / np.maximum(modes, 1)
