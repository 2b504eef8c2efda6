"""Files of finished simulations of a shard while it runs, each of several simulations."""

from __future__ import annotations

import time
from pathlib import Path

from crackfront.simulate.checksums import BATCH, CHECKPOINT
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.curves import FinishedSimulation, curves_dataset, write_curves

_MOST_WAITING = 2000
"""Finished simulations that are written at once, however short the time since the last batch."""

_MOST_WAITING_BYTES = 2e8
"""Size of the fronts of finished simulations that are written at once: the fronts of a minute of
many ranks would fill the memory of the manager. (Units: byte)"""


class BatchWriter:
    """Writes finished simulations of one shard, from time to time, into files of several."""

    def __init__(self, folder: Path, origin: Provenance, seconds: float) -> None:
        self._folder, self._origin, self._seconds = folder, origin, seconds
        self._finished: list[FinishedSimulation] = []
        self._written = time.monotonic()
        self._count = self._n_byte = 0
        self.n_written = 0

    def add(self, finished: FinishedSimulation) -> None:
        """Take a finished simulation; it is written with others in time."""
        self._finished.append(finished)
        if finished.record is not None and finished.record.fronts is not None:
            self._n_byte += finished.record.fronts.nbytes
        if len(self._finished) >= _MOST_WAITING or self._n_byte >= _MOST_WAITING_BYTES:
            self.flush()

    def flush_in_time(self) -> None:
        """Write what is finished if the last batch was long enough ago."""
        if time.monotonic() - self._written >= self._seconds:
            self.flush()

    def flush(self) -> None:
        """Write what is finished, and remove its checkpoints."""
        if not self._finished:
            return
        self._written = time.monotonic()
        self._count += 1
        # In the order of a shard, so that a batch with all of it need not be written again.
        self._finished.sort(
            key=lambda item: (item.simulation.elastic_energy, item.simulation.realisation)
        )
        dataset = curves_dataset(self._finished)
        write_curves(self._folder, BATCH, f"{self._count:06}", dataset, self._origin)
        for finished in self._finished:
            for path in checkpoint_files(self._folder, finished.simulation):
                path.unlink(missing_ok=True)
        self.n_written += len(self._finished)
        self._finished, self._n_byte = [], 0


def checkpoint_files(folder: Path, simulation: Simulation) -> list[Path]:
    """Checkpoints of a simulation in the folder of its shard, the latest last."""
    paths = folder.glob(f"{CHECKPOINT}-{simulation.stem}-*.nc")
    return sorted(paths, key=lambda path: path.stat().st_mtime)
