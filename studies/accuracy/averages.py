"""What steady runs are wrong by: averaging too little, and whether they state their true errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from crackfront.analysis.steady_adhesion import steady_adhesion
from crackfront.core.adhesion import mean_adhesion
from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, variable
from crackfront.simulate.contact import Schedule
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.numerical_errors import numerical_error, stated_error
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from studies.accuracy.scenes import HELD_OUT, Scene
from studies.accuracy.study import branches_seconds, measured_branches
from studies.progress import Progress, silent

_RUN, _BRANCH = "realisation", "branch"

_NUMERICAL_ERROR = 0.03
"""Error of k that the numerics leave where schedules vary; it is the same surface by surface."""

_START = 0.3
"""Penetration at which steady branches begin. (Units: reduced vertical length)"""

_DEEPEST = 1.0
"""Largest penetration. (Units: reduced vertical length)"""

_TRAVEL = 1.5
"""Travel while the step or the tile varies, in the unit of `SteadySchedule`."""

_NO_STOP = 1e-9
"""Standard error that no run reaches, so that all end at the largest penetration."""

_TRIED: dict[str, tuple[float, ...]] = {
    "travel": (0.25, 0.5, 1.0, 1.5, 2.0, 3.0),
    "step": (0.0125, 0.025, 0.05, 0.1, 0.2),
    "tile": (16, 32, 64, 128, 256),
}
"""What is varied, the finest value of travel and step first."""

LEVEL = 0.92
"""Share of the errors that an interval of the stated standard errors is meant to cover."""

_SCHEDULE = SteadySchedule(start=0.0, max_penetration=3.0, travel=1.5, standard_error=0.1)


@dataclass(frozen=True, slots=True)
class Sample:
    """Hysteresis of all realisations at one value of a schedule or of the tile.

    The value is the way between steady states in correlation lengths, the load step of full cycles
    in reduced vertical lengths, or the side of the tile in short cutoffs.
    """

    setting: str = variable("what is varied: travel, step or tile", "1")
    value: float = variable("correlation lengths, reduced vertical length, cutoffs", "1")
    hysteresis: Array = variable("w_retr - w_appr", ADHESION, _RUN)
    standard_error: Array = variable("that which a run states", ADHESION, _RUN)
    seconds: Array = variable("processor time", "s", _RUN)


@dataclass(frozen=True, slots=True)
class Coverage:
    """True and stated errors of w_appr and w_retr where the laws chose the numerics.

    The numerical error compares with the reference on the same surface at the same loads. The
    total error compares a steady run with the truth: the mean of the reference's runs on the
    other surfaces, which has a standard error itself.
    """

    requested: float = variable("standard error that was requested", "e_el")
    numerical: Array = variable("numerical error of w_appr and w_retr", ADHESION, _RUN, _BRANCH)
    numerical_stated: Array = variable("stated numerical standard error", ADHESION, _BRANCH)
    total: Array = variable("error of a steady run", ADHESION, _RUN, _BRANCH)
    run_numerical: Array = variable("numerical standard error it states", ADHESION, _RUN, _BRANCH)
    run_statistical: Array = variable(
        "statistical standard error it states", ADHESION, _RUN, _BRANCH
    )
    n_state: Array = variable("its steady states", "1", _RUN, _BRANCH)
    truth_error: Array = variable("standard error of the truth", ADHESION, _RUN, _BRANCH)

    @property
    def numerical_interval(self) -> Array:
        """Half width of the interval of the numerical error, as of a normal distribution."""
        width = stats.norm.ppf((1 + LEVEL) / 2) * self.numerical_stated
        return np.broadcast_to(width, self.numerical.shape)

    @property
    def total_interval(self) -> Array:
        """Half width of the interval of the total error, including the error of the truth."""
        share = (1 + LEVEL) / 2
        statistical = stats.t.ppf(share, np.maximum(self.n_state - 1, 1)) * self.run_statistical
        systematic = np.hypot(self.run_numerical, self.truth_error)
        return np.hypot(statistical, stats.norm.ppf(share) * systematic)


def sampling_errors(
    scene: Scene, surfaces: range, progress: Progress = silent
) -> tuple[Sample, ...]:
    """Hysteresis of a scene with other schedules and tiles.

    States are independent of the path, so that a fine schedule also visits all states of a coarse
    one: travel and step change the mean alone. Another tile is another surface.
    """
    samples = []
    for setting, values in _TRIED.items():
        for value in values:
            rows = [_sampled(scene, setting, value, number) for number in surfaces]
            samples.append(Sample(setting, value, *np.array(rows).T))
            progress(f"{setting} {value:g}: {samples[-1].hysteresis.mean():.5g} w_int")
    return tuple(samples)


def _sampled(scene: Scene, setting: str, value: float, number: int) -> tuple[float, float, float]:
    """Hysteresis, its stated error and processor time with another schedule or tile."""
    simulation = _other(scene, setting, value, number)
    result = run_simulation(simulation)
    steady = steady_adhesion(result.record, simulation.correlation_length)
    return steady.hysteresis, steady.hysteresis_error, result.measures.cpu_seconds


def _other(scene: Scene, setting: str, value: float, number: int) -> Simulation:
    """Simulation with another schedule or tile."""
    settings = scene.chosen_settings(_NUMERICAL_ERROR)
    if setting == "tile":
        scene = replace(scene, tile_cutoffs=value)
    schedule: Schedule
    if setting == "step":
        schedule = FullCycle(_DEEPEST, value)
    else:
        travel = value if setting == "travel" else _TRAVEL
        schedule = SteadySchedule(_START, _DEEPEST, travel, _NO_STOP)
    return replace(scene.simulation(settings, number), schedule=schedule)


def sampling_seconds(scene: Scene) -> float:
    """Processor time that a surface is expected to take in `sampling_errors` (Units: s)."""
    simulations = [
        _other(scene, setting, value, 0) for setting, values in _TRIED.items() for value in values
    ]
    return sum(expected_cost(simulation).seconds for simulation in simulations)


def coverage_seconds(scene: Scene, requested: tuple[float, ...]) -> float:
    """Processor time that a surface is expected to take in `held_out_coverage` (Units: s)."""
    tried = [scene.reference, *(scene.chosen_settings(error) for error in requested)]
    steady = [replace(scene.simulation(settings, 0), schedule=_SCHEDULE) for settings in tried]
    branches = sum(branches_seconds(scene, settings) for settings in tried)
    return branches + sum(expected_cost(simulation).seconds for simulation in steady)


def held_out_coverage(
    scene: Scene,
    requested: tuple[float, ...],
    n_realisation: int,
    progress: Progress = silent,
) -> tuple[Coverage, ...]:
    """True and stated errors on surfaces that no law was fitted to, for errors of k.

    Fewer than three surfaces are a ValueError: the others' scatter is part of the interval.
    """
    if n_realisation < 3:
        raise ValueError(f"coverage needs 3 surfaces or more, not {n_realisation}; ask for more")
    numbers = range(HELD_OUT, HELD_OUT + n_realisation)
    exact = [measured_branches(scene, scene.reference, number) for number in numbers]
    truth = np.array([_steady(scene.simulation(scene.reference, number))[0] for number in numbers])
    other_truths = [np.delete(truth, row, axis=0) for row in range(n_realisation)]
    expected = np.array([rows.mean(axis=0) for rows in other_truths])
    scatter = np.array([rows.std(axis=0, ddof=1) for rows in other_truths])
    circumference = 2 * np.pi * float(exact[0].radius.mean())
    cutoffs_crossed = scene.penetrations.size * circumference / scene.spectrum.short_cutoff
    coverages = []
    for error in requested:
        settings = scene.chosen_settings(error)
        simulations = [scene.simulation(settings, number) for number in numbers]
        branches = [measured_branches(scene, settings, number) for number in numbers]
        pairs = zip(branches, exact, strict=True)
        runs = np.array([_steady(simulation) for simulation in simulations])
        coverages.append(
            Coverage(
                requested=error,
                numerical=np.array(
                    [branch.adhesion - reference.adhesion for branch, reference in pairs]
                ),
                numerical_stated=np.array(numerical_error(simulations[0], cutoffs_crossed)),
                total=runs[:, 0] - expected,
                run_numerical=runs[:, 1],
                run_statistical=runs[:, 2],
                n_state=runs[:, 3],
                truth_error=scatter / np.sqrt(n_realisation - 1),
            )
        )
        progress(f"requested {error:g}: {n_realisation} surfaces")
    return tuple(coverages)


def _steady(simulation: Simulation) -> list[tuple[float, float]]:
    """Adhesion, its stated errors and the number of states, of both branches of a steady run."""
    simulation = replace(simulation, schedule=_SCHEDULE)
    length = simulation.correlation_length
    result = run_simulation(simulation)
    steady = steady_adhesion(result.record, length)
    # Tiles differ in the mean of w_loc and in e_el: k is made of what is relative to both.
    mean = mean_adhesion(simulation.kind, result.measures.e_el)
    scale = simulation.elastic_energy / result.measures.e_el
    return [
        (scale * (steady.w_appr - mean), scale * (steady.w_retr - mean)),
        stated_error(simulation, steady, length),
        (steady.w_appr_error, steady.w_retr_error),
        (float(steady.n_approach), float(steady.n_retraction)),
    ]
