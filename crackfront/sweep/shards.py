"""The file of a shard: the rows of its simulations, derived from the files of their curves."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.table import SweepRow
from crackfront.core.variables import variables
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.storage import write_derived
from crackfront.sweep.curves import PARAMETERS, parameters_text
from crackfront.sweep.inventory import Inventory
from crackfront.sweep.requests import REQUEST, shard_request
from crackfront.sweep.rows import AT_LIMIT, COMPLETE, STATUSES
from crackfront.sweep.sweep import Shard, Sweep
from crackfront.sweep.table_file import columns_dataset

_BETWEEN = "; "
"""What stands between series and arithmetics in the attributes of a file."""

NO_LIMIT = -1
"""Attribute of a file in which no simulation reached its limit of sweeps."""

Columns = Mapping[str, NDArray[np.generic]]


@dataclass(frozen=True, slots=True)
class ShardSummary:
    """What the attributes of a shard's file say, which are read without its rows."""

    path: Path
    spectrum: str
    """Name of its spectrum."""
    realisations: range
    """Numbers of its realisations."""
    series: tuple[str, ...]
    """Series of its simulations, one for each amplitude."""
    physics_version: int
    """Version of its states."""
    rows_version: int
    """Version of its rows."""
    request: str
    """Digest of what was asked for."""
    n_failed: NDArray[np.int64]
    """Simulations of each amplitude without a value."""
    limit: int
    """Lowest limit of sweeps that a simulation reached; -1 if none did."""
    cpu_seconds: NDArray[np.float64]
    """Processor time of the simulations of each amplitude. (Units: s)"""
    arithmetic: frozenset[str]
    """Processors and packages that computed the rows."""
    parameters: dict[str, dict[str, Any]]
    """Parameters of each series."""

    def has_states(self, series: Iterable[str], max_sweeps: int) -> bool:
        """Whether it was derived from states of all these series as of today, at such a limit."""
        within = self.limit == NO_LIMIT or self.limit >= max_sweeps
        has_series = {*self.series}.issuperset(series)
        return self.physics_version == PHYSICS_VERSION and within and has_series

    def has_rows(self, series: Iterable[str], max_sweeps: int) -> bool:
        """Whether its rows of all these series are as of today as well."""
        return self.has_states(series, max_sweeps) and self.rows_version == ROWS_VERSION

    def inventory(self, series: Iterable[str], taken: range, expected_seconds: float) -> Inventory:
        """Inventory of some of its series and realisations, all of which it has.

        Costs of the realisations that are taken are a share of all; the expected time is theirs.
        """
        rows = [self.series.index(digest) for digest in series]
        n_simulation = len(rows) * len(taken)
        failed = min(int(self.n_failed[rows].sum()), n_simulation)
        share = len(taken) / len(self.realisations)
        return Inventory(
            n_simulation - failed,
            failed,
            remade=n_simulation if self.rows_version != ROWS_VERSION else 0,
            arithmetic=self.arithmetic,
            cpu_seconds=share * float(self.cpu_seconds[rows].sum()),
            expected_seconds=expected_seconds,
        )


def write_shard(
    path: Path,
    sweep: Sweep,
    shard: Shard,
    columns: Columns,
    arithmetic: Iterable[str],
    origin: Provenance,
) -> None:
    """Write the file of a shard and its checksum.

    Columns are the fields of the rows, over amplitudes and realisations in their order. The layout
    is the same as in the file of the whole sweep.
    """
    alone = replace(sweep, spectra=(shard.item,))
    shape = 1, len(sweep.elastic_energies), len(shard.realisations)
    shaped = {name: values.reshape(shape) for name, values in columns.items()}
    status = shaped["status"]
    limits = shaped["max_sweeps"][status == STATUSES.index(AT_LIMIT)]
    complete = np.isin(status, [STATUSES.index(word) for word in COMPLETE])
    about = {
        "spectrum_name": shard.item.name,
        "series_of_amplitudes": _BETWEEN.join(sweep.series(shard.item)),
        REQUEST: shard_request(sweep, shard).digest,
        "first_realisation": np.int64(shard.realisations[0]),
        "last_realisation": np.int64(shard.realisations[-1]),
        "n_failed": np.count_nonzero(~complete, axis=(0, 2)),
        "limit": np.int64(min(limits, default=NO_LIMIT)),
        "total_cpu_seconds": np.nansum(shaped["cpu_seconds"], axis=(0, 2)),
        "arithmetic_of_rows": _BETWEEN.join(sorted({*arithmetic})),
        PARAMETERS: parameters_text(sweep.one_per_amplitude(shard.item)),
    }
    dataset = columns_dataset(alone, shaped, shard.realisations)
    write_derived(path, dataset.assign_attrs(about), origin)


def shard_summary(path: Path) -> ShardSummary:
    """What the attributes of a shard's file say; its checksum has been looked at."""
    with netCDF4.Dataset(path) as file:
        first, last = int(file.first_realisation), int(file.last_realisation)
        return ShardSummary(
            path=path,
            spectrum=str(file.spectrum_name),
            realisations=range(first, last + 1),
            series=tuple(str(file.series_of_amplitudes).split(_BETWEEN)),
            physics_version=int(file.physics_version),
            rows_version=int(file.rows_version),
            request=str(file.getncattr(REQUEST)),
            n_failed=np.atleast_1d(file.n_failed),
            limit=int(file.limit),
            cpu_seconds=np.atleast_1d(file.total_cpu_seconds),
            arithmetic=frozenset(filter(None, str(file.arithmetic_of_rows).split(_BETWEEN))),
            parameters=json.loads(file.getncattr(PARAMETERS)),
        )


def shard_columns(
    shard: ShardSummary, series: Sequence[str], taken: range, rows: type[SweepRow]
) -> dict[str, NDArray[np.generic]]:
    """Columns of the rows, of a type, of some series and realisations of a shard.

    They are read without xarray, which takes 0.1 s to open a file: sweeps have hundreds.
    """
    first = shard.realisations.start
    amplitudes = [shard.series.index(digest) for digest in series]
    columns = {}
    with netCDF4.Dataset(shard.path) as file:
        file.set_auto_maskandscale(False)
        for item in variables(rows):
            stored = file[item.name]
            values = np.asarray(stored[:, :, taken.start - first : taken.stop - first])
            columns[item.name] = np.ascontiguousarray(values[:, amplitudes])
    return columns


def covering(
    shards: Iterable[ShardSummary], n_realisation: int
) -> list[tuple[ShardSummary, range]]:
    """Shards of a spectrum that together have as many realisations as possible, and what of each.

    No realisation is taken twice, and none beyond the requested number.
    """
    chosen, position = [], 0
    # Sorted by their first realisation; the longest first if it is the same.
    for shard in sorted(shards, key=lambda shard: (shard.realisations[0], -shard.realisations[-1])):
        block = shard.realisations
        taken = range(max(position, block.start), min(block.stop, n_realisation))
        if taken:
            chosen.append((shard, taken))
            position = taken.stop
    return chosen
