"""Checkpoints of a run, written from time to time and when a stop is requested."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from crackfront.sweep import parallel


class CheckpointTimer:
    """Lets a run write into a file or folder from time to time, and at once when it is to stop."""

    def __init__(self, path: Path, seconds: float) -> None:
        self.path = path
        self._seconds = seconds
        self._written = time.monotonic()

    def keep(self, write: Callable[[Path], None]) -> bool:
        """Let a function write there where it is time for that; whether the run is to stop."""
        stop = parallel.stop_is_requested()
        if stop or time.monotonic() - self._written >= self._seconds:
            write(self.path)
            self._written = time.monotonic()
        return stop
