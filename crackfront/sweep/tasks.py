"""A simulation of a sweep as a task: run, checkpointed, stored, and told to the journal."""

from __future__ import annotations

import contextlib
import functools
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from crackfront.data.files import UnreadableFileError
from crackfront.data.provenance import Provenance
from crackfront.simulate.files import read_checkpoint, write_checkpoint, write_simulation
from crackfront.simulate.run import PartialRun, run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import notice
from crackfront.sweep.journal import Entry, Journal
from crackfront.sweep.table import failed_row, row_fingerprint, sweep_row

STOPPED, NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""

REFUSED, DEFECT = "refused", "defect"
"""Statuses of rows: the surface or the load cannot be simulated, or the solver found a defect."""

SECONDS_BETWEEN_BEATS = 20.0
"""Time after which a running simulation shows that it lives."""


@dataclass(frozen=True, slots=True)
class Task:
    """A simulation, the store that it goes to and what its file says about its origin.

    Attributes
    ----------
    simulation : Simulation
        What to run.
    folder : Path
        Folder of the store.
    origin : Provenance
        What the files say about their origin.
    checkpoint_seconds : float
        Time between checkpoints.
    """

    simulation: Simulation
    folder: Path
    origin: Provenance
    checkpoint_seconds: float

    @property
    def curve(self) -> Path:
        """File of the result."""
        return self.folder / "curves" / f"{self.simulation.stem}.nc"

    @property
    def checkpoint(self) -> Path:
        """File from which a later run goes on."""
        return self.folder / "checkpoints" / f"{self.simulation.stem}.nc"


@dataclass(frozen=True, slots=True)
class Finished:
    """How a task ended.

    Attributes
    ----------
    status : str
        Status of its row; `stopped` or `not_stored` where there is none.
    seconds : float
        Wall time.
    sentence : str
        What was wrong, or empty.
    """

    status: str
    seconds: float = 0.0
    sentence: str = ""


class _Keeper:
    """What stores the checkpoints of a task, and ends it where notice was given."""

    def __init__(self, task: Task, journal: Journal) -> None:
        self._task, self._journal = task, journal
        self._written = self._beaten = time.monotonic()

    def found(self) -> PartialRun | None:
        """An earlier run to go on from."""
        try:
            return read_checkpoint(self._task.checkpoint, self._task.simulation)
        except UnreadableFileError:
            return None

    def keep(self, make: Callable[[], PartialRun]) -> None:
        """Store a checkpoint where it is time to; end where notice was given."""
        now, stop = time.monotonic(), notice.is_given()
        if stop or now - self._written >= self._task.checkpoint_seconds:
            with _storing():
                write_checkpoint(self._task.checkpoint, make(), self._task.origin)
            self._written = time.monotonic()
        if stop:
            raise notice.NoticeGivenError
        if now - self._beaten >= SECONDS_BETWEEN_BEATS:
            with _storing():
                self._journal.beat()
            self._beaten = now


def run_task(task: Task) -> Finished:
    """Run one simulation and store its result; one that cannot be done becomes a row as well."""
    if notice.is_given():
        return Finished(STOPPED)
    try:
        return _run(task, _journal(task.folder / "journals"))
    except notice.NoticeGivenError:
        return Finished(STOPPED)
    except MemoryError:
        return Finished(NOT_STORED, sentence="the memory does not suffice; start fewer ranks")
    except _NotStoredError as error:
        return Finished(NOT_STORED, sentence=str(error))


def _run(task: Task, journal: Journal) -> Finished:
    """Run one simulation; the journal tells that it began and how it ended."""
    simulation, keeper = task.simulation, _Keeper(task, journal)
    begun = Entry(simulation.key, simulation.label, simulation.parts)
    with _storing():
        journal.append(begun)
    try:
        result = run_simulation(simulation, resume=keeper.found(), keep=keeper.keep)
    except (ValueError, ArithmeticError, RuntimeError) as error:
        status = REFUSED if isinstance(error, ValueError) else DEFECT
        sentence = str(error) or type(error).__name__
        row, size, seconds = failed_row(simulation, status, sentence), 0, 0.0
    else:
        with _storing():
            write_simulation(task.curve, result, task.origin)
            size = task.curve.stat().st_size
        row, sentence, seconds = sweep_row(result), "", result.measures.seconds
    with _storing():
        journal.append(replace(begun, size=size, definition=row_fingerprint(), row=row))
    task.checkpoint.unlink(missing_ok=True)
    return Finished(row.status, seconds, sentence)


class _NotStoredError(Exception):
    """What was computed cannot be written; the sentence says why."""


@contextlib.contextmanager
def _storing() -> Iterator[None]:
    """Tell what prevents a file from being written from what prevents a simulation."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        raise _NotStoredError(f"nothing can be stored ({error}); make room and repeat") from error


@functools.cache
def _journal(folder: Path) -> Journal:
    """The journal of this process in a folder."""
    return Journal(folder)
