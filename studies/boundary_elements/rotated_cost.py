"""Cost of the mapping whose crack turns with the angle, against the sum over all modes.

    python -m studies.boundary_elements.rotated_cost

One row for every tile: time of a ray and of a point of it, and of a point by the plain sum.
"""

from __future__ import annotations

import time

import click
import numpy as np

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from studies.boundary_elements.rotated import adhesion_on_rays

_SIDE, _SAMPLES_PER_CUTOFF = 5.12, 8
_TILES = ((256, 0.2), (512, 0.02), (1024, 0.01))
_RAYS, _POINTS = 48, 16


def row(n_point: int, cutoff: float) -> str:
    """Row of the table for one tile."""
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
    return (
        f"| {n_point} | {cutoff:g} | {modes} | {1e3 * ray:.2f} | {1e6 * ray / n_sample:.1f} | "
        f"{1e6 * point:.0f} |"
    )


def main() -> None:
    """Print the table."""
    click.echo("| points | short cutoff | modes | ms a ray | us a point | us a point, plain sum |")
    click.echo("|---|---|---|---|---|---|")
    for n_point, cutoff in _TILES:
        click.echo(row(n_point, cutoff))


if __name__ == "__main__":
    main()
