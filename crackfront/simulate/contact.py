"""From the parameters of a simulation, or a given tile, to the field of the contact."""

from __future__ import annotations

import math

import numpy as np

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.field.fields import Interpolation, TileField, tile_field
from crackfront.core.geometry.sphere import sphere
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.simulation import Simulation, n_site


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation.

    The noise of a realisation is scaled to the amplitude, so that all amplitudes of a spectrum
    see the same surface.
    """
    tile = simulation.resolution
    pixel = tile.tile_side / tile.n_point
    rng = np.random.default_rng(simulation.seed)
    unit = simulation.spectrum.with_elastic_energy(1.0)
    if simulation.kind == "roughness":
        heights = gaussian_field(unit, tile.n_point, tile.tile_side, rng)
        heights *= math.sqrt(simulation.elastic_energy)
        return rough_adhesion(heights, pixel)
    fluctuation = gaussian_field(unit, tile.n_point, tile.tile_side, rng)
    fluctuation *= 2 * math.sqrt(simulation.elastic_energy / unit.mean_square(0.0))
    return chemical_adhesion(fluctuation, pixel)


def simulation_field(simulation: Simulation, adhesion: AdhesionMap | None = None) -> TileField:
    """Field of a simulation, on its tile if that has been made already."""
    sizes = simulation.resolution
    return contact_field(
        simulation_adhesion(simulation) if adhesion is None else adhesion,
        sizes.n_angle,
        sizes.spacing,
        simulation.schedule.max_penetration,
        sizes.interpolation,
        band_limited=True,
    )


def contact_field(
    adhesion: AdhesionMap,
    n_angle: int,
    spacing: float,
    max_penetration: float,
    interpolation: Interpolation = "cubic",
    *,
    band_limited: bool = False,
) -> TileField:
    """Field of a tile that no front can leave up to a penetration.

    By no passing, a front stays inside the circle in equilibrium with the tile's largest work of
    adhesion; a tenth more allows for the overshoot of the splines between the points. The other
    arguments are as of :func:`crackfront.core.field.fields.tile_field`.
    """
    values = adhesion.work_of_adhesion
    # The refusal of values that are not finite, with their place, is tile_field's.
    strongest = float(np.max(values, where=np.isfinite(values), initial=WORK_OF_ADHESION))
    largest = 1.1 * jkr.equilibrium_radius(max_penetration, strongest / WORK_OF_ADHESION)
    return tile_field(
        adhesion, sphere(n_angle), spacing, largest, interpolation, band_limited=band_limited
    )


def tile_contact(
    adhesion: AdhesionMap,
    max_penetration: float,
    n_angle: int | None = None,
    samples_per_pixel: float | None = None,
    interpolation: Interpolation = "cubic",
) -> TileField:
    """Field of a given tile, resolved by its pixels where nothing else is asked for.

    Parameters
    ----------
    adhesion : AdhesionMap
        Work of adhesion on the tile.
    max_penetration : float
        Largest penetration. (Units: reduced vertical length)
    n_angle : int, optional
        Sites of the front; by default one or more a pixel on the smooth contact's largest
        circle, an even product of 2, 3 and 5.
    samples_per_pixel : float, optional
        Samples along a ray per pixel, by default 2, or 4 where they are joined by straight pieces.
    interpolation : {"cubic", "linear"}, optional
        Pieces between samples.
    """
    circle = 2 * math.pi * jkr.equilibrium_radius(max_penetration)
    if n_angle is None:
        n_angle = n_site(circle / adhesion.pixel)
    density = samples_per_pixel or (2 if interpolation == "cubic" else 4)
    return contact_field(
        adhesion, n_angle, adhesion.pixel / density, max_penetration, interpolation
    )
