"""The real run behind a prediction: synthesised surfaces with the fitted spectrum.

Spheres are run, or where these have too many sites the straight fronts that they are locally.
"""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, replace

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

_ERROR = 0.03
"""Standard error of k that the numerics may leave."""

_START, _DEEPEST, _TRAVEL, _STEADY_ERROR = 1.0, 1.5, 1.5, 0.1
"""Steady parts of both branches, as in config/default.yaml, from which the table of k is."""

_WAY = 15.0
"""Correlation lengths that the contact grows by at least, for a few independent states."""

_MOST_SITES, _MOST_LINE_SITES, _MOST_MEMORY = 1_000_000, 2_000_000, 8e9
"""Sites of a sphere and of a straight front, and bytes of either, up to which they are run."""

_LINE = LineLoad(spring_unit="larkin_length", length=10, period=25, transient=6, step=0.5)
"""Straight fronts, as in config/line.yaml, from which the law of k is."""


@dataclass(frozen=True, slots=True)
class SimulationPlan:
    """What is simulated for a prediction."""

    simulations: tuple[Simulation, ...]
    remark: str = ""
    """What is run in place of spheres, and why; empty where spheres are."""

    @property
    def expected_seconds(self) -> float:
        """Processor time that the simulations are expected to take."""
        return sum(expected_cost(item).seconds for item in self.simulations)


@dataclass(frozen=True, slots=True)
class Adhesions:
    """Works of adhesion (Units: J / m^2)."""

    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]


@dataclass(frozen=True, slots=True)
class Simulated:
    """What simulations found, means over surfaces with 95% intervals."""

    realisations: int
    """Surfaces with a value."""
    w_appr: Estimate[float]
    w_retr: Estimate[float]
    hysteresis: Estimate[float]
    """Works of adhesion; without an interval (NaN) where there is one surface. (Units: J / m^2)"""
    k: Estimate[float]
    numerical_error: float
    """Standard error of k that the numerics leave."""
    failed: tuple[str, ...]
    """Why surfaces have no value."""
    remark: str
    """As of :class:`SimulationPlan`."""

    def corrected(self, prediction: Prediction) -> Adhesions:
        """Works of adhesion, divided as the prediction divides its own.

        What lies on either side of w_int - e_el is divided; without an interval of the ratio,
        which stands in the prediction.
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
    """Simulations of surfaces with the fitted spectrum and its amplitude, and noise of a seed."""
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
    """A sphere, or where it is too large a straight front on its springs, and why."""
    numerics = Numerics(_ERROR)
    # Spheres go deeper where the features are large against the contact.
    largest = jkr.equilibrium_radius(_START) + _WAY * spectrum.correlation_length
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
    """Whether a simulation has few enough sites, and a tile that is not too large."""
    sites = simulation.resolution.n_angle
    return sites <= most_sites and expected_cost(simulation).memory <= _MOST_MEMORY


def _extent(simulation: Simulation) -> str:
    """Sites and memory of a simulation."""
    memory = expected_cost(simulation).memory
    return f"{simulation.resolution.n_angle:.3g} sites, {memory / 1e9:.2g} GB"


def simulated(plan: SimulationPlan, scales: Scales) -> Simulated:
    """Run the simulations of one surface, one after the other, and average what they find."""
    rows, failed = [], []
    for simulation in plan.simulations:
        result = run_simulation(simulation)
        e_el, steady = result.measures.e_el, result.steady_adhesion
        if steady.sentence:
            failed.append(f"{simulation.label}: {steady.sentence}")
            continue
        lost = steady.w_retr - steady.w_appr
        rows.append((steady.w_appr, steady.w_retr, lost, lost / (2 * e_el)))
    if not rows:
        raise ValueError(f"no simulation has a value; {failed[0]}")
    means = mean_estimate(np.transpose(rows))[0]
    *works, factor = (Estimate(*map(float, one)) for one in np.transpose(astuple(means)))
    appr, retr, hysteresis = (
        work.each(lambda number: number * scales.work_of_adhesion) for work in works
    )
    first = plan.simulations[0]
    return Simulated(
        realisations=len(rows),
        w_appr=appr,
        w_retr=retr,
        hysteresis=hysteresis,
        k=factor,
        numerical_error=math.hypot(*numerical_error(first)) / (2 * first.elastic_energy),
        failed=tuple(failed),
        remark=plan.remark,
    )
