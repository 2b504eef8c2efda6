"""From the parameters of a simulation, or a given tile, to the field of the contact."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.cycle.period import LineSchedule
from crackfront.core.field.fields import Interpolation, TileField, tile_field
from crackfront.core.geometry.line import line_field
from crackfront.core.geometry.sphere import sphere
from crackfront.core.synthesis import gaussian_field, uncorrelated_rows
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.simulation import Simulation, n_site


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation.

    The noise of a realisation is scaled to the amplitude, so that all amplitudes of a spectrum
    see the same surface.
    """
    (points, sides), schedule = simulation.tile, simulation.schedule
    pixel = sides[1] / points[1]
    rng = np.random.default_rng(simulation.seed)
    unit = simulation.spectrum.with_elastic_energy(1.0)
    if isinstance(schedule, LineSchedule) and schedule.uncorrelated:
        return _uncorrelated_adhesion(simulation, points, pixel, rng)
    if simulation.kind == "roughness":
        heights = gaussian_field(unit, points, sides, rng)
        heights *= math.sqrt(simulation.elastic_energy)
        return rough_adhesion(heights, pixel)
    fluctuation = gaussian_field(unit, points, sides, rng)
    fluctuation *= 2 * math.sqrt(simulation.elastic_energy / unit.mean_square(0.0))
    return chemical_adhesion(fluctuation, pixel)


def _uncorrelated_adhesion(
    simulation: Simulation, points: tuple[int, int], pixel: float, rng: np.random.Generator
) -> AdhesionMap:
    """Rows of the spectrum that w_loc has when integrated along the front, with its f_2.

    Its e_el is that of which f_2 is four times as large.
    """
    spectrum, order = simulation.spectrum, 0.5 if simulation.kind == "roughness" else 0.0
    rows = uncorrelated_rows(spectrum, order, points, pixel, rng)
    ratio = spectrum.mean_square(order - 0.5) / spectrum.mean_square(order)
    adhesion = chemical_adhesion(rows, pixel)
    rows *= math.sqrt(8 * simulation.elastic_energy * ratio / pixel)
    return replace(
        chemical_adhesion(rows, pixel), e_el=simulation.elastic_energy * adhesion.w_rms**2
    )


def simulation_field(simulation: Simulation, adhesion: AdhesionMap | None = None) -> TileField:
    """Field of a simulation, on its tile if that has been made already."""
    sizes, schedule = simulation.resolution, simulation.schedule
    if adhesion is None:
        adhesion = simulation_adhesion(simulation)
    if isinstance(schedule, LineSchedule):
        return line_field(
            adhesion,
            schedule.spring,
            (0.0, float(schedule.loads[-1])),
            n_site=sizes.n_angle,
            spacing=sizes.spacing,
            interpolation=sizes.interpolation,
            band_limited=not schedule.uncorrelated,
        )
    return contact_field(
        adhesion,
        sizes.n_angle,
        sizes.spacing,
        schedule.max_penetration,
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
