"""Files of single cycles: the curves, what they cost, and whose they are."""

from __future__ import annotations

from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.core.cycle.record import Checkpoint, CycleRecord
from crackfront.core.solver.relax import Status
from crackfront.data.files import UnreadableFileError, labelled, read_dataset, write_dataset
from crackfront.data.provenance import Provenance
from crackfront.data.schema import (
    ANGLES,
    COSTS,
    CURVES,
    DISSIPATED,
    LAST_FRONT,
    RADIUS,
    TURNING_FRONT,
)
from crackfront.simulate.run import PartialRun, SimulationResult
from crackfront.simulate.simulation import Simulation

Array = NDArray[np.float64]


def write_cycle(
    path: Path, record: CycleRecord, origin: Provenance, angles: Array | None = None
) -> None:
    """Write the record of one cycle.

    Parameters
    ----------
    path : Path
        netCDF file.
    record : CycleRecord
        What to write.
    origin : Provenance
        Where it comes from.
    angles : (n_angle,) array, optional
        Angles of the sites, if not 0, 2 pi / N, ... (Units: rad)
    """
    write_dataset(path, cycle_dataset(record, angles), origin)


def write_simulation(path: Path, result: SimulationResult, origin: Provenance) -> None:
    """Write what one simulation of a sweep found and what it cost.

    Parameters
    ----------
    path : Path
        netCDF file.
    result : SimulationResult
        What to write.
    origin : Provenance
        Where it comes from.
    """
    costs = (
        result.elastic_energy,
        result.work_of_adhesion_rms,
        result.seconds,
        result.cpu_seconds,
        result.peak_memory,
    )
    simulation = result.simulation
    dataset = cycle_dataset(result.record).assign(
        {item.name: labelled(item, value) for item, value in zip(COSTS, costs, strict=True)}
    )
    dataset.attrs |= {
        "simulation": simulation.label,
        "key": simulation.key,
        "seed": np.int64(simulation.seed),
        "kind": simulation.kind,
        "solver": simulation.solver,
        "tolerance": simulation.tolerance,
        "elastic_energy_requested": simulation.elastic_energy,
        "short_cutoff": simulation.spectrum.short_cutoff,
        "roll_off": simulation.spectrum.roll_off,
        "hurst": simulation.spectrum.hurst,
        **asdict(simulation.resolution),
    }
    write_dataset(path, dataset, origin)


def read_cycle(path: Path) -> CycleRecord:
    """Record of one cycle.

    Parameters
    ----------
    path : Path
        netCDF file.

    Raises
    ------
    UnreadableFileError
        If the file is missing, truncated or holds no cycle.
    """
    return cycle_record(read_dataset(path), path)


def read_simulation(path: Path, simulation: Simulation) -> SimulationResult:
    """Stored result of a simulation.

    Parameters
    ----------
    path : Path
        netCDF file.
    simulation : Simulation
        Whose result it must be.

    Raises
    ------
    UnreadableFileError
        If the file is missing, truncated or that of another simulation.
    """
    dataset = read_dataset(path)
    if dataset.attrs.get("key") != simulation.key:
        raise UnreadableFileError(f"{path} is not the result of {simulation.label}; remove it")
    record = cycle_record(dataset, path)
    missing = [item.name for item in COSTS if item.name not in dataset]
    if missing:
        raise UnreadableFileError(f"{path} lacks {', '.join(missing)}; remove it")
    costs = (float(dataset[item.name]) for item in COSTS)
    return SimulationResult(simulation, record, *costs)


def write_checkpoint(path: Path, partial: PartialRun, origin: Provenance) -> None:
    """Write what a simulation needs to go on later.

    Parameters
    ----------
    path : Path
        netCDF file.
    partial : PartialRun
        What to write.
    origin : Provenance
        Where it comes from.
    """
    checkpoint = partial.checkpoint
    dataset = cycle_dataset(checkpoint.record).assign(
        {
            LAST_FRONT.name: labelled(LAST_FRONT, checkpoint.front),
            TURNING_FRONT.name: labelled(TURNING_FRONT, checkpoint.turn),
        }
    )
    dataset.attrs |= {
        "simulation": partial.simulation.label,
        "key": partial.simulation.key,
        "seconds": partial.seconds,
        "cpu_seconds": partial.cpu_seconds,
    }
    write_dataset(path, dataset, origin)


def read_checkpoint(path: Path, simulation: Simulation) -> PartialRun:
    """What a simulation needs to go on.

    Parameters
    ----------
    path : Path
        netCDF file.
    simulation : Simulation
        Whose checkpoint it must be.

    Raises
    ------
    UnreadableFileError
        If the file is missing, truncated or that of another simulation.
    """
    dataset = read_dataset(path)
    if dataset.attrs.get("key") != simulation.key or LAST_FRONT.name not in dataset:
        raise UnreadableFileError(f"{path} is no checkpoint of {simulation.label}; remove it")
    fronts = (np.asarray(dataset[item.name]) for item in (LAST_FRONT, TURNING_FRONT))
    checkpoint = Checkpoint(cycle_record(dataset, path), *fronts)
    costs = (float(dataset.attrs[name]) for name in ("seconds", "cpu_seconds"))
    return PartialRun(simulation, checkpoint, *costs)


def cycle_dataset(record: CycleRecord, angles: Array | None = None) -> xr.Dataset:
    """Labelled curves of a record.

    Parameters
    ----------
    record : CycleRecord
        The states of a cycle.
    angles : (n_angle,) array, optional
        Angles of the sites, if not 0, 2 pi / N, ... (Units: rad)
    """
    variables = {item.name: labelled(item, getattr(record, item.name)) for item in CURVES}
    if record.dissipated_energy is not None:
        variables[DISSIPATED.name] = labelled(DISSIPATED, record.dissipated_energy)
    if record.radius is not None:
        count = record.radius.shape[1]
        directions = 2 * np.pi * np.arange(count) / count if angles is None else angles
        variables[RADIUS.name] = labelled(RADIUS, record.radius)
        variables[ANGLES.name] = labelled(ANGLES, directions)
    attributes: dict[str, str | float] = {
        "status": record.status.name.lower(),
        "status_sentence": record.status.value,
        "end_penetration": record.end_penetration,
    }
    if record.pull_off_energy is not None:
        attributes["pull_off_energy"] = record.pull_off_energy
    return xr.Dataset(variables, attrs=attributes)


def cycle_record(dataset: xr.Dataset, place: Path | str = "the dataset") -> CycleRecord:
    """Record that a dataset holds.

    Parameters
    ----------
    dataset : xarray.Dataset
        What :func:`cycle_dataset` made.
    place : Path or str, optional
        What an error calls it.

    Raises
    ------
    UnreadableFileError
        If it holds no cycle.
    """
    missing = [item.name for item in CURVES if item.name not in dataset]
    name = str(dataset.attrs.get("status", "")).upper()
    if missing or name not in Status.__members__ or "end_penetration" not in dataset.attrs:
        what = ", ".join(missing) or "a known status"
        raise UnreadableFileError(f"{place} holds no cycle: it lacks {what}")
    known = {item.name for item in fields(CycleRecord)} - {"pull_off_energy"}
    columns: dict[str, Any] = {
        str(name): np.asarray(values) for name, values in dataset.data_vars.items() if name in known
    }
    pull_off = dataset.attrs.get("pull_off_energy")
    return CycleRecord(
        status=Status[name],
        end_penetration=float(dataset.attrs["end_penetration"]),
        pull_off_energy=None if pull_off is None else float(pull_off),
        **columns,
    )
