"""Whether the errors that runs state are those that they have, on surfaces no law was fitted to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from crackfront.accuracy.scenes import Scene
from crackfront.accuracy.study import Branches, measured_branches
from crackfront.fits import steady_adhesion
from crackfront.laws import chosen_numerics, numerical_error
from crackfront.scene import Simulation, correlation_length, run_simulation
from crackfront.steady import SteadySchedule

Array = NDArray[np.float64]

LEVEL = 0.92
"""Share of the errors that an interval of the stated standard errors is meant to cover."""

_HELD_OUT = 1000
"""Number of the first surface."""

_SCHEDULE = SteadySchedule(start=0.0, max_penetration=3.0, travel=1.0, error=0.1)


@dataclass(frozen=True, slots=True)
class Coverage:
    """True and stated errors of runs whose numerics the laws chose.

    Attributes
    ----------
    asked : float
        Error of k that was asked for.
    numerical : (n_realisation, 2) array
        Error of w_appr and w_retr against the reference, same surface, same loads. (Units: w_int)
    numerical_stated : (2,) array
        Standard error that the laws state for those loads. (Units: w_int)
    statistical : (n_realisation, 2) array
        Difference of w_appr and w_retr of steady runs from the mean of the other surfaces.
        (Units: w_int)
    statistical_stated : (n_realisation, 2) array
        Standard error that each run states. (Units: w_int)
    n_state : (n_realisation, 2) array
        Steady states of each.
    """

    asked: float
    numerical: Array
    numerical_stated: Array
    statistical: Array
    statistical_stated: Array
    n_state: Array


def held_out_coverage(
    scene: Scene,
    asked: tuple[float, ...],
    n_realisation: int,
    progress: Callable[[str], None] | None = None,
) -> tuple[Coverage, ...]:
    """True and stated errors on surfaces that no law was fitted to.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    asked : tuple of float
        Errors of k.
    n_realisation : int
        Number of surfaces.
    progress : callable, optional
        Called with a line for every error.
    """
    tell = progress or (lambda line: None)
    numbers = range(_HELD_OUT, _HELD_OUT + n_realisation)
    exact = [measured_branches(scene, scene.reference, number) for number in numbers]
    found = []
    for error in asked:
        numerics = chosen_numerics(
            error, scene.kind, scene.spectrum, scene.elastic_energy, scene.reference
        )
        branches = [measured_branches(scene, numerics, number) for number in numbers]
        first = scene.simulation(numerics, _HELD_OUT)
        runs = np.array([_steady(scene.simulation(numerics, number)) for number in numbers])
        others = (runs[:, 0].sum(axis=0) - runs[:, 0]) / (n_realisation - 1)
        item = Coverage(
            asked=error,
            numerical=np.array(
                [_mean(one) - _mean(two) for one, two in zip(branches, exact, strict=True)]
            ),
            numerical_stated=np.array(numerical_error(first, _size(scene, exact[0]))),
            statistical=runs[:, 0] - others,
            statistical_stated=runs[:, 1],
            n_state=runs[:, 2],
        )
        found.append(item)
        covered = np.abs(item.numerical) <= numerical_interval(item)
        tell(f"asked {error:g}: {100 * np.mean(covered):.0f}% of the numerical errors are covered")
    return tuple(found)


def numerical_interval(item: Coverage) -> Array:
    """Half width of the interval of the stated numerical error, as of a normal distribution.

    Parameters
    ----------
    item : Coverage
        True and stated errors.

    Returns
    -------
    (2,) array
        By branch. (Units: w_int)
    """
    return stats.norm.ppf((1 + LEVEL) / 2) * item.numerical_stated


def statistical_interval(item: Coverage) -> Array:
    """Half width of the interval of the stated statistical error, by Student's t.

    Parameters
    ----------
    item : Coverage
        True and stated errors.

    Returns
    -------
    (n_realisation, 2) array
        By surface and branch. (Units: w_int)
    """
    return stats.t.ppf((1 + LEVEL) / 2, np.maximum(item.n_state - 1, 1)) * item.statistical_stated


def _mean(branches: Branches) -> Array:
    """W_appr and w_retr."""
    return branches.apparent_work_of_adhesion.mean(axis=1)


def _size(scene: Scene, branches: Branches) -> float:
    """Cutoffs along the front, summed over its states."""
    circumference = 2 * np.pi * float(branches.radius.mean())
    return scene.penetrations.size * circumference / scene.spectrum.short_cutoff


def _steady(simulation: Simulation) -> list[tuple[float, float]]:
    """Adhesion, its stated standard error and the number of states, of both branches."""
    result = run_simulation(replace(simulation, schedule=_SCHEDULE))
    length = correlation_length(simulation.kind, simulation.spectrum)
    steady = steady_adhesion(result.record, length)
    return [
        (steady.approach, steady.retraction),
        (steady.approach_error, steady.retraction_error),
        (float(steady.n_approach), float(steady.n_retraction)),
    ]
