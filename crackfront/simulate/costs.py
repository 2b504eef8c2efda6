"""Expected processor time and memory of simulations, and errors for what no machine can run."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace

from crackfront.core import jkr
from crackfront.core.bounds import LENGTH, PENETRATION, check_within
from crackfront.core.resources import check_memory, check_time
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import Simulation

# Times of 90 simulations on busy cores, times 0.75: an idle machine needs half of them.

_RUN_SECONDS = 2.1e-3
"""Time to set up and evaluate a simulation. (Units: s)"""

_POINT_SECONDS = 3.6e-9
"""Time to make a tile, by Fourier transforms, per n_point log2(n_point). (Units: s)"""

_STATE_SECONDS = 2.5e-4
"""Time of a load step on a front of few sites. (Units: s)"""

_STEP_SECONDS = 2.8e-3
"""Time of a load step of 1000 sites over one correlation length at e_el = 0.02 w_int. (Units: s)"""

_SITE_POWER, _TRAVEL_POWER, _ENERGY_POWER = 1.46, 0.47, 0.06
"""Powers of that time: a longer front, a longer step and disorder need more sweeps."""

_JUMP_SECONDS = 0.4
"""Time to separate the jumps of a load step of 1000 sites that sweeps 100 squared correlation
lengths. (Units: s)"""

_JUMP_SITE_POWER, _JUMP_AREA_POWER = 0.95, 0.62
"""Powers of that time in the sites and in the area: a larger area has more jumps, and each of them
moves fewer of the sites."""

_PROCESS_BYTES = 300e6
"""Memory of a rank after imports and compilation. (Units: bytes)"""

_POINT_BYTES = 32
"""Four tiles while one is made, 8 bytes a point each. (Units: bytes)"""

_SITE_BYTES = 512
"""32 samples around each site, and its splines, while the front moves. (Units: bytes)"""

_STATE_BYTES = 1e3
"""Memory of a recorded state without its front. (Units: bytes)"""

_SAMPLE_SECONDS = 1e-7
"""Time of a sample that a site passes, where the disorder of a field is not known. (Units: s)"""


@dataclass(frozen=True, slots=True)
class Cost:
    """Expected processor time (s) and memory of the process (bytes)."""

    seconds: float
    memory: float
    jump_seconds: float = 0.0
    """Share of the processor time that separates jumps, if they are recorded. (Units: s)"""


def expected_cost(simulation: Simulation) -> Cost:
    """Expected cost of a simulation, the same for all its realisations.

    The time of a sweep is right within a factor of two, on an idle machine and on busy cores;
    `python -m studies speed costs` measures it.
    """
    return _realisation_cost(replace(simulation, realisation=0))


@functools.lru_cache(maxsize=4096)
def _realisation_cost(simulation: Simulation) -> Cost:
    """Cost of every realisation, by the first one."""
    n_state, travel = simulation.schedule.expected_motion(simulation.surface)
    n_site = simulation.resolution.n_angle
    cost = run_cost(
        n_site=n_site,
        n_point=math.prod(simulation.tile[0]),
        n_state=n_state,
        travel=travel,
        elastic_energy=simulation.elastic_energy,
    )
    fronts = 8 * n_site * n_state if simulation.record_fronts else 0.0
    surface = simulation.ensemble.point_seconds * math.prod(simulation.tile[0])
    jumps = 0.0
    if simulation.record_jumps:
        front = simulation.schedule.front_length / simulation.correlation_length
        jumps = n_state * _jump_seconds(n_site, area=front * travel)
    return Cost(cost.seconds + surface + jumps, cost.memory + fronts, jumps)


def _jump_seconds(n_site: float, area: float) -> float:
    """Time to separate the jumps of a load step over an area, in squared correlation lengths."""
    return _JUMP_SECONDS * (n_site / 1000) ** _JUMP_SITE_POWER * (area / 100) ** _JUMP_AREA_POWER


def run_cost(
    *,
    n_site: float,
    n_point: float,
    n_state: float,
    travel: float = 1.0,
    elastic_energy: float = 0.02,
) -> Cost:
    """Cost of making a tile of points and moving a front of sites through its states.

    The front moves so many correlation lengths of w_loc from state to state; e_el in units of
    w_int.
    """
    tile = _POINT_SECONDS * n_point * math.log2(n_point)
    step = _STEP_SECONDS * (n_site / 1000) ** _SITE_POWER * travel**_TRAVEL_POWER
    step *= (elastic_energy / 0.02) ** _ENERGY_POWER
    memory = _PROCESS_BYTES + _POINT_BYTES * n_point + _SITE_BYTES * n_site + _STATE_BYTES * n_state
    return Cost(_RUN_SECONDS + tile + n_state * (_STATE_SECONDS + step), memory)


def affordable_seconds(*, n_angle: float, n_point: float, n_state: float, n_sample: float) -> float:
    """Rough processor time of a cycle on a given field, in seconds.

    The arguments count the sites of the front, the points of the field, the load steps, and the
    samples that each site passes. TooLargeError if time or memory are more than there is.
    """
    cost = run_cost(n_site=n_angle, n_point=n_point, n_state=n_state)
    seconds = cost.seconds + _SAMPLE_SECONDS * n_angle * n_sample
    counts = f"{n_state:.3g} load steps with {n_angle:.3g} sites and {n_sample:.3g} samples a ray"
    check_memory(f"a cycle of {counts}", cost.memory, "take fewer of them")
    check_time(f"a cycle of {counts}", seconds, "take fewer of them")
    return seconds


def check_sizes(
    spectrum: Spectrum, numerics: Numerics, settings: Settings, max_penetration: float
) -> None:
    """Raise if the tile or the front of a sphere is too large for the memory of any machine.

    The settings are what the numerics choose for this spectrum. (Units: reduced lengths)
    """
    lengths = {"short_cutoff": spectrum.short_cutoff, "roll_off": spectrum.longest_feature}
    for name, value in lengths.items():
        check_within(name, value, LENGTH, "reduced lateral lengths")
    check_within("max_penetration", max_penetration, PENETRATION, "reduced vertical lengths")
    cutoff = spectrum.short_cutoff
    points = numerics.tile_side(spectrum) / cutoff * settings.pixels_per_cutoff
    tiles = f"tiles of {points:.2g} x {points:.2g} points"
    remedy = "lower roll_offs, cutoffs or pixels_per_cutoff, or raise short_cutoff"
    check_memory(tiles, _POINT_BYTES * points**2, remedy, anywhere=True)
    circle = 2 * math.pi * jkr.equilibrium_radius(max_penetration)
    sites = settings.angles or circle / cutoff * settings.angles_per_cutoff
    remedy = "lower angles or angles_per_cutoff, or raise short_cutoff"
    check_memory(f"fronts of {sites:.2g} sites", _SITE_BYTES * sites, remedy, anywhere=True)
