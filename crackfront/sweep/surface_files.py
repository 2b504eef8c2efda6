"""Surfaces of a sweep as files: heights and works of adhesion of every realisation.

Simulations do not read them: they make their surfaces from the seed. A file has a variable for each
amplitude and realisation, because the grid depends on the amplitude where an error is requested.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from crackfront.core.arrays import Array
from crackfront.core.units import WORK_OF_ADHESION, ReducedUnit, Scales
from crackfront.core.variables import ADHESION, LATERAL, VERTICAL
from crackfront.simulate.checksums import forget_sums
from crackfront.simulate.labels import unit_attributes
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.simulation import Simulation, simulation_adhesion
from crackfront.simulate.storage import write_derived_parts
from crackfront.simulate.tiles import surface_values
from crackfront.sweep.row_simulation import has_heights
from crackfront.sweep.sweep import NamedSpectrum, Sweep

SURFACES_FOLDER = "surfaces"
"""Folder of these files among results."""


def write_surfaces(results: Path, sweep: Sweep, item: NamedSpectrum, origin: Provenance) -> Path:
    """Write the surfaces of a spectrum into `surfaces/<name>.nc` of a folder; return the path.

    One surface is in memory at a time. Lengths are in m and works of adhesion in J/m^2 if the sweep
    has scales, else in reduced units.
    """
    path = results / SURFACES_FOLDER / f"{item.name}.nc"
    forget_sums(results)
    write_derived_parts(path, _parts(sweep, item), origin)
    return path


def _parts(sweep: Sweep, item: NamedSpectrum) -> Iterator[xr.Dataset]:
    """A dataset for each surface."""
    title = f"surfaces of {item.name}, {sweep.kind}"
    for first in sweep.one_per_amplitude(item):
        for number in range(sweep.n_realisation):
            surface = _surface_dataset(replace(first, realisation=number), sweep.scales)
            yield surface.assign_attrs(title=title, sweep_seed=sweep.seed)


def _surface_dataset(simulation: Simulation, scales: Scales | None) -> xr.Dataset:
    """Heights, if the simulation has them, and works of adhesion of one surface."""
    amplitude = f"e{simulation.elastic_energy:g}"
    name = f"{amplitude}_r{simulation.realisation}"
    adhesion = simulation_adhesion(simulation)
    about = {
        "elastic_energy": simulation.elastic_energy,
        "realisation": simulation.realisation,
        "seed": simulation.seed,
        "e_el": adhesion.e_el,
        "w_rms": adhesion.w_rms,
    }
    axes = f"x_{amplitude}", f"y_{amplitude}"
    variables = {}
    if has_heights(simulation):
        scale, units = _unit(VERTICAL, scales)
        heights = scale * surface_values(simulation.surface)
        attributes = units | about | _moments(heights) | {"long_name": "height, positive at peaks"}
        variables[f"height_{name}"] = xr.Variable(axes, heights, attributes)
    scale, units = _unit(ADHESION, scales)
    works = scale / WORK_OF_ADHESION * adhesion.work_of_adhesion
    attributes = units | about | _moments(works) | {"long_name": "local work of adhesion"}
    variables[f"w_loc_{name}"] = xr.Variable(axes, works, attributes)
    scale, units = _unit(LATERAL, scales)
    pixel = scale * simulation.surface.pixel
    coordinates = {
        axis: xr.Variable((axis,), pixel * (np.arange(count) - count / 2), units)
        for axis, count in zip(axes, works.shape, strict=True)
    }
    return xr.Dataset(variables, coordinates)


def _unit(unit: ReducedUnit, scales: Scales | None) -> tuple[float, dict[str, str]]:
    """Value of a reduced unit in the unit that a file has, and attributes that state this unit."""
    if scales is None:
        return 1.0, unit_attributes(unit)
    return unit.scale(scales), unit_attributes(unit.si)


def _moments(values: Array) -> dict[str, float]:
    """Skewness and excess kurtosis of values, which are 0 for a normal distribution."""
    scores = (values - np.mean(values)) / np.std(values)
    return {
        "skewness": float(np.mean(scores**3)),
        "excess_kurtosis": float(np.mean(scores**4)) - 3,
    }
