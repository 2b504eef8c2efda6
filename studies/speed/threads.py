"""Relax the paper's finest front on one thread and on several, and compare times and bits.

python -m studies.speed.threads --threads 2
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from crackfront.core import jkr
from crackfront.core.field.fields import Field
from crackfront.core.outcome import Relaxation
from crackfront.core.solver.relax import Newton, relax
from crackfront.core.solver.threads import set_threads
from crackfront.simulate.contact import simulation_field
from crackfront.sweep.configuration import load_configuration

LOADS = (0.0, 0.05)
"""Penetrations, the first from a circle of 0.9 of its smooth radius."""


def main() -> None:
    """Print a row a state."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=2)
    number = parser.parse_args().threads
    simulation = next(load_configuration(Path("config/fig3c.yaml")).simulations())
    field = simulation_field(simulation)
    circle = np.full(field.geometry.n_site, 0.9 * jkr.equilibrium_radius(0.0))
    # The first call compiles.
    _timed(field, circle, 0.0, simulation.solver.tolerance * 1e5)
    click.echo(f"| penetration | FFT pairs | updates / 10^6 | 1 thread s | {number} s | ratio |")
    click.echo("|---|---|---|---|---|---|")
    front = circle
    for load in LOADS:
        set_threads(1)
        one, alone = _timed(field, front, load, simulation.solver.tolerance)
        set_threads(number)
        other, together = _timed(field, front, load, simulation.solver.tolerance)
        if one.front.tobytes() != other.front.tobytes():
            raise click.ClickException(f"fronts at penetration {load} differ")
        click.echo(
            f"| {load} | {one.sweeps} | {one.updates / 1e6:.1f} | {alone:.1f} | {together:.1f} | "
            f"{alone / together:.2f} |"
        )
        front = one.front


def _timed(
    field: Field, front: NDArray[np.float64], load: float, tolerance: float
) -> tuple[Relaxation, float]:
    """Front at rest and seconds on the clock."""
    start = time.perf_counter()
    return relax(front, load, 1, field, Newton(tolerance)), time.perf_counter() - start


if __name__ == "__main__":
    main()
