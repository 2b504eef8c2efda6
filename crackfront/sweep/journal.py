"""Journals, files to which one process each appends lines, and the index of the rows in them."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import functools
import json
import os
import secrets
import socket
import time
import zlib
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import BinaryIO

from crackfront.analysis.table import SweepRow
from crackfront.data.digests import Integrity, integrity
from crackfront.data.files import replace_atomically, set_aside
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.table import row_fingerprint


@dataclass(frozen=True, slots=True)
class Entry:
    """What one line says: a simulation was begun, or it ended."""

    key: str
    label: str
    parts: dict[str, str]
    """Those of the :class:`crackfront.simulate.simulation.Simulation`."""
    size: int = 0
    """Bytes of its file, 0 where it has none."""
    definition: str = ""
    """:func:`crackfront.sweep.table.row_fingerprint` of its row; empty where it was only begun."""
    row: SweepRow | None = None
    """Its row, if it ended and rows have the same definition now."""
    digest: str = ""
    """Digest of its file, empty where it has none."""


class Journal:
    """The journal of this process in a folder; it is created with its first line.

    While a simulation runs the process holds a lock on the file, which ends with the process.
    """

    def __init__(self, folder: Path) -> None:
        name = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(4)}.jsonl"
        self._path = folder / name
        self._held: BinaryIO | None = None

    def append(self, entry: Entry) -> None:
        """Write a line and have it on disk.

        Raises
        ------
        OSError
            If that is impossible; what was there before stays.
        """
        text = json.dumps(asdict(entry))
        line = f"{zlib.crc32(text.encode()):08x} {text}\n".encode()
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("ab", buffering=0) as file:
            length = file.tell()
            try:
                written = file.write(line)
                os.fsync(file.fileno())
                if written != len(line):
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self._path))
            except OSError:
                file.truncate(length)
                if not length:
                    self._path.unlink()
                raise
        self._hold()

    def _hold(self) -> None:
        """Lock the file, where the file system has locks and no other process holds this one."""
        if self._held is None:
            with contextlib.ExitStack() as stack, contextlib.suppress(OSError):
                file = stack.enter_context(self._path.open("rb"))
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                self._held = file
                stack.pop_all()

    def let_go(self) -> None:
        """Unlock the file until the next line."""
        if self._held is not None:
            self._held.close()
            self._held = None

    def __del__(self) -> None:
        self.let_go()

    def beat(self) -> None:
        """Show that this process lives."""
        os.utime(self._path)


@dataclass(frozen=True, slots=True)
class Running:
    """A simulation that a living process runs."""

    key: str
    label: str
    """Key and label of the simulation."""
    host: str
    process: str
    """Machine and number of the process."""
    silent_seconds: float
    """Time since its last sign of life, by the clock of this machine. (Units: s)"""


_SECONDS_TO_LIVE = 120.0
"""Age of a journal, against the newest, at which its process has ended if it has no lock."""

_SECONDS_OF_CLOCKS = 600.0
"""Age of the newest journal by this machine's clock at which all such processes have ended."""


def running(folder: Path) -> list[Running]:
    """What the living processes of the journals of a folder have begun last."""
    found = []
    for path in _living(folder):
        entries = [entry for _, entry in read_journal(path, "")]
        if entries and not entries[-1].definition:
            host, process, _ = path.stem.rsplit("-", 2)
            silent = max(0.0, time.time() - path.stat().st_mtime)
            found.append(Running(entries[-1].key, entries[-1].label, host, process, silent))
    return found


def _living(folder: Path) -> Iterator[Path]:
    """Journals whose processes live, by their locks or, where these say nothing, by their dates."""
    moments = {path: path.stat().st_mtime for path in journal_paths(folder)}
    newest, now = max(moments.values(), default=0.0), time.time()
    for path, moment in moments.items():
        alive = _is_locked(path)
        if alive is None:
            alive = newest - moment < _SECONDS_TO_LIVE and now - newest <= _SECONDS_OF_CLOCKS
        if alive:
            yield path


def _is_locked(path: Path) -> bool | None:
    """Whether a process holds the lock on its journal; None where that cannot be known."""
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        except OSError:
            return None  # a file system without locks
    # Locks of other machines may be unknown here.
    return False if path.stem.rsplit("-", 2)[0] == socket.gethostname() else None


def renew_journals(folder: Path) -> list[str]:
    """Set damaged journals of ended processes aside but for whole lines; a sentence each."""
    found, living = [], set(_living(folder))
    for path in journal_paths(folder):
        lines, n_damaged = whole_lines(path)
        if n_damaged and path not in living:
            # Another process may just do the same.
            with contextlib.suppress(FileNotFoundError):
                aside = set_aside(path).name
                if lines:
                    content = b"".join(lines)
                    replace_atomically(path, functools.partial(Path.write_bytes, data=content))
                found.append(f"{path} is damaged; its whole lines stay, the rest is in {aside}")
    return found


def whole_lines(path: Path) -> tuple[list[bytes], int]:
    """Whole lines of a journal, and the number of damaged ones; 1 for an empty journal."""
    with path.open("rb") as file:
        lines = list(file)
    whole = [line for line in lines if _text(line) is not None]
    return whole, len(lines) - len(whole) if lines else 1


def journal_paths(folder: Path) -> list[Path]:
    """Journals of a folder, always in the same order."""
    return sorted(folder.glob("*.jsonl"))


def read_journal(path: Path, definition: str) -> Iterator[tuple[int, Entry]]:
    """Entries of the whole lines of a journal, each with the byte at which its line begins.

    Parameters
    ----------
    path : Path
        The journal.
    definition : str
        Fingerprint of what a row is now; of another one, the entry comes without its row.
    """
    place = 0
    with path.open("rb") as file:
        for line in file:
            if (entry := _entry(line, definition)) is not None:
                yield place, entry
            place += len(line)


def _text(line: bytes) -> bytes | None:
    """Text of a line behind its checksum, None where that is not the one of the text."""
    checksum, _, text = line.rstrip(b"\n").partition(b" ")
    whole = line.endswith(b"\n") and checksum == b"%08x" % zlib.crc32(text)
    return text if whole else None


def _entry(line: bytes, definition: str) -> Entry | None:
    """Entry of a line, None where it is damaged."""
    if (text := _text(line)) is None:
        return None
    content = json.loads(text)
    row = content.pop("row")
    known = row is not None and content["definition"] == definition
    return Entry(**content, row=SweepRow(**row) if known else None)


class RowIndex:
    """Rows in the journals of the store in a folder, by the labels of their simulations.

    The file of a row must have the digest that was stored with it; unless `checked`, its size only.
    """

    def __init__(self, folder: Path, *, checked: bool = True) -> None:
        self._curves, self._checked = folder / "curves", checked
        self._places: dict[str, list[tuple[Path, int]]] = defaultdict(list)
        for path in journal_paths(folder / "journals"):
            for place, entry in read_journal(path, row_fingerprint()):
                if entry.definition:
                    self._places[entry.label].append((path, place))

    def row(self, simulation: Simulation) -> SweepRow | None:
        """Row of a simulation, if there is one and its file is as the row says."""
        if simulation.label not in self._places:
            return None  # before its key is computed, which is slow
        key = simulation.key
        entries = (entry for entry in self._entries(simulation.label) if entry.key == key)
        return next((entry.row for entry in entries if self._is_valid(entry)), None)

    def parts(self, label: str) -> dict[str, str]:
        """Parts of the key with which a simulation of a label was stored last, if it was."""
        entries = list(self._entries(label))
        return entries[-1].parts if entries else {}

    def _entries(self, label: str) -> Iterator[Entry]:
        """Entries of simulations of a label that have ended, in the order of the journals."""
        for path, place in self._places.get(label, ()):
            with path.open("rb") as file:
                file.seek(place)
                if (entry := _entry(file.readline(), row_fingerprint())) is not None:
                    yield entry

    def _is_valid(self, entry: Entry) -> bool:
        """Whether an entry has a row, and the file that the row names, if any, is that of then."""
        if entry.row is None or not entry.row.curve:
            return entry.row is not None
        path = self._curves / entry.row.curve
        try:
            if not self._checked:
                return path.stat().st_size == entry.size
            return integrity(path) == (Integrity.WHOLE, entry.digest)
        except FileNotFoundError:
            return False
