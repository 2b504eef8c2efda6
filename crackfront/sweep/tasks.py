"""Simulations as tasks: run and checkpointed on the ranks, the longest first, and stored here.

Ranks return rows and states, and write only checkpoints. The process that distributes the work
writes what is finished in batches.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from numba.core.errors import NumbaError

from crackfront.core.outcome import DefectError
from crackfront.core.resources import TooLargeError
from crackfront.simulate.checksums import BATCH, CHECKPOINT, forget_sums
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.cycle_files import read_checkpoint, write_checkpoint
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.run_simulation import (
    PartialRun,
    SimulationResult,
    compile_solver,
    run_simulation,
)
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.storage import set_aside, set_aside_if_damaged
from crackfront.sweep import parallel
from crackfront.sweep.checkpoints import CheckpointTimer
from crackfront.sweep.curves import FinishedSimulation, curves_dataset, write_curves
from crackfront.sweep.rows import DEFECT, INVALID, failed_row, sweep_row
from crackfront.sweep.store import Store
from crackfront.sweep.sweep import Shard

_STOPPED, _NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""

_WRITING_ERRORS = (OSError, RuntimeError)
"""What writing a file raises where the machine cannot; netCDF has errors of its own."""

_MOST_WAITING = 2000
"""Finished simulations that are written at once, however short the time since the last batch."""

_MOST_WAITING_BYTES = 2e8
"""Size of the fronts of finished simulations that are written at once: the fronts of a minute of
many ranks would fill the memory of the manager. (Units: byte)"""


@dataclass(frozen=True, slots=True)
class SimulationOutcome:
    """How a simulation ended: status of its row, wall time, and what was wrong, if anything."""

    status: str
    seconds: float = 0.0
    sentence: str = ""


class NotStoredError(OSError):
    """The machine could not compute a simulation or store it."""


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
        self._written = time.monotonic()
        if not self._finished:
            return
        self._count += 1
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


def run_and_store(
    store: Store,
    shards: Sequence[tuple[Shard, Sequence[Simulation]]],
    origin: Provenance,
    seconds: float = 60.0,
    ranks: parallel.Ranks = parallel.ALONE,
) -> Generator[tuple[Simulation, SimulationOutcome], None, None]:
    """Run simulations of shards, the longest first, and store them in batches.

    What is finished is written after so many seconds, and so are checkpoints of what runs. Yields
    each simulation with how it ended, in the order in which they end. Close the generator to leave
    it earlier: it waits for the ranks, and writes what is finished. OSError if nothing can be
    written in the folder, before anything is run; NotStoredError if the machine could not compute a
    simulation or store it; KeyboardInterrupt if a stop was requested.
    """
    writers, tasks = {}, []
    for shard, simulations in shards:
        folder = store.curve_folder(shard)
        folder.mkdir(parents=True, exist_ok=True)
        writers[folder] = BatchWriter(folder, origin, seconds)
        tasks += [_Task(simulation, folder, origin, seconds) for simulation in simulations]
    if tasks:
        forget_sums(store.folder)
    store.keep_configuration(origin.configuration)
    tasks.sort(key=lambda task: -expected_cost(task.simulation).seconds)
    for solver, kind in {(t.simulation.solver.name, type(t.simulation.schedule)) for t in tasks}:
        compile_solver(solver, kind)

    def write_in_time() -> None:
        try:
            for writer in writers.values():
                writer.flush_in_time()
        except _WRITING_ERRORS as error:
            raise NotStoredError(_not_stored_sentence(error)) from error

    def keep(task: _Task, result: _TaskResult) -> SimulationOutcome:
        try:
            if result.finished is not None:
                writers[task.folder].add(result.finished)
            write_in_time()
        except _WRITING_ERRORS as error:
            return SimulationOutcome(_NOT_STORED, sentence=_not_stored_sentence(error))
        return result.outcome

    runs, done = ranks.run(_run_task, tasks, keep, write_in_time), 0
    try:
        with closing(runs) as outcomes:
            for task, outcome in outcomes:
                if outcome.status == _NOT_STORED:
                    _flush_all(writers.values())
                    count = sum(writer.n_written for writer in writers.values())
                    raise NotStoredError(
                        f"{task.simulation.label}: {outcome.sentence}; {count} of {len(tasks)} "
                        "simulations were stored, and the same command continues with the others"
                    )
                if outcome.status != _STOPPED:
                    done += 1
                    yield task.simulation, outcome
        if done < len(tasks):  # a stop was requested, of this process or of a rank
            raise KeyboardInterrupt(
                f"{done} of {len(tasks)} simulations are finished; they and the states of running "
                "ones are stored; run the same command to continue"
            )
    finally:
        unwritten = _flush_all(writers.values())
        if unwritten and not isinstance(sys.exception(), NotStoredError):
            raise NotStoredError(unwritten)


def _flush_all(writers: Iterable[BatchWriter]) -> str:
    """Write what is finished of all shards; why some of it could not be written, or nothing."""
    sentence = ""
    for writer in writers:
        try:
            writer.flush()
        except _WRITING_ERRORS as error:
            sentence = _not_stored_sentence(error)
    return sentence


@dataclass(frozen=True, slots=True)
class _Task:
    """A simulation, the folder of its shard, and what its checkpoints say about their origin."""

    simulation: Simulation
    folder: Path
    origin: Provenance
    checkpoint_seconds: float


@dataclass(frozen=True, slots=True)
class _TaskResult:
    """What the process that ran a task hands to the one that stores it."""

    outcome: SimulationOutcome
    finished: FinishedSimulation | None = None
    """What is to be stored; None where the simulation has not ended."""


def _not_stored_sentence(error: Exception) -> str:
    """Why a simulation could not be computed or stored, and what to do."""
    if isinstance(error, NotStoredError):  # by another simulation, whose sentence it has
        return str(error)
    return (
        f"the machine could not compute or store it ({error}); free disk, memory or threads and "
        "run the same command again"
    )


def _result(task: _Task, idle: Callable[[], None]) -> tuple[SimulationResult, str]:
    """Result of a task, and why it did not go on from its checkpoint; empty if nothing was wrong.

    `idle` is called at every new state, as of :meth:`crackfront.sweep.parallel.Ranks.run`.
    """
    simulation, wrong = task.simulation, ""
    timer = CheckpointTimer(task.folder, task.checkpoint_seconds)

    def keep(make: Callable[[], PartialRun]) -> None:
        idle()
        if timer.keep(lambda folder: _write_checkpoint(folder, make(), task.origin)):
            raise _StopRequestedError

    for path in reversed(checkpoint_files(task.folder, simulation)):
        if sentence := set_aside_if_damaged(path):
            wrong = sentence
            continue
        try:
            resume = read_checkpoint(path, simulation)
            return run_simulation(simulation, resume=resume, keep=keep), ""
        except TooLargeError:  # the checkpoint serves where there is more memory
            raise
        except (*_REPRODUCIBLE_ERRORS, LookupError, TypeError) as error:
            wrong = str(error) or type(error).__name__
            if path.exists():  # unless a later one has replaced it before the error
                set_aside(path)
    result = run_simulation(simulation, keep=keep)
    return result, f"begun anew without its checkpoint: {wrong}" if wrong else ""


def _write_checkpoint(folder: Path, partial: PartialRun, origin: Provenance) -> None:
    """Write a checkpoint and remove earlier ones of its simulation."""
    simulation = partial.simulation
    earlier = checkpoint_files(folder, simulation)
    latest = write_checkpoint(folder, f"{CHECKPOINT}-{simulation.stem}", partial, origin)
    for path in earlier:
        if path != latest:
            path.unlink(missing_ok=True)


def _run_task(task: _Task, idle: Callable[[], None]) -> _TaskResult:
    """Run one simulation; failures of the machine (memory, disk) are not stored as results."""
    if parallel.stop_is_requested():
        return _TaskResult(SimulationOutcome(_STOPPED))
    try:
        return _run(task, idle)
    except _StopRequestedError:
        return _TaskResult(SimulationOutcome(_STOPPED))
    except (MemoryError, TooLargeError):
        sentence = "the memory does not suffice; start fewer ranks"
    except (OSError, RuntimeError, SystemError, NumbaError) as error:
        sentence = _not_stored_sentence(error)
    return _TaskResult(SimulationOutcome(_NOT_STORED, sentence=sentence))


_REPRODUCIBLE_ERRORS = (ValueError, ArithmeticError, DefectError)
"""Errors that end a simulation in the same way on every machine."""


def _run(task: _Task, idle: Callable[[], None]) -> _TaskResult:
    """Run one simulation to its row and its states."""
    simulation, arithmetic = task.simulation, task.origin.here().arithmetic
    try:
        result, wrong = _result(task, idle)
    except TooLargeError:
        raise
    except _REPRODUCIBLE_ERRORS as error:
        # The surface or the load cannot be simulated, or the solver found a defect in itself.
        status = INVALID if isinstance(error, ValueError) else DEFECT
        sentence = str(error) or type(error).__name__
        row = failed_row(simulation, status, sentence)
        finished = FinishedSimulation(simulation, row, None, arithmetic)
        return _TaskResult(SimulationOutcome(status, 0.0, sentence), finished)
    row = sweep_row(result)
    finished = FinishedSimulation(simulation, row, result.record, arithmetic)
    return _TaskResult(SimulationOutcome(row.status, result.measures.seconds, wrong), finished)


class _StopRequestedError(Exception):
    """A simulation was left as the process is to stop; its checkpoint is stored."""
