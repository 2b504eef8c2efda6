"""Expected results of a sweep: k by the law, contacts that are too small or lack a steady part."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from crackfront.analysis.law_spheres import sizes_on_springs, straight_factors
from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.core.adhesion import force_correlation_length, larkin_length, mean_adhesion
from crackfront.simulate.contact import Pressed
from crackfront.simulate.line.line_loads import front_rms
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.sweep import Sweep

_DOUBTFUL_STATES = FEWEST_STATES + 1
"""Expected steady states below which surfaces may lack a steady part: with 3, 20 of 48 did."""

_ENOUGH_STATES = FEWEST_STATES + 2
"""Expected steady states with which all of 120 simulations had a steady part."""

_SMALL_SIZE = 0.5
"""Size g below which k is less than half of k in the infinite contact."""

_LAST_SITE = 1.0
"""Lag of the last site behind the mean of a front, over its rms; from 144 runs."""


@dataclass(frozen=True, slots=True)
class Expectation:
    """What the simulations of a spectrum and an amplitude are expected to find."""

    disorder: float
    """w_rms / w_int."""
    size: float | None
    """g, L_kappa over the Larkin length, for a sphere at its largest penetration; None for an
    anisotropic spectrum, whose Larkin length depends on the direction of the front."""
    factor: float | None
    """k by the law; None near pull-off, where the edge is unstable, and if the law does not cover
    the surface."""
    needed_penetration: float | None = None
    """Set if the largest one may leave no steady part. (Units: reduced vertical length, or as in
    the configuration)"""
    needed_start: float | None = None
    """Start of steady loads that helps as well, if there is one. (Units: as above)"""
    needed_travel: float | None = None
    """Travel of steady loads that helps as well, if there is one. (Units: correlation length)"""


def expectation(simulation: Simulation) -> Expectation:
    """What the realisations of a simulation are expected to find."""
    kind, energy, schedule = simulation.kind, simulation.elastic_energy, simulation.schedule
    disorder = 2 * math.sqrt(energy)
    if not simulation.is_covered:
        return Expectation(disorder, _size_of_isotropic(simulation, disorder), None)
    sizes = sizes_on_springs(kind, simulation.spectrum, energy, schedule.spring_at)
    if not sizes.is_stable:
        return Expectation(disorder, schedule.spring_at(1.0) / sizes.larkin_length, None)
    factor = straight_factors(kind, energy, sizes).both.value
    expected = Expectation(disorder, sizes.smooth, factor)
    if not isinstance(schedule, Pressed):
        return expected
    works, transient = _expected_works(simulation, factor), _transient(simulation, sizes.smooth)
    contact = simulation.surface, works, transient
    if schedule.steady_penetration(*contact, _DOUBTFUL_STATES) <= schedule.max_penetration:
        return expected
    return replace(
        expected,
        needed_penetration=schedule.steady_penetration(*contact, _ENOUGH_STATES),
        needed_start=schedule.steadier_start(*contact, _ENOUGH_STATES),
        needed_travel=schedule.steadier_travel(*contact, _ENOUGH_STATES),
    )


def _size_of_isotropic(simulation: Simulation, disorder: float) -> float | None:
    """Size g without hysteresis; None for an anisotropic spectrum."""
    kind, spectrum = simulation.kind, simulation.spectrum
    if not spectrum.is_isotropic:
        return None
    return simulation.schedule.spring_at(1.0) / larkin_length(kind, spectrum, disorder)


def _transient(simulation: Simulation, size: float) -> float:
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
        if expected.needed_penetration is None:
            return expected
        depth, start = vertical * expected.needed_penetration, expected.needed_start
        start = None if start is None else vertical * start
        return replace(expected, needed_penetration=depth, needed_start=start)

    return {
        item.name: [converted(expectation(first)) for first in sweep.one_per_amplitude(item)]
        for item in sweep.spectra
    }


def steady_part_warnings(sweep: Sweep) -> Iterator[str]:
    """A sentence for each spectrum that may have no steady part, with what helps."""
    if not isinstance(sweep.schedule, Pressed):
        return
    vertical, unit = (1.0, "") if sweep.scales is None else (sweep.scales.vertical, " m")
    largest = f"{vertical * sweep.schedule.max_penetration:g}{unit}"
    for spectrum, expected in expectations(sweep).items():
        doubtful = {
            elastic_energy: cell
            for elastic_energy, cell in zip(sweep.elastic_energies, expected, strict=True)
            if cell.needed_penetration is not None
        }
        if doubtful:
            energies = ", ".join(f"{elastic_energy:g}" for elastic_energy in doubtful)
            yield (
                f"{spectrum} may have no steady part at e_el {energies}: up to the largest "
                f"penetration, {largest}, its front does not forget where both branches begin; "
                f"{_remedies([*doubtful.values()], unit)}"
            )


def small_size_warnings(sweep: Sweep) -> Iterator[str]:
    """A sentence for each spectrum that is too coarse for the sphere, with what helps."""
    if not isinstance(sweep.schedule, Pressed):
        return
    lateral, unit = (1.0, "") if sweep.scales is None else (sweep.scales.lateral, " m")
    for item in sweep.spectra:
        weakest = min(sweep.fit.chosen(sweep.elastic_energies))
        size = expectation(sweep.simulation(item, weakest, 0)).size
        if size is not None and size < _SMALL_SIZE:
            # The Larkin length is proportional to the wavelengths.
            cutoff = _two_digits(size * lateral * item.spectrum.short_cutoff, math.floor)
            yield (
                f"{item.name} has g = {size:.2g} at e_el {weakest:g}, the weakest of the fit: "
                f"below {_SMALL_SIZE:g} the front hardly bends, and k is small; for g = 1 divide "
                f"its wavelengths by {1 / size:.2g} (short_cutoff {cutoff}{unit}), or raise "
                "fit: lowest_elastic_energy"
            )


def _remedies(doubtful: Sequence[Expectation], unit: str) -> str:
    """Keys of the load that help at all of these amplitudes, each with its value."""
    depth = max(cell.needed_penetration or 0.0 for cell in doubtful)
    remedies = [f"raise max_penetration to {_two_digits(depth, math.ceil)}{unit}"]
    starts = [cell.needed_start for cell in doubtful if cell.needed_start is not None]
    if len(starts) == len(doubtful):
        remedies.append(f"lower start to {_two_digits(min(starts), math.floor)}{unit}")
    travels = [cell.needed_travel for cell in doubtful if cell.needed_travel is not None]
    if len(travels) == len(doubtful):
        remedies.append(f"lower travel to {_two_digits(min(travels), math.floor)}")
    return " or ".join(reversed(remedies))


def _two_digits(value: float, rounded: Callable[[float], int]) -> str:
    """Number of two digits, rounded in one direction."""
    if value == 0:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - 1)
    return f"{rounded(value / unit) * unit:.2g}"
