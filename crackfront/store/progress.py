"""How far a sweep is, told from its files alone, also while it runs elsewhere."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from crackfront.costs import expected_cost
from crackfront.dataset import COMPLETE, SweepRow, row_fingerprint
from crackfront.scene import Simulation
from crackfront.store.inventory import holdings
from crackfront.store.journal import journal_paths, read_journal
from crackfront.sweep import Sweep

SECONDS_TO_LIVE = 120.0
"""Age of a journal, against the newest, from which its process counts as ended."""

SECONDS_OF_CLOCKS = 600.0
"""Age of the newest journal by this machine's clock from which nothing runs any more."""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far one spectrum is.

    Attributes
    ----------
    name : str
        Name of the spectrum.
    done, failed, running, waiting : int
        Simulations with values; rows without; those that a process is at; all others.
    seconds : float
        Processor time that is expected for those that are running or waiting. (Units: s)
    """

    name: str
    done: int
    failed: int
    running: int
    waiting: int
    seconds: float


def sweep_progress(folder: Path, sweep: Sweep) -> list[Progress]:
    """How far each spectrum of a sweep is.

    The expected times are those of the cost model, in proportion to what the stored simulations of
    the sweep took.

    Parameters
    ----------
    folder : Path
        Folder of the store.
    sweep : Sweep
        Its parameters.
    """
    simulations = [one for item in sweep.spectra for one in sweep.shard(item)]
    rows = holdings(folder, simulations).rows
    running = _running(folder)
    pace = _pace([(simulations[place], row) for place, row in rows.items()])
    found = []
    for item in sweep.spectra:
        places = [i for i, one in enumerate(simulations) if one.spectrum_name == item.name]
        ended = [rows[place] for place in places if place in rows]
        left = [simulations[place] for place in places if place not in rows]
        done = sum(row.status in COMPLETE for row in ended)
        at_work = sum(one.key in running for one in left)
        seconds = pace * sum(expected_cost(one).seconds for one in left)
        found.append(
            Progress(item.name, done, len(ended) - done, at_work, len(left) - at_work, seconds)
        )
    return found


def _pace(ended: Sequence[tuple[Simulation, SweepRow]]) -> float:
    """Measured over expected time of simulations that have ended; 1 where there is none."""
    ratios = [
        row.cpu_seconds / expected_cost(simulation).seconds
        for simulation, row in ended
        if row.cpu_seconds > 0
    ]
    return statistics.median(ratios) if ratios else 1.0


def _running(folder: Path) -> set[str]:
    """Keys that the journals of living processes have begun last."""
    moments = {path: path.stat().st_mtime for path in journal_paths(folder / "journals")}
    newest = max(moments.values(), default=0.0)
    if time.time() - newest > SECONDS_OF_CLOCKS:
        return set()
    found = set()
    for path, moment in moments.items():
        if newest - moment < SECONDS_TO_LIVE:
            entries = list(read_journal(path, row_fingerprint()))
            if entries and not entries[-1].definition:
                found.add(entries[-1].key)
    return found
