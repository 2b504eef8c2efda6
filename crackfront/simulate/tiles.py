"""Surfaces of simulations: random heights and works of adhesion on their tiles."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from crackfront.core.adhesion import AdhesionMap, chemical_adhesion, rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.synthesis import gaussian_field, uncorrelated_rows

if TYPE_CHECKING:
    from crackfront.simulate.simulation import Simulation


def gaussian_values(simulation: Simulation) -> Array:
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


def gaussian_adhesion(simulation: Simulation) -> AdhesionMap:
    """Work of adhesion of a Gaussian surface on the tile of a simulation."""
    adhesion = rough_adhesion if simulation.kind == "roughness" else chemical_adhesion
    return adhesion(gaussian_values(simulation), _pixel(simulation))


def uncorrelated_adhesion(simulation: Simulation) -> AdhesionMap:
    """Rows of the spectrum of w_loc integrated along the front; e_el is a quarter of its f_2."""
    spectrum, order = simulation.spectrum, 0.5 if simulation.kind == "roughness" else 0.0
    rng, pixel = np.random.default_rng(simulation.seed), _pixel(simulation)
    rows = uncorrelated_rows(spectrum, order, simulation.tile[0], pixel, rng)
    ratio = spectrum.mean_square(order - 0.5) / spectrum.mean_square(order)
    adhesion = chemical_adhesion(rows, pixel)
    rows *= math.sqrt(8 * simulation.elastic_energy * ratio / pixel)
    energy = simulation.elastic_energy * adhesion.w_rms**2
    return replace(chemical_adhesion(rows, pixel), e_el=energy)


def _pixel(simulation: Simulation) -> float:
    """Distance of points of the tile (Units: reduced lateral length)."""
    points, sides = simulation.tile
    return sides[1] / points[1]
