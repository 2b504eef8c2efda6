"""Measures of any tile: its modes, its mean work of adhesion, its correlation length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import fftfreq, rfft2, rfftfreq

from crackfront.core.adhesion import AdhesionMap, FieldKind
from crackfront.core.arrays import Array
from crackfront.core.units import WORK_OF_ADHESION

_ROUND_OFF = 1e-28
"""Share of the whole power below which a mode counts as round-off, which leaves (2e-16)^2."""

_MEAN_ERROR = 0.1
"""Largest difference of the mean work of adhesion from w_int - e_el of a rough tile, over e_el."""


@dataclass(frozen=True, slots=True)
class Modes:
    """Modes of a periodic tile that have any power, by increasing wavevector."""

    wavevector: Array
    """Magnitudes, (n_mode,). (Units: 1 / length)"""
    power: Array
    """Part of the mean square, of a mode and its conjugate, (n_mode,). (Units: value**2)"""
    count: Array
    """2 where the conjugate is another mode, else 1; (n_mode,)."""

    @property
    def mean_wavelength(self) -> float:
        """Wavelength of the mean wavevector, weighted by variance (Units: length).

        Examples
        --------
        >>> wave = np.cos(2 * np.pi * np.arange(12) / 6)[:, None] * np.ones(12)
        >>> round(tile_modes(wave, pixel=0.5).mean_wavelength, 12)
        3.0
        """
        return 2 * np.pi * float(np.sum(self.power) / np.sum(self.power * self.wavevector))

    def isotropic_density(self, bins_a_decade: int, area: float) -> tuple[Array, Array]:
        """Means of the spectral density over bins that contain modes, and their wavevectors.

        The bins have equal widths on a logarithmic scale; `area` is the area of the tile (Units:
        length**2).
        """
        decade_bin = np.floor(bins_a_decade * np.log10(self.wavevector)).astype(int)
        _, used_bin = np.unique(decade_bin, return_inverse=True)
        power, count = (np.bincount(used_bin, values) for values in (self.power, self.count))
        total = np.bincount(used_bin, self.count * self.wavevector)
        return total / count, area * power / count


def tile_modes(values: Array, pixel: float) -> Modes:
    """Modes of a periodic tile (n_x, n_y), without its mean and round-off."""
    n_x, n_y = values.shape
    power = np.abs(rfft2(values, norm="forward")) ** 2
    round_off = _ROUND_OFF * float(np.sum(power))
    power[0, 0] = 0.0
    count = np.ones_like(power)
    count[:, 1 : (n_y + 1) // 2] = 2.0
    wavevector = 2 * np.pi * np.hypot(fftfreq(n_x, pixel)[:, None], rfftfreq(n_y, pixel)[None, :])
    used = power > round_off
    rising = np.argsort(wavevector[used])
    return Modes(*(part[used][rising] for part in (wavevector, count * power, count)))


@dataclass(frozen=True, slots=True)
class TileMeasures:
    """Measures of the tile of a loop."""

    kind: FieldKind
    """Roughness if the mean work of adhesion lies below w_int by e_el, else chemical."""
    e_el: float
    """Energy of full conformity. (Units: w_int)"""
    w_rms: float
    """Rms of the work of adhesion. (Units: w_int)"""
    mean: float
    """Mean work of adhesion. (Units: w_int)"""
    period: float
    """Side along x. (Units: reduced lateral length)"""
    correlation_length: float
    """Mean wavelength of the work of adhesion, the pixel where it is uniform.
    (Units: reduced lateral length)"""


def tile_measures(adhesion: AdhesionMap) -> TileMeasures:
    """Measures of a tile.

    A user's map of works of adhesion may come from heights: a mean of w_int - e_el then tells that
    the numerics have the errors of a rough surface.
    """
    values = adhesion.work_of_adhesion
    mean = float(np.mean(values)) / WORK_OF_ADHESION
    is_rough = abs(1 - mean - adhesion.e_el) < _MEAN_ERROR * adhesion.e_el
    modes = tile_modes(values, adhesion.pixel)
    return TileMeasures(
        kind="roughness" if is_rough else "chemical",
        e_el=adhesion.e_el,
        w_rms=adhesion.w_rms,
        mean=mean,
        period=adhesion.pixel * len(values),
        correlation_length=modes.mean_wavelength if modes.power.size else adhesion.pixel,
    )
