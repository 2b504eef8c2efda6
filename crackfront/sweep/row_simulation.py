"""The simulation of a row of a sweep's table: its surface, and the same run again."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from xarray import DataArray, Dataset

from crackfront.analysis.table import PLACE
from crackfront.core.adhesion import FieldKind
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import variables
from crackfront.core.versions import PHYSICS_VERSION
from crackfront.simulate.cycle_files import cycle_dataset
from crackfront.simulate.labels import labelled
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import Simulation, simulation_adhesion
from crackfront.simulate.tiles import surface_values
from crackfront.surfaces.loops import result_sentence
from crackfront.surfaces.surface_array import surface_array
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import sweep_row
from crackfront.validation import checked_call


@dataclass(frozen=True, slots=True)
class RowSimulation:
    """The simulation of one row of the table of a sweep."""

    parameters: Simulation
    """Everything that determines it."""

    @property
    def surface(self) -> DataArray:
        """Its tile: `height(x, y)`, or `work_of_adhesion(x, y)` if the sweep lacks heights.

        The surface is in reduced units, as of :func:`crackfront.random_surface`.
        """
        return simulated_surface(self.parameters)

    def run(self) -> Dataset:
        """Run it again: its states over `step`, the values of its row, and `result` in words.

        The table has the same values bit for bit, on one kind of processor with one set of
        packages. What `record` of the sweep asks for is there as well.
        """
        result = run_simulation(self.parameters)
        curves = cycle_dataset(result.record, self.parameters.geometry)
        row = sweep_row(result)
        sentence = result_sentence(result.record, result.steady_adhesion)
        return curves.assign(
            {
                item.name: labelled(item, getattr(row, item.name))
                for item in variables(type(row))
                if item.name not in curves and not item.name.startswith("status")
            }
        ).assign_attrs(result=sentence)


@checked_call
def simulation(row: Dataset) -> RowSimulation:
    """The simulation of a row of a sweep's table, which can be looked at and run again.

    Parameters
    ----------
    row : xarray.Dataset
        One row of `hysteresis.nc`, or of what :func:`crackfront.run_sweep` returns, as by
        `table.sel(spectrum="flat", amplitude=0.1, realisation=0)`.

    Returns
    -------
    RowSimulation
        `surface` is its surface, and `run()` repeats it with all its states.

    Raises
    ------
    ValueError
        If it is not one row, or was computed by another version of the physics.
    TypeError
        If it is not a dataset.

    Examples
    --------
    >>> import crackfront as cf
    >>> table = cf.run_sweep("config/test.yaml", progress=False)  # doctest: +SKIP
    >>> row = table.sel(spectrum="flat", amplitude=0.1, realisation=0)  # doctest: +SKIP
    >>> bool(cf.simulation(row).run().w_appr == row.w_appr)  # doctest: +SKIP
    True
    """
    if row.sizes or not {*PLACE, "series", "max_sweeps"} <= row.variables.keys():
        raise ValueError(
            f"the row has the sizes {dict(row.sizes)}; select one row of the table of a sweep, as "
            "by table.sel(spectrum='flat', amplitude=0.1, realisation=0)"
        )
    if (version := row.attrs.get("physics_version")) != PHYSICS_VERSION:
        raise ValueError(
            f"the row has version {version} of the physics, and this is version {PHYSICS_VERSION}; "
            "run the sweep again"
        )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "configuration.yaml")
        path.write_text(row.attrs["configuration"], encoding="utf-8")
        sweep = load_sweep(path)
    item = sweep.named(str(row.spectrum.item()))
    series = sweep.series(item).index(str(row.series.item()))
    first = sweep.one_per_amplitude(item)[series]
    solver = replace(first.solver, max_sweeps=int(row.max_sweeps))
    return RowSimulation(replace(first, realisation=int(row.realisation), solver=solver))


def simulated_surface(simulation: Simulation) -> DataArray:
    """Tile of a simulation, `height(x, y)` or `work_of_adhesion(x, y)`, in reduced units.

    Its attributes state the spectrum where numerics can be chosen by it; else `parameters` has it
    as JSON.
    """
    kind: FieldKind
    if has_heights(simulation):
        kind, values = "roughness", surface_values(simulation.surface)
    else:
        kind = "chemical"
        values = simulation_adhesion(simulation).work_of_adhesion / WORK_OF_ADHESION
    stated = simulation.stated_parameters
    if not simulation.is_covered:
        stated = {"parameters": json.dumps(stated, default=np.ndarray.tolist)}
    return surface_array(
        kind,
        values,
        simulation.surface.pixel,
        **stated,
        elastic_energy_requested=simulation.elastic_energy,
        seed=simulation.sweep_seed,
        realisation=simulation.realisation,
    )


def has_heights(simulation: Simulation) -> bool:
    """Whether the work of adhesion of a simulation follows from heights."""
    loads = simulation.schedule
    is_uncorrelated = isinstance(loads, LineSchedule) and loads.uncorrelated
    return simulation.kind == "roughness" and not is_uncorrelated
