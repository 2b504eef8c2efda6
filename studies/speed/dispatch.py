"""Time of handing out and storing a simulation: `mpiexec -n 5 python -m studies.speed.dispatch`.

Each rank runs one simulation, and answers all later tasks with its curve and row at once.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import click

from crackfront.cli.sweep_commands import run_missing
from crackfront.sweep import parallel, tasks
from crackfront.sweep.run_sweep import opened

_WARM_UP = 50
"""Simulations before the clock starts, in which every rank runs its own."""


def _answer_from_the_first_run() -> None:
    """Let this rank run a simulation once, and return that result for all others."""
    run = tasks._run
    results: list[Any] = []

    def repeated(task: Any, idle: Any) -> Any:
        if not results:
            results.append(run(task, idle))
        return results[0]

    tasks._run = repeated


def main(folder: Path, configuration: Path, n_simulation: int) -> None:
    """Print the seconds a simulation, on the rank that hands out."""
    _answer_from_the_first_run()
    with parallel.ranks() as workers:
        if workers is None:
            return
        sweep, store, origin = opened(configuration, folder)
        shard = sweep.shards()[0]
        simulations = [*sweep.simulations(shard.item)] * n_simulation
        run_missing(store, [(shard, simulations[:_WARM_UP])], origin, workers)
        started = time.perf_counter()
        run_missing(store, [(shard, simulations[:n_simulation])], origin, workers)
        click.echo((time.perf_counter() - started) / n_simulation)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
