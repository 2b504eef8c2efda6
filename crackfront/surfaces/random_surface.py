"""Random surfaces on a periodic tile."""

from __future__ import annotations

import numpy as np
from pydantic import InstanceOf
from xarray import DataArray

from crackfront.core.adhesion import FieldKind
from crackfront.core.resources import check_memory
from crackfront.core.spectrum import SelfAffineSpectrum, Spectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.costs import check_sizes, expected_cost
from crackfront.simulate.laws import measured_energies
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.simulation import Simulation, simulation_adhesion, simulation_of
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.tiles import surface_values
from crackfront.surfaces.surface_array import surface_array
from crackfront.surfaces.tile_measures import tile_modes
from crackfront.validation import Fraction, Positive, Seed, checked_call


@checked_call
def random_surface(
    short_cutoff: Positive | InstanceOf[Spectrum],
    elastic_energy: Fraction,
    *,
    kind: FieldKind = "roughness",
    roll_off: Positive | None = None,
    hurst: float | None = None,
    side: Positive | None = None,
    error: Fraction = 0.03,
    seed: Seed = 0,
    realisation: Seed = 0,
) -> DataArray:
    """A Gaussian surface on a periodic tile, self-affine or of another spectrum.

    Parameters
    ----------
    short_cutoff : float or Spectrum
        Shortest wavelength (Units: reduced lateral length); or a whole spectrum, which replaces
        `roll_off` and `hurst` too. Its amplitude is scaled to `elastic_energy`.
    elastic_energy : float
        Energy of full conformity e_el, from 0.001 to 0.4, where the errors of numerics are known;
        for a chemical surface the equivalent (w_rms / w_int)^2 / 4. It is the mean over
        realisations, from which a tile of few roll-offs departs. (Units: w_int)
    kind : {"roughness", "chemical"}, optional
        Whether the spectrum describes the heights, or the work of adhesion around w_int.
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
        If the spectrum, surface or error is impossible.
    TypeError
        If an argument is of another type.

    Examples
    --------
    >>> surface = random_surface(short_cutoff=0.2, elastic_energy=0.05, side=4, seed=1)
    >>> surface.name, surface.dims, float(surface.x[0])
    ('height', ('x', 'y'), -2.0)
    """
    spectrum = _shape(short_cutoff, roll_off, hurst)
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
        values = surface_values(simulation.surface)
    else:
        values = simulation_adhesion(simulation).work_of_adhesion / WORK_OF_ADHESION
    tile = simulation.resolution
    return surface_array(
        kind,
        values,
        tile.tile_side / tile.n_point,
        **spectrum.parameters,
        elastic_energy_requested=elastic_energy,
        seed=seed,
        realisation=realisation,
    )


def _shape(short_cutoff: float | Spectrum, roll_off: float | None, hurst: float | None) -> Spectrum:
    """Spectrum of the arguments of :func:`random_surface`."""
    optional = {"roll_off": roll_off, "hurst": hurst}
    numbers = {name: value for name, value in optional.items() if value is not None}
    if isinstance(short_cutoff, Spectrum):
        if numbers:
            raise ValueError(f"a whole spectrum is given; leave out {' and '.join(numbers)}")
        return short_cutoff
    if hurst is not None and roll_off is None:
        raise ValueError(
            f"hurst is {hurst:g}, but without a roll_off the spectrum is flat and lacks a Hurst "
            "exponent; give the roll_off, or leave hurst out"
        )
    longest = short_cutoff if roll_off is None else roll_off
    return SelfAffineSpectrum(short_cutoff, longest, 1.0 if hurst is None else hurst)


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
    """Simulation of a surface under some loads; arguments as of :func:`random_surface`.

    ValueError if the side, the tile or the front is too small or too large.
    """
    numerics = Numerics(error=error)
    if side is not None:
        longest = spectrum.longest_feature
        if not longest <= side:
            raise ValueError(
                f"side is {side}; the tile must fit the longest waves of the spectrum, of "
                f"{longest:g}, or its e_el is not the one that is asked for"
            )
        numerics = Numerics(
            error=error, tile_roll_offs=0.0, tile_cutoffs=side / spectrum.short_cutoff
        )
    settings = numerics.settings_of(kind, spectrum, elastic_energy)
    check_sizes(spectrum, numerics, settings, schedule.max_penetration)
    simulation = simulation_of(
        kind, spectrum, elastic_energy, schedule, numerics, seed=seed, realisation=realisation
    )
    n_point = simulation.resolution.n_point
    tiles = f"tiles of {n_point} x {n_point} points"
    remedy = "take a smaller side or a longer short_cutoff"
    check_memory(tiles, expected_cost(simulation).memory, remedy)
    return simulation


def stated_spectrum(surface: DataArray) -> Spectrum | None:
    """Shape of the spectrum that the attributes of a surface state; None if they state none.

    ValueError if the surface has waves shorter than its stated short cutoff.
    """
    spectrum = Spectrum.stated({str(name): value for name, value in surface.attrs.items()})
    if spectrum is None:
        return None
    pixel = float(surface.x[1] - surface.x[0])
    modes = tile_modes(surface.values, pixel)
    beyond = modes.wavevector > 2 * np.pi / spectrum.short_cutoff * (1 + 1e-9)
    if np.sum(modes.power[beyond]) > 1e-9 * np.sum(modes.power):
        raise ValueError(
            f"the surface has waves shorter than its attributes say, "
            f"{spectrum.short_cutoff:g}; remove {' and '.join(spectrum.parameters)}, so that the "
            "pixels decide"
        )
    return spectrum
