"""Expected against measured processor time of simulations of some configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crackfront.simulate.costs import expected_cost
from crackfront.simulate.run_simulation import run_simulation
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.sweep import Sweep
from studies.law.front_sweeps import front_sweeps
from studies.progress import Progress
from studies.tables import Table, make_table

_CONFIG = Path(__file__).parents[2] / "config"

_CONFIGURATIONS = ("default", "test", "line-quick", "line")
"""Steady branches and full cycles of spheres, and straight fronts."""

_FRONTS_OF_LAW = ("line-strong", "line-chemical")

_LONGEST_SECONDS = 10.0
"""Simulations that are expected to take longer are left out. (Units: s)"""


@dataclass(frozen=True, slots=True)
class MeasuredCost:
    """Expected over measured processor time of one simulation."""

    configuration: str
    ratio: float


def compared_sweeps(folder: Path) -> dict[str, Sweep]:
    """Sweeps whose costs are compared, by name; configurations of the law go into a folder."""
    fronts = front_sweeps(folder)
    sweeps = {name: load_sweep(_CONFIG / f"{name}.yaml") for name in _CONFIGURATIONS}
    return sweeps | {name: fronts[name] for name in _FRONTS_OF_LAW}


def measured_costs(sweeps: Mapping[str, Sweep], progress: Progress) -> list[MeasuredCost]:
    """Costs of the first realisation of each spectrum at its weakest and strongest amplitude."""
    costs = []
    for name, sweep in sweeps.items():
        for item in sweep.spectra:
            for energy in sorted(sweep.elastic_energies)[:: len(sweep.elastic_energies) - 1 or 1]:
                simulation = sweep.simulation(item, energy, 0)
                expected = expected_cost(simulation).seconds
                if expected < _LONGEST_SECONDS:
                    seconds = run_simulation(simulation).measures.cpu_seconds
                    costs.append(MeasuredCost(name, expected / seconds))
                    progress(f"{name}, {simulation.label}: {expected:.3g} of {seconds:.3g} s")
    return costs


def ratio_table(costs: Sequence[MeasuredCost]) -> Table:
    """Least, median and largest ratio of each configuration and of all."""
    ratios = {
        name: [cost.ratio for cost in costs if cost.configuration == name]
        for name in dict.fromkeys(cost.configuration for cost in costs)
    }
    ratios["all"] = [cost.ratio for cost in costs]
    rows = [
        [name, f"{len(values)}", *(f"{find(values):.2f}" for find in (min, np.median, max))]
        for name, values in ratios.items()
    ]
    return make_table("configuration | simulations | least | median | largest", rows)
