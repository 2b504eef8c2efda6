"""From the parameters of a simulation to the field of its contact."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.field.fields import TileField
from crackfront.core.synthesis import gaussian_field, uncorrelated_rows
from crackfront.simulate.simulation import Simulation


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation."""
    points, sides = simulation.tile
    pixel = sides[1] / points[1]
    if simulation.schedule.uncorrelated:
        return _uncorrelated_adhesion(simulation, pixel)
    adhesion = rough_adhesion if simulation.kind == "roughness" else chemical_adhesion
    return adhesion(simulation_values(simulation), pixel)


def simulation_values(simulation: Simulation) -> Array:
    """Heights on the tile (Units: reduced vertical length), or deviations of w_loc (Units: w_int).

    The noise of a realisation is scaled to the amplitude, so that all amplitudes of a spectrum
    see the same surface.
    """
    unit, rng = simulation.spectrum.with_elastic_energy(1.0), np.random.default_rng(simulation.seed)
    values = gaussian_field(unit, *simulation.tile, rng)
    if simulation.kind == "roughness":
        values *= math.sqrt(simulation.elastic_energy)
    else:
        values *= 2 * math.sqrt(simulation.elastic_energy / unit.mean_square(0.0))
    return values


def _uncorrelated_adhesion(simulation: Simulation, pixel: float) -> AdhesionMap:
    """Rows of the spectrum of w_loc integrated along the front; e_el is a quarter of its f_2."""
    spectrum, order = simulation.spectrum, 0.5 if simulation.kind == "roughness" else 0.0
    rng = np.random.default_rng(simulation.seed)
    rows = uncorrelated_rows(spectrum, order, simulation.tile[0], pixel, rng)
    ratio = spectrum.mean_square(order - 0.5) / spectrum.mean_square(order)
    adhesion = chemical_adhesion(rows, pixel)
    rows *= math.sqrt(8 * simulation.elastic_energy * ratio / pixel)
    energy = simulation.elastic_energy * adhesion.w_rms**2
    return replace(chemical_adhesion(rows, pixel), e_el=energy)


def simulation_field(simulation: Simulation, adhesion: AdhesionMap | None = None) -> TileField:
    """Field of a simulation, on its tile if that has been made already."""
    if adhesion is None:
        adhesion = simulation_adhesion(simulation)
    sizes = simulation.resolution
    return simulation.schedule.field(adhesion, sizes.n_angle, sizes.spacing, sizes.interpolation)
