"""Errors of k from steady branches, and how far a front has to go before w is another one.

python -m studies.accuracy.independence

The error of k that was asked for is held against the scatter of k between surfaces, and against
what a run states. The autocorrelation of w along a branch, in mean radius, pooled over surfaces and
summed up to where it first falls below a twentieth, gives the distance of independent states;
beside it stand the correlation length of w_loc and the rms deviation of the fronts from their mean
radius, of which :func:`crackfront.core.cycle.steady.standard_error` makes it.
"""

from __future__ import annotations

from dataclasses import replace

import click
import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.steady import steady_adhesion
from crackfront.core.adhesion import correlation_length
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.outcome import Direction
from crackfront.simulate.run import run_simulation
from studies.accuracy.scenes import SCENES, Scene

Array = NDArray[np.float64]

N_REALISATION = 10
_FIRST = 2000
"""Number of the first surface: no law was fitted to it, no coverage measured."""

_SCHEDULE = SteadySchedule(start=0.3, max_penetration=2.0, travel=0.5, standard_error=1e-4)
_FORGOTTEN = 0.05

_ASKED = SteadySchedule(start=0.3, max_penetration=2.0, travel=1.5, standard_error=0.1)

NAMES = [name for name in SCENES if name.startswith(("chemical", "flat", "h08", "h03"))]


def records(scene: Scene) -> list[CycleRecord]:
    """Steady branches on all surfaces, states half a correlation length apart."""
    knobs = scene.chosen_knobs(0.03)
    simulations = (
        replace(scene.simulation(knobs, number), schedule=_SCHEDULE)
        for number in range(_FIRST, _FIRST + N_REALISATION)
    )
    return [run_simulation(simulation).record for simulation in simulations]


def independent_distance(
    found: list[CycleRecord], direction: Direction, length: float
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


def errors_of_k(scene: Scene) -> tuple[float, float, float, float]:
    """States of an approach, the scatter of k, its stated error, that of the branches apart."""
    rows = []
    for number in range(_FIRST, _FIRST + N_REALISATION):
        simulation = replace(scene.simulation(scene.chosen_knobs(0.03), number), schedule=_ASKED)
        result = run_simulation(simulation)
        found = steady_adhesion(result.record, simulation.correlation_length)
        apart = np.hypot(found.w_appr_error, found.w_retr_error)
        values = np.array([found.hysteresis, found.hysteresis_error, apart])
        rows.append((found.n_approach, *values / (2 * result.measures.e_el)))
    count, factor, stated, apart = np.transpose(rows)
    scatter = float(np.std(factor, ddof=1))
    return float(np.mean(count)), scatter, _root_mean_square(stated), _root_mean_square(apart)


def _root_mean_square(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def main() -> None:
    """Print the tables of all scenes."""
    click.echo(
        f"| scene, k to {_ASKED.standard_error:g} | states of the approach | scatter of k between "
        "surfaces | stated error | that of the branches apart |\n|---|---|---|---|---|"
    )
    for name in NAMES:
        n_state, *errors = errors_of_k(SCENES[name])
        click.echo(f"| {name} | {n_state:.1f} | " + " | ".join(f"{x:.3f}" for x in errors) + " |")
    click.echo(
        "\n| scene | branch | independent / correlation length | rms of the front / correlation "
        "length | independent / rms |\n|---|---|---|---|---|"
    )
    branches: tuple[tuple[Direction, str], ...] = ((1, "approach"), (-1, "retraction"))
    for name in NAMES:
        scene = SCENES[name]
        length = correlation_length(scene.kind, scene.spectrum)
        found = records(scene)
        for direction, branch in branches:
            distance, roughness = independent_distance(found, direction, length)
            click.echo(
                f"| {name} | {branch} | {distance / length:.2f} | {roughness / length:.2f} | "
                f"{distance / roughness:.1f} |"
            )


if __name__ == "__main__":
    main()
