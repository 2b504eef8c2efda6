"""One load step of the rough sphere by boundary elements: this minimiser against NuMPI's.

    python -m studies.boundary_elements.minimiser

Both start from the state at b = 0.30 and end at b = 0.31, to the same balance of pressures, at the
disorder of the validation and at that of experiments.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
from NuMPI.Optimization import tr_newton_bounded

from studies.boundary_elements.contact import equilibrium
from studies.boundary_elements.parameters import Case, load_validation, validation_cases

_CONFIGURATION = Path("config/validation.yaml")
_FROM, _TO, _TOLERANCE = 0.30, 0.31, 1e-4

_STRONG = 0.177
"""e_el / w_int of the nanodiamond film of the paper."""


def row(case: Case) -> str:
    """Row of the table for one case."""
    contact = case.contact()
    side = 2 * case.n_point
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
    return (
        f"| {case.n_point} | {case.interaction_range:g} | {case.elastic_energy:g} "
        f"| {ours.products} | {middle - began:.2f} | "
        f"{theirs.nb_hessp} | {end - middle:.2f} | {(end - middle) / (middle - began):.1f} | "
        f"{apart / case.interaction_range:.1g} |"
    )


def main() -> None:
    """Print the table."""
    click.echo(
        "| points | range | e_el | products | s | NuMPI's products | s | faster | apart / range |"
    )
    click.echo("|" + "---|" * 9)
    for case in validation_cases(load_validation(_CONFIGURATION)):
        if case.elastic_energy > 0:
            for energy in (case.elastic_energy, _STRONG):
                click.echo(row(replace(case, elastic_energy=energy)))


if __name__ == "__main__":
    main()
