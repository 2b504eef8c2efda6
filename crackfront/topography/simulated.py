"""The real run behind a prediction: cycles on synthesised surfaces with the fitted spectrum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from crackfront.analysis.estimate import Estimate, mean_estimate
from crackfront.analysis.steady import steady_adhesion
from crackfront.core import jkr
from crackfront.core.cycle.steady import SteadySchedule
from crackfront.core.units import Scales
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import (
    Numerics,
    Simulation,
    numerical_error,
    simulation_of,
)
from crackfront.topography.measures import MeasuredSurface
from crackfront.topography.prediction import reduced_spectrum

_ERROR = 0.03
"""Standard error of k that the numerics may leave."""

_START, _DEEPEST, _TRAVEL, _STEADY_ERROR = 1.0, 1.5, 1.5, 0.1
"""Steady parts of both branches, as in config/default.yaml, from which the table of k is."""

_WAY = 15.0
"""Correlation lengths that the contact grows by at least, for a few independent states."""


@dataclass(frozen=True, slots=True)
class Simulated:
    """What simulations found, means over surfaces with 95% intervals.

    Attributes
    ----------
    realisations : int
        Surfaces with a value.
    w_appr, w_retr, hysteresis : Estimate of a number
        Works of adhesion; without an interval (NaN) where there is one surface.
        (Units: J / m^2)
    k : Estimate of a number
        Their k.
    numerical_error : float
        Standard error of k that the numerics leave.
    failed : tuple of str
        Why surfaces have no value.
    """

    realisations: int
    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]
    k: Estimate[float]
    numerical_error: float
    failed: tuple[str, ...]


def prediction_simulations(
    surface: MeasuredSurface, scales: Scales, realisations: int, seed: int
) -> tuple[Simulation, ...]:
    """Simulations of surfaces with the fitted spectrum and its amplitude, and noise of a seed.

    Raises
    ------
    ValueError
        If no contact conforms, e_el >= w_int.
    """
    spectrum = reduced_spectrum(surface.fitted.spectrum, scales)
    energy = spectrum.elastic_energy
    if not energy < 1:
        raise ValueError(f"e_el is {energy:.3g} w_int; no simulation conforms fully at 1 or more")
    schedule = _schedule(spectrum.correlation_length)
    first = simulation_of("roughness", spectrum, energy, schedule, Numerics(_ERROR), seed=seed)
    name = f"measured-{surface.checksum}"
    return tuple(
        replace(first, spectrum_name=name, realisation=number) for number in range(realisations)
    )


def expected_seconds(simulations: Sequence[Simulation]) -> float:
    """Processor time that simulations are expected to take."""
    return sum(expected_cost(item).seconds for item in simulations)


def simulated(simulations: Sequence[Simulation], scales: Scales) -> Simulated:
    """Run simulations of one surface, one after the other, and average what they find.

    Raises
    ------
    ValueError
        If none of them has a value.
    """
    rows, failed = [], []
    for simulation in simulations:
        result = run_simulation(simulation)
        length = simulation.correlation_length
        steady = steady_adhesion(result.record, length)
        if steady.sentence:
            failed.append(f"{simulation.label}: {steady.sentence}")
            continue
        k = steady.hysteresis / (2 * result.measures.e_el)
        rows.append((steady.w_appr, steady.w_retr, steady.hysteresis, k))
    if not rows:
        raise ValueError(f"no simulation has a value; {failed[0]}")
    means = mean_estimate(np.transpose(rows))[0]
    *works, factor = (Estimate(*map(float, one)) for one in np.transpose(astuple(means)))
    appr, retr, hysteresis = (
        work.each(lambda number: number * scales.work_of_adhesion) for work in works
    )
    first = simulations[0]
    return Simulated(
        realisations=len(rows),
        w_appr=appr,
        w_retr=retr,
        hysteresis=hysteresis,
        k=factor,
        numerical_error=math.hypot(*numerical_error(first)) / (2 * first.elastic_energy),
        failed=tuple(failed),
    )


def _schedule(correlation_length: float) -> SteadySchedule:
    """Penetrations to visit; deeper ones where the features are large against the contact."""
    largest = jkr.equilibrium_radius(_START) + _WAY * correlation_length
    deepest = max(_DEEPEST, float(jkr.equilibrium_penetration(largest)))
    return SteadySchedule(_START, deepest, _TRAVEL, _STEADY_ERROR)
