"""Time the solvers against the reference on the registry and write tables and a plot.

python -m studies.speed --group disorder --output results/benchmark
"""

from __future__ import annotations

import argparse
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import click

from crackfront.data.files import write_dataset
from crackfront.data.provenance import provenance
from crackfront.plots.style import save_figure
from studies.speed.problems import PROBLEMS
from studies.speed.solvers import dataset, measure, report, scaling_figure


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
    rows = []
    # A process for each problem, so that its memory is its own.
    for problem in PROBLEMS:
        if problem.group in wanted:
            spawn = multiprocessing.get_context("spawn")
            with ProcessPoolExecutor(1, mp_context=spawn) as fresh:
                rows.append(fresh.submit(measure, problem, chosen.seed, chosen.repeats).result())
            click.echo(f"{rows[-1].label}: {rows[-1].ratio:.1f} times, error {rows[-1].error:.1e}")
    chosen.output.mkdir(parents=True, exist_ok=True)
    text = report(rows, chosen.repeats)
    (chosen.output / "benchmark.md").write_text(text, encoding="utf-8")
    write_dataset(chosen.output / "benchmark.nc", dataset(rows), provenance())
    if "scaling" in wanted:
        save_figure(scaling_figure(rows), chosen.output / "scaling")
    click.echo(text)
    click.echo(f"Results: {chosen.output}/")


if __name__ == "__main__":
    main()
