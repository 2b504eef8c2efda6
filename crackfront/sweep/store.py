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

from crackfront.analysis.table import SweepRow, SweepTable
from crackfront.data.digests import Integrity, integrity
from crackfront.data.files import (
    UnreadableFileError,
    integrities,
    read_attributes,
    replace_atomically,
    set_aside_damaged,
    write_text,
)
from crackfront.data.provenance import Provenance
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_simulation
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.journal import RowIndex, journal_paths, renew_journals, running, whole_lines
from crackfront.sweep.sweep import Shard, Sweep
from crackfront.sweep.table import (
    COMPLETE,
    SWEEP_FINGERPRINT,
    read_table,
    sweep_row,
    write_hysteresis,
)

SUMS = "SHA256SUMS"
"""File of an archive that lists the checksums of all others."""

_COMPRESSED = {".nc", ".png", ".pdf", ".gif", ".zip"}
"""Files that become no smaller."""


@dataclass(frozen=True, slots=True)
class Holding:
    """What a store has of a simulation: its row, or a sentence where its file is of no use."""

    simulation: Simulation
    row: SweepRow | None
    unreadable: str


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks, and why."""

    missing: tuple[Simulation, ...]
    """What is to be computed."""
    unreadable: tuple[str, ...]
    """A sentence for every file that is of no use."""
    stale: tuple[tuple[str, ...], ...]
    """Of every missing simulation that is stored with another key the parts of it that changed."""

    def stale_sentence(self) -> str:
        """How many are stale for which reason; empty where none is."""
        reasons = sorted(Counter(" and ".join(changed) for changed in self.stale).items())
        listed = ", ".join(f"{count} as {reason} changed" for reason, count in reasons)
        return f"{len(self.stale)} stored simulations are stale: {listed}" if listed else ""


@dataclass(frozen=True, slots=True)
class Progress:
    """How far one spectrum is."""

    name: str
    done: int
    failed: int
    running: int
    waiting: int
    """Simulations with values; rows without; those that a process is at; all others."""
    seconds: float
    """Processor time that is expected for those that are running or waiting. (Units: s)"""


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
        self, simulations: Iterable[Simulation], index: RowIndex | None = None
    ) -> Iterator[Holding]:
        """What is stored of simulations, by the index of the rows or one that is given."""
        curves = {path.name for path in (self.folder / "curves").glob("*.nc")}
        index = index or RowIndex(self.folder)
        for simulation in simulations:
            row, unreadable = index.row(simulation), ""
            # The path has the key in its name, which is slow to compute.
            if row is None and curves and (path := self.path(simulation)).name in curves:
                try:
                    row = sweep_row(read_simulation(path, simulation))
                except UnreadableFileError as error:
                    unreadable = str(error)
            yield Holding(simulation, row, unreadable)

    def inventory(self, simulations: Iterable[Simulation]) -> Inventory:
        """Which of some simulations are missing, and why."""
        index = RowIndex(self.folder)
        absent = [one for one in self.holdings(simulations, index) if one.row is None]
        stale = []
        for simulation in (one.simulation for one in absent):
            known = index.parts(simulation.label)
            now = simulation.parts if known else {}
            stale.append(tuple(name for name, part in now.items() if part != known.get(name)))
        return Inventory(
            missing=tuple(one.simulation for one in absent),
            unreadable=tuple(one.unreadable for one in absent if one.unreadable),
            stale=tuple(filter(None, stale)),
        )

    def progress(self, sweep: Sweep) -> list[Progress]:
        """How far each spectrum of a sweep is, also while it runs elsewhere.

        The expected times are those of the cost model, in proportion to what the stored simulations
        of the sweep took.
        """
        begun = {one.key for one in running(self.journals)}
        index = RowIndex(self.folder, checked=False)
        found, paces = [], []
        for item in sweep.spectra:
            counts, seconds = dict.fromkeys(("done", "failed", "running", "waiting"), 0), 0.0
            for held in self.holdings(sweep.simulations(item), index):
                expected = expected_cost(held.simulation).seconds
                if held.row is None:
                    counts["running" if held.simulation.key in begun else "waiting"] += 1
                    seconds += expected
                    continue
                counts["done" if held.row.status in COMPLETE else "failed"] += 1
                if held.row.cpu_seconds > 0:
                    paces.append(held.row.cpu_seconds / expected)
            found.append(Progress(item.name, **counts, seconds=seconds))
        pace = statistics.median(paces) if paces else 1.0
        return [replace(one, seconds=pace * one.seconds) for one in found]

    def write_manifest(self, sweep: Sweep, shard: Shard) -> Path:
        """Write the file that says that all simulations of a shard are stored."""
        content = {
            "spectrum": shard.item.name,
            "fingerprint": sweep.shard_fingerprint(shard),
            "simulations": [
                {"key": one.key, "file": f"curves/{self.path(one).name}"}
                for one in sweep.simulations(shard.item, shard.realisations)
            ],
        }
        path = self.folder / "shards" / f"{shard.name}.json"
        write_text(path, json.dumps(content, indent=1) + "\n", sealed=True)
        return path

    def table(self, sweep: Sweep) -> SweepTable:
        """Arrays of the file of the whole sweep.

        Raises
        ------
        ValueError
            If the file is missing or damaged, or the table of another configuration.
        """
        self.about(sweep)
        return read_table(self.hysteresis)

    def about(self, sweep: Sweep) -> dict[str, str]:
        """Attributes of the file of the whole sweep; refused as by :meth:`table`."""
        about = read_attributes(self.hysteresis)
        if about.get(SWEEP_FINGERPRINT) != sweep.table_fingerprint:
            raise ValueError(
                f"{self.hysteresis} is the table of another configuration than the one given; run "
                "crackfront simulate and crackfront aggregate with this one, or make"
            )
        return {name: str(value) for name, value in about.items()}

    def renewed(self, sweep: Sweep, configuration: Path) -> Iterator[str]:
        """Set aside what is damaged, and remove lists of what is missing; the workflow renews it.

        Parameters
        ----------
        sweep : Sweep
            What the folder is about.
        configuration : Path
            Its configuration.

        Yields
        ------
        str
            A sentence for every damaged file, and one for all simulations that run again.
        """
        if not self.folder.is_dir():
            return
        yield from set_aside_damaged(self.folder)
        yield from renew_journals(self.journals)
        if any((self.folder / "shards").glob("*.json")):
            if not self.configuration.is_file():
                text = configuration.read_text(encoding="utf-8")
                write_text(self.configuration, text, sealed=True)
            lacking = self.inventory(sweep.simulations())
            yield from (f"{sentence}; it is computed anew" for sentence in lacking.unreadable)
            if count := self._forget(lacking.missing):
                yield f"{self.folder}: {count} list(s) of shards are made anew with what they lack"

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
        """Rows of a whole sweep; raises a ValueError that counts those that are missing."""
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

    def _forget(self, missing: Sequence[Simulation]) -> int:
        """Remove lists of shards that are damaged or name missing simulations; their number."""
        keys, count = {one.key for one in missing}, 0
        for path in (self.folder / "shards").glob("*.json"):
            if integrity(path)[0] is Integrity.WHOLE:
                content = json.loads(path.read_text(encoding="utf-8"))
                if keys.isdisjoint(entry["key"] for entry in content["simulations"]):
                    continue
            path.unlink()
            count += 1
        return count

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
            If the folder holds no file of a sweep, or a file that belongs to the archive is
            damaged.
        """
        if not self.hysteresis.is_file():
            raise ValueError(
                f"{self.folder} holds no hysteresis.nc; run the sweep before it is archived"
            )
        left_out = {"checkpoints"} if curves else {"checkpoints", "curves"}
        found = {
            file: counts[Integrity.DAMAGED]
            for file, counts in checked_files(self.folder)
            if file.relative_to(self.folder).parts[0] not in left_out
            and file.resolve() != path.resolve()
        }
        if damaged := [file for file, n_damaged in found.items() if n_damaged]:
            raise ValueError(
                f"{len(damaged)} files of {self.folder} are damaged, the first is {damaged[0]}; "
                "run make, which makes them anew, before it is archived"
            )

        def write(part: Path) -> None:
            root, sums = Path(self.folder.name), []
            with ZipFile(part, "w") as archive:
                for file in sorted(found):
                    name, content = file.relative_to(self.folder), file.read_bytes()
                    # A clock may have been wrong: ZIP knows no year before 1980.
                    entry = ZipInfo.from_file(file, root / name, strict_timestamps=False)
                    entry.compress_type = ZIP_STORED if file.suffix in _COMPRESSED else ZIP_DEFLATED
                    archive.writestr(entry, content)
                    sums.append(f"{hashlib.sha256(content).hexdigest()}  {name}\n")
                archive.writestr(str(root / SUMS), "".join(sums))

        replace_atomically(path, write)
        return len(found)


def checked_files(folder: Path) -> Iterator[tuple[Path, Counter[Integrity]]]:
    """Files of a folder of results, each counted by whether it, or each line of it, is whole."""
    for path, state in integrities(folder):
        yield path, Counter([state])
    for path in journal_paths(folder / "journals"):
        lines, n_damaged = whole_lines(path)
        yield path, Counter({Integrity.WHOLE: len(lines), Integrity.DAMAGED: n_damaged})
