"""Errors of averaging: travel between states, load step, size of the tile, realisations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.steady import steady_adhesion
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.records import ADHESION, variable
from crackfront.simulate.laws import chosen_knobs
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.studies.accuracy.scenes import Scene

Array = NDArray[np.float64]

_RUN = "realisation"

_NUMERICAL_ERROR = 0.03
"""Error of k that the numerics leave here; it is the same surface by surface."""

_START, _DEEPEST, _TRAVEL = 0.3, 1.0, 1.5
_NO_STOP = 1e-9

_TRIED: dict[str, tuple[float, ...]] = {
    "travel": (0.25, 0.5, 1.0, 1.5, 2.0, 3.0),
    "step": (0.0125, 0.025, 0.05, 0.1, 0.2),
    "tile": (16, 32, 64, 128, 256),
}
"""What is varied, the finest value of travel and step first."""


@dataclass(frozen=True, slots=True)
class Sample:
    """Hysteresis of all realisations at one value of a schedule or of the tile.

    Attributes
    ----------
    knob : {"travel", "step", "tile"}
        Way between steady states in correlation lengths, load step of full cycles in reduced
        vertical lengths, side of the tile in short cutoffs.
    value : float
        Its value.
    hysteresis : (n_realisation,) array
        w_retr - w_appr. (Units: w_int)
    standard_error : (n_realisation,) array
        That which a run states for its hysteresis, from its own states. (Units: w_int)
    seconds : (n_realisation,) array
        Processor time. (Units: s)
    """

    knob: str = variable("what is varied: travel, step or tile", "1")
    value: float = variable("correlation lengths, reduced vertical length, cutoffs", "1")
    hysteresis: Array = variable("w_retr - w_appr", ADHESION, _RUN)
    standard_error: Array = variable("that which a run states", ADHESION, _RUN)
    seconds: Array = variable("processor time", "s", _RUN)


def sampling_errors(
    scene: Scene, realisations: range, progress: Callable[[str], None] | None = None
) -> tuple[Sample, ...]:
    """Hysteresis of a scene with other schedules and tiles.

    By path independence the states of a coarse schedule are among those of a fine one, so that
    travel and step change the mean alone; another tile is another surface.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    realisations : range
        Numbers of the surfaces.
    progress : callable, optional
        Called with a line for every value.
    """
    tell = progress or (lambda line: None)
    samples = []
    for knob, values in _TRIED.items():
        for value in values:
            rows = [_run(_simulation(scene, knob, value, number)) for number in realisations]
            sample = Sample(knob, value, *np.array(rows).T)
            samples.append(sample)
            tell(f"{knob} {value:g}: {sample.hysteresis.mean():.5g} w_int")
    return tuple(samples)


def _simulation(scene: Scene, knob: str, value: float, realisation: int) -> Simulation:
    """One simulation with another schedule or tile."""
    knobs = chosen_knobs(_NUMERICAL_ERROR, scene.kind, scene.spectrum, scene.elastic_energy)
    if knob == "tile":
        scene = replace(scene, tile_cutoffs=value)
    travel = value if knob == "travel" else _TRAVEL
    return replace(
        scene.simulation(knobs, realisation),
        schedule=LoadSchedule(_DEEPEST, value)
        if knob == "step"
        else SteadySchedule(_START, _DEEPEST, travel, _NO_STOP),
    )


def _run(simulation: Simulation) -> tuple[float, float, float]:
    """Hysteresis of a simulation, its stated standard error and processor time."""
    result = run_simulation(simulation)
    length = simulation.correlation_length
    steady = steady_adhesion(result.record, length)
    error = float(np.hypot(steady.w_appr_error, steady.w_retr_error))
    return steady.hysteresis, error, result.measures.cpu_seconds
