"""The folder of a sweep: the simulations that its files have or lack, its shards, its table.

What is stored are the files of finished simulations (:mod:`crackfront.sweep.curves`). The files of
shards and of the table are derived from them at any time (:mod:`crackfront.sweep.finished_shards`).
A file has one writer, which has the lock of the shard (:mod:`crackfront.sweep.shard_locks`); ranks
write only their checkpoints.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crackfront.analysis.table import SweepTable
from crackfront.simulate.checksums import forget_sums
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.run_simulation import SimulationResult
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.storage import (
    UnreadableFileError,
    read_derived,
    set_aside_if_damaged,
    write_text,
)
from crackfront.sweep.curves import (
    StoredRows,
    curve_files,
    read_result,
    stored_rows,
)
from crackfront.sweep.inventory import (
    Inventory,
    LocatedRows,
    inventory_of_rows,
    located_rows,
)
from crackfront.sweep.requests import FOLDER, REQUEST, Request, shard_request, table_request
from crackfront.sweep.shard_locks import Announce, locked_folders, locked_names
from crackfront.sweep.shards import (
    ShardSummary,
    covering,
    shard_columns,
    shard_summary,
)
from crackfront.sweep.sweep import NamedSpectrum, Shard, Sweep
from crackfront.sweep.table_file import read_table, write_hysteresis


@dataclass(frozen=True, slots=True)
class Store:
    """Results of a sweep in a folder."""

    folder: Path
    """Folder of the results."""
    announce: Announce = print
    """What is done with a sentence on a damaged file, or on another process."""

    @property
    def configuration(self) -> Path:
        """Configuration with which the folder was filled last."""
        return self.folder / "configuration.yaml"

    def keep_configuration(self, text: str) -> None:
        """Write the configuration that results follow, unless it is there already."""
        path = self.configuration
        if not (path.is_file() and path.read_bytes() == text.encode()):
            forget_sums(self.folder)
            write_text(path, text)

    @property
    def hysteresis(self) -> Path:
        """File of the whole sweep."""
        return self.folder / "hysteresis.nc"

    def curve_folder(self, shard: Shard) -> Path:
        """Folder of the finished simulations of a shard, and of its checkpoints."""
        return self.folder / "curves" / shard.name

    def shard_path(self, shard: Shard) -> Path:
        """File of the rows of a shard."""
        return self.folder / "shards" / f"{shard.name}.nc"

    def set_aside_damaged(self) -> None:
        """Set the table and the fit aside if they are damaged; the workflow makes them again."""
        for path in (self.hysteresis, self.folder / "fit.nc"):
            if path.is_file() and (sentence := set_aside_if_damaged(path)):
                self.announce(f"{sentence}; the workflow makes it again")

    def _whole(self, paths: Iterable[Path]) -> Iterator[Path]:
        """Files that are as they were written; damaged ones are set aside."""
        for path in paths:
            try:
                sentence = set_aside_if_damaged(path)
            except FileNotFoundError:  # another process has merged it meanwhile
                continue
            if sentence:
                self.announce(f"{sentence}; what it had is made again")
            else:
                yield path

    def _curve_folders(self, item: NamedSpectrum, realisations: range) -> list[Path]:
        """Folders in which simulations of a spectrum and block may be, whatever their shards."""
        folders = [self.folder / "curves" / item.name]
        for path in sorted((self.folder / "curves").glob(f"{item.name}.*-*")):
            first, _, last = path.name.removeprefix(f"{item.name}.").partition("-")
            if first.isdecimal() and last.isdecimal():
                block = range(int(first), int(last) + 1)
                if max(block.start, realisations.start) < min(block.stop, realisations.stop):
                    folders.append(path)
        return [folder for folder in folders if folder.is_dir()]

    def _stored_rows(self, item: NamedSpectrum, realisations: range) -> list[StoredRows]:
        """Rows of all files of curves that may have simulations of a spectrum and block."""
        rows = []
        for folder in self._curve_folders(item, realisations):
            for path in self._whole(curve_files(folder)):
                with contextlib.suppress(FileNotFoundError):
                    rows.append(stored_rows(path))
        return rows

    def located(self, sweep: Sweep, shard: Shard) -> LocatedRows:
        """Places of the simulations of a shard in the files of curves."""
        return located_rows(
            self._stored_rows(shard.item, shard.realisations),
            sweep.series(shard.item),
            shard.realisations,
            sweep.numerics.max_sweeps,
        )

    def inventory(self, sweep: Sweep, item: NamedSpectrum, realisations: range) -> Inventory:
        """What the files of curves have and lack of a spectrum and block."""
        rows = self._stored_rows(item, realisations)
        series, limit = sweep.series(item), sweep.numerics.max_sweeps
        located = located_rows(rows, series, realisations, limit)
        return inventory_of_rows(rows, located, sweep.one_per_amplitude(item))

    def shard_summaries(self, item: NamedSpectrum) -> list[ShardSummary]:
        """Attributes of the files of shards of a spectrum that are whole."""
        folder = self.folder / "shards"
        paths = [folder / f"{item.name}.nc", *sorted(folder.glob(f"{item.name}.*-*.nc"))]
        summaries = map(shard_summary, self._whole(path for path in paths if path.is_file()))
        return [summary for summary in summaries if summary.spectrum == item.name]

    def is_finished(self, sweep: Sweep, shard: Shard) -> bool:
        """Whether the file of a shard is there, whole, and what is asked for."""
        path = self.shard_path(shard)
        if not path.is_file() or not [*self._whole([path])]:
            return False
        return shard_summary(path).request == shard_request(sweep, shard).digest

    def unfinished(self, sweep: Sweep, shards: Iterable[Shard]) -> Inventory:
        """What is stored and lacking of shards; those with a file that is asked for are done."""
        total = Inventory()
        for shard in shards:
            if self.is_finished(sweep, shard):
                total += Inventory(len(sweep.elastic_energies) * len(shard.realisations))
            else:
                total += self.inventory(sweep, shard.item, shard.realisations)
        return total

    def progress(self, sweep: Sweep, item: NamedSpectrum) -> Inventory:
        """How far a spectrum is: by the attributes of its shards, the rest by files of curves."""
        series, limit = sweep.series(item), sweep.numerics.max_sweeps
        firsts = sweep.one_per_amplitude(item)
        expected_seconds = sum(expected_cost(first).seconds for first in firsts)
        summaries = self.shard_summaries(item)
        current = [summary for summary in summaries if summary.has_states(series, limit)]
        total, position = Inventory(), 0
        for summary, taken in covering(current, sweep.n_realisation):
            total += self._inventory_between(sweep, item, position, taken.start)
            total += summary.inventory(series, taken, expected_seconds * len(taken))
            position = taken.stop
        return total + self._inventory_between(sweep, item, position, sweep.n_realisation)

    def _inventory_between(
        self, sweep: Sweep, item: NamedSpectrum, start: int, stop: int
    ) -> Inventory:
        """What the files of curves have and lack between two realisations; empty if they agree."""
        return self.inventory(sweep, item, range(start, stop)) if start < stop else Inventory()

    def locked(self, shards: Iterable[Shard]) -> contextlib.AbstractContextManager[None]:
        """Lock the folders of shards while a context is open."""
        return locked_folders([self.curve_folder(shard) for shard in shards], self.announce)

    def running_shards(self) -> list[str]:
        """Names of the shards that another process has locked, as far as this machine sees it."""
        return locked_names(self.folder / "curves")

    def result(self, sweep: Sweep, simulation: Simulation) -> SimulationResult:
        """Stored result of a simulation; `UnreadableFileError` where it is not stored."""
        number = simulation.realisation
        item = sweep.named(simulation.spectrum_name)
        block = range(number, number + 1)
        located = located_rows(
            self._stored_rows(item, block),
            (simulation.series,),
            block,
            simulation.solver.max_sweeps,
        )
        if located.missing.any():
            raise UnreadableFileError(
                f"{self.folder / 'curves'} does not have {simulation.label}; simulate it"
            )
        path = located.files[located.file[0, 0]].path
        return read_result(path, int(located.place[0, 0]), simulation)

    def table(self, sweep: Sweep) -> SweepTable:
        """Arrays of the file of the whole sweep.

        ValueError if the file is missing or damaged, or the table of another configuration.
        """
        self.about(sweep)
        return read_table(self.hysteresis)

    def about(self, sweep: Sweep) -> dict[str, str]:
        """Attributes of the file of the whole sweep; errors as of :meth:`table`."""
        if not self.hysteresis.exists():
            raise ValueError(
                f"{self.folder} lacks hysteresis.nc; run crackfront aggregate with the "
                "configuration of the sweep, or the workflow"
            )
        about = read_derived(self.hysteresis, ()).attrs
        if about.get(REQUEST) != table_request(sweep).digest:
            raise ValueError(
                f"{self.hysteresis} is the table of another configuration than the one given; run "
                "crackfront simulate and crackfront aggregate with this one, or the workflow"
            )
        return {str(name): str(value) for name, value in about.items()}

    def aggregate(
        self, sweep: Sweep, origin: Provenance, watched: Callable[[list[Any]], Iterable[Any]] = iter
    ) -> Path:
        """Write the file of the whole sweep from the files of its shards, and return its path.

        Shards are read as `watched` yields them, which may show how far this is. ValueError if
        shards are missing or damaged.
        """
        limit, chosen, n_missing = sweep.numerics.max_sweeps, [], 0
        for item in sweep.spectra:
            series = sweep.series(item)
            summaries = self.shard_summaries(item)
            current = [summary for summary in summaries if summary.has_rows(series, limit)]
            taken = covering(current, sweep.n_realisation)
            n_missing += sweep.n_realisation - sum(len(block) for _, block in taken)
            chosen.append([(shard, series, block) for shard, block in taken])
        if n_missing:
            raise ValueError(
                f"{n_missing * len(sweep.elastic_energies)} of {sweep.n_simulation} simulations "
                f"are in no finished shard of {self.folder}; run `crackfront simulate` with this "
                "configuration and output, or `make` again"
            )
        blocks = watched([block for spectrum in chosen for block in spectrum])
        read = (
            shard_columns(shard, series, taken, sweep.row_type) for shard, series, taken in blocks
        )
        parts = [[*itertools.islice(read, len(spectrum))] for spectrum in chosen]
        forget_sums(self.folder)
        self.keep_configuration(origin.configuration)
        write_request(self.folder, table_request(sweep))
        write_hysteresis(self.hysteresis, sweep, parts, origin)
        return self.hysteresis


def write_request(results: Path, request: Request) -> None:
    """Write the file of a request among results unless it is there; remove earlier ones."""
    folder = results / FOLDER
    for path in folder.glob(request.siblings):
        if path.name != request.name:
            path.unlink()
    if not (folder / request.name).is_file():
        write_text(folder / request.name, request.text)
