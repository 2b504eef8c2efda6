"""`crackfront predict`: from measurements of a surface to its adhesion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from crackfront.cli.report import (
    FILE,
    announce_compilation,
    as_json,
    echo_json,
    examples,
    refuse_unwritable,
)
from crackfront.cli.scans import (
    Reading,
    Sphere,
    echo_notes,
    reading_options,
    scene_of,
    sphere_options,
    surface_of,
)

if TYPE_CHECKING:
    from crackfront.core.units import Scales
    from crackfront.topography.measures import Surface
    from crackfront.topography.simulated import Simulated

_RESULTS = Path("results/predict")


@click.command(
    epilog=examples(
        "crackfront predict examples/scans/nanodiamond-detail.al3d --modulus 0.7MPa \\",
        "    --poisson 0.5 --radius 1.25mm --work-of-adhesion 63mJ/m2 --json",
    )
)
@reading_options
@sphere_options(required=True)
@as_json
@click.option(
    "--simulate", is_flag=True, help="Run the simulations that the prediction stands for."
)
@click.option(
    "--realisations",
    type=click.IntRange(min=1),
    default=3,
    show_default=True,
    help="Synthesised surfaces that --simulate runs.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of their noise."
)
@click.option(
    "--figure",
    type=FILE,
    help="Figure, without suffix; PDF and PNG.  [default: results/predict/<first scan>]",
)
def predict(
    reading: Reading,
    sphere: Sphere,
    as_json: bool,
    simulate: bool,
    realisations: int,
    seed: int,
    figure: Path | None,
) -> None:
    """Predict how strongly a soft sphere sticks to a measured surface, from the fitted law.

    SCANS are files of instruments in any format that SurfaceTopography reads, one measurement of
    the surface or several. w = w_int - e_el -+ k e_el with k by the simulations of this project
    (crackfront/factors.csv).
    """
    from crackfront.plots.style import save_figure
    from crackfront.topography.drawing import prediction_figure
    from crackfront.topography.limits import prediction_notes, theory_limits
    from crackfront.topography.machine import machine_readable
    from crackfront.topography.prediction import predicted, surface_factors
    from crackfront.topography.report import prediction_text, simulation_text, surface_text

    scene = scene_of(sphere)
    stem = _RESULTS / reading.scans[0].stem if figure is None else figure
    refuse_unwritable(stem.parent)
    found = surface_of(reading)
    if not as_json:
        click.echo(surface_text(found) + "\n")
    factors = surface_factors(found, scene)
    prediction = predicted(found, scene, factors)
    limits = theory_limits(found, prediction)
    notes = prediction_notes(found, prediction, factors)
    if not as_json:
        click.echo(prediction_text(prediction, limits))
        echo_notes(notes)
    paths = save_figure(prediction_figure(found, prediction), stem)
    outcome = _simulated(found, scene, realisations, seed, as_json) if simulate else None
    if as_json:
        content = machine_readable(found, scene, prediction, factors, limits, notes, outcome)
        echo_json(content)
        return
    for path in paths:
        click.echo(f"figure: {path}")
    if outcome is not None:
        click.echo(simulation_text(outcome))


def _simulated(
    surface: Surface, scene: Scales, realisations: int, seed: int, quiet: bool
) -> Simulated:
    """Run the simulations behind a prediction."""
    from crackfront.topography.simulated import expected_seconds, prediction_simulations, simulated

    simulations = prediction_simulations(surface, scene, realisations, seed)
    if not quiet:
        announce_compilation()
        seconds = expected_seconds(simulations)
        click.echo(f"simulating {realisations} surface(s), about {seconds:.3g} s ...")
    return simulated(simulations, scene)
