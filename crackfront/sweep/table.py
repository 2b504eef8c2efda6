"""The file of a whole sweep: every simulation's apparent work of adhesion, status and cost."""

from __future__ import annotations

import functools
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.analysis.steady import STEADY_DEFINITION, SteadyAdhesion, steady_adhesion
from crackfront.analysis.table import SweepTable
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.fingerprint import fingerprint
from crackfront.data.files import (
    Block,
    UnreadableFileError,
    labelled,
    read_dataset,
    write_dataset_in_blocks,
)
from crackfront.data.provenance import Provenance
from crackfront.data.schema import AMPLITUDE, COORDINATES, HYSTERESIS
from crackfront.simulate.laws import stated_error
from crackfront.simulate.run import SimulationResult
from crackfront.simulate.simulation import Simulation, correlation_length
from crackfront.sweep.sweep import Sweep

ROWS_AT_ONCE = 4096
"""Rows that are written at once."""

COMPLETE = ("lost_contact", "steady")
"""Statuses of a simulation that has values: a full cycle, or the steady parts of both branches."""

NO_STEADY_PART = "no_steady_part"
"""Status of a complete cycle without enough steady states."""


@dataclass(frozen=True, slots=True)
class SweepRow:
    """One simulation in the file; each field is a variable of that name."""

    w_appr: float
    w_retr: float
    w_appr_error: float
    w_retr_error: float
    w_appr_numerical_error: float
    w_retr_numerical_error: float
    hysteresis: float
    midpoint: float
    w_appr_from_force: float
    w_retr_from_force: float
    hysteresis_from_force: float
    e_el: float
    w_rms: float
    seconds: float
    cpu_seconds: float
    peak_memory: float
    iterations: int
    n_step: int
    n_approach: int
    n_retraction: int
    lowest_radius: float
    highest_radius: float
    pull_off_force: float
    end_penetration: float
    status: str
    status_sentence: str
    seed: int
    curve: str


def write_hysteresis(
    path: Path, sweep: Sweep, rows: Iterable[SweepRow], origin: Provenance
) -> Counter[str]:
    """Write the file of a sweep, in the memory of a few thousand rows.

    Parameters
    ----------
    path : Path
        netCDF file.
    sweep : Sweep
        Its parameters.
    rows : iterable of SweepRow
        One for each simulation: by spectrum, amplitude and realisation, the last the fastest.
    origin : Provenance
        Where it comes from.

    Returns
    -------
    Counter
        Number of simulations of every status.
    """
    dataset = xr.Dataset(coords=_coordinates(sweep), attrs=_attributes(sweep))
    statuses: Counter[str] = Counter()

    def blocks() -> Iterator[Block]:
        remaining = iter(rows)
        for cell in np.ndindex(len(sweep.spectra), len(sweep.elastic_energies)):
            for start in range(0, sweep.n_realisation, ROWS_AT_ONCE):
                stop = min(start + ROWS_AT_ONCE, sweep.n_realisation)
                block = list(islice(remaining, stop - start))
                statuses.update(row.status for row in block)
                yield Block((*cell, slice(start, stop)), _columns(block))

    write_dataset_in_blocks(path, dataset, HYSTERESIS, blocks(), origin)
    return statuses


def _columns(rows: Sequence[SweepRow]) -> list[NDArray[Any]]:
    """Columns of rows in the order of their variables; texts as objects."""
    columns = [np.array([getattr(row, item.name) for row in rows]) for item in HYSTERESIS]
    return [column.astype(object) if column.dtype.kind == "U" else column for column in columns]


def read_table(path: Path) -> SweepTable:
    """Arrays of a sweep that a fit needs.

    Parameters
    ----------
    path : Path
        File that :func:`write_hysteresis` wrote.

    Raises
    ------
    ValueError
        If the file is missing, truncated or that of something else.
    """
    sources = {name: name for name in SweepTable.__dataclass_fields__}
    sources["e_el_requested"] = AMPLITUDE
    dataset = read_dataset(path, sources.values())
    missing = [name for name in sources.values() if name not in dataset]
    if missing:
        raise UnreadableFileError(f"{path} lacks {', '.join(missing)}; aggregate the sweep again")
    columns = {name: np.asarray(dataset[source]) for name, source in sources.items()}
    columns["spectrum"] = columns["spectrum"].astype(np.str_)
    return SweepTable(**columns)


def read_statuses(path: Path) -> Counter[str]:
    """Number of simulations of every status in the file of a sweep.

    Raises
    ------
    ValueError
        If the file is missing, truncated or that of something else.
    """
    dataset = read_dataset(path, ("status",))
    if "status" not in dataset:
        raise UnreadableFileError(f"{path} lacks status; aggregate the sweep again")
    return Counter(dataset["status"].values.ravel().tolist())


def sweep_row(result: SimulationResult) -> SweepRow:
    """What the file of a sweep says about one simulation."""
    record, simulation = result.record, result.simulation
    length = correlation_length(simulation.kind, simulation.spectrum)
    steady = steady_adhesion(record, length)
    status, sentence = _status(record, steady)
    known = status in COMPLETE
    cycle = status == COMPLETE[0]
    numerical = np.nan, np.nan
    if known:
        numerical = stated_error(simulation, steady, length)
    return SweepRow(
        w_appr=steady.approach if known else np.nan,
        w_retr=steady.retraction if known else np.nan,
        w_appr_error=steady.approach_error if known else np.nan,
        w_retr_error=steady.retraction_error if known else np.nan,
        w_appr_numerical_error=numerical[0],
        w_retr_numerical_error=numerical[1],
        hysteresis=steady.hysteresis if known else np.nan,
        midpoint=steady.midpoint if known else np.nan,
        w_appr_from_force=steady.approach_from_force if known else np.nan,
        w_retr_from_force=steady.retraction_from_force if known else np.nan,
        hysteresis_from_force=(
            steady.retraction_from_force - steady.approach_from_force if known else np.nan
        ),
        e_el=result.elastic_energy,
        w_rms=result.work_of_adhesion_rms,
        seconds=result.seconds,
        cpu_seconds=result.cpu_seconds,
        peak_memory=result.peak_memory,
        iterations=int(np.sum(record.iterations)),
        n_step=record.penetration.size,
        n_approach=steady.n_approach,
        n_retraction=steady.n_retraction,
        lowest_radius=steady.lowest_radius,
        highest_radius=steady.highest_radius,
        pull_off_force=float(np.min(record.force, initial=np.inf)) if cycle else np.nan,
        end_penetration=record.end_penetration,
        status=status,
        status_sentence=sentence,
        seed=simulation.seed,
        curve=f"{simulation.stem}.nc",
    )


def failed_row(simulation: Simulation, status: str, sentence: str) -> SweepRow:
    """What the file of a sweep says about a simulation that cannot be done.

    Parameters
    ----------
    simulation : Simulation
        The simulation.
    status, sentence : str
        Why, in a word and in a sentence.
    """
    unknown: dict[str, Any] = {item.name: math.nan for item in fields(SweepRow)}
    nothing = dict.fromkeys(("iterations", "n_step", "n_approach", "n_retraction"), 0)
    told = {"status": status, "status_sentence": sentence, "seed": simulation.seed, "curve": ""}
    return SweepRow(**(unknown | nothing | told))


@functools.cache
def row_fingerprint() -> str:
    """Twelve hexadecimal digits that change with any source that makes a row of a result."""
    return fingerprint("analysis", "sweep/table.py", "simulate/laws.py", "simulate/laws.csv")


def _status(record: CycleRecord, steady: SteadyAdhesion) -> tuple[str, str]:
    """How a simulation ended, in a word and in a sentence."""
    status = record.status.name.lower()
    if status in COMPLETE and steady.sentence:
        return NO_STEADY_PART, steady.sentence
    return status, record.status.value


def _coordinates(sweep: Sweep) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]:
    """Labelled coordinates of a sweep."""
    spectra = [item.spectrum for item in sweep.spectra]
    energies = np.array(sweep.elastic_energies)
    firsts = [
        [sweep.simulation(item, energy, 0) for energy in sweep.elastic_energies]
        for item in sweep.spectra
    ]
    tiles = [[one.resolution for one in row] for row in firsts]
    columns = (
        np.array([item.name for item in sweep.spectra]),
        np.array([spectrum.short_cutoff for spectrum in spectra]),
        np.array([spectrum.roll_off for spectrum in spectra]),
        np.array([spectrum.hurst for spectrum in spectra]),
        np.array([sweep.correlation_length(item) for item in sweep.spectra]),
        np.array([[tile.n_angle for tile in row] for row in tiles]),
        np.array([[tile.spacing for tile in row] for row in tiles]),
        np.array([row[0].tile_side for row in tiles]),
        np.array([[tile.n_point for tile in row] for row in tiles]),
        np.array([[one.tolerance for one in row] for row in firsts]),
        energies,
        2 * np.sqrt(energies),
        np.arange(sweep.n_realisation),
    )
    return {
        item.name: labelled(item, values) for item, values in zip(COORDINATES, columns, strict=True)
    }


def _attributes(sweep: Sweep) -> dict[str, str | float]:
    """Attributes of the file of a sweep."""
    attributes: dict[str, str | float] = {
        "title": f"adhesion hysteresis, {sweep.kind}",
        "kind": sweep.kind,
        "definition": STEADY_DEFINITION,
        "sweep_seed": sweep.seed,
    }
    if sweep.scales is not None:
        attributes |= {f"scale_{name}": value for name, value in asdict(sweep.scales).items()}
        attributes |= {
            "lateral_unit_in_metres": sweep.scales.lateral,
            "vertical_unit_in_metres": sweep.scales.vertical,
            "force_unit_in_newtons": sweep.scales.force,
        }
    return attributes
