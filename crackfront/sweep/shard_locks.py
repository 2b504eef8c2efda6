"""Locks of the folders of shards, so that one process at a time writes into each."""

from __future__ import annotations

import contextlib
import fcntl
import itertools
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO

from crackfront.sweep.parallel import stop_is_requested

Announce = Callable[[str], None]
"""Called with a sentence on a damaged file, or on another process that is waited for."""

_LOCK = ".lock"
"""File in the folder of a shard that its writer has locked."""

_WAIT_SECONDS = 0.5
"""Time between two attempts to lock a shard that another process has locked. (Units: s)"""

_LOCKED_ELSEWHERE = (BlockingIOError, PermissionError)
"""What locking a file raises where another process has locked it."""


@contextlib.contextmanager
def locked_folders(folders: Iterable[Path], announce: Announce) -> Iterator[None]:
    """Lock folders of shards while the context is open; make those that are missing.

    Waits where another process has one of them, until that has ended in whatever way, and
    announces it: a killed Snakemake leaves its jobs running, and starts the same ones again.
    On a file system without locks nothing is locked. KeyboardInterrupt if a stop is requested
    meanwhile.
    """
    with contextlib.ExitStack() as files:
        # In one order for all processes, so that no two wait for each other.
        for folder in sorted(folders):
            folder.mkdir(parents=True, exist_ok=True)
            file = files.enter_context((folder / _LOCK).open("ab"))
            _lock(file, folder, announce)
            # Only this process writes here now: half-written files were left by others.
            for part in (*folder.glob(".*.part"), *folder.glob(".*.nc")):
                part.unlink(missing_ok=True)
        yield


def _lock(file: IO[bytes], folder: Path, announce: Announce) -> None:
    """Lock the file of a folder, when another process has left it."""
    for attempt in itertools.count():
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return
        except _LOCKED_ELSEWHERE:
            if attempt == 1:  # `status` locks for an instant
                announce(
                    f"another process simulates {folder.name} in {folder.parents[1]} already; "
                    "waiting for its results"
                )
            if stop_is_requested():
                raise KeyboardInterrupt from None
            time.sleep(_WAIT_SECONDS)
        except OSError:
            return  # a file system without locks


def locked_names(curves: Path) -> list[str]:
    """Names of the folders that another process has locked, as far as this machine sees it."""
    names = []
    for path in sorted(curves.glob(f"*/{_LOCK}")):
        with contextlib.suppress(OSError), path.open("ab") as file:
            try:
                fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except _LOCKED_ELSEWHERE:
                names.append(path.parent.name)
    return names
