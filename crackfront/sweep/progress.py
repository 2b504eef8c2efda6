"""How far a sweep is, told from its files alone, also while it runs elsewhere."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, replace
from pathlib import Path

from crackfront.simulate.costs import expected_cost
from crackfront.sweep.inventory import holdings
from crackfront.sweep.journal import journal_paths, read_journal
from crackfront.sweep.ledger import Ledger
from crackfront.sweep.sweep import Sweep
from crackfront.sweep.table import COMPLETE, row_fingerprint

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
    running, ledger = _running(folder), Ledger(folder)
    found, paces = [], []
    for item in sweep.spectra:
        done = failed = at_work = waiting = 0
        seconds = 0.0
        for held in holdings(folder, sweep.simulations(item), ledger):
            expected = expected_cost(held.simulation).seconds
            if held.row is None:
                at_work += held.simulation.key in running
                waiting += held.simulation.key not in running
                seconds += expected
                continue
            done += held.row.status in COMPLETE
            failed += held.row.status not in COMPLETE
            if held.row.cpu_seconds > 0:
                paces.append(held.row.cpu_seconds / expected)
        found.append(Progress(item.name, done, failed, at_work, waiting, seconds))
    pace = statistics.median(paces) if paces else 1.0
    return [replace(one, seconds=pace * one.seconds) for one in found]


def _running(folder: Path) -> set[str]:
    """Keys that the journals of living processes have begun last."""
    moments = {path: path.stat().st_mtime for path in journal_paths(folder / "journals")}
    newest = max(moments.values(), default=0.0)
    if time.time() - newest > SECONDS_OF_CLOCKS:
        return set()
    found = set()
    for path, moment in moments.items():
        if newest - moment < SECONDS_TO_LIVE:
            entries = [entry for _, entry in read_journal(path, row_fingerprint())]
            if entries and not entries[-1].definition:
                found.add(entries[-1].key)
    return found
