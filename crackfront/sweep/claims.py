"""Claims: which realisations a process simulates, so that another one waits for them.

Two processes have the same realisations where an unknown launcher starts a command several times,
or where a controller starts jobs that an earlier, killed one has left running.
"""

from __future__ import annotations

import contextlib
import fcntl
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO

from crackfront.sweep.parallel import stop_is_requested
from crackfront.sweep.sweep import Shard

_SECONDS = 0.5
"""Time between two attempts to lock realisations that another process holds. (Units: s)"""


@contextlib.contextmanager
def claimed(
    folder: Path, shards: Iterable[Shard], announce: Callable[[str], None]
) -> Iterator[bool]:
    """Hold the realisations of shards in a folder; yields whether another process had one of them.

    Waits until that has ended, in whatever way, and announces it by a sentence. Where the file
    system has no locks nothing is held. KeyboardInterrupt if a stop is requested meanwhile.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with contextlib.ExitStack() as files:
        # In the order of the sweep, so that no two processes wait for each other. Closed at the
        # end: a process loses its locks on a file with the first time that it closes it.
        waited = False
        for shard in shards:
            # Each realisation of a spectrum is a byte of its file.
            path = folder / f".{shard.item.name}.lock"
            with contextlib.suppress(PermissionError):  # the file is another user's
                waited |= _hold(files.enter_context(path.open("ab")), shard, announce)
        yield waited


def _hold(file: IO[bytes], shard: Shard, announce: Callable[[str], None]) -> bool:
    """Lock the realisations of a shard; whether another process had one of them."""
    block, waited = shard.realisations, False
    while True:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, len(block), block.start)
        except (BlockingIOError, PermissionError):
            if not waited:
                announce(
                    f"another process simulates realisations {block[0]} to {block[-1]} of "
                    f"{shard.item.name} in {file.name.rpartition('/')[0]} already; waiting for "
                    "its results. If a launcher started this command several times, start it once "
                    "with --ranks and --launcher instead"
                )
            waited = True
            if stop_is_requested():
                raise KeyboardInterrupt from None
            time.sleep(_SECONDS)
        except OSError:
            return waited  # a file system without locks
        else:
            return waited
