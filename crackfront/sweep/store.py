"""The folder of a sweep: its files, the simulations they hold or lack, and their one table."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import itertools
import json
import os
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from crackfront.analysis.table import SweepRow, SweepTable
from crackfront.core.versions import PHYSICS_VERSION
from crackfront.data.bounds import counted
from crackfront.data.digests import (
    SUMS,
    digest_path,
    forget_sums,
    read_sums,
    result_files,
    stated_digest,
    sums_text,
)
from crackfront.data.files import (
    UnreadableFileError,
    is_damaged,
    read_attributes,
    replace_atomically,
    set_aside_damaged,
    write_text,
)
from crackfront.data.packs import Member, Pack, members
from crackfront.data.provenance import Provenance
from crackfront.data.section import movable_text
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.files import read_simulation
from crackfront.simulate.run import SimulationResult
from crackfront.simulate.simulation import Simulation, stems
from crackfront.sweep.result_packs import Entry, RowIndex, new_pack, pack_paths, repair_packs
from crackfront.sweep.rows import COMPLETE, sweep_row
from crackfront.sweep.shards import (
    FinishedShard,
    covering,
    curve_names,
    finished_shard,
    shard_columns,
    shard_request,
    write_shard,
)
from crackfront.sweep.sweep import NamedSpectrum, Shard, Sweep
from crackfront.sweep.table import SWEEP_FINGERPRINT, read_table, write_hysteresis

_COMPRESSED = {".nc", ".png", ".pdf", ".gif", ".zip"}
"""Files that become no smaller."""


@dataclass(frozen=True, slots=True)
class StoredResult:
    """What the packs have of a simulation: its row, or a sentence where its curve is of no use."""

    simulation: Simulation
    row: SweepRow | None
    unreadable: str
    changed: tuple[str, ...] = ()
    """Parts of its key that changed since it was stored, where it is missing."""
    arithmetic: str = ""
    """That of its origin, where it has a row."""


@dataclass(frozen=True, slots=True)
class Inventory:
    """What a store has of some simulations, and what it lacks and why."""

    done: int
    failed: int
    """Simulations with values, and those that ended without."""
    missing: tuple[Simulation, ...]
    """What is to be computed."""
    unreadable: tuple[str, ...] = ()
    """A sentence for every curve that is of no use."""
    stale: tuple[tuple[str, ...], ...] = ()
    """Of every missing simulation that is stored with another key the parts of it that changed."""
    arithmetic: frozenset[str] = frozenset()
    """Those of the origins of what is stored."""
    cpu_seconds: float = 0.0
    expected_seconds: float = 0.0
    """Processor time of what is stored, and what was expected for it. (Units: s)"""

    def __add__(self, other: Inventory) -> Inventory:
        """Inventory of the simulations of both."""
        return Inventory(
            self.done + other.done,
            self.failed + other.failed,
            self.missing + other.missing,
            self.unreadable + other.unreadable,
            self.stale + other.stale,
            self.arithmetic | other.arithmetic,
            self.cpu_seconds + other.cpu_seconds,
            self.expected_seconds + other.expected_seconds,
        )

    @property
    def stored(self) -> int:
        """Number of simulations that have ended."""
        return self.done + self.failed

    def stale_sentence(self) -> str:
        """How many are stale for which reason; empty where none is."""
        reasons = sorted(Counter(" and ".join(changed) for changed in self.stale).items())
        listed = ", ".join(f"{count} as {reason} changed" for reason, count in reasons)
        return f"{len(self.stale)} stored simulations are stale: {listed}" if listed else ""


NOTHING = Inventory(0, 0, ())
"""Inventory of no simulation."""


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
        """Folder of the checkpoints of running simulations."""
        return self.folder / "checkpoints"

    def checkpoint(self, simulation: Simulation) -> Path:
        """File from which a simulation goes on."""
        return self.checkpoints / f"{simulation.stem}.nc"

    def shard_path(self, shard: Shard) -> Path:
        """File of the rows of a shard."""
        return self.folder / "shards" / f"{shard.name}.nc"

    def is_finished(self, sweep: Sweep, shard: Shard) -> bool:
        """Whether the file of a shard is there, by its fingerprint alone."""
        found = finished_shard(self.shard_path(shard))
        wanted = shard_request(sweep.one_per_amplitude(shard.item), shard.realisations)
        return found is not None and found.fingerprint == wanted

    def finished(
        self, sweep: Sweep, item: NamedSpectrum
    ) -> tuple[list[tuple[FinishedShard, range]], list[range]]:
        """Files of shards of a spectrum with what is taken of each, and what none of them has."""
        one_per_amplitude = sweep.one_per_amplitude(item)
        found = map(finished_shard, sorted((self.folder / "shards").glob(f"{item.name}.*nc")))
        known = (
            one
            for one in found
            if one is not None
            and one.spectrum == item.name
            and one.fingerprint == shard_request(one_per_amplitude, one.realisations)
        )
        chosen, left, position = covering(known, sweep.n_realisation), [], 0
        for _, taken in chosen:
            left.append(range(position, taken.start))
            position = taken.stop
        left.append(range(position, sweep.n_realisation))
        return chosen, [block for block in left if block]

    def stored_results(
        self, simulations: Iterable[Simulation], *, checked: bool = True
    ) -> Iterator[StoredResult]:
        """What the packs have of simulations, in their order; one spectrum after another.

        Unless `checked`, a curve counts without a look at its digest.
        """
        for spectrum, group in itertools.groupby(simulations, attrgetter("spectrum_name")):
            alike = list(group)
            index = RowIndex(self.curves, spectrum, _span(alike), checked=checked)
            yield from map(_stored_result, alike, stems(alike), itertools.repeat(index))

    @contextlib.contextmanager
    def packs(self, simulations: Iterable[Simulation]) -> Iterator[dict[str, Pack]]:
        """New packs for simulations, by the names of their spectra, until they are left."""
        self.curves.mkdir(parents=True, exist_ok=True)
        alike: dict[str, list[Simulation]] = defaultdict(list)
        for one in simulations:
            alike[one.spectrum_name].append(one)
        found = {name: new_pack(self.curves, name, _span(ones)) for name, ones in alike.items()}
        try:
            yield found
        finally:
            for pack in found.values():
                pack.close()

    def result(self, simulation: Simulation) -> SimulationResult:
        """Stored result of a simulation; `UnreadableFileError` where no curve of it can be read."""
        name, block = simulation.spectrum_name, _span([simulation])
        reason = f"{self.curves} has no curve of {simulation.label}; simulate it"
        for member in RowIndex(self.curves, name, block).curves(simulation.stem):
            try:
                return read_simulation(member, simulation)
            except UnreadableFileError as error:  # another pack may have it, too
                reason = str(error)
        raise UnreadableFileError(reason)

    def inventory(self, simulations: Iterable[Simulation], *, checked: bool = True) -> Inventory:
        """What the packs have and lack of some simulations; as :meth:`stored_results`."""
        results = list(self.stored_results(simulations, checked=checked))
        found = [one for one in results if one.row is not None]
        absent = [one for one in results if one.row is None]
        rows = [one.row for one in found if one.row is not None]
        done = sum(row.status in COMPLETE for row in rows)
        expected = expected_seconds(one.simulation for one in found)
        return Inventory(
            done,
            len(rows) - done,
            tuple(one.simulation for one in absent),
            tuple(one.unreadable for one in absent if one.unreadable),
            tuple(one.changed for one in absent if one.changed),
            frozenset(filter(None, (one.arithmetic for one in found))),
            sum(row.cpu_seconds for row in rows if row.cpu_seconds > 0),
            expected,
        )

    def unfinished(self, sweep: Sweep, shards: Iterable[Shard]) -> Inventory:
        """What the packs have and lack of the shards that have no file; finished ones are done."""
        found = NOTHING
        for shard in shards:
            if self.is_finished(sweep, shard):
                size = len(sweep.elastic_energies) * len(shard.realisations)
                found += Inventory(size, 0, ())
            else:
                found += self.inventory(sweep.simulations(shard.item, shard.realisations))
        return found

    def progress(self, sweep: Sweep, item: NamedSpectrum) -> Inventory:
        """How far a spectrum is: finished shards by their attributes, the rest by the packs."""
        chosen, left = self.finished(sweep, item)
        found = NOTHING
        for shard, taken in chosen:
            size = len(sweep.elastic_energies) * len(taken)
            cost = sum(expected_cost(one).seconds for one in sweep.one_per_amplitude(item)) * len(
                taken
            )
            share = len(taken) / len(shard.realisations)
            failed = min(shard.failed, size)
            found += Inventory(
                size - failed,
                failed,
                (),
                arithmetic=shard.arithmetic,
                cpu_seconds=share * shard.cpu_seconds,
                expected_seconds=cost,
            )
        for block in left:
            found += self.inventory(sweep.simulations(item, block), checked=False)
        return found

    def finish_shard(self, sweep: Sweep, shard: Shard, origin: Provenance) -> Path:
        """Write the file of a shard from its rows in the packs, unless it is there.

        ValueError if simulations are missing.
        """
        path = self.shard_path(shard)
        if self.is_finished(sweep, shard):
            return path
        found = list(self.stored_results(sweep.simulations(shard.item, shard.realisations)))
        rows = [one.row for one in found if one.row is not None]
        if len(rows) < len(found):
            first = next(one.simulation for one in found if one.row is None)
            raise ValueError(
                f"{len(found) - len(rows)} of {len(found)} simulations are missing or unreadable "
                f"in {self.curves}, the first is {first.label}; run the same command again"
            )
        arithmetic = {one.arithmetic for one in found if one.arithmetic}
        forget_sums(self.folder)
        write_shard(path, sweep, shard, rows, arithmetic, origin)
        return path

    def table(self, sweep: Sweep) -> SweepTable:
        """Arrays of the file of the whole sweep.

        ValueError if the file is missing or damaged, or the table of another configuration.
        """
        self.about(sweep)
        return read_table(self.hysteresis)

    def about(self, sweep: Sweep) -> dict[str, str]:
        """Attributes of the file of the whole sweep; refused as by :meth:`table`."""
        self._refuse_no_table()
        about = read_attributes(self.hysteresis)
        if about.get(SWEEP_FINGERPRINT) != sweep.table_fingerprint:
            raise ValueError(
                f"{self.hysteresis} is the table of another configuration than the one given; run "
                "crackfront simulate and crackfront aggregate with this one, or the workflow"
            )
        return {name: str(value) for name, value in about.items()}

    def _refuse_no_table(self) -> None:
        """Raise ValueError if there is no file of the whole sweep."""
        if not self.hysteresis.exists():
            raise ValueError(
                f"{self.folder} holds no hysteresis.nc; run crackfront aggregate with the "
                "configuration of the sweep, or the workflow"
            )

    def repair(self, configuration: Path) -> Iterator[str]:
        """Set aside what is damaged, and remove shards whose curves are gone, to be made anew.

        Yields a sentence for every such file.
        """
        if not any((self.folder / name).exists() for name in _OF_SWEEP):
            return
        for path in sorted((self.folder / "shards").glob("*.nc")):
            if stated_digest(path) is None:
                forget_sums(self.folder)
                path.unlink()
                yield f"{path} is made anew, as no file beside it states its checksum"
        yield from set_aside_damaged(self.folder)
        yield from repair_packs(pack_paths(self.curves))
        if (self.folder / "shards").is_dir() and not self.configuration.is_file():
            write_text(self.configuration, movable_text(configuration))
        known = {one.name for path in pack_paths(self.curves) for one in members(path)[0]}
        for path in sorted((self.folder / "shards").glob("*.nc")):
            if lost := [name for name in curve_names(path) if name not in known]:
                forget_sums(self.folder)
                path.unlink()
                digest_path(path).unlink(missing_ok=True)
                curves = counted(len(lost), "curve")
                yield f"{path} is made anew, as it lacks {curves} of its simulations"

    def aggregate(
        self, sweep: Sweep, origin: Provenance, watched: Callable[[list[Any]], Iterable[Any]] = iter
    ) -> Path:
        """Write the file of the whole sweep from those of its shards, and return its path.

        Shards are read as `watched` yields them, which may show how far this is. ValueError if
        shards are missing or damaged.
        """
        shards, missing = [], 0
        for item in sweep.spectra:
            chosen, left = self.finished(sweep, item)
            missing += sum(map(len, left)) * len(sweep.elastic_energies)
            shards.append(chosen)
        if missing:
            raise ValueError(
                f"{missing} of {sweep.n_simulation} simulations are in no finished shard of "
                f"{self.folder}; run `crackfront simulate` with this configuration and output, or "
                "`make` again"
            )
        read = (shard_columns(*one) for one in watched([one for some in shards for one in some]))
        parts = [[*itertools.islice(read, len(chosen))] for chosen in shards]
        forget_sums(self.folder)
        write_hysteresis(self.hysteresis, sweep, parts, origin)
        return self.hysteresis

    def unpack_curves(self, folder: Path) -> int:
        """Write the curves of the table into a folder, a file each; their number.

        Curves of other numerics, which the packs may hold too, are left out. ValueError if any is
        missing or damaged, before a file is written.
        """
        self._refuse_no_table()
        wanted = dict.fromkeys(curve_names(self.hysteresis))
        found: dict[str, Member] = {}
        for path in pack_paths(self.curves):
            for member in members(path)[0]:
                if member.name in wanted and member.content() is not None:
                    found.setdefault(member.name, member)
        if lost := [name for name in wanted if name not in found]:
            raise ValueError(
                f"{len(lost)} of {len(wanted)} curves of {self.hysteresis} are missing or damaged "
                f"in {self.curves}, the first is {lost[0]}; run crackfront repair and make"
            )
        for name, member in found.items():
            content = member.content() or b""
            replace_atomically(folder / name, functools.partial(Path.write_bytes, data=content))
        return len(found)

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
        listed = read_sums(self.folder)
        own = os.path.realpath(path)  # also of a link to itself
        found = {
            file: str(file.relative_to(self.folder))
            for file in result_files(self.folder)
            if (curves or file.parent != self.curves) and os.path.realpath(file) != own
        }
        if damaged := [file for file, name in found.items() if is_damaged(file, listed.get(name))]:
            raise ValueError(
                f"{self.folder} holds {counted(len(damaged), 'damaged file')}, the first is "
                f"{damaged[0]}; run make, which makes them anew, before it is archived"
            )

        root = Path(self.folder.name)
        for name in found.values():
            try:
                str(root / name).encode()
            except UnicodeEncodeError as error:
                raise ValueError(
                    f"{self.folder / name} has a name that is no UTF-8 text, as those in a ZIP "
                    "file must be; rename it"
                ) from error

        def write(part: Path) -> None:
            digests = {}
            with ZipFile(part, "w") as archive:
                for file, name in found.items():
                    content = file.read_bytes()
                    # A clock may have been wrong: ZIP knows no year before 1980.
                    entry = ZipInfo.from_file(file, root / name, strict_timestamps=False)
                    entry.compress_type = ZIP_STORED if file.suffix in _COMPRESSED else ZIP_DEFLATED
                    archive.writestr(entry, content)
                    digests[name] = hashlib.sha256(content).hexdigest()
                archive.writestr(str(root / SUMS), sums_text(digests))

        replace_atomically(path, write)
        return len(found)


def mixture_sentence(arithmetic: Collection[str]) -> str:
    """Sentence on results of several processors or packages; empty if all are of one."""
    if len(arithmetic) < 2:
        return ""
    listed = "; ".join(sorted(arithmetic))
    return f"stored simulations differ in their origin, and may in their last digits: {listed}"


_OF_SWEEP = "curves", "shards", "configuration.yaml", "hysteresis.nc"
"""Files and folders, one of which every folder has that a sweep has written to."""


def lost_curves(folder: Path) -> Iterator[str]:
    """Curves that belong to rows of finished shards in a folder, and are in no pack."""
    known = {one.name for path in pack_paths(folder / "curves") for one in members(path)[0]}
    for path in sorted((folder / "shards").glob("*.nc")):
        if finished_shard(path) is not None:
            yield from (name for name in curve_names(path) if name not in known)


def _stored_result(simulation: Simulation, stem: str, index: RowIndex) -> StoredResult:
    """What an index has of a simulation."""
    if (entry := index.entry(stem)) is not None:
        return StoredResult(simulation, entry.row, "", arithmetic=entry.arithmetic)
    unreadable, alike = "", list(index.alike(stem))
    for member in index.curves(stem):
        try:
            row = sweep_row(read_simulation(member, simulation))
        except UnreadableFileError as error:
            unreadable = str(error)
        else:
            arithmetic = alike[-1].arithmetic if alike else ""
            return StoredResult(simulation, row, "", arithmetic=arithmetic)
    changes = [_changed_parameters(simulation, one) for one in alike]
    nearest = min(changes, key=len) if changes else []
    return StoredResult(simulation, None, unreadable, tuple(nearest))


def _changed_parameters(simulation: Simulation, entry: Entry) -> list[str]:
    """Names of what differs between a simulation and one of its name that is stored."""
    if entry.physics_version != PHYSICS_VERSION:
        return [f"version of the physics (now {PHYSICS_VERSION})"]
    # As JSON reads it back.
    now = json.loads(json.dumps(simulation.parameters))
    names = sorted(now.keys() | entry.parameters.keys())
    return [name for name in names if now.get(name) != entry.parameters.get(name)]


def expected_seconds(simulations: Iterable[Simulation]) -> float:
    """Processor time that simulations are expected to take, where realisations cost the same."""
    alike: dict[tuple[str, float], list[Simulation]] = defaultdict(list)
    for one in simulations:
        alike[one.spectrum_name, one.elastic_energy].append(one)
    return sum(expected_cost(ones[0]).seconds * len(ones) for ones in alike.values())


def _span(simulations: Sequence[Simulation]) -> range:
    """The least consecutive realisations among which those of simulations are."""
    numbers = [one.realisation for one in simulations]
    return range(min(numbers), max(numbers) + 1)
