"""Hysteresis of straight fronts from collective to individual pinning, beyond w_rms/w_int = 1.

The springs are scaled with the disorder, so that the stiffness c of the line, w_int over w_rms, is
all that changes. At c = 0 every site of the front moves by itself, and its states follow from the
running maximum of the load at which it rests.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.signal import resample

from crackfront.analysis.estimate import Estimate, mean_estimate, with_error
from crackfront.core.adhesion import AdhesionMap, chemical_adhesion
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load, converged_front, follow
from crackfront.core.geometry.line import initial_front, line_field
from crackfront.core.solver.relax import Newton
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import WORK_OF_ADHESION
from studies.canaries import interval_number
from studies.numbers import Number
from studies.tables import Table, make_table

SPRING = 10.0
"""Length of the springs times w_rms / w_int, in short cutoffs."""

SIDE = 128
"""Side of a tile in short cutoffs, at least three times the longest spring."""

PIXELS_PER_CUTOFF = 4

TRANSIENT = 40.0
"""Travel before the average: more than any site lags behind its spring. (Units: short cutoff)"""

STEP = 0.5
"""Load step (Units: short cutoff)."""

TOLERANCE = 1e-6
"""Force left per length of the front, over w_rms."""

SURFACES = 4

DISORDERS = 4.0 ** np.arange(-1, 6)
"""w_rms / w_int."""


def surface(disorder: float, seed: int) -> AdhesionMap:
    """Flat chemical spectrum of a disorder; the short cutoff is the unit of length."""
    spectrum, n_point = SelfAffineSpectrum(1.0, 1.0, 1.0), SIDE * PIXELS_PER_CUTOFF
    noise = gaussian_field(spectrum, n_point, SIDE, np.random.default_rng(seed))
    return chemical_adhesion(noise * disorder / noise.std(), 1 / PIXELS_PER_CUTOFF)


def front_hysteresis(disorder: float, seed: int) -> float:
    """Hysteresis of a front over w_rms: twice the pull of its springs over a period of the tile.

    Approach and retraction are equal in the mean, since the disorder is Gaussian.
    """
    adhesion, spring = surface(disorder, seed), SPRING / disorder
    field = line_field(adhesion, spring, (0.0, TRANSIENT + SIDE), band_limited=True)
    loads = np.arange(0.0, TRANSIENT + SIDE, STEP)
    steps = follow(
        field,
        initial_front(field, adhesion, 0.0),
        (Load(load, 1) for load in loads),
        Newton(TOLERANCE * disorder * WORK_OF_ADHESION),
    )
    lags = np.array([step.load.value - converged_front(step, field).mean() for step in steps])
    return 2 * float(lags[loads >= TRANSIENT].mean()) / (spring * disorder)


def independent_hysteresis(seed: int) -> float:
    """Hysteresis over w_rms of sites that do not pull at each other, from the same rays."""
    adhesion, fine = surface(1.0, seed), 16
    rays = resample(adhesion.work_of_adhesion / WORK_OF_ADHESION, fine * SIDE, axis=0)
    places = np.arange(2 * fine * SIDE)[:, None] / fine
    # A site rests where the load at which it is in equilibrium first reaches the load.
    resting = places - SPRING * (np.tile(rays, (2, 1)) - rays.mean())
    reached = np.maximum.accumulate(resting, axis=0)
    loads = np.arange(TRANSIENT, TRANSIENT + SIDE, STEP)
    lags = [
        loads - places[np.searchsorted(reached[:, ray], loads), 0] for ray in range(rays.shape[1])
    ]
    return 2 * float(np.mean(lags)) / SPRING


def exponent(low: Array, high: Array, ratio: float) -> Estimate[float]:
    """Exponent of the hysteresis between two disorders, a mean over surfaces.

    Both hystereses are over w_rms and share their surfaces; `ratio` is the ratio of the disorders.
    """
    mean, _ = mean_estimate(1 + np.log(high / low) / np.log(ratio))
    return mean.each(float)


def measured_pinning() -> tuple[Table, dict[str, Number]]:
    """Table of all disorders, and the last exponent."""
    seeds = range(SURFACES)
    independent = np.array([independent_hysteresis(seed) for seed in seeds])
    fronts = [np.array([front_hysteresis(s, seed) for seed in seeds]) for s in DISORDERS]
    slopes = [
        exponent(low, high, DISORDERS[1] / DISORDERS[0]) for low, high in itertools.pairwise(fronts)
    ]
    texts = (with_error(slope.value, slope.high - slope.value) for slope in slopes)
    exponents = [["", ""], *(text.split(" ± ") for text in texts)]
    rows = [
        (f"{s:g}", f"{front.mean():.3f}", *cells, f"{np.mean(front / independent):.3f}")
        for s, front, cells in zip(DISORDERS, fronts, exponents, strict=True)
    ]
    header = (
        "w_rms/w_int | hysteresis / w_rms | exponent since the row above | error of the exponent "
        "| hysteresis over independent sites"
    )
    return (
        make_table(header, rows),
        {"exponent of individual pinning": interval_number(slopes[-1])},
    )
