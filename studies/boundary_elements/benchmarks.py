"""What the minimiser saves against NuMPI's, and the mapping of rays against the sum over modes."""

from __future__ import annotations

import time

import numpy as np
from NuMPI.Optimization import tr_newton_bounded

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from studies.boundary_elements.cases import Case
from studies.boundary_elements.contact import equilibrium
from studies.boundary_elements.rotated import adhesion_on_rays

MINIMISER = "points | range | e_el | products | s | NuMPI's products | s | faster | apart / range"
ROTATED = "points | short cutoff | modes | ms a ray | us a point | us a point, plain sum"

TILES = (256, 0.2), (512, 0.02), (1024, 0.01)
"""Points along a side and short cutoffs of the tiles whose mapping is timed."""

_FROM, _TO, _TOLERANCE = 0.30, 0.31, 1e-4
_SIDE, _SAMPLES_PER_CUTOFF, _RAYS, _POINTS = 5.12, 8, 48, 16


def minimiser_row(case: Case) -> list[str]:
    """One load step of a case by both minimisers, to the same balance of pressures."""
    contact, side = case.contact(), 2 * case.n_point
    zero = np.zeros((side, side))
    start = equilibrium(contact, zero, _FROM, tolerance=_TOLERANCE, radius=1.0)
    began = time.process_time()
    ours = equilibrium(contact, start.displacement, _TO, tolerance=_TOLERANCE, radius=start.radius)
    middle = time.process_time()
    lowest = np.full((side, side), -np.inf)
    lowest[: case.n_point, : case.n_point] = contact.surface + _TO
    theirs = tr_newton_bounded(
        contact.system.objective(_TO, gradient=True),
        start.displacement.ravel(),
        contact.system.hessian_product_function(_TO),
        jac=True,
        bounds_lo=lowest.ravel(),
        gtol=_TOLERANCE * contact.largest_tension * contact.pixel**2,
        maxiter=1000,
    )
    end = time.process_time()
    apart = float(np.max(np.abs(theirs.x.reshape(side, side) - ours.displacement)))
    times = f"{middle - began:.2f}", f"{end - middle:.2f}"
    return [
        *(f"{case.n_point}", f"{case.interaction_range:g}", f"{case.elastic_energy:g}"),
        *(f"{ours.products}", times[0], f"{theirs.nb_hessp}", times[1]),
        *(f"{(end - middle) / (middle - began):.1f}", f"{apart / case.interaction_range:.1g}"),
    ]


def rotated_row(n_point: int, cutoff: float) -> list[str]:
    """Time of a ray and of a point of it on one tile, and of a point by the plain sum."""
    spectrum = SelfAffineSpectrum(cutoff, cutoff, hurst=1.0).with_elastic_energy(0.03)
    rng = np.random.default_rng(np.random.SeedSequence(1))
    heights = gaussian_field(spectrum, n_point, _SIDE, rng)
    angles = 2 * np.pi * np.arange(_RAYS) / _RAYS
    spacing = cutoff / _SAMPLES_PER_CUTOFF
    n_sample = int(_SIDE / 2 / spacing)
    began = time.process_time()
    adhesion_on_rays(heights, _SIDE / n_point, angles, spacing, n_sample)
    ray = (time.process_time() - began) / _RAYS
    modes = round(np.pi * (_SIDE / cutoff) ** 2 / 2)
    phases, amplitudes = rng.random(modes), rng.random(modes)
    began = time.process_time()
    for radius in range(_POINTS):
        np.sum(amplitudes * np.exp(1j * radius * phases))
    point = (time.process_time() - began) / _POINTS
    found = f"{1e3 * ray:.2f}", f"{1e6 * ray / n_sample:.1f}", f"{1e6 * point:.0f}"
    return [f"{n_point}", f"{cutoff:g}", f"{modes}", *found]
