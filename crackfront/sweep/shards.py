"""The file of a shard: the rows of its simulations, and attributes that say which these are."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import netCDF4
import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.table import PLACE, SweepRow
from crackfront.core.variables import variables
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from crackfront.data.digests import file_digest, stated_digest
from crackfront.data.files import (
    read_dataset,
    refuse_failing_system,
    utf8_path,
    write_dataset,
    write_digest,
)
from crackfront.data.provenance import Provenance
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.rows import COMPLETE
from crackfront.sweep.sweep import Shard, Sweep
from crackfront.sweep.table import rows_dataset

_BETWEEN = "; "
"""What stands between arithmetics in the attribute of a file."""


@dataclass(frozen=True, slots=True)
class FinishedShard:
    """What the attributes of a shard's file say, which are read without its rows."""

    path: Path
    spectrum: str
    realisations: range
    fingerprint: str
    """:func:`shard_request` when it was written."""
    failed: int
    """Simulations without a value."""
    cpu_seconds: float
    """Processor time of all simulations. (Units: s)"""
    arithmetic: frozenset[str]
    """Those of the origins of the rows."""


def shard_request(one_per_amplitude: Sequence[Simulation], realisations: range) -> str:
    """Twelve hexadecimal digits that change with the simulations of a shard and with the versions.

    The first realisation of each amplitude says what all realisations share.
    """
    series = [simulation.series for simulation in one_per_amplitude]
    text = repr((series, realisations, PHYSICS_VERSION, ROWS_VERSION))
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def write_shard(
    path: Path,
    sweep: Sweep,
    shard: Shard,
    rows: Sequence[SweepRow],
    arithmetic: Iterable[str],
    origin: Provenance,
) -> None:
    """Write the file of a shard, atomically, and its checksum beside it.

    The rows are those of :meth:`crackfront.sweep.sweep.Sweep.simulations`, in their order. The
    layout is that of the file of the whole sweep.
    """
    alone = replace(sweep, spectra=(shard.item,))
    about = {
        "spectrum_name": shard.item.name,
        "fingerprint": shard_request(sweep.one_per_amplitude(shard.item), shard.realisations),
        "first_realisation": np.int64(shard.realisations.start),
        "last_realisation": np.int64(shard.realisations.stop - 1),
        "failed": np.int64(sum(row.status not in COMPLETE for row in rows)),
        "cpu_seconds": float(np.nansum([row.cpu_seconds for row in rows])),
        "arithmetic_of_rows": _BETWEEN.join(sorted(arithmetic)),
    }
    dataset = rows_dataset(alone, rows, shard.realisations)
    write_dataset(path, dataset.assign_attrs(about), origin)
    write_digest(path)


def finished_shard(path: Path) -> FinishedShard | None:
    """What the attributes of a file say; None if it is damaged or not the file of a shard.

    OSError if the system cannot read it.
    """
    try:
        # HDF5 may read a damaged file as valid, or never return from it.
        if stated_digest(path) != file_digest(path):
            return None
        with utf8_path(path) as named, netCDF4.Dataset(named) as file:
            return FinishedShard(
                path=path,
                spectrum=str(file.spectrum_name),
                realisations=range(int(file.first_realisation), int(file.last_realisation) + 1),
                fingerprint=str(file.fingerprint),
                failed=int(file.failed),
                cpu_seconds=float(file.cpu_seconds),
                arithmetic=frozenset(filter(None, str(file.arithmetic_of_rows).split(_BETWEEN))),
            )
    except (OSError, AttributeError, ValueError) as error:
        if path.is_file():
            refuse_failing_system(path, error)
        return None  # emptied, cut, or of something else


def shard_columns(shard: FinishedShard, taken: range) -> dict[str, NDArray[np.generic]]:
    """Columns of the rows of a shard, of some of its realisations; texts are bytes of UTF-8.

    They are read without xarray, which takes 0.1 s to open a file: sweeps have hundreds.
    """
    first = shard.realisations.start
    columns = {}
    with utf8_path(shard.path) as named, netCDF4.Dataset(named) as file:
        file.set_auto_maskandscale(False)
        file.set_auto_chartostring(False)
        for item in variables(SweepRow):
            stored = file[item.name]
            values = np.asarray(stored[:, :, taken.start - first : taken.stop - first])
            is_text = stored.ndim > len(PLACE)
            columns[item.name] = values.view(f"S{values.shape[-1]}")[..., 0] if is_text else values
    return columns


def covering(
    shards: Iterable[FinishedShard], n_realisation: int
) -> list[tuple[FinishedShard, range]]:
    """Shards of a spectrum that together hold what all of them hold, and what is taken of each.

    No realisation is taken twice, and none beyond the number of those that are wanted.
    """
    chosen, position = [], 0
    for one in sorted(shards, key=lambda one: (one.realisations.start, -one.realisations.stop)):
        start, stop = one.realisations.start, one.realisations.stop
        taken = range(max(position, start), min(stop, n_realisation))
        if taken:
            chosen.append((one, taken))
            position = taken.stop
    return chosen


def curve_names(path: Path) -> list[str]:
    """Names of the curves in packs that belong to the rows of a shard's file."""
    return [name for name in read_dataset(path, ("curve",))["curve"].values.flat if name]
