"""How a sweep scales: efficiency of dispatch, a million simulations on paper, aggregation.

Dispatch is measured with tasks that sleep, on real ranks of MPI. The million simulations are
played through event by event, with the times of the cost model and the recorded deviations from
it, for 1 to 4096 ranks. Aggregation reads as many rows as asked for from synthetic packs.
"""

from __future__ import annotations

import heapq
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from crackfront.core.arrays import Array
from crackfront.data.provenance import provenance
from crackfront.simulate.costs import expected_cost, measured_runs, predicted_seconds
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.journal import Entry
from crackfront.sweep.parallel import default_launcher
from crackfront.sweep.store import Store
from crackfront.sweep.sweep import Sweep
from crackfront.sweep.table import failed_row, row_fingerprint
from studies.pages import markdown_table
from studies.speed.machine import peak_memory, restart_peak

ROOT = Path(__file__).parents[2]
RANKS = tuple(2**power for power in range(13))

HAND_OUT_SECONDS = 0.8e-3
"""Time of the manager for a task."""

START_SECONDS = 15.0
"""From the start of a job to its first task: the nested Snakemake, imports, compiled code."""

SUBMIT_SECONDS = 1.0
"""Between two submissions of Snakemake."""

RANKS_OF_A_JOB = 32


@dataclass(frozen=True, slots=True)
class Played:
    """Hours and efficiency of a sweep on a number of ranks, managers included."""

    n_rank: int
    hours: float
    efficiency: float


def job_seconds(tasks: Sequence[float] | Array, n_worker: int) -> float:
    """Time of a job whose manager hands out tasks, the longest first, to whoever is free."""
    free = [0.0] * n_worker
    manager = end = 0.0
    for seconds in sorted(tasks, reverse=True):
        begun = max(heapq.heappop(free), manager) + HAND_OUT_SECONDS
        manager = begun
        heapq.heappush(free, begun + seconds)
        end = max(end, begun + seconds)
    return START_SECONDS + end


def played(shards: Sequence[Array], rank_numbers: Sequence[int] = RANKS) -> list[Played]:
    """Play a sweep, given as seconds of the tasks of its shards, through on numbers of ranks.

    Up to :data:`RANKS_OF_A_JOB` ranks are those of one job, more those of several.
    """
    useful = float(sum(np.sum(shard) for shard in shards))
    sizes = {n_rank: min(n_rank, RANKS_OF_A_JOB) for n_rank in rank_numbers}
    jobs = {
        size: [job_seconds(shard, max(1, size - 1)) for shard in shards]
        for size in set(sizes.values())
    }
    rows = []
    for n_rank, size in sizes.items():
        free, end = [0.0] * (n_rank // size), 0.0
        for number, seconds in enumerate(sorted(jobs[size], reverse=True)):
            ended = max(heapq.heappop(free), number * SUBMIT_SECONDS) + seconds
            heapq.heappush(free, ended)
            end = max(end, ended)
        rows.append(Played(n_rank, end / 3600, useful / (n_rank * end)))
    return rows


def million(n_simulation: int = 10**6, n_shard: int = 1000, seed: int = 1) -> list[Array]:
    """Times of the tasks of a sweep like that of `config/default.yaml`, shard by shard.

    A time is what the cost model expects, times measured over expected time of one of the runs
    that were recorded for the model, drawn anew for every task.
    """
    sweep = load_configuration(ROOT / "config/default.yaml")
    rng = np.random.default_rng(seed)
    runs = measured_runs()
    recorded = [run.cpu_seconds for run in runs] / predicted_seconds(runs)
    n_block = n_shard // len(sweep.spectra)
    n_amplitude = len(sweep.elastic_energies)
    n_realisation = n_simulation // (len(sweep.spectra) * n_block * n_amplitude)
    shards = []
    for item in sweep.spectra:
        expected = [
            expected_cost(sweep.simulation(item, energy, 0)).seconds
            for energy in sweep.elastic_energies
        ]
        for _ in range(n_block):
            factors = rng.choice(recorded, (n_realisation, n_amplitude))
            shards.append((factors * expected).ravel())
    return shards


def dispatch_efficiency(n_worker: int, n_round: int, seconds: float = 0.5) -> float:
    """Useful over worker seconds of tasks that sleep, on so many ranks and one that hands out."""
    script = (
        "import time\n"
        "from crackfront.sweep import parallel\n"
        f"n_worker, tasks = {n_worker}, [{seconds}] * {n_worker * n_round}\n"
        "for given in ([0.0] * n_worker, tasks):\n"
        "    started = time.perf_counter()\n"
        "    if parallel.is_manager(n_worker):\n"
        "        list(parallel.run_tasks(time.sleep, given, lambda task, _: task))\n"
        "    else:\n"
        "        parallel.serve_tasks('time')\n"
        "if parallel.is_manager(n_worker):\n"
        "    print(sum(tasks) / (n_worker * (time.perf_counter() - started)))\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "dispatch.py"
        path.write_text(script)
        mpi = [*default_launcher().split(), "-n", str(n_worker + 1), sys.executable, "-m", "mpi4py"]
        done = subprocess.run(
            [*mpi, str(path)], capture_output=True, text=True, timeout=250, check=True
        )
    return float(done.stdout)


def synthetic(folder: Path, n_simulation: int) -> Sweep:
    """A sweep whose simulations have all ended without a value, a pack a spectrum."""
    sweep = load_configuration(ROOT / "config/test.yaml")
    sweep = replace(sweep, n_realisation=n_simulation // 4, failed_fraction=1.0)
    with Store(folder).packs(sweep.simulations()) as packs:
        for number, one in enumerate(sweep.simulations()):
            row = failed_row(one, "step_limit", "the solver reached its limit of sweeps")
            row = replace(row, seconds=0.1 * number, n_step=number % 60)
            entry = Entry(one.stem, one.parts, row_fingerprint(), row)
            packs[one.spectrum_name].append(entry.files())
    return sweep


def aggregation(n_simulation: int) -> tuple[float, float]:
    """Wall time and largest memory of aggregating synthetic rows. (Units: s, bytes)."""
    # In memory, so that writing them costs no time.
    with tempfile.TemporaryDirectory(dir="/dev/shm") as folder:
        sweep = synthetic(Path(folder), n_simulation)
        restart_peak()
        started = time.perf_counter()
        Store(Path(folder)).aggregate(sweep, provenance())
        seconds = time.perf_counter() - started
    return seconds, 1e6 * peak_memory()


def sections() -> list[str]:
    """Paragraphs of the page, measured and played."""
    measured = [
        f"Dispatch of 0.5 s to {n_worker} workers: {dispatch_efficiency(n_worker, 20):.1%}."
        for n_worker in (2, 32)
    ]
    for n_row in (10**5, 10**6):
        seconds, peak = aggregation(n_row)
        measured.append(f"Aggregation of {n_row} rows: {seconds:.1f} s, {peak / 1e6:.0f} MB.")
    sweeps = [million(n_shard=n_shard) for n_shard in (1000, 250)]
    useful = sum(float(np.sum(shard)) for shard in sweeps[0]) / 3600
    header = " | ".join(
        ["ranks", *(f"hours, {len(shards)} shards | efficiency" for shards in sweeps)]
    )
    cells = [
        [f"{rows[0].n_rank}"]
        + [text for row in rows for text in (f"{row.hours:.3g}", f"{row.efficiency:.1%}")]
        for rows in zip(*map(played, sweeps), strict=True)
    ]
    return [
        "\n".join(measured),
        f"{sum(map(len, sweeps[0]))} simulations of {useful:.0f} core hours:",
        markdown_table(header, cells),
    ]
