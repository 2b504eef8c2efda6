"""The packs of a store, to which the process of each job appends, and the index of their rows.

A finished simulation is two files in a pack: its curve as netCDF, where it has one, and its row as
JSON.
"""

from __future__ import annotations

import contextlib
import functools
import json
import os
import re
import secrets
import socket
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from crackfront.analysis.table import SweepRow
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.data.files import replace_atomically, set_aside
from crackfront.data.packs import (
    PACK,
    Member,
    Pack,
    checked,
    is_locked,
    members,
    record,
)

_CURVE, _ROW = ".nc", ".json"
"""Endings of the names of curves and rows in packs."""

_KEY = 16
"""Digits of a key, which end the name of a simulation."""

_NAME = re.compile(r"([A-Za-z0-9_-]+)\.(\d+)-(\d+)\.(.+)")
"""Name of a pack: spectrum, first and last realisation, and its process."""


@dataclass(frozen=True, slots=True)
class Entry:
    """What a pack says of a simulation that has ended."""

    stem: str
    """Name of the simulation's files without a suffix; its key ends it."""
    parameters: dict[str, Any]
    """Parameters that its series is the digest of."""
    physics_version: int
    rows_version: int
    """:mod:`crackfront.core.versions` of its states and of its row."""
    row: SweepRow | None
    """Its row, if rows have the same definition now."""
    arithmetic: str = ""
    """Arithmetic of its provenance; empty where an earlier version stored it."""

    def files(self, curve: bytes = b"") -> dict[str, bytes]:
        """Files of a pack, by their names."""
        row = {self.stem + _ROW: json.dumps(asdict(self)).encode()}
        return {self.stem + _CURVE: curve} | row if curve else row


def new_pack(folder: Path, spectrum: str, block: range) -> Pack:
    """A pack of this process for a spectrum and some consecutive realisations."""
    return Pack(folder / f"{spectrum}.{block[0]}-{block[-1]}.{_own_name()}{PACK}")


def _own_name() -> str:
    """Part of a name that no other process has: machine, process, and random digits."""
    return f"{socket.gethostname()}-{os.getpid()}-{secrets.token_hex(4)}"


@dataclass(frozen=True, slots=True)
class Writer:
    """A process that stores simulations of a spectrum and some realisations."""

    spectrum: str
    realisations: str
    """First and last one."""
    host: str
    process: str
    """Machine and number of the process."""


def writers(folder: Path) -> list[Writer]:
    """Processes that hold the lock on their pack, as far as this machine sees locks of others."""
    found = []
    for path in filter(is_locked, pack_paths(folder)):
        match = _NAME.fullmatch(path.stem)
        assert match is not None, "it is the name of a pack"
        host, process, _ = match[4].rsplit("-", 2)
        found.append(Writer(match[1], f"{match[2]}-{match[3]}", host, process))
    return found


def pack_paths(folder: Path, spectrum: str | None = None, block: range | None = None) -> list[Path]:
    """Packs of a store's folder in which simulations may be, always in the same order.

    They are those of a spectrum and of a block of consecutive realisations, by default of all.
    """
    found = []
    for path in sorted(folder.glob(f"*{PACK}")):
        match = _NAME.fullmatch(path.stem)
        if match is not None and spectrum in (None, match[1]):
            first, last = int(match[2]), int(match[3])
            if block is None or (first <= block[-1] and block[0] <= last):
                found.append(path)
    return found


def repair_packs(paths: Iterable[Path]) -> Iterator[str]:
    """Set damaged packs that no process writes aside but for their whole files; a sentence each."""
    for path in paths:
        whole, n_damaged = checked(path)
        if not n_damaged or is_locked(path):
            continue
        # Another process may just do the same.
        with contextlib.suppress(FileNotFoundError):
            aside = set_aside(path)
            kept = [replace(one, path=aside) for one in whole]
            if kept:
                replace_atomically(path, functools.partial(_write, kept))
            yield f"{path} is damaged; its whole files stay, the rest is in {aside.name}"


def _write(kept: Iterable[Member], path: Path) -> None:
    """Write a pack of files of another one."""
    with path.open("wb") as file:
        file.writelines(record(one.name, one.content() or b"") for one in kept)


def _entry(member: Member) -> Entry | None:
    """Entry in the file of a row, None where it is of no use; an older row is left out of it."""
    if (content := member.content()) is None:
        return None
    values = {"arithmetic": ""} | json.loads(content)
    if not values.keys() >= Entry.__dataclass_fields__.keys():
        return None  # of another version
    values = {name: values[name] for name in Entry.__dataclass_fields__}
    known = values["rows_version"] == ROWS_VERSION
    return Entry(**values | {"row": SweepRow(**values["row"]) if known else None})


class RowIndex:
    """Simulations in the packs of a spectrum and some consecutive realisations, by their stems.

    A row counts if its curve is whole; unless `checked`, if there is a curve.
    """

    def __init__(self, folder: Path, spectrum: str, block: range, *, checked: bool = True) -> None:
        self._checked = checked
        self._members: dict[str, list[Member]] = defaultdict(list)
        self._alike: dict[str, list[Member]] = defaultdict(list)
        for path in pack_paths(folder, spectrum, block):
            for member in members(path)[0]:
                self._members[member.name].append(member)
                stem, dot, suffix = member.name.rpartition(".")
                if dot + suffix == _ROW:
                    self._alike[_without_key(stem)].append(member)

    def entry(self, stem: str) -> Entry | None:
        """Entry of a simulation with a row, if there is one and its curve is as that says."""
        for member in self._members.get(stem + _ROW, ()):
            entry = _entry(member)
            if entry is None or entry.row is None or entry.physics_version != PHYSICS_VERSION:
                continue
            if not entry.row.curve or self._has_curve(stem):
                return entry
        return None

    def _has_curve(self, stem: str) -> bool:
        """Whether there is a whole curve, or any where they are not to be checked."""
        curves = self.curves(stem)
        if not self._checked:
            return bool(curves)
        return any(one.content() is not None for one in curves)

    def curves(self, stem: str) -> list[Member]:
        """Curves that are stored of a simulation."""
        return self._members.get(stem + _CURVE, [])

    def alike(self, stem: str) -> Iterator[Entry]:
        """Entries of the simulations of this name, with whatever keys."""
        entries = map(_entry, self._alike.get(_without_key(stem), []))
        return (entry for entry in entries if entry is not None)


def _without_key(stem: str) -> str:
    """Name of a simulation without its key."""
    return stem[: -_KEY - 1]
