"""The end of a shard: its simulations in one file, and the file of its rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.analysis.table import SweepRow
from crackfront.core.variables import variables
from crackfront.core.versions import PHYSICS_VERSION
from crackfront.simulate.checksums import MERGED, forget_sums
from crackfront.simulate.labels import labelled
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.storage import read_dataset
from crackfront.sweep.curves import (
    SIMULATION,
    StoredRows,
    concatenated,
    curve_files,
    read_results,
    selected,
    stored_rows,
    write_curves,
)
from crackfront.sweep.inventory import LocatedRows, is_older
from crackfront.sweep.requests import shard_request
from crackfront.sweep.rows import row_columns, sweep_row
from crackfront.sweep.shards import write_shard
from crackfront.sweep.store import Store, write_request
from crackfront.sweep.sweep import Shard, Sweep

_MOST_MERGED_BYTES = 1e8
"""Size of the files of a shard beyond which batches stay as they are: merging takes three
times their memory. (Units: byte)"""


def finish_shard(store: Store, sweep: Sweep, shard: Shard, origin: Provenance) -> Path:
    """Merge the files of curves of a shard, and derive the file of its rows.

    The process must have locked the shard. ValueError if simulations are missing.
    """
    path = store.shard_path(shard)
    if store.is_finished(sweep, shard):
        return path
    located = store.located(sweep, shard)
    if n_missing := int(np.count_nonzero(located.missing)):
        raise ValueError(
            f"{n_missing} of {located.missing.size} simulations are not in "
            f"{store.curve_folder(shard)}; run the same command again"
        )
    columns = {item.name: located.column(item.name) for item in variables(sweep.row_type)}
    remade = [number for number, rows in enumerate(located.files) if is_older(rows)]
    for number in remade:
        _remake(sweep, shard, located, number, columns)
    arithmetic = {*located.column("arithmetic").tolist()}
    _merge(store.curve_folder(shard), shard.name, located, columns, sweep.row_type, origin)
    forget_sums(store.folder)
    write_request(store.folder, shard_request(sweep, shard))
    write_shard(path, sweep, shard, columns, arithmetic, origin)
    return path


def _remake(
    sweep: Sweep,
    shard: Shard,
    located: LocatedRows,
    number: int,
    columns: dict[str, NDArray[Any]],
) -> None:
    """Make the rows of a file anew from its states, and put them into columns of the shard."""
    chosen = np.flatnonzero(located.file == number)
    everything = [*sweep.simulations(shard.item, shard.realisations)]
    simulations = [everything[position] for position in chosen]
    path = located.files[number].path
    results = read_results(path, located.place.ravel()[chosen], simulations)
    for position, result in zip(chosen.tolist(), results, strict=True):
        if result is None:
            continue
        row = row_columns([sweep_row(result)], (1,))
        del row["max_sweeps"]  # the limit that it had
        for name, values in row.items():
            if values.dtype.kind == "U":  # of any length
                columns[name] = columns[name].astype(object)
            columns[name][position] = values[0]


def _merge(
    folder: Path,
    name: str,
    located: LocatedRows,
    columns: dict[str, NDArray[Any]],
    row: type[SweepRow],
    origin: Provenance,
) -> None:
    """Put all simulations of a shard into one file, and remove those that it replaces."""
    used = [number for number in range(len(located.files)) if np.any(located.file == number)]
    paths = [located.files[number].path for number in used]
    if [folder] == [path.parent for path in paths] and _is_merged(located.files[used[0]], located):
        return
    if sum(path.stat().st_size for path in paths) > _MOST_MERGED_BYTES:
        return
    parts, order = [], []
    for number in used:
        chosen = located.place[located.file == number]
        parts.append(selected(_with_all_columns(located.files[number].path, row), chosen))
        order.append(np.flatnonzero(located.file.ravel() == number))
    merged = selected(concatenated(parts), np.argsort(np.concatenate(order)))
    merged = merged.assign(
        {column: (SIMULATION, values, merged[column].attrs) for column, values in columns.items()}
    )
    merged_path = write_curves(folder, MERGED, name, merged, origin)
    in_merged = stored_rows(merged_path).identities
    for path in curve_files(folder):
        rows = stored_rows(path)
        is_replaced = rows.physics_version < PHYSICS_VERSION or rows.identities <= in_merged
        if is_replaced and path != merged_path:
            path.unlink()


def _with_all_columns(path: Path, row: type[SweepRow]) -> xr.Dataset:
    """Dataset of a file of curves; columns of a row that its older version lacks are NaN."""
    dataset = read_dataset(path)
    unknown = np.full(dataset.sizes[SIMULATION], np.nan)
    lacking = {
        item.name: labelled(item, unknown)
        for item in variables(row, SIMULATION)
        if item.name not in dataset
    }
    return dataset.assign(lacking)


def _is_merged(rows: StoredRows, located: LocatedRows) -> bool:
    """Whether a file is a merged one of this version with all simulations and no others."""
    is_complete = len(rows.series) == located.file.size
    return rows.path.name.startswith(MERGED) and is_complete and not is_older(rows)
