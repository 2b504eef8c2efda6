"""Expected results of a sweep: k by the law, and penetrations that leave no steady part."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from crackfront.analysis.law_spheres import factors_on_springs
from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.core.adhesion import force_correlation_length, larkin_length, mean_adhesion
from crackfront.simulate.contact import Pressed
from crackfront.simulate.line.line_loads import front_rms
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.sweep import Sweep

_LAST_SITE = 1.0
"""Lag of the last site behind the mean of a front, over its rms; from 144 runs."""


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
    """Set if the largest one leaves no steady part. (Units: reduced vertical length, or as in
    the configuration)"""


def expectation(simulation: Simulation) -> Expectation:
    """What the realisations of a simulation are expected to find."""
    kind, spectrum, energy = simulation.kind, simulation.spectrum, simulation.elastic_energy
    schedule, disorder = simulation.schedule, 2 * math.sqrt(energy)
    try:
        factors = factors_on_springs(kind, spectrum, energy, schedule.spring_at)
    except ValueError:
        larkin = larkin_length(kind, spectrum, disorder)
        return Expectation(disorder, schedule.spring_at(1.0) / larkin, None)
    size, factor = factors.size, factors.both.value
    if not isinstance(schedule, Pressed):
        return Expectation(disorder, size, factor)

    works, travel = _expected_works(simulation, factor), _steady_travel(simulation, size)
    # Rather some states more than the fewest: surfaces differ.
    fewest, needed = (
        schedule.steady_penetration(simulation.surface, works, travel, n_state)
        for n_state in (FEWEST_STATES, 3 * FEWEST_STATES)
    )
    if fewest <= schedule.max_penetration:
        return Expectation(disorder, size, factor)
    return Expectation(disorder, size, factor, float(f"{needed:.2g}"))


def _steady_travel(simulation: Simulation, size: float) -> float:
    """Travel of a front of a size g after which every site has forgotten its start."""
    rough = front_rms(force_correlation_length(simulation.kind, simulation.spectrum), size)
    return simulation.correlation_length + _LAST_SITE * rough


def _expected_works(simulation: Simulation, factor: float) -> tuple[float, float]:
    """Expected works of adhesion of approach and retraction (Units: w_int)."""
    mean = mean_adhesion(simulation.kind, simulation.elastic_energy)
    low = max(mean - factor * simulation.elastic_energy, 0.0)
    return low, mean + factor * simulation.elastic_energy


def expectations(sweep: Sweep) -> dict[str, list[Expectation]]:
    """Expectations of each spectrum and amplitude, in the units of the configuration."""
    vertical = 1.0 if sweep.scales is None else sweep.scales.vertical

    def converted(expected: Expectation) -> Expectation:
        if (needed := expected.needed_penetration) is None:
            return expected
        return replace(expected, needed_penetration=vertical * needed)

    return {
        item.name: [converted(expectation(first)) for first in sweep.one_per_amplitude(item)]
        for item in sweep.spectra
    }


def steady_part_warnings(sweep: Sweep) -> Iterator[str]:
    """A sentence for each spectrum that may have no steady part, with the penetration it needs."""
    if not isinstance(sweep.schedule, Pressed):
        return
    vertical, name = (1.0, "") if sweep.scales is None else (sweep.scales.vertical, " m")
    for spectrum, expected in expectations(sweep).items():
        needed = {
            elastic_energy: cell.needed_penetration
            for elastic_energy, cell in zip(sweep.elastic_energies, expected, strict=True)
            if cell.needed_penetration is not None
        }
        if needed:
            energies = ", ".join(f"{elastic_energy:g}" for elastic_energy in needed)
            largest = f"{vertical * sweep.schedule.max_penetration:g}{name}"
            yield (
                f"{spectrum} may have no steady part at e_el {energies}: up to the largest "
                f"penetration, {largest}, its front does not forget where both branches begin; "
                f"penetrate to {max(needed.values()):.2g}{name} or deeper"
            )
