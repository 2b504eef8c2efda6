"""What a store holds, lacks and no longer needs of a list of simulations."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from crackfront.dataset import (
    SweepRow,
    UnreadableFileError,
    read_simulation,
    row_fingerprint,
    sweep_row,
)
from crackfront.scene import Simulation
from crackfront.store.journal import Entry, journal_paths, read_journal


@dataclass(frozen=True, slots=True)
class Stale:
    """A simulation that is stored as it was asked for earlier.

    Attributes
    ----------
    label : str
        Label of the simulation.
    changed : tuple of str
        Which parts of its key have changed since.
    """

    label: str
    changed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks.

    Attributes
    ----------
    missing : tuple of Simulation
        Simulations without a row.
    unreadable : tuple of str
        A sentence for every file that is there and of no use.
    stale : tuple of Stale
        Those of the missing that are stored with another key.
    """

    missing: tuple[Simulation, ...]
    unreadable: tuple[str, ...]
    stale: tuple[Stale, ...]

    def stale_sentence(self) -> str:
        """How many are stale for which reason; empty where none is."""
        reasons = Counter(" and ".join(item.changed) for item in self.stale)
        told = ", ".join(
            f"{count} as {reason} changed" for reason, count in sorted(reasons.items())
        )
        return f"{len(self.stale)} stored simulations are stale: {told}" if told else ""


@dataclass(frozen=True, slots=True)
class Holdings:
    """Simulations of a list, by their places in it.

    Attributes
    ----------
    rows : dict of int to SweepRow
        Rows of those that are stored.
    unreadable : tuple of str
        A sentence for every file that is there and of no use.
    older : dict of str to dict
        Parts of the keys of simulations that are not in the list, by their labels.
    """

    rows: dict[int, SweepRow]
    unreadable: tuple[str, ...]
    older: dict[str, dict[str, str]]


def holdings(folder: Path, simulations: Sequence[Simulation]) -> Holdings:
    """What a store has of simulations.

    Parameters
    ----------
    folder : Path
        Folder of the store.
    simulations : sequence of Simulation
        What to look for.
    """
    # Spectra of one shape and different names have the same keys.
    wanted = {(one.key, one.label): place for place, one in enumerate(simulations)}
    sizes = _sizes(folder / "curves")
    rows: dict[int, SweepRow] = {}
    older: dict[str, dict[str, str]] = {}
    for entry in _entries(folder):
        place = wanted.get((entry.key, entry.label))
        if place is None:
            older[entry.label] = entry.parts
        # A simulation that cannot be done has a row and no file.
        elif (
            entry.row is not None
            and place not in rows
            and sizes.get(f"{simulations[place].stem}.nc", 0) == entry.size
        ):
            rows[place] = entry.row
    unreadable = []
    for place, simulation in enumerate(simulations):
        path = folder / "curves" / f"{simulation.stem}.nc"
        if place not in rows and path.name in sizes:
            try:
                rows[place] = sweep_row(read_simulation(path, simulation))
            except UnreadableFileError as error:
                unreadable.append(str(error))
    return Holdings(rows, tuple(unreadable), older)


def stale(missing: Sequence[Simulation], older: dict[str, dict[str, str]]) -> tuple[Stale, ...]:
    """Those of missing simulations that are stored with another key, and what changed it."""
    return tuple(
        Stale(one.label, tuple(name for name, part in one.parts.items() if part != known.get(name)))
        for one in missing
        if (known := older.get(one.label)) is not None
    )


def _entries(folder: Path) -> Iterator[Entry]:
    """Entries of all journals of a store."""
    definition = row_fingerprint()
    for path in journal_paths(folder / "journals"):
        yield from read_journal(path, definition)


def _sizes(folder: Path) -> dict[str, int]:
    """Bytes of the files of a folder, which need not exist."""
    if not folder.is_dir():
        return {}
    with os.scandir(folder) as files:
        return {file.name: file.stat().st_size for file in files}
