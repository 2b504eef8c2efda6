"""Files of finished simulations: their rows, and their states as ragged arrays.

`curves/<shard>/` has the simulations of a shard, in batches while it runs and in one file in the
end. Rows lie along `simulation`. The states of all simulations follow each other along `state`, the
numbers of all their fronts along `front_site`, their jumps along `jump`: contiguous ragged arrays
(CF conventions, 9.3.3), whose counts are `n_state`, `n_front_site` and `n_jump`. The name of a file
ends with its checksum.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.analysis.jump_measures import JumpMeasures
from crackfront.analysis.run_measures import RunMeasures
from crackfront.analysis.table import JumpRow, SweepRow
from crackfront.core.cycle.jumps import JUMP, Jumps, jump_variables
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.geometry.base import State
from crackfront.core.outcome import Status
from crackfront.core.variables import ADHESION, ENERGY, Variable, variables
from crackfront.simulate.checksums import BATCH, MERGED, stated_digest
from crackfront.simulate.labels import label
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.run_simulation import SimulationResult
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.storage import (
    UnreadableFileError,
    read_dataset,
    write_named_by_digest,
)
from crackfront.sweep.rows import CYCLE_STATUSES, STATUSES, row_columns

SIMULATION, STATE, FRONT_SITE = "simulation", "state", "front_site"
"""Dimensions of a file: simulations, the states of all, and the sites of the fronts of all."""

_COUNTS = {"n_state": STATE, "n_front_site": FRONT_SITE, "n_jump": JUMP}
"""Variables that count the entries of each simulation along a ragged dimension."""


_FLAGS = {"status": STATUSES, "cycle_status": CYCLE_STATUSES}
"""Words that the numbers in a variable stand for."""

_NO_CYCLE = -1
"""Cycle status of a simulation that failed before its first state."""

IDENTITY = (
    Variable("series", (SIMULATION,), "1", "digest of the parameters that realisations share"),
    Variable("realisation", (SIMULATION,), "1", "number of the realisation"),
    Variable("spectrum", (SIMULATION,), "1", "name of the spectrum"),
    Variable("elastic_energy", (SIMULATION,), ADHESION, "requested e_el"),
    Variable("arithmetic", (SIMULATION,), "1", "processor and packages that computed it"),
)
"""What identifies a simulation, and what computed it."""

_CYCLE = (
    Variable("cycle_status", (SIMULATION,), "1", "how the cycle ended; -1 if it did not begin"),
    Variable("end_load", (SIMULATION,), "1", "load at which the cycle ended"),
    Variable("pull_off_energy", (SIMULATION,), ENERGY, "energy lost at pull-off, if recorded"),
    Variable("n_site", (SIMULATION,), "1", "sites of a recorded front; 0 where none is"),
    Variable("n_state", (SIMULATION,), "1", "states of the simulation"),
    Variable("n_front_site", (SIMULATION,), "1", "sites of all recorded fronts"),
)

_N_JUMP = Variable("n_jump", (SIMULATION,), "1", "jumps of the simulation")

_FRONT = Variable("front", (FRONT_SITE,), "1", "fronts of all states, in reduced lateral length")

PARAMETERS = "parameters_of_series"
"""Attribute of a file: the parameters of each series in it, as JSON."""


@dataclass(frozen=True, slots=True)
class FinishedSimulation:
    """A simulation that has ended, as a rank returns it."""

    simulation: Simulation
    row: SweepRow
    record: CycleRecord | None
    """States, unless the simulation failed before the first."""
    arithmetic: str


def curve_files(folder: Path) -> list[Path]:
    """Files of finished simulations in the folder of a shard, in the order of their names."""
    return [
        path
        for path in sorted(folder.glob("*.nc"))
        if path.name.startswith((BATCH, MERGED)) and path.is_file() and stated_digest(path)
    ]


def write_curves(
    folder: Path, kind: str, name: str, dataset: xr.Dataset, origin: Provenance
) -> Path:
    """Write a file of finished simulations; `name` keeps batches in their order."""
    return write_named_by_digest(folder, f"{kind}-{name}", dataset, origin)


def rename_curves(path: Path, kind: str, name: str) -> Path:
    """Give a file of finished simulations another kind and name; its content and digest stay."""
    return path.replace(path.with_name(f"{kind}-{name}-{stated_digest(path)}.nc"))


def curves_dataset(finished: Sequence[FinishedSimulation]) -> xr.Dataset:
    """Rows and states of finished simulations of one kind of contact."""
    records = [item.record for item in finished]
    simulations = [item.simulation for item in finished]
    columns: dict[str, Any] = dict(row_columns([item.row for item in finished], (len(finished),)))
    columns |= {
        "series": [simulation.series for simulation in simulations],
        "realisation": [simulation.realisation for simulation in simulations],
        "spectrum": [simulation.spectrum_name for simulation in simulations],
        "elastic_energy": [simulation.elastic_energy for simulation in simulations],
        "arithmetic": [item.arithmetic for item in finished],
        "cycle_status": np.array([_cycle_status(record) for record in records], np.int8),
        "end_load": [math.nan if record is None else record.end_load for record in records],
        "pull_off_energy": [_pull_off_energy(record) for record in records],
        "n_site": [_fronts(record).shape[1] for record in records],
        "n_state": [_n_state(record) for record in records],
        "n_front_site": [_fronts(record).size for record in records],
    }
    if any(simulation.record_jumps for simulation in simulations):
        columns["n_jump"] = [_n_jump(record) for record in records]
    begun = [record for record in records if record is not None]
    columns |= _state_columns(begun)
    if any(record.fronts is not None for record in begun):
        columns["front"] = np.concatenate([_fronts(record).ravel() for record in begun])
    state_types = {type(record.states) for record in begun}
    return _labelled(columns, state_types).assign_attrs({PARAMETERS: parameters_text(simulations)})


def parameters_text(simulations: Iterable[Simulation]) -> str:
    """Parameters of each series of simulations, as JSON."""
    parameters = {simulation.series: simulation.parameters for simulation in simulations}
    return json.dumps(parameters, sort_keys=True)


def _n_state(record: CycleRecord | None) -> int:
    """Number of recorded states."""
    return 0 if record is None else int(record.states.direction.size)


def _n_jump(record: CycleRecord | None) -> int:
    """Number of recorded jumps."""
    return 0 if record is None or record.jumps is None else int(record.jumps.jump_area.size)


def _cycle_status(record: CycleRecord | None) -> int:
    """Place of the status of a cycle among all."""
    if record is None:
        return _NO_CYCLE
    return list(Status).index(record.status)


def _pull_off_energy(record: CycleRecord | None) -> float:
    """Energy that is lost at pull-off; NaN where it was not recorded."""
    if record is None or record.pull_off_energy is None:
        return math.nan
    return record.pull_off_energy


def _fronts(record: CycleRecord | None) -> NDArray[np.float64]:
    """Recorded fronts, (n_state, n_site); (0, 0) where none are."""
    return np.zeros((0, 0)) if record is None or record.fronts is None else record.fronts


def _state_name(name: str) -> str:
    """Name of the variable of states; rows have `iterations` too, the sum over the states."""
    return f"state_{name}" if name in SweepRow.__dataclass_fields__ else name


def _state_columns(records: Sequence[CycleRecord]) -> dict[str, NDArray[Any]]:
    """States of cycles, one after the other."""
    if not records:
        return {}
    columns = {
        _state_name(item.name): np.concatenate(
            [getattr(record.states, item.name) for record in records]
        )
        for item in variables(type(records[0].states))
    }
    energies = [
        record.dissipated_energy for record in records if record.dissipated_energy is not None
    ]
    if energies:
        columns["dissipated_energy"] = np.concatenate(energies)
    jumps = [record.jumps for record in records if record.jumps is not None]
    if jumps:
        columns |= {
            item.name: np.concatenate([getattr(part, item.name) for part in jumps])
            for item in variables(Jumps)
        }
    return columns


def _labelled(columns: dict[str, Any], state_types: Iterable[type[State]]) -> xr.Dataset:
    """Dataset of columns with their units and meanings; states are of some types."""
    state_variables: dict[str, Variable] = {}
    for kind in (*state_types, CycleRecord):
        state_variables |= {_state_name(item.name): item for item in variables(kind)}
    for kind in state_types:
        state_variables |= {item.name: item for item in jump_variables(kind)}
    labelled: dict[str, Any] = {}
    for item in (*variables(JumpRow, SIMULATION), *IDENTITY, *_CYCLE, _N_JUMP):
        if item.name not in columns:
            continue
        about = label(item, _FLAGS.get(item.name, ()))
        if item.name in _COUNTS:
            about["sample_dimension"] = _COUNTS[item.name]
        labelled[item.name] = (SIMULATION,), columns[item.name], about
    for name, values in columns.items():
        if name == "front":
            labelled[name] = _FRONT.dims, values, label(_FRONT)
        elif name not in labelled:
            along = (JUMP,) if state_variables[name].dims == (JUMP,) else (STATE,)
            labelled[name] = along, values, label(state_variables[name])
    return xr.Dataset(labelled)


@dataclass(frozen=True, slots=True)
class StoredRows:
    """Rows of a file of finished simulations, without their states."""

    path: Path
    physics_version: int
    rows_version: int
    series: NDArray[np.str_]
    realisation: NDArray[np.int64]
    """Which simulations they are, (n,)."""
    parameters: dict[str, dict[str, Any]]
    """Parameters of each series."""
    columns: dict[str, NDArray[Any]]
    """Their values by the names of `SweepRow`, and `arithmetic`, each (n,)."""

    @property
    def identities(self) -> set[tuple[str, int]]:
        """Series and number of each simulation."""
        return {*zip(self.series.tolist(), self.realisation.tolist(), strict=True)}


def stored_rows(path: Path) -> StoredRows:
    """Rows of a file that :func:`write_curves` wrote; its checksum has been looked at."""
    names = [item.name for item in variables(SweepRow)]
    names += ["arithmetic", "series", "realisation"]
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        # Rows of an older version may lack columns, until they are made again.
        unknown = np.full(file.dimensions[SIMULATION].size, np.nan)
        names += [item.name for item in variables(JumpMeasures) if item.name in file.variables]
        columns = {
            name: np.asarray(file[name][:]) if name in file.variables else unknown for name in names
        }
        versions = int(file.physics_version), int(file.rows_version)
        parameters = json.loads(file.getncattr(PARAMETERS))
    return StoredRows(
        path, *versions, columns["series"], columns["realisation"], parameters, columns
    )


def selected(dataset: xr.Dataset, chosen: NDArray[np.integer[Any]]) -> xr.Dataset:
    """Some simulations of a dataset in the order of their places, with their states."""
    places = {SIMULATION: chosen}
    for count, dimension in _COUNTS.items():
        if dimension in dataset.sizes:
            counts = dataset[count].values
            ends = np.cumsum(counts)
            parts = [np.arange(ends[place] - counts[place], ends[place]) for place in chosen]
            places[dimension] = np.concatenate([np.zeros(0, np.int64), *parts])
    return dataset.isel(places)


def concatenated(datasets: Sequence[xr.Dataset]) -> xr.Dataset:
    """Simulations of several datasets, one after the other, with their states."""
    names = dict.fromkeys(name for dataset in datasets for name in dataset.variables)
    joined = {}
    for name in names:
        # Files of simulations that all failed have no states.
        parts = [dataset[name].variable for dataset in datasets if name in dataset]
        joined[name] = xr.Variable.concat(parts, dim=parts[0].dims[0])  # type: ignore[no-untyped-call]
    parameters: dict[str, Any] = {}
    for dataset in datasets:
        parameters |= json.loads(dataset.attrs[PARAMETERS])
    present = sorted({*joined["series"].values.tolist()})
    text = json.dumps({series: parameters[series] for series in present}, sort_keys=True)
    return xr.Dataset(joined, attrs={PARAMETERS: text})


def read_result(path: Path, place: int, simulation: Simulation) -> SimulationResult:
    """Result of a simulation at a place of a file; its checksum has been looked at.

    UnreadableFileError if the simulation failed before its first state.
    """
    [result] = read_results(path, np.array([place]), [simulation])
    if result is None:
        raise UnreadableFileError(f"{path} lacks states of {simulation.label}, which failed")
    return result


def read_results(
    path: Path, places: NDArray[np.integer[Any]], simulations: Iterable[Simulation]
) -> Iterator[SimulationResult | None]:
    """Results of simulations at places of a file; None if one failed before its first state.

    The checksum of the file has been looked at.
    """
    dataset = read_dataset(path)
    for place, simulation in zip(places, simulations, strict=True):
        yield _result(selected(dataset, np.array([place])), simulation)


def _result(dataset: xr.Dataset, simulation: Simulation) -> SimulationResult | None:
    """Result of the simulation that a dataset has."""
    row = {name: dataset[name].values[0] for name in (item.name for item in _CYCLE)}
    if row["cycle_status"] == _NO_CYCLE:
        return None
    costs = {item.name: float(dataset[item.name].values[0]) for item in variables(RunMeasures)}
    energies, fronts = dataset.get("dissipated_energy"), dataset.get("front")
    n_site, pull_off = int(row["n_site"]), float(row["pull_off_energy"])
    jumps = None
    if simulation.record_jumps:
        jumps = Jumps(**{item.name: dataset[item.name].values for item in variables(Jumps)})
    record = CycleRecord(
        status=list(Status)[int(row["cycle_status"])],
        end_load=float(row["end_load"]),
        states=_states_of(dataset, simulation.geometry.state_type),
        dissipated_energy=None if energies is None else energies.values,
        pull_off_energy=None if math.isnan(pull_off) else pull_off,
        fronts=None if fronts is None or not n_site else fronts.values.reshape(-1, n_site),
        jumps=jumps,
    )
    return SimulationResult(simulation, record, RunMeasures(**costs))


def _states_of(dataset: xr.Dataset, kind: type[Any]) -> State:
    """States of a dataset of one simulation."""
    return kind(**{item.name: dataset[_state_name(item.name)].values for item in variables(kind)})
