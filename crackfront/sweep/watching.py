"""A bar on a terminal of a whole sweep, while jobs of a workflow fill its folder."""

from __future__ import annotations

import re
import sys
import threading
import time
from pathlib import Path

_SECONDS = 1.0
"""Time between two looks at the logs. (Units: s)"""

_FINISHED = re.compile(rb"^\[\d+/\d+\] ", re.MULTILINE)
"""Beginning of the line that a job writes into its log for each finished simulation."""


class SweepBar:
    """Bar of the simulations of a sweep, drawn by a thread of the process that runs the workflow.

    It counts lines in the logs of the jobs. Nothing is drawn where standard error is no terminal:
    jobs print the lines there.
    """

    def __init__(self, n_simulation: int, results: Path) -> None:
        self._total, self._logs = n_simulation, results / "logs"
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

    def _finished(self) -> int:
        """How many simulations have finished since the workflow began."""
        logs = [path for path in self._logs.glob("simulate-*.log")]
        recent = [path for path in logs if path.stat().st_mtime >= self._began]
        return sum(len(_FINISHED.findall(path.read_bytes())) for path in recent)

    def _draw(self) -> None:
        """Read the logs repeatedly, and update the bar."""
        from tqdm import tqdm

        with tqdm(total=self._total, unit="simulation", smoothing=0, file=sys.stderr) as bar:
            while not self._ended.wait(_SECONDS):
                bar.update(self._finished() - bar.n)
            bar.update(self._finished() - bar.n)
