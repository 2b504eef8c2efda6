"""Simulations for comparison with a prediction, on random surfaces with the fitted spectrum.

They are spheres, or straight fronts if spheres have too many sites.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from crackfront.analysis.estimate import Estimate, mean_estimate
from crackfront.core import jkr
from crackfront.core.adhesion import larkin_length
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.measured.prediction.conditions import zero_load_radius
from crackfront.measured.prediction.prediction import Prediction
from crackfront.measured.prediction.works import surface_spectrum
from crackfront.measured.spectrum.stated import Surface
from crackfront.simulate.contact import Schedule
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.line.line_loads import LineLoad
from crackfront.simulate.numerical_errors import numerical_error
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.simulation import Simulation, simulation_of
from crackfront.simulate.sphere.steady_branches import SteadySchedule

_FACTOR_ERROR = 0.03
"""Standard error of k by the numerics."""

# Loads of the steady parts, as in config/default.yaml.

_START = 1.0
"""Penetration at which the approach starts. (Units: reduced vertical length)"""

_DEEPEST = 1.5
"""Largest penetration; more for large features. (Units: reduced vertical length)"""

_TRAVEL = 1.5
"""Travel of the front before its states are steady. (Units: correlation length)"""

_STEADY_ERROR = 0.1
"""Standard error of k over the states of a simulation at which its parts are long enough."""

_LEAST_GROWTH = 15.0
"""Least growth of the contact, for several independent states. (Units: correlation length)"""

_MOST_SITES = 1_000_000
"""Largest number of sites of a sphere."""

_MOST_LINE_SITES = 2_000_000
"""Largest number of sites of a straight front."""

_MOST_MEMORY = 8e9
"""Largest memory of a simulation. (Units: byte)"""

_LINE = LineLoad(spring_unit="larkin_length", length=10, period=25, transient=6, step=0.5)
"""Load of straight fronts, as in config/line.yaml, to which the law of k was fitted."""


@dataclass(frozen=True, slots=True)
class SimulationPlan:
    """Simulations for a prediction."""

    simulations: tuple[Simulation, ...]
    remark: str = ""
    """Why straight fronts replace spheres; empty for spheres."""

    @property
    def expected_seconds(self) -> float:
        """Expected processor time (Units: s)."""
        return sum(expected_cost(simulation).seconds for simulation in self.simulations)


@dataclass(frozen=True, slots=True)
class Adhesions:
    """Works of adhesion (Units: J / m^2)."""

    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]


@dataclass(frozen=True, slots=True)
class Simulated:
    """Results of simulations: means over surfaces with 95% intervals."""

    realisations: int
    """Surfaces with a value."""
    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]
    """Works of adhesion; intervals are NaN for a single surface. (Units: J / m^2)"""
    k: Estimate[float]
    numerical_error: float
    """Standard error of k by the numerics."""
    failed: tuple[str, ...]
    """Reasons why simulations failed."""
    remark: str
    """As in :class:`SimulationPlan`."""

    def corrected(self, prediction: Prediction) -> Adhesions:
        """Works of adhesion with the hysteresis divided by the excess, as in the prediction.

        The differences from w_int - e_el are divided. The uncertainty of the excess is not
        included.
        """
        middle = prediction.work_of_adhesion - prediction.e_el.value
        ratio = prediction.excess.ratio.value
        appr, retr = (
            work.each(lambda number: middle + (number - middle) / ratio)
            for work in (self.w_appr, self.w_retr)
        )
        return Adhesions(appr, retr, self.hysteresis.each(lambda number: number / ratio))


def prediction_plan(
    surface: Surface, scales: Scales, realisations: int, seed: int
) -> SimulationPlan:
    """Simulations of random surfaces with the fitted spectrum; ValueError if they are too large."""
    spectrum = surface_spectrum(surface, scales)
    energy = spectrum.elastic_energy
    first, remark = _affordable(spectrum, energy, zero_load_radius(scales) / scales.lateral, seed)
    name = f"measured-{surface.checksum}"
    simulations = (
        replace(first, spectrum_name=name, realisation=number) for number in range(realisations)
    )
    return SimulationPlan(tuple(simulations), remark)


def _affordable(
    spectrum: TabulatedSpectrum, energy: float, contact_radius: float, seed: int
) -> tuple[Simulation, str]:
    """A sphere, or a straight front on its springs if the sphere is too large, and a remark."""
    numerics = Numerics(error=_FACTOR_ERROR)
    # Large features need deeper penetration.
    largest = jkr.equilibrium_radius(_START) + _LEAST_GROWTH * spectrum.correlation_length
    deepest = max(_DEEPEST, float(jkr.equilibrium_penetration(largest)))
    schedule: Schedule = SteadySchedule(_START, deepest, _TRAVEL, _STEADY_ERROR)
    sphere = simulation_of("roughness", spectrum, energy, schedule, numerics, seed=seed)
    if _fits(sphere, _MOST_SITES):
        return sphere, ""
    larkin = larkin_length("roughness", spectrum, 2 * math.sqrt(energy))
    size = jkr.spring(contact_radius, 1 - energy) / larkin
    schedule = _LINE.for_surface("roughness", spectrum, energy, size, numerics)
    front = simulation_of("roughness", spectrum, energy, schedule, numerics, seed=seed)
    if not _fits(front, _MOST_LINE_SITES):
        raise ValueError(
            f"no simulation is small enough: a sphere has {_extent(sphere)}, a straight front "
            f"{_extent(front)}; trust fewer short waves with --shortest, or do without --simulate"
        )
    return front, (
        f"In place of a sphere ({_extent(sphere)}) a straight front is simulated, on springs of "
        f"the length L_kappa: g {size:.3g}, {_extent(front)}."
    )


def _fits(simulation: Simulation, most_sites: int) -> bool:
    """Whether a simulation is small enough."""
    sites = simulation.resolution.n_angle
    return sites <= most_sites and expected_cost(simulation).memory <= _MOST_MEMORY


def _extent(simulation: Simulation) -> str:
    """Sites and memory of a simulation."""
    memory = expected_cost(simulation).memory
    return f"{simulation.resolution.n_angle:.3g} sites, {memory / 1e9:.2g} GB"


def simulated(plan: SimulationPlan, scales: Scales) -> Simulated:
    """Means over the simulations of a plan, which are run one after the other.

    ValueError if all of them fail.
    """
    rows, failed = [], []
    for simulation in plan.simulations:
        result = run_simulation(simulation)
        e_el, steady = result.measures.e_el, result.steady_adhesion
        if steady.sentence:
            failed.append(f"{simulation.label}: {steady.sentence}")
            continue
        hysteresis = steady.w_retr - steady.w_appr
        rows.append((steady.w_appr, steady.w_retr, hysteresis, hysteresis / (2 * e_el)))
    if not rows:
        raise ValueError(f"all simulations failed; {failed[0]}")
    means, _ = mean_estimate(np.transpose(rows))

    def in_si(index: int) -> Estimate[float]:
        return means.each(lambda values: float(values[index] * scales.work_of_adhesion))

    first = plan.simulations[0]
    return Simulated(
        realisations=len(rows),
        w_appr=in_si(0),
        w_retr=in_si(1),
        hysteresis=in_si(2),
        k=means.each(lambda values: float(values[3])),
        numerical_error=math.hypot(*numerical_error(first)) / (2 * first.elastic_energy),
        failed=tuple(failed),
        remark=plan.remark,
    )
