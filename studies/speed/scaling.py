"""How a sweep scales: dispatch, the start of a job, what follows, a million simulations on paper.

Dispatch is measured with curves that are stored, on real ranks of MPI. The million simulations are
played through event by event, for 1 to 4096 ranks, with the expected times, their usual scatter and
the speed of this machine, on which dispatch and starts are measured too.
What follows is run on copies of stored rows and curves.
"""

from __future__ import annotations

import contextlib
import heapq
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from crackfront.cli import main
from crackfront.core.arrays import Array
from crackfront.core.resources import peak_memory
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.provenance import Provenance, provenance
from crackfront.simulate.run_simulation import run_simulation
from crackfront.simulate.storage import write_text
from crackfront.sweep.batches import BatchWriter
from crackfront.sweep.curves import FinishedSimulation
from crackfront.sweep.finished_shards import finish_shard
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.requests import shard_request
from crackfront.sweep.rows import row_columns, sweep_row
from crackfront.sweep.shards import write_shard
from crackfront.sweep.store import Store, write_request
from crackfront.sweep.sweep import NamedSpectrum, Shard, Sweep
from studies.speed.machine import in_fresh_process
from studies.tables import Table, make_table

ROOT = Path(__file__).parents[2]
RANKS = tuple(2**power for power in range(13))

SUBMIT_SECONDS = 1.0
"""Time between two submissions of Snakemake. (Units: s)"""

JOBS = ((1000, 16), (250, 32), (160, 32))
"""Shards of a million simulations, and the ranks of a job: fewer where jobs are short."""

REALISATIONS_OF_A_SHARD = 2000
"""Realisations of a shard of a synthetic sweep. Its two amplitudes make shards of 4000 simulations,
250 of a million."""

LATE_COMMANDS = ("plan", "status", "aggregate", "fit")
"""Commands on a stored sweep, in the order of their use."""

_SCATTER = 0.25
"""Rms logarithm of measured over expected time of a simulation."""

_MOST_WITH_CURVES = 10**5
"""Simulations up to which the curves of a synthetic sweep are stored: a million take 60 GB."""


@dataclass(frozen=True, slots=True)
class Played:
    """Hours and efficiency of a sweep on a number of cores, a rank that simulates on each."""

    n_rank: int
    hours: float
    efficiency: float


@dataclass(frozen=True, slots=True)
class Losses:
    """Seconds of the rank that hands out, a task, and of a job before and after its tasks."""

    hand_out: float
    start: float


def job_seconds(tasks: Sequence[float] | Array, n_worker: int, losses: Losses) -> float:
    """Time of a job whose manager hands out tasks, the longest first, to whoever is free."""
    free = [0.0] * n_worker
    manager = end = 0.0
    for seconds in sorted(tasks, reverse=True):
        begun = max(heapq.heappop(free), manager) + losses.hand_out
        manager = begun
        heapq.heappush(free, begun + seconds)
        end = max(end, begun + seconds)
    return losses.start + end


def played(
    shards: Sequence[Array], losses: Losses, job_ranks: int, rank_numbers: Sequence[int] = RANKS
) -> list[Played]:
    """Play a sweep through on numbers of ranks, from the seconds of the tasks of its shards.

    Up to `job_ranks` ranks belong to one job, more to several.
    """
    useful = float(sum(np.sum(shard) for shard in shards))
    sizes = {n_rank: min(n_rank, job_ranks) for n_rank in rank_numbers}
    jobs = {
        size: [job_seconds(shard, size, losses) for shard in shards] for size in set(sizes.values())
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


def slowness() -> float:
    """Measured over expected processor time of one simulation of each spectrum of the default."""
    sweep = load_sweep(ROOT / "config/default.yaml")
    energy = sweep.elastic_energies[-1]
    runs = [sweep.simulation(item, energy, 0) for item in sweep.spectra]
    run_simulation(runs[0])  # compiles, and loads what is compiled
    measured = sum(run_simulation(simulation).measures.cpu_seconds for simulation in runs)
    return measured / sum(expected_cost(simulation).seconds for simulation in runs)


def million(
    slower: float, n_simulation: int = 10**6, n_shard: int = 1000, seed: int = 1
) -> list[Array]:
    """Times of the tasks of a sweep like `config/default.yaml`, shard by shard.

    A time is the expected one, times how much slower the machine is, times a random factor.
    """
    sweep = load_sweep(ROOT / "config/default.yaml")
    rng = np.random.default_rng(seed)
    n_block, n_amplitude = n_shard // len(sweep.spectra), len(sweep.elastic_energies)
    shape = n_simulation // (n_block * len(sweep.spectra) * n_amplitude), n_amplitude
    shards = []
    for item in sweep.spectra:
        expected = [
            slower * expected_cost(sweep.simulation(item, energy, 0)).seconds
            for energy in sweep.elastic_energies
        ]
        shards += [(rng.lognormal(0.0, _SCATTER, shape) * expected).ravel() for _ in range(n_block)]
    return shards


def hand_out_seconds(n_worker: int = 4, n_task: int = 5000) -> float:
    """Time of the rank that hands out, for a simulation of the default sweep that it stores."""
    mpiexec = [str(Path(sys.executable).with_name("mpiexec")), "-n", str(n_worker + 1)]
    with tempfile.TemporaryDirectory() as folder:
        arguments = [folder, str(ROOT / "config/default.yaml"), str(n_task)]
        done = subprocess.run(
            [*mpiexec, sys.executable, "-m", "studies.speed.dispatch", *arguments],
            capture_output=True,
            text=True,
            timeout=250,
            check=True,
            cwd=ROOT,
        )
    return float(done.stdout.split()[-1])


def start_seconds() -> float:
    """Processor time of a job on Slurm without its tasks: two nested Snakemakes, and the command.

    They run twice, and the second time counts: Python has compiled what it imports then.
    """
    with tempfile.TemporaryDirectory() as folder:
        sweep = f"{ROOT}/config/test.yaml"
        plan = ["-m", "snakemake", "--snakefile", f"{ROOT}/Snakefile", "-n", "--cores", "1"]
        plan += ["--directory", folder, "--config", f"sweep={sweep}"]
        simulate = ["-m", "crackfront", "simulate", sweep, "--output", folder]
        for number in range(2):
            before = _seconds_of_children()
            for arguments in (plan, plan, [*simulate, "--realisations", f"{number}-{number}"]):
                subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
    return _seconds_of_children() - before


def _seconds_of_children() -> float:
    """Processor time of all processes that this one has started and waited for (Units: s)."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def synthetic(folder: Path, n_simulation: int, *, curves: bool = True) -> Path:
    """Configuration of a finished sweep, whose realisations have the rows of the first ones.

    Its shards have :data:`REALISATIONS_OF_A_SHARD`. Without `curves` there are only the files of
    rows; nothing else is read of a finished sweep but its example of a loop.
    """
    path = folder / "test.yaml"
    text = (ROOT / "config/test.yaml").read_text(encoding="utf-8")
    path.write_text(text.replace("realisations: 2", f"realisations: {n_simulation // 4}"))
    sweep, rng = load_sweep(path), np.random.default_rng(1)
    store, origin = Store(folder), provenance()
    write_text(store.configuration, path.read_text(encoding="utf-8"))
    firsts = {item.name: _finished(sweep, item, origin) for item in sweep.spectra}
    for shard in sweep.shards(REALISATIONS_OF_A_SHARD):
        shard_firsts = firsts[shard.item.name]
        if curves:
            writer = BatchWriter(store.curve_folder(shard), origin, seconds=60)
            for finished in _repeated(shard_firsts, shard, rng):
                writer.add(finished)
            writer.flush()
            finish_shard(store, sweep, shard, origin)
        else:
            columns = _repeated_rows(shard_firsts, shard, rng)
            write_request(folder, shard_request(sweep, shard))
            shard_path = store.shard_path(shard)
            write_shard(shard_path, sweep, shard, columns, [origin.arithmetic], origin)
    return path


def _repeated(
    firsts: Sequence[FinishedSimulation], shard: Shard, rng: np.random.Generator
) -> Iterator[FinishedSimulation]:
    """Simulations of a shard with the states of the first ones and scattered rows."""
    for first in firsts:
        for number in shard.realisations:
            simulation = replace(first.simulation, realisation=number)
            w_appr = first.row.w_appr * rng.normal(1, 0.01)
            row = replace(first.row, w_appr=w_appr, seed=simulation.seed)
            yield replace(first, simulation=simulation, row=row)


def _finished(sweep: Sweep, item: NamedSpectrum, origin: Provenance) -> list[FinishedSimulation]:
    """The first simulation of each amplitude of a spectrum."""
    results = map(run_simulation, sweep.one_per_amplitude(item))
    return [
        FinishedSimulation(result.simulation, sweep_row(result), result.record, origin.arithmetic)
        for result in results
    ]


def _repeated_rows(
    firsts: Sequence[FinishedSimulation], shard: Shard, rng: np.random.Generator
) -> dict[str, Array]:
    """Columns of a shard, whose realisations have the row of the first one and other values."""
    count = len(shard.realisations)
    rows = row_columns([first.row for first in firsts], (len(firsts),))
    columns = {name: np.repeat(values, count) for name, values in rows.items()}
    return columns | {
        "w_appr": columns["w_appr"] * rng.normal(1, 0.01, len(firsts) * count),
        "seed": rng.integers(2**62, size=len(firsts) * count),
    }


def late(configuration: Path, command: str) -> tuple[float, float]:
    """Processor time and memory of a process for a command on a stored sweep. (Units: s, bytes)."""
    folder = str(configuration.parent)
    whole = command in ("status", "checksums", "verify")
    arguments = [folder] if whole else [str(configuration), "--output", folder]
    main([command, *arguments], standalone_mode=False)
    return time.process_time(), peak_memory()


def planned(configuration: Path) -> tuple[float, float]:
    """Processor time and memory of Snakemake's plan of a stored sweep. (Units: s, bytes)."""
    from snakemake.cli import main as snakemake

    folder = configuration.parents[2]
    settings = [f"sweep={configuration}", f"block={REALISATIONS_OF_A_SHARD}"]
    plan = ["--dry-run", "--cores", "1", "--directory", str(folder)]
    with contextlib.suppress(SystemExit):
        snakemake(["--snakefile", f"{ROOT}/Snakefile", *plan, "--config", *settings])
    return time.process_time(), peak_memory()


def late_table(sizes: Sequence[int]) -> Table:
    """Time and memory of the commands that follow the simulations.

    `sha256sum --check` reads what `verify` reads. The last `plan` sees a sweep one of whose
    shards has all its rows, but lacks its file.
    """
    rows = [row for size in sizes for row in _late_rows(size)]
    return make_table("command | simulations | CPU s | MB", rows)


def _late_rows(n_simulation: int) -> Iterator[list[str]]:
    """Rows of a table for a stored sweep of a size."""
    with_curves = n_simulation <= _MOST_WITH_CURVES
    size = f"{n_simulation}"
    with tempfile.TemporaryDirectory() as above:
        folder = Path(above, "results", "test")
        folder.mkdir(parents=True)
        path = synthetic(folder, n_simulation, curves=with_curves)
        yield ["snakemake -n", size, *_late_cells(in_fresh_process(planned, path))]
        for name in LATE_COMMANDS:
            yield [name, size, *_late_cells(in_fresh_process(late, path, name))]
        if with_curves:
            for name in ("checksums", "verify"):
                yield [name, size, *_late_cells(in_fresh_process(late, path, name))]
            yield ["sha256sum", size, f"{_sum_seconds(folder):.0f}", ""]
            next((folder / "shards").glob("*.nc")).unlink()
            cells = _late_cells(in_fresh_process(late, path, "plan"))
            yield ["plan, a shard left", size, *cells]


def _sum_seconds(folder: Path) -> float:
    """Processor time of `sha256sum --check` in a folder, in seconds."""
    before = _seconds_of_children()
    checked = ["sha256sum", "--quiet", "--check", "SHA256SUMS"]
    subprocess.run(checked, check=True, cwd=folder)
    return _seconds_of_children() - before


def _late_cells(measured: tuple[float, float]) -> list[str]:
    """Measured seconds and megabytes of a command."""
    seconds, peak = measured
    return [f"{seconds:.0f}", f"{peak / 1e6:.0f}"]


def tables() -> dict[str, Table]:
    """Tables, measured and played."""
    losses, slower = Losses(hand_out_seconds(), start_seconds()), slowness()
    return {
        "late": late_table((10**4, 10**5, 10**6)),
        "efficiency": efficiency_table(losses, slower),
    }


def efficiency_table(losses: Losses, slower: float) -> Table:
    """Hours and efficiency of a million simulations, by the size of their shards."""
    sweeps = [million(slower, n_shard=n_shard) for n_shard, _ in JOBS]
    columns = [
        played(shards, losses, job_ranks)
        for shards, (_, job_ranks) in zip(sweeps, JOBS, strict=True)
    ]
    header, rows = "cores", [[f"{n_rank}"] for n_rank in RANKS]
    for (n_shard, job_ranks), column in zip(JOBS, columns, strict=True):
        sweep = f"{n_shard} shards of {job_ranks} ranks"
        header += f" | hours, {sweep} | efficiency %, {sweep}"
        for row, result in zip(rows, column, strict=True):
            row += [f"{result.hours:.3g}", f"{100 * result.efficiency:.1f}"]
    n_simulation = sum(shard.size for shard in sweeps[0])
    useful = sum(float(np.sum(shard)) for shard in sweeps[0]) / 3600
    return make_table(
        header,
        rows,
        "The times are simulated event by event; no sweep of this size was run. "
        f"{n_simulation} simulations of {useful:.0f} core hours; "
        f"{1e3 * losses.hand_out:.2f} ms to hand out and store one, {losses.start:.1f} s to start "
        f"a job. A simulation takes {slower:.2f} times what is expected.",
    )
