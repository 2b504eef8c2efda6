"""Random surfaces on a periodic tile, and measures of any tile."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Integral

import numpy as np
from scipy.fft import fftfreq, rfft2, rfftfreq
from xarray import DataArray

from crackfront.core.adhesion import AdhesionMap, FieldKind, refuse_unknown_kind
from crackfront.core.arguments import refuse_no_numbers, refuse_other_type
from crackfront.core.arrays import Array
from crackfront.core.bounds import SEED
from crackfront.core.resources import refuse_beyond_memory
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.costs import expected_cost, refuse_oversized
from crackfront.simulate.laws import measured_energies
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.simulation import Simulation, simulation_adhesion, simulation_of
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.tiles import gaussian_values
from crackfront.surfaces.given_surface import surface_array


def random_surface(
    short_cutoff: float | Spectrum,
    elastic_energy: float,
    *,
    kind: FieldKind = "roughness",
    roll_off: float | None = None,
    hurst: float | None = None,
    side: float | None = None,
    error: float = 0.03,
    seed: int = 0,
    realisation: int = 0,
) -> DataArray:
    """A Gaussian surface on a periodic tile, self-affine or of another spectrum.

    Parameters
    ----------
    short_cutoff : float or Spectrum
        Shortest wavelength (Units: reduced lateral length), or the whole spectrum, whose amplitude
        has no effect, in place of it, of `roll_off` and of `hurst`.
    elastic_energy : float
        Energy of full conformity e_el, from 0.001 to 0.4, where the errors of numerics are known;
        for a chemical surface the equivalent (w_rms / w_int)^2 / 4. It is the mean over
        realisations, from which a tile of few roll-offs departs. (Units: w_int)
    kind : {"roughness", "chemical"}, optional
        Whether the spectrum is that of the heights, or of the work of adhesion around w_int.
    roll_off : float, optional
        Wavelength above which the spectrum is flat, by default the short cutoff.
        (Units: reduced lateral length)
    hurst : float, optional
        Hurst exponent between the two, by default 1.
    side : float, optional
        Side of the tile, by default 4 roll-offs and at least 200 short cutoffs; at least the
        roll-off. (Units: reduced lateral length)
    error : float, optional
        Standard error of the factor k that the numerics may leave; here it sets the pixel.
    seed, realisation : int, optional
        Which surface; a sweep of this seed has the same one.

    Returns
    -------
    xarray.DataArray
        `height(x, y)` (Units: reduced vertical length) or `work_of_adhesion(x, y)`
        (Units: w_int), the apex of the sphere at x = y = 0.

    Raises
    ------
    ValueError
        If there is no such spectrum, surface or error.
    TypeError
        If an argument is of another type.

    Examples
    --------
    >>> surface = random_surface(short_cutoff=0.2, elastic_energy=0.05, side=4, seed=1)
    >>> surface.name, surface.dims, float(surface.x[0])
    ('height', ('x', 'y'), -2.0)
    """
    spectrum = _shape(short_cutoff, roll_off, hurst)
    refuse_no_fraction("elastic_energy", elastic_energy)
    least, most = measured_energies()
    if not least <= elastic_energy <= most:
        raise ValueError(
            f"elastic_energy is {elastic_energy:g}; the numerics are known from {least:g} to "
            f"{most:g}, so choose one there, or make the heights and take crackfront.surface"
        )
    simulation = chosen_simulation(
        kind,
        spectrum,
        elastic_energy,
        FullCycle(0.0, 1.0),  # without effect on the surface
        error=error,
        side=side,
        seed=seed,
        realisation=realisation,
    )
    if kind == "roughness":
        values = gaussian_values(simulation.surface)
    else:
        values = simulation_adhesion(simulation).work_of_adhesion / WORK_OF_ADHESION
    tile = simulation.resolution
    which = {"elastic_energy_requested": elastic_energy, "seed": seed, "realisation": realisation}
    about = spectrum.parameters | which
    return surface_array(kind, values, tile.tile_side / tile.n_point, **about)


def _shape(short_cutoff: float | Spectrum, roll_off: float | None, hurst: float | None) -> Spectrum:
    """Spectrum that the arguments of :func:`random_surface` name."""
    optional = {"roll_off": roll_off, "hurst": hurst}
    named = {name: one for name, one in optional.items() if one is not None}
    if not isinstance(short_cutoff, Spectrum):
        refuse_no_numbers(short_cutoff=short_cutoff, **named)
        if hurst is not None and roll_off is None:
            raise ValueError(
                f"hurst is {hurst:g}, but without a roll_off the spectrum is flat and has no Hurst "
                "exponent; give the roll_off, or leave hurst out"
            )
        long = short_cutoff if roll_off is None else roll_off
        return SelfAffineSpectrum(short_cutoff, long, 1.0 if hurst is None else hurst)
    for name, value in named.items():
        raise ValueError(f"{name} is {value}, but a whole spectrum is given; leave it out")
    return short_cutoff


def chosen_simulation(
    kind: FieldKind,
    spectrum: Spectrum,
    elastic_energy: float,
    schedule: FullCycle,
    *,
    error: float,
    side: float | None = None,
    seed: int = 0,
    realisation: int = 0,
) -> Simulation:
    """Simulation of a surface under some loads; arguments as of :func:`random_surface`."""
    refuse_unknown_kind(kind)
    refuse_no_fraction("error", error)
    refuse_no_fraction("elastic_energy", elastic_energy)
    for name, number in (("seed", seed), ("realisation", realisation)):
        refuse_other_type(name, number, Integral, "a whole number")
        if isinstance(number, bool):
            raise TypeError(f"{name} is {number}; give a whole number")
        if not SEED.least <= number <= SEED.most:
            raise ValueError(f"{name} is {number}; it must lie between 0 and {SEED.most}")
    numerics, cutoff = Numerics(error), spectrum.short_cutoff
    if side is not None:
        refuse_no_numbers(side=side)
        longest = spectrum.longest_feature
        if not longest <= side < math.inf:
            raise ValueError(
                f"side is {side}; the tile must hold the longest waves of the spectrum, of "
                f"{longest:g}, or its e_el is not the one that is asked for"
            )
        numerics = Numerics(error, tile_roll_offs=0.0, tile_cutoffs=side / cutoff)
    settings = numerics.settings_of(kind, spectrum, elastic_energy)
    refuse_oversized(spectrum, numerics, settings, schedule.max_penetration)
    found = simulation_of(
        kind, spectrum, elastic_energy, schedule, numerics, seed=seed, realisation=realisation
    )
    tiles = f"tiles of {found.resolution.n_point} x {found.resolution.n_point} points"
    remedy = "take a smaller side or a longer short_cutoff"
    refuse_beyond_memory(tiles, expected_cost(found).memory, remedy)
    return found


def refuse_no_fraction(name: str, value: float) -> None:
    """Raise if a number does not lie between 0 and 1."""
    refuse_no_numbers(**{name: value})
    if not 0 < value < 1:
        raise ValueError(f"{name} is {value}; it must lie between 0 and 1")


_ROUND_OFF = 1e-28
"""Share of the whole power below which a mode counts as round-off, which leaves (2e-16)^2."""


def stated_spectrum(surface: DataArray) -> Spectrum | None:
    """Shape of the spectrum that the attributes of a surface state, if they do.

    ValueError if the surface holds waves below its stated short cutoff.
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

        The bins have equal width on a logarithmic scale, the area is that of the tile (Units:
        length**2).
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


_MEAN_ERROR = 0.1
"""Largest difference of the mean work of adhesion from w_int - e_el of a rough tile, over e_el."""


@dataclass(frozen=True, slots=True)
class TileMeasures:
    """Measures of the tile of a loop."""

    kind: FieldKind
    """Whether the mean work of adhesion lies below w_int by e_el, as that of a rough surface."""
    e_el: float
    w_rms: float
    mean: float
    """Energy of full conformity, rms and mean work of adhesion. (Units: w_int)"""
    period: float
    """Side along x. (Units: reduced lateral length)"""
    correlation_length: float
    """Mean wavelength of the work of adhesion, the pixel where it is uniform.
    (Units: reduced lateral length)"""


def tile_measures(adhesion: AdhesionMap) -> TileMeasures:
    """Measures of a tile; its kind follows from its mean work of adhesion."""
    values, energy = adhesion.work_of_adhesion, adhesion.e_el
    mean, period = float(np.mean(values)) / WORK_OF_ADHESION, adhesion.pixel * len(values)
    lacking = 1 - mean
    kind: FieldKind = "chemical"
    if abs(lacking - energy) < _MEAN_ERROR * energy:
        kind = "roughness"
    modes = tile_modes(values, adhesion.pixel)
    length = modes.mean_wavelength if modes.power.size else adhesion.pixel
    return TileMeasures(kind, energy, adhesion.w_rms, mean, period, length)
