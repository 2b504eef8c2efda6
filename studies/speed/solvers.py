"""Both solvers on the problems of the registry: times, memory, and how much the fronts differ."""

from __future__ import annotations

import resource
import time
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import RayField, TileField
from crackfront.core.solver.relax import SOLVERS
from crackfront.plots.style import BLUE, COLUMN, VERMILION, blank_figure, house_style
from studies.speed.machine import described_machine
from studies.speed.problems import Problem

TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Row:
    """What one problem gave.

    Attributes
    ----------
    group, label, status : str
        The problem, and how its cycle ended.
    n_cutoff : float
        Sites times short cutoffs that the front crosses.
    reference_seconds, newton_seconds : float
        CPU time of the cycle, the least of the repeats. (Units: s)
    reference_pairs, newton_pairs : int
        Pairs of FFTs.
    reference_updates, newton_updates : int
        Updates of single sites.
    error : float
        Largest difference of the fronts over all states, relative to the short cutoff.
    memory : float
        Largest resident memory of the problem's process. (Units: MB)
    """

    group: str
    label: str
    status: str
    n_cutoff: float
    reference_seconds: float
    newton_seconds: float
    reference_pairs: int
    newton_pairs: int
    reference_updates: int
    newton_updates: int
    error: float
    memory: float

    @property
    def ratio(self) -> float:
        """How many times faster the fast solver is."""
        return self.reference_seconds / self.newton_seconds


def timed_cycle(
    field: RayField | TileField, schedule: LoadSchedule, solver: str
) -> tuple[float, CycleRecord]:
    """CPU seconds of a cycle, and its record."""
    start = time.process_time()
    record = run_cycle(field, schedule, SOLVERS[solver](TOLERANCE), Recorder(fronts=True))
    return time.process_time() - start, record


def measure(problem: Problem, seed: int, repeats: int) -> Row:
    """Run both solvers in turn on one realisation."""
    for solver in ("reference", "newton"):
        timed_cycle(problem.smallest().field(0), LoadSchedule(0.0, 1.0), solver)
    field = problem.field(seed)
    runs = [
        {solver: timed_cycle(field, problem.schedule, solver) for solver in ("reference", "newton")}
        for _ in range(repeats)
    ]
    reference, newton = runs[0]["reference"][1], runs[0]["newton"][1]
    if reference.fronts is None or newton.fronts is None or reference.status != newton.status:
        raise RuntimeError(f"{problem.label}: the solvers end with different states")
    travel = 2 * float(reference.states.max_radius.max())
    return Row(
        group=problem.group,
        label=problem.label,
        status=newton.status.name.lower(),
        n_cutoff=problem.n_angle * travel / problem.spectrum.short_cutoff,
        reference_seconds=min(run["reference"][0] for run in runs),
        newton_seconds=min(run["newton"][0] for run in runs),
        reference_pairs=int(reference.states.iterations.sum()),
        newton_pairs=int(newton.states.iterations.sum()),
        reference_updates=int(reference.states.updates.sum()),
        newton_updates=int(newton.states.updates.sum()),
        error=float(np.max(np.abs(newton.fronts - reference.fronts)))
        / problem.spectrum.short_cutoff,
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def table(rows: Iterable[Row]) -> str:
    """Markdown table of rows."""
    lines = [
        "| problem | reference s | newton s | ratio | FFT pairs | updates a site and cutoff "
        "| newton us a site and cutoff | error / lambda_s | MB |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.label} | {row.reference_seconds:.2f} | {row.newton_seconds:.2f} | {row.ratio:.1f} "
        f"| {row.reference_pairs} / {row.newton_pairs} "
        f"| {row.reference_updates / row.n_cutoff:.1f} / {row.newton_updates / row.n_cutoff:.1f} "
        f"| {1e6 * row.newton_seconds / row.n_cutoff:.2f} | {row.error:.1e} | {row.memory:.0f} |"
        for row in rows
    ]
    return "\n".join(lines)


def exponents(rows: Iterable[Row]) -> str:
    """How the time grows with sites times cutoffs crossed, at every disorder."""
    scaling = [row for row in rows if row.group == "scaling"]
    lines = []
    for disorder in sorted({row.label.split(", ")[1] for row in scaling}):
        chosen = [row for row in scaling if row.label.split(", ")[1] == disorder]
        crossed = np.log([row.n_cutoff for row in chosen])
        grown = {
            solver: np.polyfit(crossed, np.log([getattr(row, solver) for row in chosen]), 1)[0]
            for solver in ("reference_seconds", "newton_seconds")
        }
        lines.append(
            f"- {disorder}: reference {grown['reference_seconds']:.2f}, "
            f"newton {grown['newton_seconds']:.2f}"
        )
    return "\n".join(lines)


def scaling_figure(rows: Iterable[Row]) -> Figure:
    """Time of both solvers against sites times cutoffs crossed."""
    scaling = [row for row in rows if row.group == "scaling"]
    disorders = sorted({row.label.split(", ")[1] for row in scaling})
    with house_style():
        figure = blank_figure(COLUMN, 0.85 * COLUMN)
        axes = figure.add_subplot()
        for disorder, colour in zip(disorders, (BLUE, VERMILION), strict=True):
            strength = rf"$w_\mathrm{{rms}} = {disorder.split()[1]}\,w_\mathrm{{int}}$"
            chosen = [row for row in scaling if row.label.split(", ")[1] == disorder]
            crossed = np.array([row.n_cutoff for row in chosen])
            for solver, marker, dashes in (("reference", "s", (3, 2)), ("newton", "o", (1, 0))):
                seconds = np.array([getattr(row, f"{solver}_seconds") for row in chosen])
                axes.plot(
                    crossed,
                    seconds,
                    color=colour,
                    marker=marker,
                    markersize=4,
                    dashes=dashes,
                    linewidth=0.8,
                    label=f"{solver}, {strength}",
                )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("sites times short cutoffs crossed")
        axes.set_ylabel("CPU time of a cycle / s")
        axes.legend(loc="upper left")
        return figure


def dataset(rows: list[Row]) -> xr.Dataset:
    """All rows on one dimension."""
    meanings = {
        "group": ("1", "table of the problem"),
        "label": ("1", "problem"),
        "status": ("1", "how its cycle ended"),
        "n_cutoff": ("1", "sites times short cutoffs crossed"),
        "reference_seconds": ("s", "CPU time of the reference"),
        "newton_seconds": ("s", "CPU time of the fast solver"),
        "reference_pairs": ("1", "pairs of FFTs of the reference"),
        "newton_pairs": ("1", "pairs of FFTs of the fast solver"),
        "reference_updates": ("1", "updates of single sites of the reference"),
        "newton_updates": ("1", "updates of single sites of the fast solver"),
        "error": ("short cutoff", "largest difference of the fronts"),
        "memory": ("MB", "largest resident memory of the problem's process"),
    }
    return xr.Dataset(
        {
            name: (
                "problem",
                np.array([getattr(row, name) for row in rows]),
                {"units": units, "long_name": meaning},
            )
            for name, (units, meaning) in meanings.items()
        }
    )


def report(rows: list[Row], repeats: int) -> str:
    """The whole page."""
    parts = [
        "# Benchmarks of the solvers",
        "",
        "Made by `make benchmark`. One process, one core; both solvers in turn on the same field,",
        f"tolerance {TOLERANCE:g} w_int, penetration 0 to 1 and back to pull-off; CPU seconds, the",
        f"least of {repeats} runs. The error is the largest difference of the fronts over all load",
        "steps.",
        "",
        described_machine(),
    ]
    for group in dict.fromkeys(row.group for row in rows):
        chosen = [row for row in rows if row.group == group]
        parts += ["", f"## {group.capitalize()}", "", table(chosen)]
    if any(row.group == "scaling" for row in rows):
        parts += [
            "",
            "Exponent of the time in sites times cutoffs crossed (least squares of logarithms):",
            "",
            exponents(rows),
        ]
    return "\n".join(parts) + "\n"
