"""Simulations as tasks: run, checkpointed and stored with a line in the journal, longest first."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

from numba.core.errors import NumbaError

from crackfront.core.outcome import DefectError
from crackfront.data.bounds import TooLargeError
from crackfront.data.files import leftover_parts, write_text
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_checkpoint, write_checkpoint, write_simulation
from crackfront.simulate.run import PartialRun, SimulationResult, compile_solver, run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import parallel
from crackfront.sweep.journal import Entry, Journal, renew_journals
from crackfront.sweep.store import Store
from crackfront.sweep.table import failed_row, row_fingerprint, sweep_row

_STOPPED, _NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""

SECONDS_BETWEEN_BEATS = 20.0
"""Time after which a running simulation shows that it lives."""


@dataclass(frozen=True, slots=True)
class Finished:
    """How a simulation ended: status of its row, wall time, and what was wrong, if anything."""

    status: str
    seconds: float = 0.0
    sentence: str = ""


class NotStoredError(OSError):
    """The machine could not compute a simulation or store it."""


def fill(
    store: Store,
    simulations: Sequence[Simulation],
    origin: Provenance,
    checkpoint_seconds: float = 60.0,
) -> Generator[tuple[Simulation, Finished], None, None]:
    """Run simulations, the longest first, and store each as soon as it is finished.

    Yields each simulation with how it ended, in the order in which they end. Close the generator
    to leave it earlier: it waits for the ranks.

    Raises
    ------
    OSError
        If nothing can be written in the folder, before anything is run.
    NotStoredError
        If the machine could not compute a simulation or store it.
    KeyboardInterrupt
        If a stop was requested.
    """
    for name in ("curves", "journals", "checkpoints"):
        (store.folder / name).mkdir(parents=True, exist_ok=True)
        for part in leftover_parts(store.folder / name):
            part.unlink(missing_ok=True)
    renew_journals(store.journals)
    write_text(store.configuration, origin.configuration, sealed=True)
    longest_first = sorted(simulations, key=lambda one: -expected_cost(one).seconds)
    tasks = [_Task(one, store, origin, checkpoint_seconds) for one in longest_first]
    for solver, straight in {(one.solver.name, one.schedule.straight) for one in simulations}:
        compile_solver(solver, straight)
    with closing(parallel.run_tasks(_run_task, tasks)) as outcomes:
        for count, (task, finished) in enumerate(outcomes):
            stored = f"{count} of {len(tasks)} simulations"
            if finished.status == _STOPPED:
                raise KeyboardInterrupt(
                    f"{stored} are finished; they and the states of running ones are stored; the "
                    "same call continues"
                )
            if finished.status == _NOT_STORED:
                raise NotStoredError(
                    f"{task.simulation.label}: {finished.sentence}; {stored} were stored, and the "
                    "same call continues with the others"
                )
            yield task.simulation, finished


@dataclass(frozen=True, slots=True)
class _Task:
    """A simulation, where it is stored, and what its file says about its origin."""

    simulation: Simulation
    store: Store
    origin: Provenance
    checkpoint_seconds: float


class _Keeper:
    """Stores checkpoints of a task, and ends it with the last one when the process is to stop."""

    def __init__(self, task: _Task, journal: Journal) -> None:
        self._task, self._journal = task, journal
        self._path = task.store.checkpoint(task.simulation)
        self._written = self._beaten = time.monotonic()

    def result(self) -> tuple[SimulationResult, str]:
        """Result of the task, from its checkpoint on if there is one, and what is wrong with that.

        Where the checkpoint leads to an error, the task runs without it.
        """
        simulation, wrong = self._task.simulation, ""
        if self._path.is_file():
            try:
                resume = read_checkpoint(self._path, simulation)
                return run_simulation(simulation, resume=resume, keep=self._keep), ""
            except (*_OF_PHYSICS, LookupError, TypeError) as error:
                wrong = f"begun anew without its checkpoint: {error}"
        return run_simulation(simulation, keep=self._keep), wrong

    def _keep(self, make: Callable[[], PartialRun]) -> None:
        """Store a checkpoint when it is time for one; leave when the process is to stop."""
        now, stop = time.monotonic(), parallel.stop_is_requested()
        if stop or now - self._written >= self._task.checkpoint_seconds:
            write_checkpoint(self._path, make(), self._task.origin)
            self._written = time.monotonic()
        if stop:
            raise _StopRequestedError
        if now - self._beaten >= SECONDS_BETWEEN_BEATS:
            self._journal.beat()
            self._beaten = now


def _run_task(task: _Task) -> Finished:
    """Run and store one simulation; what the machine could not do leaves nothing in the store."""
    if parallel.stop_is_requested():
        return Finished(_STOPPED)
    journal = _journal(task.store.journals)
    try:
        return _run(task, journal)
    except _StopRequestedError:
        return Finished(_STOPPED)
    except (MemoryError, TooLargeError):
        return Finished(_NOT_STORED, sentence="the memory does not suffice; start fewer ranks")
    except (OSError, RuntimeError, SystemError, NumbaError) as error:
        sentence = f"the machine could not compute or store it ({error}); free disk, memory or "
        return Finished(_NOT_STORED, sentence=f"{sentence}threads and run the same command again")
    finally:
        journal.let_go()


_OF_PHYSICS = (ValueError, ArithmeticError, DefectError)
"""What ends a simulation in the same way on every machine."""


def _run(task: _Task, journal: Journal) -> Finished:
    """Run one simulation, with a line in the journal when it begins and one when it ends."""
    simulation = task.simulation
    begun = Entry(simulation.key, simulation.label, simulation.parts)
    journal.append(begun)
    try:
        result, wrong = _Keeper(task, journal).result()
    except TooLargeError:
        raise
    except _OF_PHYSICS as error:
        # The surface or the load cannot be simulated, or the solver found a defect in itself.
        status = "refused" if isinstance(error, ValueError) else "defect"
        sentence = str(error) or type(error).__name__
        row, size, digest, seconds = failed_row(simulation, status, sentence), 0, "", 0.0
    else:
        curve = task.store.path(simulation)
        digest = write_simulation(curve, result, task.origin)
        size = curve.stat().st_size
        row, sentence, seconds = sweep_row(result), wrong, result.measures.seconds
    journal.append(replace(begun, size=size, digest=digest, definition=row_fingerprint(), row=row))
    task.store.checkpoint(simulation).unlink(missing_ok=True)
    return Finished(row.status, seconds, sentence)


class _StopRequestedError(Exception):
    """A simulation was left as the process is to stop; its checkpoint is stored."""


_journal = functools.cache(Journal)
"""The journal of this process in a folder."""
