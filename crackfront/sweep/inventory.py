"""What a store has and lacks of simulations: where their rows are, how many, and what they cost."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.curves import StoredRows
from crackfront.sweep.rows import AT_LIMIT, COMPLETE, STATUSES

_NOWHERE = -1
"""Place of a simulation that no file has."""

_COMPLETE_PLACES = [STATUSES.index(word) for word in COMPLETE]


@dataclass(frozen=True, slots=True)
class MissingSimulations:
    """Realisations of a series that are to be simulated."""

    first: Simulation
    """The first realisation, which states the parameters of all."""
    realisations: NDArray[np.int64]

    def simulations(self) -> Iterator[Simulation]:
        """All of them."""
        for number in self.realisations.tolist():
            yield replace(self.first, realisation=number)

    @property
    def seconds(self) -> float:
        """Processor time that they are expected to take (Units: s)."""
        return expected_cost(self.first).seconds * self.realisations.size


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store has of some simulations, and what it lacks and why."""

    done: int = 0
    """Simulations with values."""
    failed: int = 0
    """Simulations that ended without values."""
    missing: tuple[MissingSimulations, ...] = ()
    """What is to be simulated."""
    older: int = 0
    """Missing simulations that are stored of an older version of the physics."""
    remade: int = 0
    """Stored simulations whose rows are of an older version, and made anew from their states."""
    changed: Counter[str] = field(default_factory=Counter)
    """Stored simulations of other parameters, by the names of what differs."""
    arithmetic: frozenset[str] = frozenset()
    """Processors and packages that computed what is stored."""
    cpu_seconds: float = 0.0
    """Processor time of what is stored. (Units: s)"""
    expected_seconds: float = 0.0
    """Processor time that was expected for what is stored. (Units: s)"""

    def __add__(self, further: Inventory) -> Inventory:
        """Inventory of the simulations of two inventories."""
        return Inventory(
            done=self.done + further.done,
            failed=self.failed + further.failed,
            missing=self.missing + further.missing,
            older=self.older + further.older,
            remade=self.remade + further.remade,
            changed=self.changed + further.changed,
            arithmetic=self.arithmetic | further.arithmetic,
            cpu_seconds=self.cpu_seconds + further.cpu_seconds,
            expected_seconds=self.expected_seconds + further.expected_seconds,
        )

    @property
    def stored(self) -> int:
        """Number of simulations that have ended."""
        return self.done + self.failed

    @property
    def n_missing(self) -> int:
        """Number of simulations that are to be run."""
        return sum(item.realisations.size for item in self.missing)

    def simulations(self) -> list[Simulation]:
        """Simulations that are to be run."""
        return [simulation for item in self.missing for simulation in item.simulations()]

    def sentences(self) -> list[str]:
        """Why simulations run again although the folder has some of their names."""
        reasons = []
        if self.older:
            reasons.append(
                f"{self.older} stored simulations belong to an older version of the physics (now "
                f"{PHYSICS_VERSION}) and run again"
            )
        if self.remade:
            reasons.append(
                f"{self.remade} stored simulations have rows of an older version (now "
                f"{ROWS_VERSION}), which are made again from their states"
            )
        if self.changed:
            listed = ", ".join(f"{n} with another {name}" for name, n in self.changed.most_common())
            reasons.append(f"stored simulations of other parameters stay unused: {listed}")
        return reasons


@dataclass(frozen=True, slots=True)
class LocatedRows:
    """Places in files of the simulations of some series and consecutive realisations."""

    files: tuple[StoredRows, ...]
    series: tuple[str, ...]
    realisations: range
    file: NDArray[np.int64]
    """Number of the file of each simulation, (n_series, n_realisation); -1 where none has it."""
    place: NDArray[np.int64]
    """Place of its row in the file, (n_series, n_realisation)."""

    @property
    def missing(self) -> NDArray[np.bool_]:
        """Which simulations no file has, (n_series, n_realisation)."""
        return self.file == _NOWHERE

    @property
    def n_older_rows(self) -> int:
        """Number of simulations whose rows are of an older version."""
        older = [number for number, rows in enumerate(self.files) if is_older(rows)]
        return int(np.count_nonzero(np.isin(self.file, older)))

    def column(self, name: str) -> NDArray[Any]:
        """Values of a column of the simulations that are there, series by series."""
        there = ~self.missing
        # Files of other simulations may lack the column.
        used, order = np.unique(self.file[there], return_inverse=True)
        parts = [self.files[number].columns[name] for number in used.tolist()]
        # Where each file begins in the columns of these files, one after the other.
        starts = np.cumsum([0, *map(len, parts)])
        return np.asarray(np.concatenate(parts)[starts[order] + self.place[there]])


def located_rows(
    files: Iterable[StoredRows], series: Sequence[str], realisations: range, max_sweeps: int
) -> LocatedRows:
    """Places in files of simulations of this version of the physics, with a limit of sweeps."""
    # Rows that need not be remade come first.
    usable = [rows for rows in files if rows.physics_version == PHYSICS_VERSION]
    usable.sort(key=lambda rows: rows.rows_version != ROWS_VERSION)
    shape = len(series), len(realisations)
    file, place = np.full(shape, _NOWHERE), np.full(shape, _NOWHERE)
    for number, rows in enumerate(usable):
        stopped = rows.columns["status"] == STATUSES.index(AT_LIMIT)
        counts = ~(stopped & (rows.columns["max_sweeps"] < max_sweeps))
        counts &= (rows.realisation >= realisations.start) & (rows.realisation < realisations.stop)
        for row, digest in enumerate(series):
            places = np.flatnonzero(counts & (rows.series == digest))
            columns = rows.realisation[places] - realisations.start
            free = file[row, columns] == _NOWHERE
            file[row, columns[free]] = number
            place[row, columns[free]] = places[free]
    return LocatedRows(tuple(usable), tuple(series), realisations, file, place)


def is_older(rows: StoredRows) -> bool:
    """Whether rows are of an older version, and made anew from states."""
    return rows.rows_version != ROWS_VERSION


def inventory_of_rows(
    rows: Iterable[StoredRows], located: LocatedRows, firsts: Sequence[Simulation]
) -> Inventory:
    """Inventory of the simulations that were located among the rows of files.

    `firsts` are the first realisations of the series.
    """
    missing, numbers = located.missing, np.array(located.realisations)
    older, changed = _unused(rows, firsts, missing, located.realisations)
    lacking = [
        MissingSimulations(first, numbers[row])
        for first, row in zip(firsts, missing, strict=True)
        if row.any()
    ]
    unstored = Inventory(missing=tuple(lacking), older=older, changed=changed)
    if missing.all():
        return unstored
    n_done = int(np.isin(located.column("status"), _COMPLETE_PLACES).sum())
    costs = [expected_cost(first).seconds for first in firsts]
    return unstored + Inventory(
        n_done,
        int(np.count_nonzero(~missing)) - n_done,
        remade=located.n_older_rows,
        arithmetic=frozenset(located.column("arithmetic").tolist()),
        cpu_seconds=float(np.nansum(located.column("cpu_seconds"))),
        expected_seconds=float(np.sum((~missing).sum(axis=1) * costs)),
    )


def _unused(
    rows: Iterable[StoredRows],
    firsts: Sequence[Simulation],
    missing: NDArray[np.bool_],
    realisations: range,
) -> tuple[int, Counter[str]]:
    """Simulations stored of older physics that are missing, and of other parameters, by these."""
    older, changed = 0, Counter[str]()
    requested = {first.series for first in firsts}
    for stored in rows:
        within = np.isin(stored.realisation, realisations)
        if stored.physics_version != PHYSICS_VERSION:
            for first, lacking in zip(firsts, missing, strict=True):
                again = np.isin(stored.realisation, np.array(realisations)[lacking])
                older += int(np.count_nonzero(again & (stored.series == first.series)))
            continue
        for series, parameters in stored.parameters.items():
            if series not in requested and missing.any():
                names = min((_differences(first, parameters) for first in firsts), key=_distance)
                count = int(np.count_nonzero(within & (stored.series == series)))
                changed[" and ".join(names)] += count
    return older, +changed  # without counts of 0


def _differences(simulation: Simulation, parameters: dict[str, Any]) -> list[str]:
    """Names of the parameters in which a simulation differs from stored ones."""
    # As JSON reads it back.
    now = json.loads(json.dumps(simulation.parameters))
    names = sorted(now.keys() | parameters.keys())
    return [name for name in names if now.get(name) != parameters.get(name)]


def _distance(names: list[str]) -> tuple[bool, int]:
    """Sort key of differences: simulations of one amplitude are compared if there are some."""
    return "elastic_energy" in names, len(names)


def mixture_sentence(arithmetic: Collection[str]) -> str:
    """Sentence on results of several processors or packages; empty if all are of one."""
    if len(arithmetic) < 2:
        return ""
    listed = "; ".join(sorted(arithmetic))
    return f"stored simulations differ in their origin, and may in their last digits: {listed}"
