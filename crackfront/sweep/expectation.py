"""What a sweep will find: k by the law, and which loads leave its branches without steady part."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from crackfront.analysis.law import mean_adhesion, pinning_factor, spectral_breadth
from crackfront.analysis.law_spheres import sphere_factors
from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.core import jkr
from crackfront.core.adhesion import force_correlation_length, larkin_length
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.simulate.line_loads import front_rms
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.steady import SteadySchedule
from crackfront.sweep.sweep import Sweep

_LAST_SITE = 1.0
"""Rms of a front by which its last site lags behind, by 144 runs that became steady or not."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """What the simulations of a spectrum and an amplitude are expected to find."""

    disorder: float
    """w_rms / w_int."""
    size: float
    """g, L_kappa over the Larkin length, of a sphere at its largest penetration."""
    factor: float | None
    """k by the law; None so close to pull-off that nothing holds the edge."""
    needed_penetration: float | None = None
    """Where the largest one leaves no steady part. (Units: reduced vertical length)"""


def expectation(simulation: Simulation) -> Expectation:
    """What the realisations of a simulation are expected to find."""
    kind, spectrum, energy = simulation.kind, simulation.spectrum, simulation.elastic_energy
    schedule, disorder = simulation.schedule, 2 * math.sqrt(energy)
    larkin = larkin_length(kind, spectrum, disorder)
    if schedule.straight:
        size, breadth = schedule.spring / larkin, spectral_breadth(kind, spectrum)
        found = pinning_factor(disorder, size, kind, breadth).factor.value
        return Expectation(disorder, size, found)
    radius = float(jkr.equilibrium_radius(schedule.max_penetration))
    try:
        factors = sphere_factors(kind, spectrum, energy, radius)
    except ValueError:
        return Expectation(disorder, jkr.spring(radius) / larkin, None)
    size, factor = factors.size, factors.both.value
    if _needed_penetration(simulation, size, factor, FEWEST_STATES) <= schedule.max_penetration:
        return Expectation(disorder, size, factor)
    # Rather some states more than the fewest: surfaces differ.
    needed = _needed_penetration(simulation, size, factor, 3 * FEWEST_STATES)
    return Expectation(disorder, size, factor, float(f"{needed:.2g}"))


def _needed_penetration(simulation: Simulation, size: float, factor: float, n_state: int) -> float:
    """Penetration at which so many states are steady on both branches."""
    schedule, length = simulation.schedule, simulation.correlation_length
    rough = front_rms(force_correlation_length(simulation.kind, simulation.spectrum), size)
    way = length + _LAST_SITE * rough
    mean = mean_adhesion(simulation.kind, simulation.elastic_energy)
    low = max(mean - factor * simulation.elastic_energy, 0.0)
    high = mean + factor * simulation.elastic_energy
    if isinstance(schedule, SteadySchedule):
        # It begins a correlation length behind, and the retraction behind the end.
        begin = jkr.equilibrium_radius(schedule.start, low) - length
        needed = way + n_state * schedule.travel * length
    elif isinstance(schedule, LoadSchedule):
        begin = max(jkr.equilibrium_radius(0.0, low), jkr.pull_off_radius(high) - way)
        step = schedule.step / jkr.penetration_slope(schedule.max_penetration)
        needed = 2 * way + n_state * step
    else:
        return -math.inf
    return float(jkr.equilibrium_penetration(begin + needed, low))


def doubts(sweep: Sweep) -> Iterator[str]:
    """A sentence for each spectrum of a sweep that may have no steady part, with what to do."""
    unit, name = (1.0, "") if sweep.scales is None else (sweep.scales.vertical, " m")
    for item in sweep.spectra:
        needed = {
            one.elastic_energy: found
            for one in sweep.firsts(item)
            if (found := expectation(one).needed_penetration) is not None
        }
        if needed:
            energies = ", ".join(f"{energy:g}" for energy in needed)
            given = f"{unit * sweep.schedule.max_penetration:.2g}{name}"
            yield (
                f"{item.name} may have no steady part at e_el {energies}: up to the largest "
                f"penetration, {given}, its front does not forget where both branches begin; "
                f"penetrate to {unit * max(needed.values()):.2g}{name} or deeper"
            )
