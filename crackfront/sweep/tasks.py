"""Simulations as tasks: run, checkpointed, stored and told to the journal, the longest first."""

from __future__ import annotations

import contextlib
import functools
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from crackfront.core.cycle.period import LineSchedule
from crackfront.data.files import leftover_parts, write_text
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_checkpoint, write_checkpoint, write_simulation
from crackfront.simulate.run import (
    PartialRun,
    SimulationResult,
    compile_solver,
    run_simulation,
)
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import parallel
from crackfront.sweep.journal import Entry, Journal
from crackfront.sweep.store import Store
from crackfront.sweep.table import failed_row, row_fingerprint, sweep_row

STOPPED, NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""

SECONDS_BETWEEN_BEATS = 20.0
"""Time after which a running simulation shows that it lives."""


@dataclass(frozen=True, slots=True)
class Finished:
    """How a task ended: the status of its row, or that without one; time; and what was wrong."""

    status: str
    seconds: float = 0.0
    sentence: str = ""


def fill(
    store: Store,
    simulations: Sequence[Simulation],
    origin: Provenance,
    checkpoint_seconds: float = 60.0,
) -> Generator[tuple[Simulation, Finished], None, None]:
    """Run simulations, the longest first, and store each as soon as it is finished.

    Each is told with how it ended, in the order in which they end. The first that is stopped or
    cannot be stored is the last. Whoever leaves before the end must close it: the ranks are
    waited for.

    Raises
    ------
    OSError
        If nothing can be written in the folder, before anything is run.
    """
    for name in ("curves", "journals", "checkpoints"):
        (store.folder / name).mkdir(parents=True, exist_ok=True)
        for part in leftover_parts(store.folder / name):
            part.unlink(missing_ok=True)
    write_text(store.configuration, origin.configuration, sealed=True)
    longest_first = sorted(simulations, key=lambda one: -expected_cost(one).seconds)
    tasks = [_Task(one, store, origin, checkpoint_seconds) for one in longest_first]
    kinds = {(item.solver.name, isinstance(item.schedule, LineSchedule)) for item in simulations}
    for solver, line in kinds:
        compile_solver(solver, line)
    for task, finished in parallel.run_tasks(_run_task, tasks):
        yield task.simulation, finished
        if finished.status in (STOPPED, NOT_STORED):
            return


@dataclass(frozen=True, slots=True)
class _Task:
    """A simulation, where it is stored, and what its file says about its origin."""

    simulation: Simulation
    store: Store
    origin: Provenance
    checkpoint_seconds: float

    @property
    def checkpoint(self) -> Path:
        """File from which a later run goes on."""
        return self.store.checkpoint(self.simulation)


class _Keeper:
    """What stores the checkpoints of a task, and ends it where notice was given."""

    def __init__(self, task: _Task, journal: Journal) -> None:
        self._task, self._journal = task, journal
        self._written = self._beaten = time.monotonic()

    def result(self) -> tuple[SimulationResult, str]:
        """Result of the task, from its checkpoint on if that is of use, and what is wrong with it.

        A refusal is never that of a checkpoint: what it leads to is tried without it.
        """
        path, simulation = self._task.checkpoint, self._task.simulation
        wrong = ""
        if path.is_file():
            try:
                resume = read_checkpoint(path, simulation)
                return run_simulation(simulation, resume=resume, keep=self.keep), ""
            except (ValueError, ArithmeticError, RuntimeError, LookupError, TypeError) as error:
                wrong = f"begun anew without its checkpoint: {error}"
        return run_simulation(simulation, keep=self.keep), wrong

    def keep(self, make: Callable[[], PartialRun]) -> None:
        """Store a checkpoint where it is time to; end where notice was given."""
        now, stop = time.monotonic(), parallel.notice_is_given()
        if stop or now - self._written >= self._task.checkpoint_seconds:
            with _storing():
                write_checkpoint(self._task.checkpoint, make(), self._task.origin)
            self._written = time.monotonic()
        if stop:
            raise _NoticeGivenError
        if now - self._beaten >= SECONDS_BETWEEN_BEATS:
            with _storing():
                self._journal.beat()
            self._beaten = now


def _run_task(task: _Task) -> Finished:
    """Run one simulation and store its result; one that cannot be done becomes a row as well."""
    if parallel.notice_is_given():
        return Finished(STOPPED)
    journal = _journal(task.store.journals)
    try:
        return _run(task, journal)
    except _NoticeGivenError:
        return Finished(STOPPED)
    except MemoryError:
        return Finished(NOT_STORED, sentence="the memory does not suffice; start fewer ranks")
    except _NotStoredError as error:
        return Finished(NOT_STORED, sentence=str(error))
    finally:
        journal.let_go()


def _run(task: _Task, journal: Journal) -> Finished:
    """Run one simulation; the journal tells that it began and how it ended."""
    simulation, keeper = task.simulation, _Keeper(task, journal)
    begun = Entry(simulation.key, simulation.label, simulation.parts)
    with _storing():
        journal.append(begun)
    try:
        result, wrong = keeper.result()
    except (ValueError, ArithmeticError, RuntimeError) as error:
        # The surface or the load cannot be simulated, or the solver found a defect in itself.
        status = "refused" if isinstance(error, ValueError) else "defect"
        sentence = str(error) or type(error).__name__
        row, size, digest, seconds = failed_row(simulation, status, sentence), 0, "", 0.0
    else:
        curve = task.store.path(simulation)
        with _storing():
            digest = write_simulation(curve, result, task.origin)
            size = curve.stat().st_size
        row, sentence, seconds = sweep_row(result), wrong, result.measures.seconds
    ended = replace(begun, size=size, digest=digest, definition=row_fingerprint(), row=row)
    with _storing():
        journal.append(ended)
    task.checkpoint.unlink(missing_ok=True)
    return Finished(row.status, seconds, sentence)


class _NoticeGivenError(Exception):
    """A simulation was left because of the notice; what was reached is stored."""


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
