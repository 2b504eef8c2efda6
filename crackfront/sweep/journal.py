"""Journals: files to which one process each appends lines; a line counts where it is whole."""

from __future__ import annotations

import json
import os
import secrets
import socket
import zlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import BinaryIO

from crackfront.analysis.table import SweepRow


@dataclass(frozen=True, slots=True)
class Entry:
    """What one line says: a simulation was begun, or it ended.

    Attributes
    ----------
    key, label : str
        Key and label of the simulation.
    parts : dict of str to str
        What the key is made of, as :attr:`crackfront.simulate.simulation.Simulation.parts`.
    size : int
        Bytes of its file, 0 where it has none.
    definition : str
        Fingerprint of what a row is, as :func:`crackfront.sweep.table.row_fingerprint`; empty where
        the simulation was only begun.
    row : SweepRow or None
        Its row, where the simulation ended and a row is still that.
    """

    key: str
    label: str
    parts: dict[str, str]
    size: int = 0
    definition: str = ""
    row: SweepRow | None = None


class Journal:
    """The journal of this process in a folder; it is created with its first line.

    Parameters
    ----------
    folder : Path
        Folder of the journals.
    """

    def __init__(self, folder: Path) -> None:
        name = f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(4)}.jsonl"
        self._path = folder / name

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
                    raise OSError(f"{self._path} took only {written} of {len(line)} bytes")
            except OSError:
                file.truncate(length)
                raise

    def beat(self) -> None:
        """Show that this process lives."""
        os.utime(self._path)


def read_journal(path: Path, definition: str) -> Iterator[tuple[int, Entry]]:
    """Places and entries of a journal; a line that is torn or changed is left out.

    Parameters
    ----------
    path : Path
        The journal.
    definition : str
        Fingerprint of what a row is now; of another one, the entry comes without its row.

    Yields
    ------
    tuple
        Byte at which the line begins, for :func:`read_entry`, and what it says.
    """
    place = 0
    with path.open("rb") as file:
        for line in file:
            entry = _entry(line, definition)
            if entry is not None:
                yield place, entry
            place += len(line)


def read_entry(file: BinaryIO, place: int, definition: str) -> Entry | None:
    """Entry of an open journal at a place; None where the line is torn or changed."""
    file.seek(place)
    return _entry(file.readline(), definition)


def _entry(line: bytes, definition: str) -> Entry | None:
    """What a line says, if it is whole."""
    checksum, _, text = line.rstrip(b"\n").partition(b" ")
    if not line.endswith(b"\n") or checksum != b"%08x" % zlib.crc32(text):
        return None
    content = json.loads(text)
    row = content.pop("row")
    known = row is not None and content["definition"] == definition
    return Entry(**content, row=SweepRow(**row) if known else None)


def journal_paths(folder: Path) -> list[Path]:
    """Journals of a folder, always in the same order."""
    return sorted(folder.glob("*.jsonl"))
