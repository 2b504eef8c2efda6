"""Errors of k from steady branches, and how far a front has to go before w is another one.

The error of k that was asked for is held against the scatter of k between surfaces, and against
what a run states. The autocorrelation of w along a branch, in mean radius, pooled over surfaces and
summed up to where it first falls below a twentieth, gives the distance of independent states;
beside it stand the correlation length of w_loc and the rms deviation of the fronts from their mean
radius, of which :func:`crackfront.simulate.steady.standard_error` makes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from crackfront.analysis.steady import steady_adhesion
from crackfront.core.adhesion import correlation_length
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.outcome import Direction
from crackfront.simulate.run import SimulationResult, run_simulation
from crackfront.simulate.steady import SteadySchedule
from studies.accuracy.scenes import SCENES, Scene
from studies.accuracy.study import BRANCHES, rms
from studies.pages import markdown_table

_SURFACES = range(2000, 2010)
"""Numbers of surfaces: no law was fitted to them, no coverage measured."""

_DENSE = SteadySchedule(start=0.3, max_penetration=2.0, travel=0.5, standard_error=1e-4)
_FORGOTTEN = 0.05

_ASKED = SteadySchedule(start=0.3, max_penetration=2.0, travel=1.5, standard_error=0.1)

NAMES = [name for name in SCENES if name.startswith(("chemical", "flat", "h08", "h03"))]


def steady_runs(
    scene: Scene, schedule: SteadySchedule, surfaces: Sequence[int] = _SURFACES
) -> Iterator[SimulationResult]:
    """Steady branches on surfaces of a scene."""
    knobs = scene.chosen_knobs(0.03)
    for number in surfaces:
        yield run_simulation(replace(scene.simulation(knobs, number), schedule=schedule))


def independent_distance(
    found: Sequence[CycleRecord], direction: Direction, length: float
) -> tuple[float, float]:
    """Integral of the autocorrelation over positive and negative lags, and the fronts' rms."""
    radii, values, roughness = [], [], []
    for record in found:
        steady = (record.states.direction == direction) & (record.states.least_travel >= length)
        order = np.argsort(record.states.mean_radius[steady])
        radii.append(record.states.mean_radius[steady][order])
        values.append(record.states.apparent_work_of_adhesion[steady][order])
        roughness.append(np.mean(record.states.rms_radius[steady]))
    spacing = length / 2
    grid = np.arange(max(r[0] for r in radii), min(r[-1] for r in radii), spacing)
    rows = np.array([np.interp(grid, *pair) for pair in zip(radii, values, strict=True)])
    # About each surface's own mean: tiles differ in theirs, which k leaves out.
    rows -= rows.mean(axis=1, keepdims=True)
    lags = range(grid.size // 2)
    correlation = [np.mean(rows[:, : grid.size - lag] * rows[:, lag:]) for lag in lags]
    relative = np.array(correlation) / correlation[0]
    end = int(np.argmax(relative < _FORGOTTEN)) or relative.size
    return spacing * float(1 + 2 * relative[1:end].sum()), float(np.mean(roughness))


def errors_of_k(runs: Iterator[SimulationResult]) -> tuple[float, float, float, float]:
    """States of an approach, the scatter of k, its stated error, that of the branches apart."""
    rows = []
    for run in runs:
        found = steady_adhesion(run.record, run.simulation.correlation_length)
        apart = np.hypot(found.w_appr_error, found.w_retr_error)
        values = np.array([found.hysteresis, found.hysteresis_error, apart])
        rows.append((found.n_approach, *values / (2 * run.measures.e_el)))
    count, factor, stated, apart = np.transpose(rows)
    return float(np.mean(count)), float(np.std(factor, ddof=1)), rms(stated), rms(apart)


def independence_tables() -> str:
    """Errors of k, and distances of independent states, of all scenes."""
    errors, distances = [], []
    for name in NAMES:
        scene = SCENES[name]
        n_state, *found = errors_of_k(steady_runs(scene, _ASKED))
        errors.append((name, f"{n_state:.1f}", *(f"{x:.3f}" for x in found)))
        length = correlation_length(scene.kind, scene.spectrum)
        records = [run.record for run in steady_runs(scene, _DENSE)]
        for direction, branch in BRANCHES:
            distance, roughness = independent_distance(records, direction, length)
            ratios = f"{distance / length:.2f}", f"{roughness / length:.2f}"
            distances.append((name, branch, *ratios, f"{distance / roughness:.1f}"))
    of_k = markdown_table(
        f"scene, k to {_ASKED.standard_error:g} | states of the approach | scatter of k between "
        "surfaces | stated error | that of the branches apart",
        errors,
    )
    of_states = markdown_table(
        "scene | branch | independent / correlation length | rms of the front / correlation length "
        "| independent / rms",
        distances,
    )
    return f"{of_k}\n\n{of_states}"
