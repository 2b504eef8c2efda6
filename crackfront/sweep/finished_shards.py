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
    rename_curves,
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
    files = [located.files[number] for number in used]
    is_whole = _is_whole_shard(folder, files, located)
    if is_whole and files[0].path.name.startswith(MERGED):
        return
    if is_whole and _is_in_order(located):
        # One batch, as of a short sweep, need not be written again.
        merged_path = rename_curves(files[0].path, MERGED, name)
        in_merged = files[0].identities
    elif sum(rows.path.stat().st_size for rows in files) > _MOST_MERGED_BYTES:
        return
    else:
        merged = _merged(located, used, columns, row)
        merged_path = write_curves(folder, MERGED, name, merged, origin)
        in_merged = stored_rows(merged_path).identities
    for path in curve_files(folder):
        if path == merged_path:
            continue
        rows = stored_rows(path)
        if rows.physics_version < PHYSICS_VERSION or rows.identities <= in_merged:
            path.unlink()


def _merged(
    located: LocatedRows,
    used: list[int],
    columns: dict[str, NDArray[Any]],
    row: type[SweepRow],
) -> xr.Dataset:
    """Dataset of all simulations of a shard in their order, from the files that have them."""
    parts, order = [], []
    for number in used:
        chosen = located.place[located.file == number]
        parts.append(selected(_with_all_columns(located.files[number].path, row), chosen))
        order.append(np.flatnonzero(located.file.ravel() == number))
    merged = selected(concatenated(parts), np.argsort(np.concatenate(order)))
    return merged.assign(
        {column: (SIMULATION, values, merged[column].attrs) for column, values in columns.items()}
    )


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


def _is_whole_shard(folder: Path, files: list[StoredRows], located: LocatedRows) -> bool:
    """Whether one file of a folder has the rows of today of a whole shard, and no others."""
    if [folder] != [rows.path.parent for rows in files] or is_older(files[0]):
        return False
    return len(files[0].series) == located.file.size


def _is_in_order(located: LocatedRows) -> bool:
    """Whether a single file has the simulations of a shard in their order."""
    return np.array_equal(located.place.ravel(), np.arange(located.place.size))
