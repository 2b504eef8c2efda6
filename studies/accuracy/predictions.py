"""Hold predictions against simulations of surfaces that the law of k was not fitted to.

python -m studies.accuracy.predictions

Every surface is scanned: a map is cut from a larger one, written as a file of an instrument, read
and fitted. Beside the k that is predicted for the fit stands that of simulations of it.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from crackfront.core.units import Scales
from crackfront.topography.measures import measured_surface
from crackfront.topography.prediction import Prediction, predicted
from crackfront.topography.reading import read_measurements
from crackfront.topography.simulated import Simulated, prediction_plan, simulated
from studies.accuracy.scans import al3d

SCENE = Scales(radius=1e-3, work_of_adhesion=60e-3, contact_modulus=0.7e6 / 0.75)
REALISATIONS, SEED, N_POINT = 3, 20240229, 128
_PIXELS_PER_CUTOFF = 2.5


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
    """What was predicted for a film, and what simulations found."""

    film: Film
    prediction: Prediction
    found: Simulated


def comparisons() -> Iterator[Comparison]:
    """Predictions and simulations of all films."""
    for film, seed in zip(FILMS, np.random.SeedSequence(SEED).spawn(len(FILMS)), strict=True):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "film.al3d"
            path.write_bytes(_scan(film, np.random.default_rng(seed)))
            surface = measured_surface(read_measurements([path]))
        plan = prediction_plan(surface, SCENE, REALISATIONS, SEED)
        yield Comparison(film, predicted(surface, SCENE), simulated(plan, SCENE))


def _scan(film: Film, rng: np.random.Generator) -> bytes:
    """Content of the file of a film."""
    pixel = film.side / N_POINT
    shape = SelfAffineSpectrum(_PIXELS_PER_CUTOFF * pixel, film.roll_off, film.hurst)
    heights = gaussian_field(shape, 2 * N_POINT, 2 * film.side, rng)[:N_POINT, :N_POINT]
    energy = film.elastic_energy * SCENE.work_of_adhesion
    unit = SCENE.contact_modulus / 4 * shape.mean_square(0.5)
    return al3d(heights * math.sqrt(energy / unit), pixel, "synthetic")


def comparison_row(item: Comparison) -> str:
    """Row of the table."""
    law, found, film = item.prediction, item.found, item.film
    k = law.factors.both
    works = " | ".join(
        f"{1e3 * work.value:.1f}" for work in (law.w_appr, found.w_appr, law.w_retr, found.w_retr)
    )
    return (
        f"| {film.hurst:g} | {1e6 * film.roll_off:g} | {law.e_el.value / law.work_of_adhesion:.3f} "
        f"| {law.correlation_length / law.contact_radius:.4f} | {k.value:.2f} ({k.low:.2f} to "
        f"{k.high:.2f}) | {found.k.value:.2f} ({found.k.low:.2f} to {found.k.high:.2f}) | {works} |"
    )


TABLE_HEAD = (
    "| H | roll-off, um | e_el/w_int | correlation length / contact radius | k predicted | "
    "k simulated | w_appr predicted, mJ/m2 | simulated | w_retr predicted, mJ/m2 | simulated |\n"
    "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
)


def main() -> None:
    """Print the table."""
    click.echo(TABLE_HEAD)
    for item in comparisons():
        click.echo(comparison_row(item))


if __name__ == "__main__":
    main()
