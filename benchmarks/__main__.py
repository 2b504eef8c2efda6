"""Time the solvers against the reference on the registry and write tables and a plot.

python -m benchmarks --group disorder --output results/benchmark
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import numpy as np

from benchmarks.problems import PROBLEMS, Problem
from crackfront.cycle import CycleRecord, LoadSchedule, run_cycle
from crackfront.pinning import PolarField, TileField
from crackfront.provenance import provenance

TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Row:
    """What one problem gave.

    Attributes
    ----------
    group, label, status : str
        The problem, and how its cycle ended.
    n_visit : float
        Sites times samples that the front crosses.
    reference_seconds, newton_seconds : float
        CPU time of the cycle, the least of the repeats. (Units: s)
    reference_pairs, newton_pairs : int
        Pairs of FFTs.
    error : float
        Largest difference of the fronts over all states, relative to the short cutoff.
    memory : float
        Largest resident memory of the process so far. (Units: MB)
    """

    group: str
    label: str
    status: str
    n_visit: float
    reference_seconds: float
    newton_seconds: float
    reference_pairs: int
    newton_pairs: int
    error: float
    memory: float

    @property
    def ratio(self) -> float:
        """How many times faster the fast solver is."""
        return self.reference_seconds / self.newton_seconds


def timed_cycle(
    field: PolarField | TileField, schedule: LoadSchedule, solver: str
) -> tuple[float, CycleRecord]:
    """CPU seconds of a cycle, and its record."""
    start = time.process_time()
    record = run_cycle(field, schedule, tolerance=TOLERANCE, solver=solver, record_fronts=True)
    return time.process_time() - start, record


def measure(problem: Problem, seed: int, repeats: int) -> Row:
    """Run both solvers in turn on one realisation."""
    field = problem.field(seed)
    runs = [
        {solver: timed_cycle(field, problem.schedule, solver) for solver in ("reference", "newton")}
        for _ in range(repeats)
    ]
    reference, newton = runs[0]["reference"][1], runs[0]["newton"][1]
    if reference.radius is None or newton.radius is None or reference.status != newton.status:
        raise RuntimeError(f"{problem.label}: the solvers end with different states")
    travel = 2 * float(reference.max_radius.max())
    spacing = problem.spectrum.short_cutoff / problem.samples_per_cutoff
    return Row(
        group=problem.group,
        label=problem.label,
        status=newton.status.name.lower(),
        n_visit=problem.n_angle * travel / spacing,
        reference_seconds=min(run["reference"][0] for run in runs),
        newton_seconds=min(run["newton"][0] for run in runs),
        reference_pairs=int(reference.iterations.sum()),
        newton_pairs=int(newton.iterations.sum()),
        error=float(np.max(np.abs(newton.radius - reference.radius)))
        / problem.spectrum.short_cutoff,
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def table(rows: Iterable[Row]) -> str:
    """Markdown table of rows."""
    lines = [
        "| problem | reference s | newton s | ratio | FFT pairs | newton ns/visit "
        "| error / lambda_s | MB |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.label} | {row.reference_seconds:.2f} | {row.newton_seconds:.2f} | {row.ratio:.1f} "
        f"| {row.reference_pairs} / {row.newton_pairs} "
        f"| {1e9 * row.newton_seconds / row.n_visit:.0f} | {row.error:.1e} | {row.memory:.0f} |"
        for row in rows
    ]
    return "\n".join(lines)


def exponents(rows: Iterable[Row]) -> str:
    """How the time grows with sites times samples crossed, at every disorder."""
    scaling = [row for row in rows if row.group == "scaling"]
    lines = []
    for disorder in sorted({row.label.split(", ")[1] for row in scaling}):
        chosen = [row for row in scaling if row.label.split(", ")[1] == disorder]
        visits = np.log([row.n_visit for row in chosen])
        grown = {
            solver: np.polyfit(visits, np.log([getattr(row, solver) for row in chosen]), 1)[0]
            for solver in ("reference_seconds", "newton_seconds")
        }
        lines.append(
            f"- {disorder}: reference {grown['reference_seconds']:.2f}, "
            f"newton {grown['newton_seconds']:.2f}"
        )
    return "\n".join(lines)


def processor() -> str:
    """Name of the processor."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text(encoding="utf-8").splitlines() if listed.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def report(rows: list[Row], repeats: int) -> str:
    """The whole page."""
    origin = provenance()
    parts = [
        "# Benchmarks of the solvers",
        "",
        "Made by `make benchmark`. One process, one core; both solvers in turn on the same field,",
        f"tolerance {TOLERANCE:g} w_int, penetration 0 to 1 and back to pull-off; CPU seconds, the",
        f"least of {repeats} runs. A visit is one site and one sample that it crosses. The error",
        "is the largest difference of the fronts over all load steps.",
        "",
        f"Machine: {processor()}, {os.cpu_count()} cores, Python "
        f"{platform.python_version()}; crackfront {origin.crackfront_version}, "
        f"commit {origin.git_commit}.",
    ]
    for group in dict.fromkeys(row.group for row in rows):
        chosen = [row for row in rows if row.group == group]
        parts += ["", f"## {group.capitalize()}", "", table(chosen)]
    if any(row.group == "scaling" for row in rows):
        parts += [
            "",
            "Exponent of the time in sites times samples crossed (least squares of logarithms):",
            "",
            exponents(rows),
        ]
    return "\n".join(parts) + "\n"


def main() -> None:
    """Run the chosen groups."""
    parser = argparse.ArgumentParser(description=__doc__)
    groups = list(dict.fromkeys(problem.group for problem in PROBLEMS))
    parser.add_argument("--group", action="append", choices=groups)
    parser.add_argument("--repeats", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=Path("results/benchmark"))
    chosen = parser.parse_args()
    wanted = chosen.group or [group for group in groups if group != "smoke"]
    for solver in ("reference", "newton"):
        for problem in (PROBLEMS[-1], PROBLEMS[-1].as_tile()):
            timed_cycle(problem.field(0), LoadSchedule(0.0, 1.0), solver)
    rows = []
    for problem in PROBLEMS:
        if problem.group in wanted:
            rows.append(measure(problem, chosen.seed, chosen.repeats))
            click.echo(f"{rows[-1].label}: {rows[-1].ratio:.1f} times, error {rows[-1].error:.1e}")
    chosen.output.mkdir(parents=True, exist_ok=True)
    text = report(rows, chosen.repeats)
    (chosen.output / "benchmark.md").write_text(text, encoding="utf-8")
    rows_as_json = json.dumps([asdict(row) for row in rows], indent=1)
    (chosen.output / "benchmark.json").write_text(rows_as_json + "\n", encoding="utf-8")
    click.echo(text)
    click.echo(f"Results: {chosen.output}/")


if __name__ == "__main__":
    main()
