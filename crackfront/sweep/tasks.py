"""Simulations as tasks: run and checkpointed on the ranks, the longest first, and stored here."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass

from numba.core.errors import NumbaError

from crackfront.core.outcome import DefectError
from crackfront.data.bounds import TooLargeError
from crackfront.data.files import dataset_content, leftover_parts, write_text
from crackfront.data.packs import Pack
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_checkpoint, simulation_dataset, write_checkpoint
from crackfront.simulate.run import PartialRun, SimulationResult, compile_solver, run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import parallel
from crackfront.sweep.journal import Entry, Note, forget_notes
from crackfront.sweep.store import SECONDS_BETWEEN_BEATS, Store
from crackfront.sweep.table import failed_row, row_fingerprint, sweep_row

_STOPPED, _NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""


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

    Yields each simulation with how it ended, in the order in which they end. Close the generator to
    leave it earlier: it waits for the ranks. OSError if nothing can be written in the folder,
    before anything is run; NotStoredError if the machine could not compute a simulation or store
    it; KeyboardInterrupt if a stop was requested.
    """
    for folder in (store.curves, store.checkpoints):
        folder.mkdir(parents=True, exist_ok=True)
        for part in leftover_parts(folder):
            part.unlink(missing_ok=True)
    forget_notes(store.checkpoints)
    write_text(store.configuration, origin.configuration, sealed=True)
    longest_first = sorted(simulations, key=lambda one: -expected_cost(one).seconds)
    begun = {path.stem for path in store.checkpoints.glob("*.nc")}
    tasks = [
        _Task(one, store, origin, checkpoint_seconds, bool(begun) and one.stem in begun)
        for one in longest_first
    ]
    for solver, kind in {(one.solver.name, type(one.schedule)) for one in simulations}:
        compile_solver(solver, kind)
    with (
        store.packs(simulations) as packs,
        closing(parallel.run_tasks(_run_task, tasks, functools.partial(_keep, packs))) as outcomes,
    ):
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
    forget_notes(store.checkpoints)


@dataclass(frozen=True, slots=True)
class _Task:
    """A simulation, where it is stored, and what its file says about its origin."""

    simulation: Simulation
    store: Store
    origin: Provenance
    checkpoint_seconds: float
    resumes: bool
    """Whether there is a checkpoint of it."""


@dataclass(frozen=True, slots=True)
class _Outcome:
    """What the process that ran a task hands to the one that stores it."""

    finished: Finished
    entry: Entry | None = None
    curve: bytes = b""
    has_checkpoint: bool = False


def _keep(packs: Mapping[str, Pack], task: _Task, outcome: _Outcome) -> Finished:
    """Store a simulation that has ended, and remove its checkpoint; how it ended."""
    if outcome.entry is not None:
        try:
            packs[task.simulation.spectrum_name].append(outcome.entry.files(outcome.curve))
            if outcome.has_checkpoint:
                task.store.checkpoint(task.simulation).unlink(missing_ok=True)
        except OSError as error:
            return _not_stored(error)
    return outcome.finished


def _not_stored(error: Exception) -> Finished:
    """That the machine could not compute a simulation or store it."""
    sentence = f"the machine could not compute or store it ({error}); free disk, memory or "
    return Finished(_NOT_STORED, sentence=f"{sentence}threads and run the same command again")


class _Keeper:
    """Stores checkpoints of a task, and ends it with the last one when the process is to stop."""

    def __init__(self, task: _Task, note: Note) -> None:
        self._task, self._note = task, note
        self._path = task.store.checkpoint(task.simulation)
        self.has_file = task.resumes
        self._written = self._beaten = time.monotonic()

    def result(self) -> tuple[SimulationResult, str]:
        """Result of the task, from its checkpoint on if that is of use, and why it was of none."""
        simulation, wrong = self._task.simulation, ""
        if self.has_file:
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
            self.has_file = True
            write_checkpoint(self._path, make(), self._task.origin)
            self._written = time.monotonic()
        if stop:
            raise _StopRequestedError
        if now - self._beaten >= SECONDS_BETWEEN_BEATS:
            self._note.beat()
            self._beaten = now


def _run_task(task: _Task) -> _Outcome:
    """Run one simulation; what the machine could not do has no entry."""
    if parallel.stop_is_requested():
        return _Outcome(Finished(_STOPPED))
    note = _note(task.store.checkpoints)
    try:
        note.begin(task.simulation)
        return _run(task, note)
    except _StopRequestedError:
        return _Outcome(Finished(_STOPPED))
    except (MemoryError, TooLargeError):
        sentence = "the memory does not suffice; start fewer ranks"
        return _Outcome(Finished(_NOT_STORED, sentence=sentence))
    except (OSError, RuntimeError, SystemError, NumbaError) as error:
        return _Outcome(_not_stored(error))
    finally:
        note.end()


_OF_PHYSICS = (ValueError, ArithmeticError, DefectError)
"""What ends a simulation in the same way on every machine."""


def _run(task: _Task, note: Note) -> _Outcome:
    """Run one simulation to its row and its curve."""
    simulation, keeper = task.simulation, _Keeper(task, note)
    origin = task.origin.here()
    try:
        result, wrong = keeper.result()
    except TooLargeError:
        raise
    except _OF_PHYSICS as error:
        # The surface or the load cannot be simulated, or the solver found a defect in itself.
        status = "refused" if isinstance(error, ValueError) else "defect"
        sentence = str(error) or type(error).__name__
        row, seconds = failed_row(simulation, status, sentence), 0.0
        curve, digest = b"", ""
    else:
        curve, digest = dataset_content(simulation_dataset(result), origin)
        row, sentence, seconds = sweep_row(result), wrong, result.measures.seconds
    named = simulation.stem, simulation.parts, row_fingerprint()
    entry = Entry(*named, row, digest, origin.arithmetic)
    return _Outcome(Finished(row.status, seconds, sentence), entry, curve, keeper.has_file)


class _StopRequestedError(Exception):
    """A simulation was left as the process is to stop; its checkpoint is stored."""


_note = functools.cache(Note)
"""The note of this process in a folder."""
