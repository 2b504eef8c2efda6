"""One simulation from its parameters to its result, and what it cost."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from crackfront.analysis.run_measures import RunMeasures
from crackfront.analysis.steady_adhesion import SteadyAdhesion
from crackfront.core.adhesion import chemical_adhesion
from crackfront.core.cycle.record import Checkpoint, CycleRecord, Recorder
from crackfront.core.resources import peak_memory
from crackfront.core.solver.relax import SOLVERS
from crackfront.core.solver.window import HALF_BAND
from crackfront.simulate.contact import Problem, Schedule
from crackfront.simulate.simulation import Simulation, simulation_adhesion, simulation_field
from crackfront.simulate.tiles import Resolution


@dataclass(frozen=True, slots=True)
class SimulationResult:
    """Record of one simulation, and measures of its tile and its costs."""

    simulation: Simulation
    record: CycleRecord
    measures: RunMeasures

    @property
    def mean_adhesion(self) -> float:
        """Mean work of adhesion of the tile (Units: w_int)."""
        return 1 - self.measures.e_el if self.simulation.kind == "roughness" else 1.0

    @property
    def steady_adhesion(self) -> SteadyAdhesion:
        """Apparent works of adhesion of both branches, as its kind of contact averages them."""
        schedule, length = self.simulation.schedule, self.simulation.correlation_length
        return schedule.steady_adhesion(self.record, length, self.mean_adhesion)


@dataclass(frozen=True, slots=True)
class PartialRun:
    """A simulation that has not ended yet, with its costs so far, as in `RunMeasures`."""

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

    With `resume`, an earlier run goes on, to the same record bit for bit. `keep` is called at every
    new state with a function that makes what a later run goes on from. ValueError if the realised
    surface does not allow full conformity, e_el >= w_int.
    """
    compile_solver(simulation.solver.name, type(simulation.schedule))
    clock = _Clock() if resume is None else _Clock(resume.seconds, resume.cpu_seconds)

    def observe(recorder: Recorder) -> None:
        if keep is not None:
            keep(
                lambda: PartialRun(
                    simulation, recorder.checkpoint(), clock.seconds, clock.cpu_seconds
                )
            )

    adhesion = simulation_adhesion(simulation)
    problem = Problem(
        simulation_field(simulation, adhesion),
        simulation.correlation_length,
        simulation.elastic_energy,
    )
    e_el, w_rms = adhesion.e_el, adhesion.w_rms
    negative_share = float(np.mean(adhesion.work_of_adhesion < 0))
    # Only the splines stay in memory during the run, not the tile.
    del adhesion
    recorder = Recorder(
        fronts=simulation.record_fronts,
        energy=simulation.record_energy,
        jumps=simulation.correlation_length if simulation.record_jumps else None,
        observers=[observe],
        resume=None if resume is None else resume.checkpoint,
    )
    record = simulation.schedule.run(problem, simulation.solver, recorder)
    measures = RunMeasures(
        e_el=e_el,
        w_rms=w_rms,
        negative_share=negative_share,
        seconds=clock.seconds,
        cpu_seconds=clock.cpu_seconds,
        peak_memory=peak_memory(),
    )
    return SimulationResult(simulation, record, measures)


class _Clock:
    """Wall time and processor time since its start, added to earlier ones (Units: s)."""

    def __init__(self, seconds: float = 0.0, cpu_seconds: float = 0.0) -> None:
        self._wall_start = time.perf_counter() - seconds
        self._cpu_start = time.process_time() - cpu_seconds

    @property
    def seconds(self) -> float:
        """Wall time."""
        return time.perf_counter() - self._wall_start

    @property
    def cpu_seconds(self) -> float:
        """Processor time."""
        return time.process_time() - self._cpu_start


@functools.cache
def compile_solver(name: str, kind: type[Schedule]) -> None:
    """Compile what a simulation of a kind calls, or load it, once a process, on a smooth tile.

    The front is longer than those that are left to the reference.
    """
    schedule = kind.smallest()
    smooth = chemical_adhesion(np.zeros((4, 4)), pixel=1.0)
    sizes = Resolution(4 * HALF_BAND, 0.1, "cubic", tile_side=4.0, n_point=4)
    problem = Problem(schedule.field(smooth, sizes), correlation_length=1.0, elastic_energy=0.0)
    solver, recorder = SOLVERS[name](1e-3), Recorder(energy=True)
    schedule.run(problem, solver, recorder)
