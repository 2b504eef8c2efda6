"""Compare predictions with simulations of surfaces that the law of k was not fitted to.

Every surface is scanned: a map is cut from a larger one, written as a file of an instrument, read
and fitted. The k that is predicted for the fit is compared with simulations of the fit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import Scales
from crackfront.measured.prediction.prediction import Prediction, predicted
from crackfront.measured.prediction.simulated_prediction import (
    Simulated,
    prediction_plan,
    simulated,
)
from crackfront.measured.spectrum.measured_surface import MeasuredSurface
from studies.accuracy.scans import scanned
from studies.tables import Table, interval_cells, interval_header, make_table

SCENE = Scales(radius=1e-3, work_of_adhesion=60e-3, contact_modulus=0.7e6 / 0.75)
REALISATIONS = 5
"""Simulated surfaces of a film."""

SEED = 20240229
"""Seed of all films."""

N_POINT = 128
"""Points along a side of a scan."""

_PIXELS_PER_CUTOFF = 2.5
"""Pixels of a scan in the short cutoff of its surface."""


@dataclass(frozen=True, slots=True)
class Film:
    """A surface to scan: Hurst exponent, roll-off and side of the scan in metres, e_el / w_int."""

    hurst: float
    roll_off: float
    side: float
    elastic_energy: float


FILMS = (
    Film(hurst=1.0, roll_off=2e-6, side=20e-6, elastic_energy=0.03),
    Film(hurst=0.5, roll_off=4e-6, side=40e-6, elastic_energy=0.1),
    Film(hurst=0.8, roll_off=1e-6, side=12e-6, elastic_energy=0.3),
    Film(hurst=0.3, roll_off=3e-6, side=25e-6, elastic_energy=0.05),
    Film(hurst=0.6, roll_off=2e-6, side=16e-6, elastic_energy=0.01),
)


@dataclass(frozen=True, slots=True)
class Comparison:
    """Prediction for a film, and simulations of it."""

    film: Film
    prediction: Prediction
    simulations: Simulated


def comparisons() -> Iterator[Comparison]:
    """Predictions and simulations of all films."""
    for film, seed in zip(FILMS, np.random.SeedSequence(SEED).spawn(len(FILMS)), strict=True):
        surface = _scanned(film, np.random.default_rng(seed))
        plan = prediction_plan(surface, SCENE, REALISATIONS, SEED)
        yield Comparison(film, predicted(surface, SCENE), simulated(plan, SCENE))


def _scanned(film: Film, rng: np.random.Generator) -> MeasuredSurface:
    """Scan of a film, cut from a surface of twice its side."""
    pixel = film.side / N_POINT
    shape = SelfAffineSpectrum(_PIXELS_PER_CUTOFF * pixel, film.roll_off, film.hurst)
    heights = gaussian_field(shape, 2 * N_POINT, 2 * film.side, rng)[:N_POINT, :N_POINT]
    energy = film.elastic_energy * SCENE.work_of_adhesion
    unit = SCENE.contact_modulus / 4 * shape.mean_square(0.5)
    return scanned(heights * math.sqrt(energy / unit), pixel, "synthetic")


def comparison_table(items: Iterable[Comparison]) -> Table:
    """Numbers of the front, predicted and simulated, a film a row."""
    rows = []
    for film, law, simulations in (
        (item.film, item.prediction, item.simulations) for item in items
    ):
        rows.append(
            (
                f"{film.hurst:g}",
                f"{1e6 * film.roll_off:g}",
                f"{law.e_el.value / law.work_of_adhesion:.3f}",
                f"{law.correlation_length / law.contact_radius:.4f}",
                *interval_cells(law.k),
                *interval_cells(simulations.k),
                *interval_cells(law.front_hysteresis.each(lambda work: 1e3 * work)),
                *interval_cells(simulations.hysteresis.each(lambda work: 1e3 * work)),
            )
        )
    columns = [
        f"{quantity} {origin}"
        for quantity in ("k", "hysteresis mJ/m2")
        for origin in ("predicted", "simulated")
    ]
    return make_table(
        "H | roll-off um | e_el/w_int | correlation length / contact radius | "
        f"{' | '.join(map(interval_header, columns))}",
        rows,
        "The hysteresis is that of the front, without boundary elements.",
    )
