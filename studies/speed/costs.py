"""What simulations cost: the runs that the cost model is fitted to, and is held against.

Every row of the `costs.csv` beside this is one simulation, run several times unless that takes
long: the least counts, since the speed of a processor varies by a quarter over minutes.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from importlib.resources import files
from itertools import product

import numpy as np
from scipy.optimize import least_squares

from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.costs import Features, features, law_coefficients, law_seconds
from crackfront.simulate.laws import Settings
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run import run_simulation
from crackfront.simulate.simulation import Simulation, simulation_of
from crackfront.simulate.sphere.cycle import FullCycle
from crackfront.simulate.sphere.steady import SteadySchedule

SETTINGS = Settings(None, 2.4, 4, "cubic", 4, 1e-4)
ENERGIES = (0.002, 0.01, 0.05, 0.15)
STEADY = SteadySchedule(start=1.0, max_penetration=1.5, travel=1.5, standard_error=0.1)
CYCLE = FullCycle(1.0, 0.1)

_PASSES, _LONG = 4, 20.0
"""Times that a simulation is run, and seconds from which once is enough."""


@dataclass(frozen=True, slots=True)
class MeasuredRun:
    """A measured run with its states; one that is held out does not enter the fit."""

    name: str
    held_out: bool
    features: Features
    n_state: int
    cpu_seconds: float


def _simulation(
    name: str,
    shape: tuple[float, float, float],
    energy: float,
    schedule: FullCycle | SteadySchedule,
    settings: Settings = SETTINGS,
    cutoffs: float = 200.0,
) -> Simulation:
    """One simulation of a roughness spectrum (short cutoff, roll-off, Hurst exponent)."""
    spectrum, numerics = SelfAffineSpectrum(*shape), Numerics(settings, tile_cutoffs=cutoffs)
    return simulation_of("roughness", spectrum, energy, schedule, numerics, seed=7, name=name)


def fitted_to() -> Iterator[Simulation]:
    """Simulations that the model is fitted to."""
    for cutoff, energy in product((0.04, 0.01, 0.005), ENERGIES):
        yield _simulation("flat", (cutoff, cutoff, 1.0), energy, STEADY)
        yield _simulation("h08", (cutoff, 16 * cutoff, 0.8), energy, STEADY)
    for cutoff, energy in product((0.04, 0.01), ENERGIES):
        yield _simulation("flat", (cutoff, cutoff, 1.0), energy, CYCLE)
        yield _simulation("h03", (cutoff, 20 * cutoff, 0.3), energy, CYCLE)
    for energy in ENERGIES:
        yield _simulation("h08", (0.0025, 0.04, 0.8), energy, STEADY)
    for energy in (0.01, 0.05):
        yield _simulation("flat", (0.00125, 0.00125, 1.0), energy, STEADY)
        yield _simulation("h08", (0.000625, 0.01, 0.8), energy, STEADY)
    for energy in (0.003, 0.15):
        yield _simulation("h03", (0.000625, 0.1, 0.3), energy, STEADY)
    coarser, finer = (replace(SETTINGS, tolerance=tolerance) for tolerance in (1e-3, 1e-6))
    for settings, energy in product((coarser, finer), ENERGIES):
        yield _simulation("flat", (0.02, 0.02, 1.0), energy, STEADY, settings)
    for cutoff, energy in product((0.6, 0.3, 0.15), ENERGIES[1:]):
        for schedule in (CYCLE, replace(CYCLE, step=0.02)):
            yield _simulation("flat", (cutoff, cutoff, 1.0), energy, schedule, cutoffs=20)
    for energy in ENERGIES[1:]:
        yield _simulation("flat", (0.1, 0.1, 1.0), energy, STEADY, cutoffs=40)
        for cutoff in (0.3, 0.04):
            yield _simulation("flat", (cutoff, cutoff, 1.0), energy, CYCLE, finer, cutoffs=20)


def held_out() -> Iterator[Simulation]:
    """Simulations of other spectra, amplitudes, loads and numerics, to hold the model against."""
    finer = replace(SETTINGS, angles_per_cutoff=3.2, tolerance=1e-5)
    longer = replace(STEADY, max_penetration=2.0, travel=2.0)
    for energy in (0.005, 0.03, 0.1):
        yield _simulation("flat", (0.0125, 0.0125, 1.0), energy, STEADY)
        yield _simulation("h03", (0.008, 0.16, 0.3), energy, STEADY)
        yield _simulation("h08", (0.025, 0.2, 0.8), energy, longer, finer)
        yield _simulation("h08", (0.02, 0.32, 0.8), energy, FullCycle(1.0, 0.05))
        yield _simulation("flat", (0.015, 0.015, 1.0), energy, FullCycle(0.5, 0.05), finer)
        yield _simulation("h08", (0.2, 0.8, 0.8), energy, FullCycle(1.0, 0.05), cutoffs=30)
        yield _simulation("flat", (0.4, 0.4, 1.0), energy, FullCycle(2.0, 0.1), finer, 20)
    for energy in (0.02, 0.1):
        yield _simulation("h08", (0.0008, 0.0128, 0.8), energy, STEADY)


def measured(simulation: Simulation, held: bool) -> MeasuredRun:
    """Measured cost of one simulation."""
    result = run_simulation(simulation)
    return MeasuredRun(
        name=simulation.label,
        held_out=held,
        features=features(simulation),
        n_state=result.record.states.penetration.size,
        cpu_seconds=result.measures.cpu_seconds,
    )


def least_of_passes(
    simulations: Iterator[Simulation], held: bool, progress: Callable[[str], None]
) -> list[MeasuredRun]:
    """Measured costs of simulations, each the least of several passes through all of them."""
    least: dict[Simulation, MeasuredRun] = {}
    for one in [*simulations] * _PASSES:
        known = least.get(one)
        if known is not None and known.cpu_seconds > _LONG:
            continue
        run = measured(one, held)
        progress(f"{run.name}: {run.cpu_seconds:.3g} s, {run.n_state} states")
        if known is None or run.cpu_seconds < known.cpu_seconds:
            least[one] = run
    return list(least.values())


def measured_runs() -> list[MeasuredRun]:
    """The runs of the kept `costs.csv`."""
    return table_runs(files("studies.speed").joinpath("costs.csv").read_text(encoding="utf-8"))


def predicted_seconds(runs: Sequence[MeasuredRun]) -> Array:
    """Processor times that the law in use gives for measured runs, in seconds."""
    return law_seconds(law_coefficients(), [run.features for run in runs])


_START = (-7.0, -9.0, -18.0, -12.0, 0.5, *(0.0,) * 9)
"""Coefficients to begin with."""


def fitted_coefficients(runs: Sequence[MeasuredRun]) -> list[float]:
    """Coefficients of the law, to seven digits, of the runs that are not held out."""
    used = [run for run in runs if not run.held_out]
    known = [replace(run.features, n_state=run.n_state) for run in used]
    found = np.log([run.cpu_seconds for run in used])

    def residuals(coefficients: Array) -> Array:
        return np.log(law_seconds(coefficients, known)) - found

    return [float(f"{value:.7g}") for value in least_squares(residuals, _START).x]


def worst_factor(held_out: bool) -> float:
    """Largest factor between times of the law in use and of its table, held out of it or not."""
    runs = [run for run in measured_runs() if run.held_out == held_out]
    ratios = predicted_seconds(runs) / [run.cpu_seconds for run in runs]
    return float(np.max(np.maximum(ratios, 1 / ratios)))


def table(runs: list[MeasuredRun]) -> str:
    """Runs as comma-separated values."""
    names = [item.name for item in fields(Features)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    expected = ["expected_n_state" if name == "n_state" else name for name in names]
    writer.writerow(["name", "held_out", *expected, "n_state", "cpu_seconds"])
    for run in runs:
        values = [f"{float(getattr(run.features, name)):.6g}" for name in names]
        last = [run.n_state, f"{run.cpu_seconds:.4g}"]
        writer.writerow([run.name, int(run.held_out), *values, *last])
    return text.getvalue()


def table_runs(text: str) -> list[MeasuredRun]:
    """Runs of comma-separated values."""
    _, *rows = csv.reader(text.splitlines())
    return [
        MeasuredRun(
            name, held_out == "1", Features(*map(float, known)), int(n_state), float(seconds)
        )
        for name, held_out, *known, n_state, seconds in rows
    ]
