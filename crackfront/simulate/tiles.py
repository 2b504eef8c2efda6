"""Measures of any tile: its modes, its correlation length, the spectrum that it states."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.fft import fftfreq, rfft2, rfftfreq
from xarray import DataArray

from crackfront.core.adhesion import AdhesionMap, FieldKind
from crackfront.core.arrays import Array
from crackfront.core.spectrum import Spectrum
from crackfront.core.units import WORK_OF_ADHESION

_ROUND_OFF = 1e-28
"""Power of a mode that is none, relative to that of all; round-off leaves (2e-16)^2."""


def stated_spectrum(surface: DataArray) -> Spectrum | None:
    """Shape of the spectrum that the attributes of a surface state, if they do.

    Parameters
    ----------
    surface : xarray.DataArray
        A surface.

    Raises
    ------
    ValueError
        If the surface holds waves below its stated short cutoff.
    """
    spectrum = Spectrum.stated({str(name): value for name, value in surface.attrs.items()})
    if spectrum is None:
        return None
    pixel = float(surface.x[1] - surface.x[0])
    modes = tile_modes(surface.values, pixel)
    beyond = modes.wavevector > 2 * np.pi / spectrum.short_cutoff * (1 + 1e-9)
    if np.sum(modes.power[beyond]) > 1e-9 * np.sum(modes.power):
        raise ValueError(
            f"the surface holds waves shorter than its attributes say, "
            f"{spectrum.short_cutoff:g}; remove {' and '.join(spectrum.parameters)}, so that the "
            "pixels decide"
        )
    return spectrum


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
        """Means of the spectral density over bins that hold modes, and their wavevectors.

        Parameters
        ----------
        bins_a_decade : int
            Bins of equal width on a logarithmic scale.
        area : float
            Area of the tile. (Units: length**2)
        """
        place = np.floor(bins_a_decade * np.log10(self.wavevector)).astype(int)
        _, place = np.unique(place, return_inverse=True)
        power, count = (np.bincount(place, values) for values in (self.power, self.count))
        total = np.bincount(place, self.count * self.wavevector)
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
    """Whether the mean work of adhesion lies below w_int by e_el, as that of a rough surface."""
    e_el: float
    w_rms: float
    """Energy of full conformity and rms work of adhesion. (Units: w_int)"""
    correlation_length: float
    """Mean wavelength of the work of adhesion, the pixel where it is uniform.
    (Units: reduced lateral length)"""


def tile_measures(adhesion: AdhesionMap, kind: FieldKind | None = None) -> TileMeasures:
    """Measures of a tile; without its kind the mean work of adhesion decides."""
    values, energy = adhesion.work_of_adhesion, adhesion.e_el
    if kind is None:
        lacking = 1 - float(np.mean(values)) / WORK_OF_ADHESION
        kind = "chemical" if abs(lacking) < abs(lacking - energy) else "roughness"
    modes = tile_modes(values, adhesion.pixel)
    length = modes.mean_wavelength if modes.power.size else adhesion.pixel
    return TileMeasures(kind, energy, adhesion.w_rms, length)
