"""Simulations as tasks: run and checkpointed on the ranks, the longest first, and stored here.

Ranks return rows and states, and write only checkpoints. The process that distributes the work
writes what is finished in batches.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from numba.core.errors import NumbaError

from crackfront.core.outcome import DefectError
from crackfront.core.resources import TooLargeError
from crackfront.simulate.checksums import CHECKPOINT, forget_sums
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
from crackfront.sweep.batches import BatchWriter, checkpoint_files
from crackfront.sweep.checkpoints import CheckpointTimer
from crackfront.sweep.curves import FinishedSimulation
from crackfront.sweep.rows import DEFECT, INVALID, failed_row, sweep_row
from crackfront.sweep.store import Store
from crackfront.sweep.sweep import Shard

_STOPPED, _NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""

_WRITING_ERRORS = (OSError, RuntimeError)
"""What writing a file raises where the machine cannot; netCDF has errors of its own."""


@dataclass(frozen=True, slots=True)
class SimulationOutcome:
    """How a simulation ended: status of its row, wall time, and what was wrong, if anything."""

    status: str
    seconds: float = 0.0
    sentence: str = ""


class NotStoredError(OSError):
    """The machine could not compute a simulation or store it."""


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
    writers = _Writers(origin, seconds)
    tasks = []
    for shard, simulations in shards:
        folder = store.curve_folder(shard)
        writers.add_folder(folder)
        tasks += [_Task(simulation, folder, origin, seconds) for simulation in simulations]
    if tasks:
        forget_sums(store.folder)
    store.keep_configuration(origin.configuration)
    tasks.sort(key=lambda task: -expected_cost(task.simulation).seconds)
    for solver, kind in {(t.simulation.solver.name, type(t.simulation.schedule)) for t in tasks}:
        compile_solver(solver, kind)
    runs, done = ranks.run(_run_task, tasks, writers.keep, writers.write_in_time), 0
    try:
        with closing(runs) as outcomes:
            for task, outcome in outcomes:
                if outcome.status == _NOT_STORED:
                    writers.flush()
                    raise NotStoredError(
                        f"{task.simulation.label}: {outcome.sentence}; {writers.n_written} of "
                        f"{len(tasks)} simulations were stored, and the same command continues "
                        "with the others"
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
        unwritten = writers.flush()
        if unwritten and not isinstance(sys.exception(), NotStoredError):
            raise NotStoredError(unwritten)


class _Writers:
    """Writers of the finished simulations of several shards, in the process that stores them."""

    def __init__(self, origin: Provenance, seconds: float) -> None:
        self._origin, self._seconds = origin, seconds
        self._by_folder: dict[Path, BatchWriter] = {}

    def add_folder(self, folder: Path) -> None:
        """Make the folder of a shard and its writer."""
        folder.mkdir(parents=True, exist_ok=True)
        self._by_folder[folder] = BatchWriter(folder, self._origin, self._seconds)

    @property
    def n_written(self) -> int:
        """Number of simulations that were written."""
        return sum(writer.n_written for writer in self._by_folder.values())

    def keep(self, task: _Task, result: _TaskResult) -> SimulationOutcome:
        """Take the result of a task, and write what is finished if it is time for that."""
        try:
            if result.finished is not None:
                self._by_folder[task.folder].add(result.finished)
            self.write_in_time()
        except _WRITING_ERRORS as error:
            return SimulationOutcome(_NOT_STORED, sentence=_not_stored_sentence(error))
        return result.outcome

    def write_in_time(self) -> None:
        """Write what is finished if the last batch was long enough ago, or `NotStoredError`."""
        try:
            for writer in self._by_folder.values():
                writer.flush_in_time()
        except _WRITING_ERRORS as error:
            raise NotStoredError(_not_stored_sentence(error)) from error

    def flush(self) -> str:
        """Write what is finished; why some of it could not be written, or nothing."""
        sentence = ""
        for writer in self._by_folder.values():
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
