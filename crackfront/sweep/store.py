"""The folder of a sweep: where its files are, how they are made, and how they become one."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from crackfront.analysis.table import SweepRow
from crackfront.data.files import leftover_parts, write_text
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.run import compile_solver
from crackfront.simulate.simulation import Simulation
from crackfront.sweep import parallel
from crackfront.sweep.inventory import Inventory, holdings, inventory
from crackfront.sweep.sweep import Shard, Sweep, shard_fingerprint
from crackfront.sweep.table import write_hysteresis
from crackfront.sweep.tasks import NOT_STORED, STOPPED, Finished, Task, run_task

CHECKPOINT_SECONDS = 60.0
"""Time between checkpoints of a running simulation, where nothing else is asked for."""


@dataclass(frozen=True, slots=True)
class Store:
    """Results of a sweep in a folder.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    """

    folder: Path

    @property
    def configuration(self) -> Path:
        """Configuration with which the folder was filled last."""
        return self.folder / "configuration.yaml"

    def path(self, simulation: Simulation) -> Path:
        """File of a simulation."""
        return self.folder / "curves" / f"{simulation.stem}.nc"

    def manifest(self, shard: Shard) -> Path:
        """File that says that all simulations of a shard are stored."""
        return self.folder / "shards" / f"{shard.name}.json"

    def inventory(self, simulations: Iterable[Simulation]) -> Inventory:
        """What is missing among simulations, and why.

        Parameters
        ----------
        simulations : iterable of Simulation
            Simulations to look for.
        """
        return inventory(self.folder, simulations)

    def fill(
        self,
        simulations: Sequence[Simulation],
        origin: Provenance,
        checkpoint_seconds: float = CHECKPOINT_SECONDS,
    ) -> Iterator[tuple[Simulation, Finished]]:
        """Run simulations, the longest first, and store each as soon as it is finished.

        Parameters
        ----------
        simulations : sequence of Simulation
            What to run.
        origin : Provenance
            What the files say about their origin.
        checkpoint_seconds : float, optional
            Time between checkpoints of a running simulation.

        Yields
        ------
        tuple
            Simulation and how it ended, in the order in which they end. The first that is stopped
            or cannot be stored is the last.

        Raises
        ------
        OSError
            If nothing can be written in the folder, before anything is run.
        """
        for name in ("curves", "journals", "checkpoints"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
            for part in leftover_parts(self.folder / name):
                part.unlink(missing_ok=True)
        write_text(self.configuration, origin.configuration)
        longest_first = sorted(simulations, key=lambda one: -expected_cost(one).seconds)
        tasks = [Task(one, self.folder, origin, checkpoint_seconds) for one in longest_first]
        for solver in {item.solver.name for item in simulations}:
            compile_solver(solver)
        for task, finished in parallel.run_tasks(run_task, tasks):
            yield task.simulation, finished
            if finished.status in (STOPPED, NOT_STORED):
                return

    def write_manifest(self, shard: Shard, simulations: Sequence[Simulation]) -> Path:
        """Write the list of the stored simulations of a shard."""
        content = {
            "spectrum": shard.item.name,
            "fingerprint": shard_fingerprint(simulations),
            "simulations": [
                {"key": one.key, "file": f"curves/{self.path(one).name}"} for one in simulations
            ],
        }
        path = self.manifest(shard)
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
            If simulations are missing or unreadable. The lists of their shards are removed, so
            that the workflow runs them again.
        """
        path = self.folder / "hysteresis.nc"
        return path, dict(write_hysteresis(path, sweep, self._rows(sweep), origin))

    def _rows(self, sweep: Sweep) -> Iterator[SweepRow]:
        """Rows of a whole sweep; where one is missing, all are looked for and none is left."""
        missing: list[Simulation] = []
        for held in holdings(self.folder, sweep.simulations()):
            if held.row is None:
                missing.append(held.simulation)
            elif not missing:
                yield held.row
        if missing:
            self._forget(missing)
            raise ValueError(
                f"{len(missing)} of {sweep.n_simulation} simulations are missing or unreadable in "
                f"{self.folder}, the first is {missing[0].label}; run `crackfront simulate` with "
                "this configuration and output, or `make` again"
            )

    def _forget(self, missing: Sequence[Simulation]) -> None:
        """Remove the lists of shards that lack simulations."""
        keys = {one.key for one in missing}
        for path in (self.folder / "shards").glob("*.json"):
            content = json.loads(path.read_text(encoding="utf-8"))
            if not keys.isdisjoint(entry["key"] for entry in content["simulations"]):
                path.unlink()
