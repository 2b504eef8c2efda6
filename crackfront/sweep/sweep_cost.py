"""Expected costs of the simulations of a sweep, also for other numerical errors of k."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from crackfront.simulate.costs import expected_cost
from crackfront.simulate.numerical_errors import missed_error
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.sweep import Sweep


@dataclass(frozen=True, slots=True)
class SweepCost:
    """What simulations are expected to cost together."""

    core_seconds: float
    """Processor time of all. (Units: s)"""
    longest_seconds: float
    """Processor time of the longest one. (Units: s)"""
    bytes_a_rank: float
    """Memory of a process that runs the largest one. (Units: bytes)"""
    jump_core_seconds: float
    """Share of the processor time that separates jumps. (Units: s)"""


def sweep_cost(counted: Iterable[tuple[Simulation, int]]) -> SweepCost:
    """Cost of simulations, each with the number of its realisations."""
    costs = [(expected_cost(simulation), number) for simulation, number in counted]
    return SweepCost(
        core_seconds=sum(number * cost.seconds for cost, number in costs),
        longest_seconds=max((cost.seconds for cost, _ in costs), default=0.0),
        bytes_a_rank=max((cost.memory for cost, _ in costs), default=0.0),
        jump_core_seconds=sum(number * cost.jump_seconds for cost, number in costs),
    )


@dataclass(frozen=True, slots=True)
class ErrorCost:
    """What a sweep costs if its numerics may leave some error of k."""

    error: float
    """Requested standard error of k of both branches, as `numerics: {error: ...}`."""
    cost: SweepCost
    """Cost of all simulations, stored or not."""
    remaining_error: float
    """Largest error that the finest numerics leave; 0 if they reach the requested one."""


def error_costs(sweep: Sweep, errors: Sequence[float]) -> Iterator[ErrorCost]:
    """Cost of a whole sweep for each numerical error of k, whatever its numerics are.

    ValueError if errors were not measured for a spectrum or an amplitude of the sweep.
    """
    for error in errors:
        numerics = replace(sweep.numerics, settings=None, error=error)
        with_error = replace(sweep, numerics=numerics)
        firsts = [first for item in sweep.spectra for first in with_error.one_per_amplitude(item)]
        yield ErrorCost(
            error,
            sweep_cost((first, sweep.n_realisation) for first in firsts),
            max(missed_error(first, error) for first in firsts),
        )
