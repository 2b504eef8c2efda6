r"""Expected time, memory and disk of simulations, from a law of measured runs.

`python -m studies speed costs` measures runs and fits the law, whose coefficients are in
`costs.json`. The processor time is that of any simulation, of making the tile, and of the load
steps,

.. math:: t = t_0 + c_t n_p^2 \log_2 n_p + n_b (t_b + N\, e^{c_0 + c \cdot x}),

with :math:`n_p^2` points of the tile, :math:`n_b` states and :math:`N` sites. :math:`x` are
logarithms of what the sweeps of a load step depend on, and whether the load is a full cycle: steps
into and out of contact take longer than those of the steady branches.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from importlib.resources import files

import numpy as np

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.spectrum import Spectrum
from crackfront.data.bounds import (
    LENGTH,
    PENETRATION,
    refuse_beyond_memory,
    refuse_beyond_time,
    refuse_outside,
)
from crackfront.simulate.laws import Settings
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.simulation import Simulation

_PROCESS_BYTES, _STORE_SECONDS = 300e6, 0.015
"""Memory of a rank after imports and compilation; processor time to store a simulation."""

_TILES, _SITE_BYTES = 4, 512
"""Tiles in memory while one is made, and bytes a site while the front moves (docs/needs.md)."""

_FILE_BYTES, _STATE_BYTES, _FRONT_PART = 30e3, 112.0, 0.72
"""Bytes of a file and its row without states, of a state, and what compression leaves of fronts."""

_RECORD_BYTES = 1e3
"""Memory of a state that is recorded."""


@dataclass(frozen=True, slots=True)
class Features:
    """Sizes and settings that the time of a simulation depends on."""

    n_angle: float
    n_point: float
    """Root of the number of points of the tile."""
    elastic_energy: float
    tolerance: float
    breadth: float
    """Roll-off over short cutoff."""
    travel: float
    """Way of a smooth front from state to state, in correlation lengths."""
    full_cycle: float
    """1 where the load goes from first contact to pull-off, else 0."""
    n_state: float
    """States that it is expected to find."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Expected processor time (s), memory of the rank and disk (bytes) of a simulation."""

    seconds: float
    memory: float
    disk: float


def expected_cost(simulation: Simulation) -> Cost:
    """Expected cost of a simulation on the processor of the measured runs."""
    return _cost(replace(simulation, realisation=0))


@functools.lru_cache(maxsize=4096)
def _cost(simulation: Simulation) -> Cost:
    """Expected cost of every realisation of a simulation."""
    return featured_cost(features(simulation), fronts=simulation.record_fronts)


def featured_cost(item: Features, *, fronts: bool) -> Cost:
    """Expected cost of a run of some features, with its fronts recorded or not."""
    recorded = 8 * item.n_state * item.n_angle if fronts else 0.0
    return Cost(
        seconds=_STORE_SECONDS + float(law_seconds(law_coefficients(), [item])[0]),
        memory=_PROCESS_BYTES
        + 8 * _TILES * item.n_point**2
        + _SITE_BYTES * item.n_angle
        + _RECORD_BYTES * item.n_state
        + recorded,
        disk=_FILE_BYTES + _STATE_BYTES * item.n_state + _FRONT_PART * recorded,
    )


def affordable_seconds(*, n_angle: float, n_point: float, n_state: float, n_sample: float) -> float:
    """Rough processor time of a cycle on a given field, in seconds.

    The numbers are those of the sites of the front, the points of the field, the load steps, and
    the samples that each site passes. TooLargeError if time or memory are more than there is.
    """
    usual = Features(
        n_angle, math.sqrt(n_point), _USUAL_ENERGY, DEFAULT_TOLERANCE, 1.0, 1.0, 1.0, n_state
    )
    cost = featured_cost(usual, fronts=False)
    seconds = cost.seconds + _SAMPLE_SECONDS * n_angle * n_sample
    cycle = f"a cycle of {n_state:.3g} load steps with {n_angle:.3g} sites and"
    what, remedy = f"{cycle} {n_sample:.3g} samples a ray", "take fewer of them"
    refuse_beyond_memory(what, cost.memory, remedy)
    refuse_beyond_time(what, seconds, remedy)
    return seconds


_USUAL_ENERGY, _SAMPLE_SECONDS = 0.05, 1e-7
"""e_el where it is not known (Units: w_int); time of one sample. (Units: s)"""


def refuse_oversized(
    spectrum: Spectrum, numerics: Numerics, settings: Settings, deepest: float
) -> None:
    """Raise if the tile or the front of a sphere is larger than any machine holds.

    The settings are those of the numerics for this spectrum, `deepest` is the largest penetration.
    (Units: reduced lengths)
    """
    lengths = {"short_cutoff": spectrum.short_cutoff, "roll_off": spectrum.longest_feature}
    for name, value in lengths.items():
        refuse_outside(name, value, LENGTH, "reduced lateral lengths")
    refuse_outside("max_penetration", deepest, PENETRATION, "reduced vertical lengths")
    cutoff = spectrum.short_cutoff
    points = numerics.tile_side(spectrum) / cutoff * settings.pixels_per_cutoff
    tiles = f"tiles of {points:.2g} x {points:.2g} points"
    remedy = "lower roll_offs, cutoffs or pixels_per_cutoff, or raise short_cutoff"
    refuse_beyond_memory(tiles, 8 * _TILES * points**2, remedy, anywhere=True)
    circle = 2 * math.pi * jkr.equilibrium_radius(deepest)
    sites = settings.angles or circle / cutoff * settings.angles_per_cutoff
    remedy = "lower angles or angles_per_cutoff, or raise short_cutoff"
    refuse_beyond_memory(f"fronts of {sites:.2g} sites", _SITE_BYTES * sites, remedy, anywhere=True)


def features(simulation: Simulation) -> Features:
    """Features of a simulation."""
    sizes, spectrum, schedule = simulation.resolution, simulation.spectrum, simulation.schedule
    travel, n_state, full_cycle = schedule.expected_motion(simulation.surface)
    return Features(
        n_angle=sizes.n_angle,
        n_point=math.sqrt(math.prod(simulation.tile[0])),
        elastic_energy=simulation.elastic_energy,
        tolerance=simulation.solver.tolerance,
        breadth=spectrum.longest_feature / spectrum.short_cutoff,
        travel=travel,
        full_cycle=full_cycle,
        n_state=n_state,
    )


@functools.cache
def law_coefficients() -> tuple[float, ...]:
    """Coefficients of the law, from `costs.json`: logarithms of t_0, t_b and c_t, c_0, and c."""
    text = files("crackfront.simulate").joinpath("costs.json").read_text(encoding="utf-8")
    return tuple(json.loads(text))


def law_seconds(coefficients: Sequence[float] | Array, items: Sequence[Features]) -> Array:
    """Processor times of runs of some features by the law, in seconds."""
    columns = np.array([astuple(item) for item in items], dtype=float).T
    n_angle, n_point, energy, tolerance, breadth, travel, full_cycle, n_state = columns
    sites, disorder, steady = np.log(n_angle / 1e3), np.log(energy / 0.02), 1 - full_cycle
    terms = np.array(
        [
            sites,
            sites**2,
            disorder,
            disorder**2,
            steady * disorder,
            steady * disorder * sites,
            np.log(tolerance / 1e-4),
            np.log(breadth),
            np.log(travel),
            full_cycle,
        ]
    )
    least, each, point, constant, *exponents = coefficients
    state = n_angle * np.exp(constant + np.array(exponents) @ terms)
    tile = np.exp(point) * n_point**2 * np.log2(n_point)
    return np.asarray(np.exp(least) + tile + n_state * (np.exp(each) + state))
