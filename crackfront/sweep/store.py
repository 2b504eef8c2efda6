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
from crackfront.sweep.journal import RowIndex, journal_paths, line_counts, renew_journals, running
from crackfront.sweep.sweep import Shard, Sweep, shard_fingerprint
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
    unreadable: str = ""


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks, and why.

    Attributes
    ----------
    missing : tuple of Simulation
        What is to be computed.
    unreadable : tuple of str
        A sentence for every file that is of no use.
    stale : tuple of tuple of str
        Of every missing simulation that is stored with another key the parts of it that changed.
    """

    missing: tuple[Simulation, ...]
    unreadable: tuple[str, ...]
    stale: tuple[tuple[str, ...], ...]

    def stale_sentence(self) -> str:
        """How many are stale for which reason; empty where none is."""
        reasons = sorted(Counter(" and ".join(changed) for changed in self.stale).items())
        listed = ", ".join(f"{count} as {reason} changed" for reason, count in reasons)
        return f"{len(self.stale)} stored simulations are stale: {listed}" if listed else ""


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


class _Curves:
    """Files of simulations by their names without the keys, which are slow to compute."""

    def __init__(self, folder: Path) -> None:
        self._names = {path.stem.rpartition("-")[0] for path in folder.glob("*.nc")}
        self._beginnings: dict[tuple[str, float], str] = {}

    def __contains__(self, simulation: Simulation) -> bool:
        """Whether there may be a file of a simulation."""
        alike = simulation.spectrum_name, simulation.elastic_energy
        if alike not in self._beginnings:
            self._beginnings[alike] = simulation.stem.rsplit("-", 2)[0]
        return f"{self._beginnings[alike]}-r{simulation.realisation}" in self._names


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
        curves = _Curves(self.folder / "curves")
        index = index or RowIndex(self.folder)
        for simulation in simulations:
            row = index.row(simulation)
            if row is not None or simulation not in curves or not self.path(simulation).is_file():
                yield Holding(simulation, row)
                continue
            try:
                result = read_simulation(self.path(simulation), simulation)
                yield Holding(simulation, sweep_row(result))
            except UnreadableFileError as error:
                yield Holding(simulation, None, str(error))

    def inventory(self, simulations: Iterable[Simulation]) -> Inventory:
        """What is missing among simulations, and why."""
        index = RowIndex(self.folder)
        absent = [one for one in self.holdings(simulations, index) if one.row is None]
        missing = tuple(one.simulation for one in absent)
        changed = (_changed_parts(one, index.parts(one.label)) for one in missing)
        return Inventory(
            missing,
            unreadable=tuple(one.unreadable for one in absent if one.unreadable),
            stale=tuple(parts for parts in changed if parts),
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
            counts: Counter[str] = Counter()
            seconds = 0.0
            for held in self.holdings(sweep.simulations(item), index):
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
        """What the file of the whole sweep says of itself; refused as by :meth:`table`."""
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
        if any(self._lists()):
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

    def _forget(self, missing: Sequence[Simulation]) -> int:
        """Remove the lists of shards that lack simulations, or are damaged; how many they are."""
        keys, count = {one.key for one in missing}, 0
        for path in self._lists():
            whole = integrity(path)[0] is Integrity.WHOLE
            content = json.loads(path.read_text(encoding="utf-8")) if whole else {}
            listed = {entry["key"] for entry in content.get("simulations", ())}
            if not whole or not keys.isdisjoint(listed):
                path.unlink()
                count += 1
        return count

    def _lists(self) -> Iterator[Path]:
        """Files of the lists of shards."""
        return (self.folder / "shards").glob("*.json")

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
            file: state is Integrity.DAMAGED
            for file, state in integrities(self.folder)
            if file.relative_to(self.folder).parts[0] not in left_out
            and file.resolve() != path.resolve()
        }
        found |= {file: line_counts(file)[1] > 0 for file in journal_paths(self.journals)}
        if damaged := [file for file, is_damaged in found.items() if is_damaged]:
            raise ValueError(
                f"{len(damaged)} files of {self.folder} are damaged, the first is {damaged[0]}; "
                "run make, which makes them anew, before it is archived"
            )
        files = sorted(found)

        def write(part: Path) -> None:
            root, sums = Path(self.folder.name), []
            with ZipFile(part, "w") as archive:
                for file in files:
                    name = file.relative_to(self.folder)
                    sums.append(f"{_added(archive, file, str(root / name))}  {name}\n")
                archive.writestr(str(root / SUMS), "".join(sums))

        replace_atomically(path, write)
        return len(files)


def _changed_parts(simulation: Simulation, known: dict[str, str] | None) -> tuple[str, ...]:
    """Parts of a key that are not as they were when a simulation of the label was stored."""
    if known is None:
        return ()
    return tuple(name for name, part in simulation.parts.items() if part != known.get(name))


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
