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
"""Cosines of windows; scipy.signal has them too, but takes half a second to import."""

_AXIS = 1
"""Modes beside an axis that hold what does not change along one direction: rows, steps, seams."""

_FIRST_ON_AXIS = 6
"""Modes from which on the axes are compared with all other directions."""

_STRIPES, _STRIPE_SIGMA = 1.5, 5.0
"""Ratio of the density on an axis to that beside it, and its significance, that are stripes."""

_NEAR, _PEAK = 2.5, 30.0
"""Modes about a wave over which a window spreads it, and how far its power is above those of
similar waves where it is periodic: powers of random surfaces are distributed exponentially."""

_PARTS, _EDGE = 4, 24
"""Parts along a side whose e_el is compared, and which part of a side is left out at its ends."""

_ROUNDING = 1e-12
"""Noise of heights in parts of the highest one, below which a density is that of computers."""

_ROUND_OFF = 1e-9
"""Relative rounding of wavevectors: half of a side, up to which scans are trusted, is a wave."""

_UNEVEN = (1.5, 2.5)
"""Variance between parts over that of a Gaussian surface: below the first ratio the excess does not
count, above the second it counts in full."""


@dataclass(frozen=True, slots=True)
class Density:
    """Density in bins of wavevectors."""

    wavevector: Array
    """Geometric means of the wavevectors in the bins, increasing. Shape (n,). (Units: 1 / m)"""
    value: Array
    """Isotropic density C of a map, C_1D of lines. Shape (n,). (Units: m^4 or m^3)"""
    modes: Array
    """Independent modes in the mean; the window makes neighbours dependent. Shape (n,)."""
    is_profile: bool
    """Whether it is C_1D."""

    def within(self, shortest: float, longest: float) -> Density:
        """Part of the density between two wavelengths (Units: m)."""
        low, high = 2 * np.pi / longest, 2 * np.pi / shortest
        chosen = _between(self.wavevector, low, high)
        return Density(
            self.wavevector[chosen], self.value[chosen], self.modes[chosen], self.is_profile
        )


@dataclass(frozen=True, slots=True)
class Periodogram:
    """Power of every wave of a measurement under its window."""

    along: tuple[Array, ...]
    """Wavevectors along the axes, shaped to broadcast. (Units: 1 / m)"""
    power: Array
    """Density of each wave. (Units: m^4 of a map, m^3 of a line)"""
    count: Array
    """Waves that an entry stands for, 2 where its conjugate is not among them; as `power`."""
    dependence: float
    """Modes of which the window makes one."""

    @property
    def wavevector(self) -> Array:
        """Magnitudes, of the shape of `power` (Units: 1 / m)."""
        return np.abs(self.along[0]) if len(self.along) == 1 else np.hypot(*self.along)

    @property
    def steps(self) -> tuple[float, ...]:
        """Least wavevectors along the axes (Units: 1 / m)."""
        return tuple(float(np.min(np.abs(one[one != 0]))) for one in self.along)

    def near_axis(self, axis: int) -> NDArray[np.bool_]:
        """Waves that hardly change along the other axis of a map: rows or columns as wholes."""
        near = np.abs(self.along[1 - axis]) < (_AXIS + 0.5) * self.steps[1 - axis]
        return np.broadcast_to(near, self.power.shape)

    def density(self, without: NDArray[np.bool_] | None = None) -> Density:
        """Means in logarithmic bins, but for some waves."""
        wavevector = self.wavevector
        used = wavevector > 0
        if without is not None:
            used &= ~without
        values, count = wavevector[used], self.count[used]
        place = bin_numbers(values)
        place -= place.min()
        modes = np.bincount(place, count)
        known = modes > 0
        number = np.where(known, modes, 1.0)
        return Density(
            wavevector=np.exp(np.bincount(place, count * np.log(values)) / number)[known],
            value=(np.bincount(place, count * self.power[used]) / number)[known],
            # Every wave stands twice in a two-sided transform.
            modes=modes[known] / (2 * self.dependence),
            is_profile=len(self.along) == 1,
        )


def _between(wavevector: Array, low: float, high: float) -> NDArray[np.bool_]:
    """Whether wavevectors lie between two, which may be theirs but for round-off."""
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
    """Power of all waves of a measurement, or of other heights in its place.

    A profile holds the waves along x, with the mean power of all lines along x of a map; of these,
    the modes of one line are counted. A periodic measurement needs no window. Points that were
    missing hold no modes.
    """
    heights = measurement.heights if heights is None else heights
    axes = (0,) if is_profile else tuple(range(heights.ndim))
    windows = [
        np.ones(count) if measurement.periodic or axis not in axes else cosine_window(window, count)
        for axis, count in enumerate(heights.shape)
    ]
    weight = np.asarray(math.prod(np.ix_(*windows)))
    square = math.prod(float(np.mean(one**2)) for one in windows)
    dependence = math.prod(float(np.mean(one**4)) for one in windows) / square**2
    if measurement.gaps is not None and not is_profile:
        known = np.where(measurement.gaps, 0.0, weight)
        dependence = float(np.mean(known**4) / np.mean(known**2) ** 2)
    level = np.sum(weight * heights, axes, keepdims=True) / np.sum(weight, axes, keepdims=True)
    heights = heights - level
    transform = rfftn(weight * heights, axes=axes, norm="forward")
    rounding = square * (_ROUNDING * np.max(np.abs(heights))) ** 2
    power = transform.real**2 + transform.imag**2
    power += rounding / math.prod(heights.shape[axis] for axis in axes)
    if len(axes) < heights.ndim:
        power = np.mean(power, axis=1)
    counts = [(heights.shape[axis], measurement.pixels[axis]) for axis in axes]
    waves = [*(fftfreq(*one) for one in counts[:-1]), rfftfreq(*counts[-1])]
    count = np.full(waves[-1].size, 2.0)
    count[0] = 1.0
    if counts[-1][0] % 2 == 0:
        count[-1] = 1.0
    return Periodogram(
        along=tuple(2 * np.pi * one for one in np.ix_(*waves)),
        power=power * (math.prod(measurement.size[axis] for axis in axes) / square),
        count=np.broadcast_to(count, power.shape),
        dependence=dependence,
    )


def weight_of_gaps(measurement: Measurement) -> float:
    """Part of the window's weight that lies on points that were missing."""
    if measurement.gaps is None:
        return 0.0
    windows = [
        np.ones(count) if measurement.periodic else cosine_window("hann", count)
        for count in measurement.heights.shape
    ]
    weight = np.asarray(math.prod(np.ix_(*windows))) ** 2
    return float(np.sum(weight[measurement.gaps]) / np.sum(weight))


def cosine_window(name: str, count: int) -> Array:
    """Weights of points of a period, a sum of cosines that is least at its ends."""
    angle = np.linspace(-np.pi, np.pi, count + 1)[:-1]
    return np.asarray(sum(part * np.cos(k * angle) for k, part in enumerate(_WINDOWS[name])))


def stripes(waves: Periodogram, shortest: float) -> tuple[int, ...]:
    """Axes on which a density departs from that beside them: rows or columns moved as wholes."""
    wavevector = waves.wavevector
    beside = ~(waves.near_axis(0) | waves.near_axis(1)) & (wavevector > 0)
    inside = wavevector <= 2 * np.pi / shortest
    place = bin_numbers(np.where(wavevector > 0, wavevector, np.max(wavevector)))
    place -= place.min()
    size, count, found = int(place.max()) + 1, waves.count, []
    base = np.bincount(place[beside], (count * waves.power)[beside], size)
    number = np.bincount(place[beside], count[beside], size)
    for axis, step in enumerate(waves.steps):
        chosen = waves.near_axis(axis) & inside & (wavevector > (_FIRST_ON_AXIS - 0.5) * step)
        chosen &= number[place] > 0
        here = place[chosen]
        ratio = waves.power[chosen] * number[here] / base[here]
        modes = np.sum(count[chosen]) / (2 * waves.dependence)
        if modes < 4:
            continue
        # That of half of the waves, as grooves are one wave among many. Powers are distributed
        # exponentially: with this median, which is known less well than a mean.
        level = float(np.median(ratio)) / math.log(2)
        apart = abs(math.log(max(level, 1e-300))) * math.sqrt(modes) * math.log(2)
        if max(level, 1 / level) > _STRIPES and apart > _STRIPE_SIGMA:
            found.append(axis)
    return tuple(found)


def periodic_part(waves: Periodogram, shortest: float, longest: float) -> tuple[float, float]:
    """Part of e_el in the wave within bounds that stands out most, and its wavelength; else 0."""
    wavevector = waves.wavevector
    inside = _between(wavevector, 2 * np.pi / longest, 2 * np.pi / shortest)
    energy = np.where(inside, waves.count * waves.power * wavevector, 0.0)
    index = np.unravel_index(np.argmax(energy), energy.shape)
    apart = [
        np.abs(np.abs(one) - abs(one.flat[place])) / step
        for one, place, step in zip(waves.along, index, waves.steps, strict=True)
    ]
    near = np.max(np.broadcast_arrays(*apart), axis=0) < _NEAR
    alike = np.abs(np.log(np.where(inside, wavevector, np.inf) / wavevector[index])) < 0.1
    others = waves.power[alike & ~near]
    if not others.size or waves.power[index] < _PEAK * np.mean(others):
        return 0.0, 0.0
    return float(energy[near].sum() / energy.sum()), float(2 * np.pi / wavevector[index])


def energy_share(
    waves: Periodogram, chosen: NDArray[np.bool_], shortest: float, longest: float
) -> float:
    """Part of e_el within bounds that some waves hold."""
    inside = _between(waves.wavevector, 2 * np.pi / longest, 2 * np.pi / shortest)
    energy = np.where(inside, waves.count * waves.power * waves.wavevector, 0.0)
    return float(np.sum(energy, where=chosen) / np.sum(energy))


def anisotropy(waves: Periodogram, shortest: float) -> tuple[float, float]:
    """Largest rms slope over that across it, of the trusted waves of a map, and its direction.

    The direction is an angle from x to y, -90 to 90. (Units: degree)
    """
    weight = waves.count * waves.power * (waves.wavevector <= 2 * np.pi / shortest)
    along_x, along_y = waves.along
    square_x, product, square_y = (
        float(np.sum(weight * one)) for one in (along_x**2, along_x * along_y, along_y**2)
    )
    squares, directions = np.linalg.eigh([[square_x, product], [product, square_y]])
    x, y = directions[:, 1]
    angle = math.degrees(math.atan(y / x)) if x else 90.0
    return math.sqrt(squares[1] / squares[0]) if squares[0] > 0 else math.inf, angle


def unevenness(measurement: Measurement) -> float:
    """Relative standard error of e_el where parts differ more than Gaussian ones; else 0.

    The variance of the square of a Gaussian field of the covariance R is twice the integral of R^2
    (Isserlis' theorem), over the places that two parts have apart.
    """
    shape = measurement.heights.shape
    *others, last = zip(shape, measurement.pixels, strict=True)
    waves = np.ix_(*(fftfreq(*one) for one in others), rfftfreq(*last))
    root = np.sqrt(np.sqrt(sum(one**2 for one in waves)))
    transform = root * rfftn(measurement.heights)
    energy, same, every = irfftn(transform, shape) ** 2, np.ones(1), np.ones(1)
    if measurement.gaps is not None:
        energy[measurement.gaps] = np.mean(energy[~measurement.gaps])
    for axis, count in enumerate(shape):
        inner = np.arange(count // _EDGE, count - count // _EDGE)
        parts = np.array_split(inner, _PARTS)
        energy = np.stack([np.mean(np.take(energy, part, axis), axis) for part in parts], axis)
        one, whole = _overlaps(parts, count)
        same, every = np.multiply.outer(same, one), np.multiply.outer(every, whole)
    found = float(np.var(energy, ddof=1) / np.mean(energy) ** 2 / energy.size)
    covariance = irfftn(np.abs(transform) ** 2, shape)
    excess = np.sum((covariance / covariance.flat[0]) ** 2 * (same - every)[0])
    gaussian = 2 * float(excess) / (energy.size - 1)
    counted = np.interp(found / gaussian, _UNEVEN, (0.0, 1.0))
    return math.sqrt(counted * max(0.0, found - gaussian))


def _overlaps(parts: Sequence[NDArray[np.int64]], count: int) -> tuple[Array, Array]:
    """Probabilities of the distances of two points along a period, both in one part or in any."""
    inside = np.zeros((len(parts) + 1, count))
    for row, part in zip(inside, [*parts, np.concatenate(parts)], strict=True):
        row[part] = 1 / part.size
    power = np.abs(rfftn(inside, axes=[1])) ** 2
    found = irfftn(power, [count], axes=[1])
    return np.mean(found[:-1], axis=0), found[-1]
