"""The folder of a sweep: where its files are, what they hold and lack, and how they become one."""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import json
import statistics
import threading
from collections import Counter, defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
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
from crackfront.data.packs import Pack, checked
from crackfront.data.provenance import Provenance
from crackfront.data.section import movable_text
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_simulation
from crackfront.simulate.run import SimulationResult
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.journal import RowIndex, living, new_pack, pack_paths, renew_packs, running
from crackfront.sweep.sweep import Shard, Sweep
from crackfront.sweep.table import (
    COMPLETE,
    SWEEP_FINGERPRINT,
    read_table,
    sweep_row,
    write_hysteresis,
)

SECONDS_BETWEEN_BEATS = 20.0
"""Time after which a process that simulates or stores shows that it lives."""

SUMS = "SHA256SUMS"
"""File of an archive that lists the checksums of all others."""

_COMPRESSED = {".nc", ".png", ".pdf", ".gif", ".zip"}
"""Files that become no smaller."""


@dataclass(frozen=True, slots=True)
class Holding:
    """What a store has of a simulation: its row, or a sentence where its curve is of no use."""

    simulation: Simulation
    row: SweepRow | None
    unreadable: str
    changed: tuple[str, ...] = ()
    """Parts of its key that changed since it was stored, where it is missing."""
    arithmetic: str = ""
    """That of its origin, where it has a row."""


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store lacks, and why."""

    missing: tuple[Simulation, ...]
    """What is to be computed."""
    unreadable: tuple[str, ...]
    """A sentence for every curve that is of no use."""
    stale: tuple[tuple[str, ...], ...]
    """Of every missing simulation that is stored with another key the parts of it that changed."""
    arithmetic: Mapping[str, int]
    """How many of the others are of which arithmetic."""

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
    def curves(self) -> Path:
        """Folder of the packs of curves and rows."""
        return self.folder / "curves"

    @property
    def hysteresis(self) -> Path:
        """File of the whole sweep."""
        return self.folder / "hysteresis.nc"

    @property
    def checkpoints(self) -> Path:
        """Folder of what running processes keep: checkpoints, and notes of what they are at."""
        return self.folder / "checkpoints"

    def checkpoint(self, simulation: Simulation) -> Path:
        """File from which a simulation goes on."""
        return self.checkpoints / f"{simulation.stem}.nc"

    def holdings(
        self, simulations: Iterable[Simulation], *, checked: bool = True
    ) -> Iterator[Holding]:
        """What is stored of simulations, in their order; the curves of one spectrum after another.

        Unless `checked`, a curve counts without a look at its digest.
        """
        for spectrum, group in itertools.groupby(simulations, attrgetter("spectrum_name")):
            alike = list(group)
            index = RowIndex(self.curves, spectrum, _span(alike), checked=checked)
            yield from (_holding(one, index) for one in alike)

    @contextlib.contextmanager
    def packs(self, simulations: Iterable[Simulation]) -> Iterator[dict[str, Pack]]:
        """New packs for simulations, by the names of their spectra, until they are left.

        Where ended processes left packs of the same realisations damaged, what is whole is kept.
        """
        self.curves.mkdir(parents=True, exist_ok=True)
        alike: dict[str, list[Simulation]] = defaultdict(list)
        for one in simulations:
            alike[one.spectrum_name].append(one)
        blocks = {name: _span(ones) for name, ones in alike.items()}
        for name, block in blocks.items():
            deque(renew_packs(pack_paths(self.curves, name, block)), maxlen=0)
        found = {name: new_pack(self.curves, name, block) for name, block in blocks.items()}
        left = threading.Event()

        def beat() -> None:
            while not left.wait(SECONDS_BETWEEN_BEATS):
                for pack in found.values():
                    pack.beat()

        beating = threading.Thread(target=beat, daemon=True)
        beating.start()
        try:
            yield found
        finally:
            left.set()
            beating.join()
            for pack in found.values():
                pack.close()

    def result(self, simulation: Simulation) -> SimulationResult:
        """Stored result of a simulation; `UnreadableFileError` where there is none."""
        name, block = simulation.spectrum_name, _span([simulation])
        for member in RowIndex(self.curves, name, block).curves(simulation):
            return read_simulation(member, simulation)
        raise UnreadableFileError(f"{self.curves} has no curve of {simulation.label}; simulate it")

    def inventory(self, simulations: Iterable[Simulation], *, checked: bool = True) -> Inventory:
        """Which of some simulations are missing, and why; as :meth:`holdings`."""
        known: Counter[str] = Counter()
        absent = []
        for one in self.holdings(simulations, checked=checked):
            absent += [one] if one.row is None else []
            known.update([] if one.row is None else [one.arithmetic])
        return Inventory(
            arithmetic=known,
            missing=tuple(one.simulation for one in absent),
            unreadable=tuple(one.unreadable for one in absent if one.unreadable),
            stale=tuple(one.changed for one in absent if one.changed),
        )

    def progress(self, sweep: Sweep) -> list[Progress]:
        """How far each spectrum of a sweep is, also while it runs elsewhere.

        The expected times are those of the cost model, in proportion to what the stored simulations
        of the sweep took.
        """
        begun = {one.key for one in running(self.checkpoints)}
        found, paces = [], []
        for item in sweep.spectra:
            counts, seconds = dict.fromkeys(("done", "failed", "running", "waiting"), 0), 0.0
            for held in self.holdings(sweep.simulations(item), checked=False):
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
            "realisations": [shard.realisations[0], shard.realisations[-1]],
        }
        path = self.folder / "shards" / f"{shard.name}.json"
        write_text(path, json.dumps(content, indent=1) + "\n", sealed=True)
        return path

    def table(self, sweep: Sweep) -> SweepTable:
        """Arrays of the file of the whole sweep.

        ValueError if the file is missing or damaged, or the table of another configuration.
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

        Yields a sentence for every damaged file, and one for all simulations that run again.
        """
        if not self.folder.is_dir():
            return
        yield from set_aside_damaged(self.folder)
        yield from renew_packs(pack_paths(self.curves))
        if any((self.folder / "shards").glob("*.json")):
            if not self.configuration.is_file():
                write_text(self.configuration, movable_text(configuration), sealed=True)
            lacking = self.inventory(sweep.simulations())
            yield from (f"{sentence}; it is computed anew" for sentence in lacking.unreadable)
            if count := self._forget(lacking.missing):
                yield f"{self.folder}: {count} list(s) of shards are made anew with what they lack"

    def aggregate(self, sweep: Sweep, origin: Provenance) -> Path:
        """Write the file of the whole sweep, and return its path.

        ValueError if simulations are missing or unreadable. The lists of their shards are removed,
        so that the workflow runs them again.
        """
        write_hysteresis(self.hysteresis, sweep, self._rows(sweep), origin)
        return self.hysteresis

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
        numbers = {(one.spectrum_name, one.realisation) for one in missing}
        count = 0
        for path in (self.folder / "shards").glob("*.json"):
            if integrity(path)[0] is Integrity.WHOLE:
                content = json.loads(path.read_text(encoding="utf-8"))
                first, last = content.get("realisations", (0, -1))
                block = range(first, last + 1)
                if block and numbers.isdisjoint((content["spectrum"], one) for one in block):
                    continue
            path.unlink()
            count += 1
        return count

    def archive(self, path: Path, *, curves: bool) -> int:
        """Write the files of the sweep and their checksums into a ZIP file; the number of files.

        Checkpoints and what is only half written are left out; the files of the single simulations
        belong to it with `curves`. Names in the archive begin with that of the folder, and the list
        stands in it too: unpack, go there, `sha256sum --check SHA256SUMS`. ValueError if the folder
        holds no file of a sweep, or a file that belongs to the archive is damaged.
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
    """Files of a folder of results, each counted by whether it, or each file in it, is whole."""
    for path, state in integrities(folder):
        yield path, Counter([state])
    alive = living(pack_paths(folder / "curves"))
    for path in pack_paths(folder / "curves"):
        whole, n_damaged = checked(path)
        n_damaged = 0 if path in alive else n_damaged
        yield path, Counter({Integrity.WHOLE: len(whole), Integrity.DAMAGED: n_damaged})


def _holding(simulation: Simulation, index: RowIndex) -> Holding:
    """What an index has of a simulation."""
    if (entry := index.entry(simulation)) is not None:
        return Holding(simulation, entry.row, "", arithmetic=entry.arithmetic)
    unreadable, latest = "", index.latest(simulation)
    for member in index.curves(simulation):
        try:
            row = sweep_row(read_simulation(member, simulation))
        except UnreadableFileError as error:
            unreadable = str(error)
        else:
            return Holding(simulation, row, "", arithmetic=latest.arithmetic if latest else "")
    known, now = (latest.parts, simulation.parts) if latest else ({}, {})
    changed = tuple(name for name, part in now.items() if part != known.get(name))
    return Holding(simulation, None, unreadable, changed)


def _span(simulations: Sequence[Simulation]) -> range:
    """The least consecutive realisations among which those of simulations are."""
    numbers = [one.realisation for one in simulations]
    return range(min(numbers), max(numbers) + 1)
