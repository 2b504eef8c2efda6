"""Whether a sweep can run: its settings, the errors that they leave, and its costs."""

from __future__ import annotations

import math
import sys
from itertools import product
from pathlib import Path

from crackfront.core.resources import check_memory, check_time
from crackfront.core.synthesis import FEWEST_POINTS
from crackfront.simulate.contact import Pressed, SurfaceLoads
from crackfront.simulate.costs import check_sizes, expected_cost
from crackfront.simulate.numerical_errors import missed_error
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.section import ConfigurationError
from crackfront.sweep.sweep import Sweep

_LISTED_BYTES = 500.0
"""Memory of a simulation in a list. (Units: bytes)"""

_SAMPLE_BYTES = 100.0
"""Memory of the means of a bootstrap sample at one amplitude. (Units: bytes)"""

_COARSER = "use fewer, coarser or larger load steps, or smaller tiles"

_FEWEST_SITES = 0.7
"""Sites per short cutoff below which k is several times too large, and its bias not known."""

_FEWEST_SAMPLES = {"cubic": 2.0, "linear": 3.0}
"""Samples per short cutoff along a ray below which they miss waves: with 1, k of straight fronts at
w_rms 0.1 to 0.8 is 0 to 0.7 of its value with cubic pieces, and 0 to 0.3 with linear ones."""


_ROUND_OFF = 1e-9
"""Relative distance by which samples may be below the fewest."""


def check_feasible(sweep: Sweep, path: Path) -> None:
    """Raise ConfigurationError if no machine can run a sweep, or its numerics are too coarse.

    The sentence begins with the path of the configuration. Settings, errors and costs are computed
    for every spectrum and amplitude; no surface is made.
    """
    try:
        _check_counts(sweep)
        _check_sizes(sweep)
        _check_costs(sweep)
        for item in sweep.spectra:
            for simulation in sweep.one_per_amplitude(item):
                if isinstance(sweep.schedule, SurfaceLoads):
                    sweep.schedule.check_resolution(simulation)
                _check_resolution(simulation)
                _check_tolerance_and_error(simulation, sweep.numerics.error)
    except ValueError as error:
        raise ConfigurationError(f"{path}: {error}") from error


def _check_counts(sweep: Sweep) -> None:
    """Raise TooLargeError if memory cannot contain lists of simulations or bootstrap samples."""
    check_memory(
        f"realisations: {sweep.n_simulation:.3g} simulations",
        _LISTED_BYTES * sweep.n_simulation,
        "lower their number",
    )
    check_memory(
        f"fit: {sweep.fit.n_bootstrap} bootstrap samples",
        _SAMPLE_BYTES * sweep.fit.n_bootstrap * len(sweep.elastic_energies),
        "lower bootstrap",
    )


def _check_sizes(sweep: Sweep) -> None:
    """Raise ValueError if a tile, a front or a length is beyond what any machine computes."""
    deepest = sweep.schedule.max_penetration if isinstance(sweep.schedule, Pressed) else 0.0
    for item, elastic_energy in product(sweep.spectra, sweep.elastic_energies):
        usual_cutoffs = sweep.schedule.usual_cutoffs(item.spectrum)
        settings = sweep.numerics.settings_of(
            sweep.kind, item.spectrum, elastic_energy, usual_cutoffs
        )
        check_sizes(item.spectrum, sweep.numerics, settings, deepest)


def _check_costs(sweep: Sweep) -> None:
    """Raise TooLargeError if simulations need more memory or time than any machine has."""
    seconds = 0.0
    for item in sweep.spectra:
        for simulation in sweep.one_per_amplitude(item):
            cost = expected_cost(simulation)
            task = f"simulations of {item.name}"
            check_memory(task, cost.memory, _COARSER, anywhere=True)
            seconds += sweep.n_realisation * cost.seconds
    check_time("the simulations", seconds, _COARSER)


def _check_resolution(simulation: Simulation) -> None:
    """Raise ValueError if sites or samples are too few for the spectrum."""
    resolution, name = simulation.resolution, simulation.spectrum_name
    if resolution.n_point < FEWEST_POINTS:
        raise ValueError(
            f"numerics: tiles of {name} have {resolution.n_point} points a side; use at least "
            f"{FEWEST_POINTS}, by a larger tile or more pixels_per_cutoff"
        )
    short_cutoff, front_length = simulation.spectrum.short_cutoff, simulation.schedule.front_length
    if (density := resolution.n_angle * short_cutoff / front_length) < _FEWEST_SITES:
        raise ValueError(
            f"numerics: {resolution.n_angle} sites of a front are {density:.2g} per short cutoff "
            f"of {name}, with which k comes out too large; use "
            f"{math.ceil(2 * front_length / short_cutoff)} or more, as angles_per_cutoff: 2 does"
        )
    fewest = _FEWEST_SAMPLES[resolution.interpolation]
    if (density := short_cutoff / resolution.spacing) < fewest * (1 - _ROUND_OFF):
        raise ValueError(
            f"numerics: samples_per_cutoff is {density:.3g}, with which {resolution.interpolation} "
            f"pieces miss waves of {name} and k comes out too small; use {fewest:g} or more"
        )


def _check_tolerance_and_error(simulation: Simulation, requested: float | None) -> None:
    """Raise ValueError if the tolerance is of no use, or the requested error cannot be reached."""
    tolerance, n_angle = simulation.solver.tolerance, simulation.resolution.n_angle
    name, elastic_energy = simulation.spectrum_name, simulation.elastic_energy
    round_off = sys.float_info.epsilon * n_angle
    if tolerance < round_off:
        raise ValueError(
            f"numerics: tolerance is {tolerance}, below the round-off of the {n_angle} "
            f"sites of {name} ({round_off:.1e}); raise it"
        )
    if requested is None:
        if tolerance > elastic_energy:
            raise ValueError(
                f"numerics: tolerance is {tolerance:g}, above e_el {elastic_energy:.3g} of {name}, "
                "to which forces of pinning are proportional, so that k comes out too large; use "
                f"{elastic_energy / 10:.1g} or less"
            )
    elif remaining := missed_error(simulation, requested):
        raise ValueError(
            f"numerics: error is {requested:g}, but the finest numerics leave {remaining:.2g} for "
            f"{name} at e_el {elastic_energy:g}; allow that, or give the settings"
        )
