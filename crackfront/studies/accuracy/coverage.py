"""Whether the errors that runs state are those that they have, on surfaces no law was fitted to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from crackfront.analysis.steady import steady_adhesion
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.records import ADHESION, variable
from crackfront.simulate.laws import chosen_knobs
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import Simulation, numerical_error, stated_error
from crackfront.studies.accuracy.scenes import Scene
from crackfront.studies.accuracy.study import Branches, measured_branches

Array = NDArray[np.float64]

LEVEL = 0.92
"""Share of the errors that an interval of the stated standard errors is meant to cover."""

_RUN = ("realisation", "branch")

_HELD_OUT = 1000
"""Number of the first surface."""

_SCHEDULE = SteadySchedule(start=0.0, max_penetration=3.0, travel=1.5, error=0.1)


@dataclass(frozen=True, slots=True)
class Coverage:
    """True and stated errors of w_appr and w_retr where the laws chose the numerics.

    Attributes
    ----------
    asked : float
        Error of k that was asked for.
    numerical : (n_realisation, 2) array
        Error against the reference, same surface, same loads. (Units: w_int)
    numerical_stated : (2,) array
        Standard error that the laws state for those loads. (Units: w_int)
    total : (n_realisation, 2) array
        Error of a steady run: difference from the mean of the reference's steady runs on the other
        surfaces. (Units: w_int)
    run_numerical, run_statistical : (n_realisation, 2) array
        Standard errors that the steady run states. (Units: w_int)
    n_state : (n_realisation, 2) array
        Its steady states.
    truth_error : (n_realisation, 2) array
        Standard error of the mean of the reference's runs on the other surfaces. (Units: w_int)
    """

    asked: float = variable("standard error that was asked for", "e_el")
    numerical: Array = variable("numerical error of w_appr and w_retr", ADHESION, *_RUN)
    numerical_stated: Array = variable("stated numerical standard error", ADHESION, _RUN[1])
    total: Array = variable("error of a steady run", ADHESION, *_RUN)
    run_numerical: Array = variable("numerical standard error it states", ADHESION, *_RUN)
    run_statistical: Array = variable("statistical standard error it states", ADHESION, *_RUN)
    n_state: Array = variable("its steady states", "1", *_RUN)
    truth_error: Array = variable("standard error of the truth", ADHESION, *_RUN)


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

    Raises
    ------
    ValueError
        If there are fewer than three surfaces: the others' scatter is part of the interval.
    """
    if n_realisation < 3:
        raise ValueError(f"coverage needs 3 surfaces or more, not {n_realisation}; ask for more")
    tell = progress or (lambda line: None)
    numbers = range(_HELD_OUT, _HELD_OUT + n_realisation)
    exact = [measured_branches(scene, scene.reference, number) for number in numbers]
    truth = np.array([_steady(scene.simulation(scene.reference, number))[0] for number in numbers])
    others = [np.delete(truth, row, axis=0) for row in range(n_realisation)]
    of_others = np.array([rows.mean(axis=0) for rows in others])
    scatter = np.array([rows.std(axis=0, ddof=1) for rows in others])
    found = []
    for error in asked:
        knobs = chosen_knobs(error, scene.kind, scene.spectrum, scene.elastic_energy)
        simulations = [scene.simulation(knobs, number) for number in numbers]
        branches = [measured_branches(scene, knobs, number) for number in numbers]
        runs = np.array([_steady(simulation) for simulation in simulations])
        item = Coverage(
            asked=error,
            numerical=np.array(
                [_mean(one) - _mean(other) for one, other in zip(branches, exact, strict=True)]
            ),
            numerical_stated=np.array(numerical_error(simulations[0], _size(scene, exact[0]))),
            total=runs[:, 0] - of_others,
            run_numerical=runs[:, 1],
            run_statistical=runs[:, 2],
            n_state=runs[:, 3],
            truth_error=scatter / np.sqrt(n_realisation - 1),
        )
        found.append(item)
        shares = [
            np.mean(np.abs(true[known]) <= interval[known])
            for true, interval, known in (
                (item.numerical, numerical_interval(item), np.isfinite(item.numerical)),
                (item.total, total_interval(item), np.isfinite(item.run_statistical)),
            )
        ]
        tell(
            f"asked {error:g}: {100 * shares[0]:.0f}% of the numerical and {100 * shares[1]:.0f}% "
            "of the total errors are covered"
        )
    return tuple(found)


def numerical_interval(item: Coverage) -> Array:
    """Half width of the interval of the numerical error, as of a normal distribution.

    Parameters
    ----------
    item : Coverage
        True and stated errors.

    Returns
    -------
    (n_realisation, 2) array
        By surface and branch. (Units: w_int)
    """
    width = stats.norm.ppf((1 + LEVEL) / 2) * item.numerical_stated
    return np.broadcast_to(width, item.numerical.shape)


def total_interval(item: Coverage) -> Array:
    """Half width of the interval of the total error; Student's t for the statistical part.

    What the mean of the other surfaces is off by is part of the difference, and of the interval.

    Parameters
    ----------
    item : Coverage
        True and stated errors.

    Returns
    -------
    (n_realisation, 2) array
        By surface and branch. (Units: w_int)
    """
    share = (1 + LEVEL) / 2
    statistical = stats.t.ppf(share, np.maximum(item.n_state - 1, 1)) * item.run_statistical
    known = np.hypot(item.run_numerical, item.truth_error)
    return np.hypot(statistical, stats.norm.ppf(share) * known)


def _mean(branches: Branches) -> Array:
    """W_appr and w_retr."""
    return branches.apparent_work_of_adhesion.mean(axis=1)


def _size(scene: Scene, branches: Branches) -> float:
    """Cutoffs along the front, summed over its states."""
    circumference = 2 * np.pi * float(branches.radius.mean())
    return scene.penetrations.size * circumference / scene.spectrum.short_cutoff


def _steady(simulation: Simulation) -> list[tuple[float, float]]:
    """Adhesion, its stated errors and the number of states, of both branches of a steady run.

    Adhesion is that about the mean of w_loc, relative to the e_el of the run's own tile, times the
    requested e_el: what k is made of. Tiles differ in both.
    """
    simulation = replace(simulation, schedule=_SCHEDULE)
    length = simulation.correlation_length
    result = run_simulation(simulation)
    steady = steady_adhesion(result.record, length)
    mean = 1 - result.measures.e_el if simulation.kind == "roughness" else 1.0
    scale = simulation.elastic_energy / result.measures.e_el
    return [
        (scale * (steady.w_appr - mean), scale * (steady.w_retr - mean)),
        stated_error(simulation, steady, length),
        (steady.w_appr_error, steady.w_retr_error),
        (float(steady.n_approach), float(steady.n_retraction)),
    ]
