"""One simulation from its parameters to its result, and what it cost."""

from __future__ import annotations

import functools
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.cycle.record import Checkpoint, CycleRecord
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import run_steady
from crackfront.simulate.contact import contact_field, simulation_adhesion, simulation_field
from crackfront.simulate.simulation import Simulation, correlation_length


@dataclass(frozen=True, slots=True)
class SimulationResult:
    """What one simulation found and what it cost.

    Attributes
    ----------
    simulation : Simulation
        What was simulated.
    record : CycleRecord
        The states of the cycle, with the status that ended it.
    elastic_energy : float
        e_el measured on the tile. (Units: w_int)
    work_of_adhesion_rms : float
        w_rms measured on the tile. (Units: w_int)
    seconds : float
        Wall time of synthesis and cycle.
    cpu_seconds : float
        Processor time of the same.
    peak_memory : float
        Largest memory of the process since it started, earlier simulations included.
        (Units: bytes)
    """

    simulation: Simulation
    record: CycleRecord
    elastic_energy: float
    work_of_adhesion_rms: float
    seconds: float
    cpu_seconds: float
    peak_memory: float


@dataclass(frozen=True, slots=True)
class PartialRun:
    """A simulation that has not ended yet.

    Attributes
    ----------
    simulation : Simulation
        What is simulated.
    checkpoint : Checkpoint
        What it takes to go on from the last state.
    seconds, cpu_seconds : float
        Cost so far, as in :class:`SimulationResult`.
    """

    simulation: Simulation
    checkpoint: Checkpoint
    seconds: float
    cpu_seconds: float


def run_simulation(
    simulation: Simulation,
    *,
    resume: PartialRun | None = None,
    keep: Callable[[Callable[[], PartialRun]], None] | None = None,
) -> SimulationResult:
    """Synthesise the surface of a simulation and run its cycle.

    Parameters
    ----------
    simulation : Simulation
        What to simulate.
    resume : PartialRun, optional
        An earlier run of it to go on from, to the same record bit for bit.
    keep : callable, optional
        Called at every new state with a function that makes what a later run goes on from.

    Raises
    ------
    ValueError
        If the realised surface does not allow full conformity, e_el >= w_int.
    """
    compile_solver(simulation.solver)
    before = (0.0, 0.0) if resume is None else (resume.seconds, resume.cpu_seconds)
    wall, cpu = time.perf_counter() - before[0], time.process_time() - before[1]

    def partial_run(checkpoint: Callable[[], Checkpoint]) -> PartialRun:
        seconds, cpu_seconds = time.perf_counter() - wall, time.process_time() - cpu
        return PartialRun(simulation, checkpoint(), seconds, cpu_seconds)

    adhesion = simulation_adhesion(simulation)
    field = simulation_field(simulation, adhesion)
    elastic_energy, rms = adhesion.elastic_energy, adhesion.rms
    # The run holds the splines alone, not the tile as well.
    del adhesion
    if isinstance(simulation.schedule, LoadSchedule):
        run = functools.partial(run_cycle, schedule=simulation.schedule)
    else:
        run = functools.partial(
            run_steady,
            schedule=simulation.schedule,
            correlation_length=correlation_length(simulation.kind, simulation.spectrum),
            elastic_energy=simulation.elastic_energy,
        )
    record = run(
        field,
        tolerance=simulation.tolerance,
        max_sweeps=simulation.max_sweeps,
        solver=simulation.solver,
        record_fronts=simulation.record_fronts,
        record_energy=simulation.record_energy,
        resume=None if resume is None else resume.checkpoint,
        keep=None if keep is None else lambda make: keep(functools.partial(partial_run, make)),
    )
    return SimulationResult(
        simulation=simulation,
        record=record,
        elastic_energy=elastic_energy,
        work_of_adhesion_rms=rms,
        seconds=time.perf_counter() - wall,
        cpu_seconds=time.process_time() - cpu,
        peak_memory=_peak_memory(),
    )


@functools.cache
def compile_solver(solver: str) -> None:
    """Compile what a simulation calls, or load it, once a process, on a tiny smooth contact."""
    smooth = chemical_adhesion(np.zeros((4, 4)), pixel=1.0)
    field = contact_field(smooth, n_angle=8, spacing=0.1, max_penetration=0.0)
    run_cycle(field, LoadSchedule(0.0, 0.5), tolerance=1e-3, solver=solver, record_energy=True)


def _peak_memory() -> float:
    """High-water mark of this process in bytes; Linux counts in KiB, macOS in bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak * (1 if sys.platform == "darwin" else 1024))
