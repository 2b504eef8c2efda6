"""Spectral densities of measurements, and the modes behind each value."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fftfreq, irfftn, rfftfreq, rfftn

from crackfront.core.arrays import Array
from crackfront.measured.scan.reading import Measurement

_BINS_PER_DECADE = 20
"""Bins of wavevectors; their edges are the same for all scans."""

_WINDOWS = {"hann": (0.5, 0.5), "blackman": (0.42, 0.50, 0.08)}
"""Coefficients of cosine windows; importing them from scipy.signal would take half a second."""

_AXIS_WIDTH = 1
"""Width of an axis in Fourier space, where rows, steps and seams appear. (Units: modes)"""

_FIRST_ON_AXIS = 6
"""First mode at which an axis is compared with other directions."""

_STRIPE_RATIO = 1.5
"""Least ratio of densities on an axis and elsewhere if there are stripes."""

_STRIPE_SIGMA = 5.0
"""Least significance of this ratio. (Units: standard errors)"""

_PEAK_WIDTH = 2.5
"""Half of the width to which the window spreads a periodic wave. (Units: modes)"""

_PEAK_RATIO = 30.0
"""Least power of a periodic wave over the mean of similar waves.

Powers of random surfaces are distributed exponentially, so that it is very improbable there.
"""

_PARTS = 4
"""Parts along a side whose e_el is compared."""

_EDGE = 24
"""Side over the width of the margin that is left out at either end."""

_HEIGHT_ROUNDING = 1e-12
"""Rounding of heights relative to the highest one, added as noise to the power."""

_ROUND_OFF = 1e-9
"""Relative rounding of wavevectors, so that a wave at the end of a range is inside."""

_UNEVEN = (1.5, 2.5)
"""Ratios of the variance between parts to the variance for a Gaussian surface.

Below the first ratio the excess does not count, above the second it counts in full.
"""


@dataclass(frozen=True, slots=True)
class Density:
    """Density in bins of wavevectors."""

    wavevector: Array
    """Geometric means of the wavevectors in the bins, increasing. Shape (n,). (Units: 1 / m)"""
    value: Array
    """Isotropic density C of a map, C_1D of lines. Shape (n,). (Units: m^4 or m^3)"""
    modes: Array
    """Number of independent modes in each bin; the window correlates neighbours. Shape (n,)."""
    is_profile: bool
    """Whether the density is C_1D."""

    def within(self, shortest: float, longest: float) -> Density:
        """Part of the density between two wavelengths (Units: m)."""
        low, high = 2 * np.pi / longest, 2 * np.pi / shortest
        inside = _between(self.wavevector, low, high)
        return Density(
            self.wavevector[inside], self.value[inside], self.modes[inside], self.is_profile
        )


@dataclass(frozen=True, slots=True)
class Periodogram:
    """Power of every wave of a measurement under its window."""

    along: tuple[Array, ...]
    """Wavevectors along the axes, shaped to broadcast. (Units: 1 / m)"""
    power: Array
    """Density of each wave. (Units: m^4 of a map, m^3 of a line)"""
    count: Array
    """Number of waves of each entry, 2 if its conjugate is omitted; of the shape of `power`."""
    dependence: float
    """Number of modes over one independent mode, because of the window."""

    @property
    def wavevector(self) -> Array:
        """Magnitudes, of the shape of `power` (Units: 1 / m)."""
        return np.abs(self.along[0]) if len(self.along) == 1 else np.hypot(*self.along)

    @property
    def steps(self) -> tuple[float, ...]:
        """Least wavevectors along the axes (Units: 1 / m)."""
        return tuple(float(np.min(np.abs(waves[waves != 0]))) for waves in self.along)

    def near_axis(self, axis: int) -> NDArray[np.bool_]:
        """Waves of a map whose wavevectors are parallel to an axis: shifts of rows or columns."""
        near = np.abs(self.along[1 - axis]) < (_AXIS_WIDTH + 0.5) * self.steps[1 - axis]
        return np.broadcast_to(near, self.power.shape)

    def density(self, left_out: NDArray[np.bool_] | None = None) -> Density:
        """Means in logarithmic bins, without some of the waves."""
        wavevector = self.wavevector
        used = wavevector > 0
        if left_out is not None:
            used &= ~left_out
        values, count = wavevector[used], self.count[used]
        bins = bin_numbers(values)
        bins -= bins.min()
        modes = np.bincount(bins, count)
        filled = modes > 0
        number = np.where(filled, modes, 1.0)
        return Density(
            wavevector=np.exp(np.bincount(bins, count * np.log(values)) / number)[filled],
            value=(np.bincount(bins, count * self.power[used]) / number)[filled],
            # A two-sided transform counts every wave twice.
            modes=modes[filled] / (2 * self.dependence),
            is_profile=len(self.along) == 1,
        )


def _between(wavevector: Array, low: float, high: float) -> NDArray[np.bool_]:
    """Whether wavevectors are between two limits, apart from round-off."""
    return (wavevector >= low * (1 - _ROUND_OFF)) & (wavevector <= high * (1 + _ROUND_OFF))


def bin_numbers(wavevector: Array) -> NDArray[np.int64]:
    """Numbers of the bins of wavevectors, the same for all scans."""
    scale = _BINS_PER_DECADE / math.log(10)
    return np.asarray(np.floor(np.log(wavevector) * scale).astype(np.int64))


def periodogram(
    measurement: Measurement,
    heights: Array | None = None,
    window: str = "hann",
    *,
    is_profile: bool = False,
) -> Periodogram:
    """Power of all waves of a measurement, or of other heights on the same points.

    A profile has the waves along x with the mean power of all lines of a map, and counts the modes
    of a single line. Periodic measurements are not windowed. Missing points reduce the number of
    independent modes.
    """
    heights = measurement.heights if heights is None else heights
    axes = (0,) if is_profile else tuple(range(heights.ndim))
    windows = _windows(measurement, window, axes)
    weight = np.asarray(math.prod(np.ix_(*windows)))
    square = math.prod(float(np.mean(factor**2)) for factor in windows)
    dependence = math.prod(float(np.mean(factor**4)) for factor in windows) / square**2
    if measurement.gaps is not None and not is_profile:
        measured = np.where(measurement.gaps, 0.0, weight)
        dependence = float(np.mean(measured**4) / np.mean(measured**2) ** 2)
    level = np.sum(weight * heights, axes, keepdims=True) / np.sum(weight, axes, keepdims=True)
    heights = heights - level
    transform = rfftn(weight * heights, axes=axes, norm="forward")
    rounding = square * (_HEIGHT_ROUNDING * np.max(np.abs(heights))) ** 2
    power = transform.real**2 + transform.imag**2
    power += rounding / math.prod(heights.shape[axis] for axis in axes)
    if len(axes) < heights.ndim:
        power = np.mean(power, axis=1)
    shape = [heights.shape[axis] for axis in axes]
    waves = frequencies(shape, [measurement.pixels[axis] for axis in axes])
    count = np.full(waves[-1].size, 2.0)
    count[0] = 1.0
    if shape[-1] % 2 == 0:
        count[-1] = 1.0
    return Periodogram(
        along=tuple(2 * np.pi * frequency for frequency in waves),
        power=power * (math.prod(measurement.size[axis] for axis in axes) / square),
        count=np.broadcast_to(count, power.shape),
        dependence=dependence,
    )


def frequencies(shape: Sequence[int], pixels: Sequence[float]) -> tuple[Array, ...]:
    """Frequencies of a real transform along its axes, shaped to broadcast."""
    axes = [fftfreq(count, pixel) for count, pixel in zip(shape, pixels, strict=True)]
    return np.ix_(*axes[:-1], rfftfreq(shape[-1], pixels[-1]))


def gap_weight(measurement: Measurement) -> float:
    """Part of the window's weight that lies on missing points."""
    if measurement.gaps is None:
        return 0.0
    windows = _windows(measurement, "hann", range(measurement.heights.ndim))
    weight = np.asarray(math.prod(np.ix_(*windows))) ** 2
    return float(np.sum(weight[measurement.gaps]) / np.sum(weight))


def _windows(measurement: Measurement, name: str, axes: Sequence[int]) -> list[Array]:
    """Weights of the points along each side; equal ones if the scan is periodic, or off `axes`."""
    return [
        np.ones(count) if measurement.periodic or axis not in axes else cosine_window(name, count)
        for axis, count in enumerate(measurement.heights.shape)
    ]


def cosine_window(name: str, count: int) -> Array:
    """Weights of the points along a side: a sum of cosines that is smallest at the ends."""
    angle = np.linspace(-np.pi, np.pi, count + 1)[:-1]
    terms = [weight * np.cos(k * angle) for k, weight in enumerate(_WINDOWS[name])]
    return np.asarray(sum(terms))


def stripes(waves: Periodogram, shortest: float) -> tuple[int, ...]:
    """Axes on which the density differs from other directions: shifted rows or columns."""
    wavevector = waves.wavevector
    off_axes = ~(waves.near_axis(0) | waves.near_axis(1)) & (wavevector > 0)
    inside = wavevector <= 2 * np.pi / shortest
    bins = bin_numbers(np.where(wavevector > 0, wavevector, np.max(wavevector)))
    bins -= bins.min()
    n_bin, count = int(bins.max()) + 1, waves.count
    power = np.bincount(bins[off_axes], (count * waves.power)[off_axes], n_bin)
    number = np.bincount(bins[off_axes], count[off_axes], n_bin)
    axes = []
    for axis, step in enumerate(waves.steps):
        near_axis = waves.near_axis(axis) & inside & (wavevector > (_FIRST_ON_AXIS - 0.5) * step)
        near_axis &= number[bins] > 0
        ratio = waves.power[near_axis] * number[bins[near_axis]] / power[bins[near_axis]]
        modes = np.sum(count[near_axis]) / (2 * waves.dependence)
        if modes < 4:
            continue
        # The median, because grooves are a single strong wave. Powers are distributed
        # exponentially: with this median, which is less precise than a mean.
        level = float(np.median(ratio)) / math.log(2)
        significance = abs(math.log(max(level, 1e-300))) * math.sqrt(modes) * math.log(2)
        if max(level, 1 / level) > _STRIPE_RATIO and significance > _STRIPE_SIGMA:
            axes.append(axis)
    return tuple(axes)


def periodic_part(waves: Periodogram, shortest: float, longest: float) -> tuple[float, float]:
    """Part of e_el in a periodic wave within bounds, and its wavelength; zeros without one."""
    wavevector = waves.wavevector
    inside = _between(wavevector, 2 * np.pi / longest, 2 * np.pi / shortest)
    energy = np.where(inside, waves.count * waves.power * wavevector, 0.0)
    index = np.unravel_index(np.argmax(energy), energy.shape)
    distances = [
        np.abs(np.abs(along) - abs(along.flat[peak])) / step
        for along, peak, step in zip(waves.along, index, waves.steps, strict=True)
    ]
    near = np.max(np.broadcast_arrays(*distances), axis=0) < _PEAK_WIDTH
    similar = np.abs(np.log(np.where(inside, wavevector, np.inf) / wavevector[index])) < 0.1
    background = waves.power[similar & ~near]
    if not background.size or waves.power[index] < _PEAK_RATIO * np.mean(background):
        return 0.0, 0.0
    return float(energy[near].sum() / energy.sum()), float(2 * np.pi / wavevector[index])


def energy_share(
    waves: Periodogram, selected: NDArray[np.bool_], shortest: float, longest: float
) -> float:
    """Part of e_el within bounds in some of the waves."""
    inside = _between(waves.wavevector, 2 * np.pi / longest, 2 * np.pi / shortest)
    energy = np.where(inside, waves.count * waves.power * waves.wavevector, 0.0)
    return float(np.sum(energy, where=selected) / np.sum(energy))


def anisotropy(waves: Periodogram, shortest: float) -> tuple[float, float]:
    """Largest rms slope of a map over the rms slope perpendicular to it, and its direction.

    Only trusted waves count. The direction is an angle from x to y, -90 to 90. (Units: degree)
    """
    weight = waves.count * waves.power * (waves.wavevector <= 2 * np.pi / shortest)
    along_x, along_y = waves.along
    square_x = float(np.sum(weight * along_x**2))
    square_y = float(np.sum(weight * along_y**2))
    product = float(np.sum(weight * (along_x * along_y)))
    squares, directions = np.linalg.eigh([[square_x, product], [product, square_y]])
    x, y = directions[:, 1]
    angle = math.degrees(math.atan(y / x)) if x else 90.0
    return math.sqrt(squares[1] / squares[0]) if squares[0] > 0 else math.inf, angle


def unevenness(measurement: Measurement) -> float:
    """Relative standard error of e_el if parts differ more than on a Gaussian surface, else 0.

    For a Gaussian field of covariance R, the covariance of its square is 2 R^2 (Isserlis' theorem),
    which is averaged over the distances of points in one part and in any part.
    """
    shape = measurement.heights.shape
    waves = frequencies(shape, measurement.pixels)
    root = np.sqrt(np.sqrt(sum(frequency**2 for frequency in waves)))
    transform = root * rfftn(measurement.heights)
    energy = irfftn(transform, shape) ** 2
    within_part = within_any = np.ones(1)
    if measurement.gaps is not None:
        energy[measurement.gaps] = np.mean(energy[~measurement.gaps])
    for axis, count in enumerate(shape):
        inner = np.arange(count // _EDGE, count - count // _EDGE)
        parts = np.array_split(inner, _PARTS)
        energy = np.stack([np.mean(np.take(energy, part, axis), axis) for part in parts], axis)
        same_part, any_part = _distance_probabilities(parts, count)
        within_part = np.multiply.outer(within_part, same_part)
        within_any = np.multiply.outer(within_any, any_part)
    measured = float(np.var(energy, ddof=1) / np.mean(energy) ** 2 / energy.size)
    covariance = irfftn(np.abs(transform) ** 2, shape)
    excess = np.sum((covariance / covariance.flat[0]) ** 2 * (within_part - within_any)[0])
    gaussian = 2 * float(excess) / (energy.size - 1)
    counted = np.interp(measured / gaussian, _UNEVEN, (0.0, 1.0))
    return math.sqrt(counted * max(0.0, measured - gaussian))


def _distance_probabilities(parts: Sequence[NDArray[np.int64]], count: int) -> tuple[Array, Array]:
    """Probabilities of the distances of two points along a side, in one part and in any part."""
    inside = np.zeros((len(parts) + 1, count))
    for row, part in zip(inside, [*parts, np.concatenate(parts)], strict=True):
        row[part] = 1 / part.size
    power = np.abs(rfftn(inside, axes=[1])) ** 2
    probability = irfftn(power, [count], axes=[1])
    return np.mean(probability[:-1], axis=0), probability[-1]
