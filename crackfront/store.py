"""The store of a sweep: one file for every finished simulation, and the run that fills it."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from crackfront import parallel
from crackfront.dataset import (
    UnreadableFileError,
    read_simulation,
    write_hysteresis,
    write_simulation,
    write_text,
)
from crackfront.provenance import Provenance
from crackfront.scene import Simulation, SimulationResult, compile_solver, run_simulation
from crackfront.sweep import NamedSpectrum, Sweep, shard_fingerprint


@dataclass(frozen=True, slots=True)
class Task:
    """A simulation, the file that it becomes and what that file says about its origin."""

    simulation: Simulation
    path: Path
    origin: Provenance


@dataclass(frozen=True, slots=True)
class Finished:
    """How a task ended.

    Attributes
    ----------
    status : str
        Status of the cycle, empty where an error prevented one.
    seconds : float
        Wall time.
    error : str
        Sentence of the error, or empty.
    """

    status: str
    seconds: float
    error: str


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks.

    Attributes
    ----------
    missing : tuple of Simulation
        Simulations without a complete file.
    unreadable : tuple of str
        A sentence for every file that is there and of no use.
    """

    missing: tuple[Simulation, ...]
    unreadable: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Store:
    """Results of a sweep in a folder.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    """

    folder: Path

    def path(self, simulation: Simulation) -> Path:
        """File of a simulation."""
        return self.folder / "curves" / f"{simulation.stem}.nc"

    def manifest(self, item: NamedSpectrum) -> Path:
        """File that says that all simulations of a spectrum are stored."""
        return self.folder / "shards" / f"{item.name}.json"

    def inventory(self, simulations: Iterable[Simulation]) -> Inventory:
        """What is missing among simulations; every file that is there is read.

        Parameters
        ----------
        simulations : iterable of Simulation
            Simulations to look for.
        """
        missing, unreadable = [], []
        for simulation in simulations:
            path = self.path(simulation)
            if path.exists():
                try:
                    read_simulation(path, simulation)
                    continue
                except UnreadableFileError as error:
                    unreadable.append(str(error))
            missing.append(simulation)
        return Inventory(tuple(missing), tuple(unreadable))

    def fill(
        self, simulations: Sequence[Simulation], origin: Provenance
    ) -> Iterator[tuple[Simulation, Finished]]:
        """Run simulations, the longest first, and store each as soon as it is finished.

        Parameters
        ----------
        simulations : sequence of Simulation
            What to run.
        origin : Provenance
            What the files say about their origin.

        Yields
        ------
        tuple
            Simulation and how it ended, in the order in which they end.

        Raises
        ------
        OSError
            If nothing can be written in the folder, before anything is run.
        """
        curves = self.folder / "curves"
        curves.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=curves):
            pass
        longest_first = sorted(simulations, key=lambda item: item.expected_cost, reverse=True)
        tasks = [Task(item, self.path(item), origin) for item in longest_first]
        for solver in {item.solver for item in simulations}:
            compile_solver(solver)
        for task, finished in parallel.run_tasks(run_task, tasks):
            yield task.simulation, finished

    def write_manifest(self, item: NamedSpectrum, shard: tuple[Simulation, ...]) -> Path:
        """Write the list of the stored simulations of a spectrum."""
        content = {
            "spectrum": item.name,
            "fingerprint": shard_fingerprint(shard),
            "simulations": [
                {"key": one.key, "file": f"curves/{self.path(one).name}"} for one in shard
            ],
        }
        path = self.manifest(item)
        write_text(path, json.dumps(content, indent=1) + "\n")
        return path

    def aggregate(self, sweep: Sweep, origin: Provenance) -> tuple[Path, dict[str, int]]:
        """Write the file of the whole sweep.

        Parameters
        ----------
        sweep : Sweep
            Parameters of the sweep.
        origin : Provenance
            What the file says about its origin.

        Returns
        -------
        tuple
            The file, and the number of simulations of every status.

        Raises
        ------
        ValueError
            If simulations are missing or unreadable. The lists of their spectra are removed, so
            that the workflow runs them again.
        """
        shards = {item: sweep.shard(item) for item in sweep.spectra}
        lacking = {item: self.inventory(shard).missing for item, shard in shards.items()}
        missing = [simulation for shard in lacking.values() for simulation in shard]
        if missing:
            for item in sweep.spectra:
                if lacking[item]:
                    self.manifest(item).unlink(missing_ok=True)
            raise ValueError(
                f"{len(missing)} of {sum(map(len, shards.values()))} simulations are missing or "
                f"unreadable in {self.folder}, the first is {missing[0].label}; run `crackfront "
                "simulate` with this configuration and output, or `make` again"
            )

        def result_of(item: NamedSpectrum, energy: float, realisation: int) -> SimulationResult:
            simulation = sweep.simulation(item, energy, realisation)
            return read_simulation(self.path(simulation), simulation)

        path = self.folder / "hysteresis.nc"
        return path, dict(write_hysteresis(path, sweep, result_of, origin))


def run_task(task: Task) -> Finished:
    """Run one simulation and store its result; what prevents that is a sentence."""
    try:
        result = run_simulation(task.simulation)
        write_simulation(task.path, result, task.origin)
    except (ValueError, OSError, MemoryError, ArithmeticError, RuntimeError) as error:
        return Finished("", 0.0, str(error) or type(error).__name__)
    return Finished(result.record.status.name.lower(), result.seconds, "")
