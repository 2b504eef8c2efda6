"""Simulations as tasks: run and checkpointed on the ranks, the longest first, and stored here."""

from __future__ import annotations

import functools
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path

from numba.core.errors import NumbaError

from crackfront.core.outcome import DefectError
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.data.bounds import TooLargeError
from crackfront.data.digests import forget_sums
from crackfront.data.files import dataset_content, leftover_parts, write_text
from crackfront.data.packs import Pack
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_checkpoint, simulation_dataset, write_checkpoint
from crackfront.simulate.run import PartialRun, SimulationResult, compile_solver, run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import parallel
from crackfront.sweep.checkpoints import CheckpointFile
from crackfront.sweep.result_packs import Entry
from crackfront.sweep.rows import failed_row, sweep_row
from crackfront.sweep.store import Store

_STOPPED, _NOT_STORED = "stopped", "not_stored"
"""Statuses of tasks after which a run ends; they have no row."""


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
    simulations: Sequence[Simulation],
    origin: Provenance,
    checkpoint_seconds: float = 60.0,
) -> Generator[tuple[Simulation, SimulationOutcome], None, None]:
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
    forget_sums(store.folder)
    write_text(store.configuration, origin.configuration)
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
        for count, (task, outcome) in enumerate(outcomes):
            stored = f"{count} of {len(tasks)} simulations"
            if outcome.status == _STOPPED:
                raise KeyboardInterrupt(
                    f"{stored} are finished; they and the states of running ones are stored; the "
                    "same call continues"
                )
            if outcome.status == _NOT_STORED:
                raise NotStoredError(
                    f"{task.simulation.label}: {outcome.sentence}; {stored} were stored, and the "
                    "same call continues with the others"
                )
            yield task.simulation, outcome


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
class _TaskResult:
    """What the process that ran a task hands to the one that stores it."""

    outcome: SimulationOutcome
    files: Mapping[str, bytes] = field(default_factory=dict)
    """What is to be stored, by the names in a pack; nothing where it has not ended."""
    checkpoint: Path | None = None
    """File of a checkpoint that is to be removed once they are stored; None where there is none."""


def _keep(packs: Mapping[str, Pack], task: _Task, result: _TaskResult) -> SimulationOutcome:
    """Store a simulation that has ended and remove its checkpoint; return how it ended."""
    if result.files:
        try:
            packs[task.simulation.spectrum_name].append(result.files)
            if result.checkpoint is not None:
                result.checkpoint.unlink(missing_ok=True)
        except OSError as error:
            return _not_stored(error)
    return result.outcome


def _not_stored(error: Exception) -> SimulationOutcome:
    """Outcome of a simulation that the machine could not compute or store."""
    sentence = f"the machine could not compute or store it ({error}); free disk, memory or "
    return SimulationOutcome(
        _NOT_STORED, sentence=f"{sentence}threads and run the same command again"
    )


def _result(task: _Task) -> tuple[SimulationResult, str]:
    """Result of a task, and why its checkpoint could not be used; empty where it was or is none."""
    simulation = task.simulation
    file = CheckpointFile(task.store.checkpoint(simulation), task.checkpoint_seconds)

    def keep(make: Callable[[], PartialRun]) -> None:
        if file.keep(lambda path: write_checkpoint(path, make(), task.origin)):
            raise _StopRequestedError

    wrong = ""
    if task.resumes:
        try:
            resume = read_checkpoint(file.path, simulation)
            return run_simulation(simulation, resume=resume, keep=keep), ""
        except (*_REPRODUCIBLE_ERRORS, LookupError, TypeError) as error:
            wrong = f"begun anew without its checkpoint: {error}"
    return run_simulation(simulation, keep=keep), wrong


def _run_task(task: _Task) -> _TaskResult:
    """Run one simulation; failures of the machine (memory, disk) are not stored as results."""
    if parallel.stop_is_requested():
        return _TaskResult(SimulationOutcome(_STOPPED))
    try:
        return _run(task)
    except _StopRequestedError:
        return _TaskResult(SimulationOutcome(_STOPPED))
    except (MemoryError, TooLargeError):
        sentence = "the memory does not suffice; start fewer ranks"
        return _TaskResult(SimulationOutcome(_NOT_STORED, sentence=sentence))
    except (OSError, RuntimeError, SystemError, NumbaError) as error:
        return _TaskResult(_not_stored(error))


_REPRODUCIBLE_ERRORS = (ValueError, ArithmeticError, DefectError)
"""Errors that end a simulation in the same way on every machine."""


def _run(task: _Task) -> _TaskResult:
    """Run one simulation to its row and its curve."""
    simulation = task.simulation
    origin = task.origin.here()
    try:
        result, wrong = _result(task)
    except TooLargeError:
        raise
    except _REPRODUCIBLE_ERRORS as error:
        # The surface or the load cannot be simulated, or the solver found a defect in itself.
        status = "refused" if isinstance(error, ValueError) else "defect"
        sentence = str(error) or type(error).__name__
        row, seconds = failed_row(simulation, status, sentence), 0.0
        curve = b""
    else:
        curve = dataset_content(simulation_dataset(result), origin)
        row, sentence, seconds = sweep_row(result), wrong, result.measures.seconds
    entry = Entry(
        simulation.stem,
        simulation.parameters,
        PHYSICS_VERSION,
        ROWS_VERSION,
        row,
        origin.arithmetic,
    )
    files = entry.files(curve)
    left = task.store.checkpoint(simulation)
    checkpoint = left if left.exists() else None
    return _TaskResult(SimulationOutcome(row.status, seconds, sentence), files, checkpoint)


class _StopRequestedError(Exception):
    """A simulation was left as the process is to stop; its checkpoint is stored."""
