"""Errors of w_appr, w_retr and k that the numerics of a simulation leave."""

from __future__ import annotations

import math

from crackfront.analysis.steady_adhesion import SteadyAdhesion
from crackfront.simulate.law_interpolation import combined_error
from crackfront.simulate.laws import SettingName
from crackfront.simulate.simulation import Simulation

_DIGITS = 1.2
"""Factor by which an error may exceed the requested one, because settings have two digits."""


def missed_error(simulation: Simulation, requested: float) -> float:
    """Error of k that the numerics are expected to leave; 0 if it is at most the requested one."""
    error = max(numerical_error(simulation)) / simulation.elastic_energy
    return error if error > _DIGITS * requested else 0.0


def numerical_error(
    simulation: Simulation, cutoffs: float | None = None, front_length: float | None = None
) -> tuple[float, float]:
    """Standard errors (w_appr, w_retr) that the numerics leave (Units: w_int).

    `cutoffs` is the number of cutoffs crossed, as in :mod:`crackfront.simulate.laws`, by default
    the usual one; `front_length` is by default the length of the longest front of a smooth contact
    (Units: reduced lateral length). NaN if no errors were measured on such surfaces.
    """
    if not simulation.is_covered:
        return math.nan, math.nan
    resolution, cutoff = simulation.resolution, simulation.spectrum.short_cutoff
    if front_length is None:
        front_length = simulation.schedule.front_length
    usual_cutoffs = simulation.schedule.usual_cutoffs(simulation.spectrum)
    values: dict[SettingName, float] = {
        "sites": resolution.n_angle * cutoff / front_length,
        resolution.interpolation: cutoff / resolution.spacing,
        "pixels": cutoff * resolution.n_point / resolution.tile_side,
        "tolerance": simulation.solver.tolerance,
    }
    return combined_error(
        simulation.kind,
        simulation.spectrum,
        simulation.elastic_energy,
        values,
        usual_cutoffs if cutoffs is None else cutoffs,
        usual_cutoffs,
    )


def stated_error(
    simulation: Simulation, steady: SteadyAdhesion, correlation_length: float
) -> tuple[float, float]:
    """Numerical standard errors of the w_appr and w_retr that a simulation found (Units: w_int).

    States closer than a correlation length of w_loc count as one.
    """
    approach_cutoffs, retraction_cutoffs, longest = simulation.schedule.averaged_cutoffs(
        steady, correlation_length, simulation.spectrum.short_cutoff
    )
    approach, _ = numerical_error(simulation, approach_cutoffs, longest)
    _, retraction = numerical_error(simulation, retraction_cutoffs, longest)
    return approach, retraction
