"""The folder of a sweep: where its files are, what they hold and lack, and how they become one."""

from __future__ import annotations

import hashlib
import json
import statistics
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from crackfront.analysis.table import SweepRow
from crackfront.data.files import UnreadableFileError, replace_atomically, write_text
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.journal import Ledger, running
from crackfront.sweep.sweep import Shard, Sweep, shard_fingerprint
from crackfront.sweep.table import COMPLETE, sweep_row, write_hysteresis

_COMPRESSED = {".nc", ".png", ".pdf", ".gif", ".zip"}
"""Files that become no smaller."""


@dataclass(frozen=True, slots=True)
class Holding:
    """What a store has of a simulation: its row, or a sentence where its file is of no use."""

    simulation: Simulation
    row: SweepRow | None
    unreadable: str = ""


@dataclass(frozen=True, slots=True)
class Stale:
    """Label of a simulation that is stored with another key, and which parts of that changed."""

    label: str
    changed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks, a sentence for every file that is of no use, and what is stale of it."""

    missing: tuple[Simulation, ...]
    unreadable: tuple[str, ...]
    stale: tuple[Stale, ...]

    def stale_sentence(self) -> str:
        """How many are stale for which reason; empty where none is."""
        reasons = Counter(" and ".join(item.changed) for item in self.stale)
        told = ", ".join(
            f"{count} as {reason} changed" for reason, count in sorted(reasons.items())
        )
        return f"{len(self.stale)} stored simulations are stale: {told}" if told else ""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far one spectrum is.

    Attributes
    ----------
    done, failed, running, waiting : int
        Simulations with values; rows without; those that a process is at; all others.
    seconds : float
        Processor time that is expected for those that are running or waiting. (Units: s)
    """

    name: str
    done: int
    failed: int
    running: int
    waiting: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Store:
    """Results of a sweep in a folder."""

    folder: Path

    @property
    def configuration(self) -> Path:
        """Configuration with which the folder was filled last."""
        return self.folder / "configuration.yaml"

    @property
    def journals(self) -> Path:
        """Folder of the journals."""
        return self.folder / "journals"

    @property
    def hysteresis(self) -> Path:
        """File of the whole sweep."""
        return self.folder / "hysteresis.nc"

    def path(self, simulation: Simulation) -> Path:
        """File of a simulation."""
        return self.folder / "curves" / f"{simulation.stem}.nc"

    def checkpoint(self, simulation: Simulation) -> Path:
        """File from which a simulation goes on."""
        return self.folder / "checkpoints" / f"{simulation.stem}.nc"

    def holdings(
        self, simulations: Iterable[Simulation], ledger: Ledger | None = None
    ) -> Iterator[Holding]:
        """What is stored of simulations, by the journals or a ledger that was made of them."""
        for simulation, row in (ledger or Ledger(self.folder)).rows(simulations):
            if row is not None or not self.path(simulation).is_file():
                yield Holding(simulation, row)
                continue
            try:
                result = read_simulation(self.path(simulation), simulation)
                yield Holding(simulation, sweep_row(result))
            except UnreadableFileError as error:
                yield Holding(simulation, None, str(error))

    def inventory(self, simulations: Iterable[Simulation]) -> Inventory:
        """What is missing among simulations, and why."""
        ledger = Ledger(self.folder)
        absent = [one for one in self.holdings(simulations, ledger) if one.row is None]
        missing = tuple(one.simulation for one in absent)
        return Inventory(
            missing,
            unreadable=tuple(one.unreadable for one in absent if one.unreadable),
            stale=tuple(
                Stale(
                    one.label,
                    tuple(name for name, part in one.parts.items() if part != known.get(name)),
                )
                for one in missing
                if (known := ledger.parts(one.label)) is not None
            ),
        )

    def progress(self, sweep: Sweep) -> list[Progress]:
        """How far each spectrum of a sweep is, also while it runs elsewhere.

        The expected times are those of the cost model, in proportion to what the stored simulations
        of the sweep took.
        """
        begun, ledger = {one.key for one in running(self.journals)}, Ledger(self.folder)
        found, paces = [], []
        for item in sweep.spectra:
            counts: Counter[str] = Counter()
            seconds = 0.0
            for held in self.holdings(sweep.simulations(item), ledger):
                expected = expected_cost(held.simulation).seconds
                if held.row is None:
                    counts["running" if held.simulation.key in begun else "waiting"] += 1
                    seconds += expected
                    continue
                counts["done" if held.row.status in COMPLETE else "failed"] += 1
                if held.row.cpu_seconds > 0:
                    paces.append(held.row.cpu_seconds / expected)
            numbers = {name: counts[name] for name in ("done", "failed", "running", "waiting")}
            found.append(Progress(item.name, **numbers, seconds=seconds))
        pace = statistics.median(paces) if paces else 1.0
        return [replace(one, seconds=pace * one.seconds) for one in found]

    def write_manifest(self, shard: Shard, simulations: Sequence[Simulation]) -> Path:
        """Write the file that says that all simulations of a shard are stored."""
        content = {
            "spectrum": shard.item.name,
            "fingerprint": shard_fingerprint(simulations),
            "simulations": [
                {"key": one.key, "file": f"curves/{self.path(one).name}"} for one in simulations
            ],
        }
        path = self.folder / "shards" / f"{shard.name}.json"
        write_text(path, json.dumps(content, indent=1) + "\n")
        return path

    def aggregate(self, sweep: Sweep, origin: Provenance) -> tuple[Path, dict[str, int]]:
        """Write the file of the whole sweep; it, and the number of simulations of every status.

        Raises
        ------
        ValueError
            If simulations are missing or unreadable. The lists of their shards are removed, so
            that the workflow runs them again.
        """
        statuses = write_hysteresis(self.hysteresis, sweep, self._rows(sweep), origin)
        return self.hysteresis, dict(statuses)

    def _rows(self, sweep: Sweep) -> Iterator[SweepRow]:
        """Rows of a whole sweep; where one is missing, all are looked for and none is left."""
        missing: list[Simulation] = []
        for held in self.holdings(sweep.simulations()):
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

    def archive(self, path: Path, *, curves: bool) -> int:
        """Write the files of the sweep and their checksums into a ZIP file; the number of files.

        Checkpoints and what is only half written are left out. Names in the archive begin with that
        of the folder, and the list stands in it too: unpack, go there, `sha256sum --check
        SHA256SUMS`.

        Parameters
        ----------
        path : Path
            The archive.
        curves : bool
            Whether the files of the single simulations belong to it.

        Raises
        ------
        ValueError
            If the folder holds no file of a sweep.
        """
        if not self.hysteresis.is_file():
            raise ValueError(
                f"{self.folder} holds no hysteresis.nc; run the sweep before it is archived"
            )
        left_out = {"checkpoints"} if curves else {"checkpoints", "curves"}
        files = [
            file
            for file in sorted(self.folder.rglob("[!.]*"))
            if file.is_file()
            and not file.is_symlink()
            and file.relative_to(self.folder).parts[0] not in left_out
            and file.resolve() != path.resolve()
        ]

        def write(part: Path) -> None:
            root, sums = Path(self.folder.name), []
            with ZipFile(part, "w") as archive:
                for file in files:
                    name = file.relative_to(self.folder)
                    sums.append(f"{_added(archive, file, str(root / name))}  {name}\n")
                archive.writestr(str(root / "SHA256SUMS"), "".join(sums))

        replace_atomically(path, write)
        return len(files)


def _added(archive: ZipFile, file: Path, name: str) -> str:
    """Checksum of a file that is added to an archive, of just what is added."""
    # A clock may have been wrong: ZIP knows no year before 1980.
    entry = ZipInfo.from_file(file, name, strict_timestamps=False)
    entry.compress_type = ZIP_STORED if file.suffix in _COMPRESSED else ZIP_DEFLATED
    digest = hashlib.sha256()
    with file.open("rb") as source, archive.open(entry, "w") as target:
        while content := source.read(2**20):
            digest.update(content)
            target.write(content)
    return digest.hexdigest()
