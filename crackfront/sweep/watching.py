"""A bar on a terminal of a whole sweep, while jobs of a workflow fill its folder."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path

from crackfront.sweep.sweep import Sweep

_LEAST_WAIT, _SHARE = 1.0, 0.1
"""Shortest time between two reads of the folder (Units: s), and largest share of time for them."""


class SweepBar:
    """Bar of the simulations of a sweep, drawn by a thread of the process that runs the workflow.

    Nothing is drawn where standard error is no terminal: jobs print lines, and logs keep them.
    """

    def __init__(self, sweep: Sweep, results: Path) -> None:
        self._sweep, self._results = sweep, results
        self.terminal = sys.stderr.isatty()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._draw, daemon=True)

    def begin(self) -> None:
        """Draw from now on, if there is a terminal."""
        if self.terminal:
            self._thread.start()

    def end(self) -> None:
        """Draw what is stored by now, and no more."""
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join()

    def _stored(self) -> int:
        """How many simulations are stored."""
        # Workflows make a bar that most of them never draw.
        from crackfront.sweep.store import Store

        store = Store(self._results)
        found = [store.progress(self._sweep, item) for item in self._sweep.spectra]
        return sum(one.done + one.failed for one in found)

    def _draw(self) -> None:
        """Read the folder repeatedly, and update the bar with newly stored simulations."""
        from tqdm import tqdm

        total, first = self._sweep.n_simulation, self._stored()
        if first == total:
            return
        with tqdm(
            total=total, initial=first, unit="simulation", smoothing=0, file=sys.stderr
        ) as bar:
            wait = _LEAST_WAIT
            while not self._ended.wait(wait):
                began = time.monotonic()
                bar.update(self._stored() - bar.n)
                wait = max(_LEAST_WAIT, (time.monotonic() - began) / _SHARE)
            bar.update(self._stored() - bar.n)
