"""The ledger: where in the journals of a store its rows stand, to read them when needed."""

from __future__ import annotations

import functools
import hashlib
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.table import SweepRow
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.journal import Entry, journal_paths, read_entry, read_journal
from crackfront.sweep.table import row_fingerprint

ROWS_AT_ONCE = 4096
"""Rows that are in memory at once."""

_LINE = np.dtype([("identity", "u8"), ("label", "u8"), ("place", "u8"), ("journal", "u4")])
"""What is held of a line: hashes of key with label and of the label, and where it begins."""


class Ledger:
    """Rows of all journals of a store as they are now, found by simulation.

    It holds 28 bytes of every row; the rows themselves are read when they are asked for.

    Parameters
    ----------
    folder : Path
        Folder of the store.
    """

    def __init__(self, folder: Path) -> None:
        self._curves = folder / "curves"
        self._journals = journal_paths(folder / "journals")
        lines = np.fromiter(self._ended(), dtype=_LINE)
        self._lines = lines[np.argsort(lines["identity"], kind="stable")]

    def rows(
        self, simulations: Iterable[Simulation]
    ) -> Iterator[tuple[Simulation, SweepRow | None]]:
        """Simulations in their order, with the rows of those whose files are as the rows say.

        Parameters
        ----------
        simulations : iterable of Simulation
            What to look for.
        """
        remaining = iter(simulations)
        while chunk := list(islice(remaining, ROWS_AT_ONCE)):
            yield from zip(chunk, self._rows(chunk), strict=True)

    def parts(self, label: str) -> dict[str, str] | None:
        """What the key is made of with which a simulation of a label was stored last, if it was."""
        labels = self._lines["label"]
        last = np.searchsorted(labels, _hash(label), side="right", sorter=self._by_label) - 1
        if last < 0:
            return None
        line = self._lines[self._by_label[last]]
        entries = self._entries(int(line["journal"]), [int(line["place"])])
        return next((one.parts for one in entries if one.label == label), None)

    @functools.cached_property
    def _by_label(self) -> NDArray[np.int64]:
        """Lines in the order of their labels."""
        return np.argsort(self._lines["label"], kind="stable")

    def _ended(self) -> Iterator[tuple[int, int, int, int]]:
        """Lines of simulations that have ended."""
        for number, path in enumerate(self._journals):
            for place, entry in read_journal(path, row_fingerprint()):
                if entry.definition:
                    identity = _hash(f"{entry.key} {entry.label}")
                    yield identity, _hash(entry.label), place, number

    def _rows(self, simulations: Sequence[Simulation]) -> Iterator[SweepRow | None]:
        """Rows of a few simulations, journal by journal."""
        # Spectra of one shape and different names have the same keys.
        names = [(one.key, one.label) for one in simulations]
        hashes = np.array([_hash(f"{key} {label}") for key, label in names], dtype="u8")
        first, last = (
            np.searchsorted(self._lines["identity"], hashes, side=side)
            for side in ("left", "right")
        )
        wanted: dict[int, list[int]] = defaultdict(list)
        for start, stop in zip(first, last, strict=True):
            for line in self._lines[start:stop]:
                wanted[int(line["journal"])].append(int(line["place"]))
        found: dict[tuple[str, str], list[Entry]] = defaultdict(list)
        for number, places in sorted(wanted.items()):
            for entry in self._entries(number, sorted(places)):
                found[entry.key, entry.label].append(entry)
        for name in names:
            yield next((entry.row for entry in found[name] if self._valid(entry)), None)

    def _entries(self, number: int, places: Sequence[int]) -> Iterator[Entry]:
        """Entries of a journal at given places."""
        with self._journals[number].open("rb") as file:
            for place in places:
                entry = read_entry(file, place, row_fingerprint())
                if entry is not None:
                    yield entry

    def _valid(self, entry: Entry) -> bool:
        """Whether an entry has a row, and the file that the row names, if any, has its size."""
        if entry.row is None or not entry.row.curve:
            return entry.row is not None
        try:
            return (self._curves / entry.row.curve).stat().st_size == entry.size
        except FileNotFoundError:
            return False


def _hash(text: str) -> int:
    """64 bits that differ for different texts, but for one in 1e19."""
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest())
