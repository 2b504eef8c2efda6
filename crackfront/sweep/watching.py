"""A bar on a terminal of a whole sweep, while jobs of a workflow fill its folder."""

from __future__ import annotations

import re
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path

_SECONDS = 1.0
"""Time between two looks at the logs. (Units: s)"""

_FINISHED = re.compile(rb"^\[\d+/\d+\] ", re.MULTILINE)
_STORED = re.compile(rb": (\d+) of \d+ simulations are stored$", re.MULTILINE)
"""Lines of the log of a job: for each finished simulation, and for those that it finds stored."""


class SweepBar:
    """Bar of the simulations of a sweep, drawn by a thread of the process that runs the workflow.

    It counts lines in the logs of the jobs; `sizes` are the numbers of simulations of the shards by
    their names. Nothing is drawn where standard error is no terminal:
    jobs print the lines there.
    """

    def __init__(self, sizes: Mapping[str, int], results: Path) -> None:
        self._sizes, self._results = sizes, results
        self.terminal = sys.stderr.isatty()
        self._began = time.time()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._draw, daemon=True)

    def begin(self) -> None:
        """Draw from now on, if there is a terminal."""
        if self.terminal:
            self._thread.start()

    def end(self) -> None:
        """Draw what is finished by now, and no more."""
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join()

    def _finished(self, shard: str) -> int:
        """How many simulations of a shard have finished: all if its file is there, and no job."""
        log = self._results / "logs" / f"simulate-{shard}.log"
        if log.exists() and log.stat().st_mtime >= self._began:
            text = log.read_bytes()
            return sum(map(int, _STORED.findall(text))) + len(_FINISHED.findall(text))
        return self._sizes[shard] if (self._results / "shards" / f"{shard}.nc").exists() else 0

    def _draw(self) -> None:
        """Read the logs repeatedly, and update the bar."""
        from tqdm import tqdm

        total = sum(self._sizes.values())
        with tqdm(total=total, unit="simulation", smoothing=0, file=sys.stderr) as bar:
            while True:
                ended = self._ended.wait(_SECONDS)
                bar.update(sum(map(self._finished, self._sizes)) - bar.n)
                if ended:
                    return
