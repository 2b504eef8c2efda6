"""From the parameters of a simulation to the field of its contact."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.field.fields import TileField
from crackfront.core.synthesis import gaussian_field, uncorrelated_rows
from crackfront.simulate.simulation import Simulation

Array = NDArray[np.float64]


def simulation_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion on the tile of a simulation.

    The noise of a realisation is scaled to the amplitude, so that all amplitudes of a spectrum
    see the same surface.
    """
    points, sides = simulation.tile
    pixel = sides[1] / points[1]
    rng = np.random.default_rng(simulation.seed)
    if simulation.schedule.uncorrelated:
        return _uncorrelated_adhesion(simulation, points, pixel, rng)
    if simulation.kind == "roughness":
        return rough_adhesion(simulation_heights(simulation), pixel)
    unit = simulation.spectrum.with_elastic_energy(1.0)
    fluctuation = gaussian_field(unit, points, sides, rng)
    fluctuation *= 2 * math.sqrt(simulation.elastic_energy / unit.mean_square(0.0))
    return chemical_adhesion(fluctuation, pixel)


def simulation_heights(simulation: Simulation) -> Array:
    """Heights on the tile of a simulation of roughness (Units: reduced vertical length)."""
    unit, rng = simulation.spectrum.with_elastic_energy(1.0), np.random.default_rng(simulation.seed)
    heights = gaussian_field(unit, *simulation.tile, rng)
    heights *= math.sqrt(simulation.elastic_energy)
    return heights


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
    if adhesion is None:
        adhesion = simulation_adhesion(simulation)
    sizes = simulation.resolution
    return simulation.schedule.field(adhesion, sizes.n_angle, sizes.spacing, sizes.interpolation)
