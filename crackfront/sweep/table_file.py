"""The file of a whole sweep: every simulation's apparent work of adhesion, status and cost."""

from __future__ import annotations

import contextlib
import json
import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import MISSING, asdict, fields
from operator import attrgetter
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.analysis.jump_measures import JUMP_DEFINITION
from crackfront.analysis.steady_adhesion import STEADY_DEFINITION
from crackfront.analysis.table import COLUMNS, SweepAxes, SweepTable
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.variables import variables
from crackfront.simulate.contact import OnSprings, Schedule
from crackfront.simulate.ensembles import GAUSSIAN
from crackfront.simulate.labels import flag_words, labelled_fields
from crackfront.simulate.provenance import Provenance
from crackfront.simulate.storage import UnreadableFileError, read_derived, write_derived
from crackfront.surfaces.scales import CONFIGURED
from crackfront.sweep.requests import REQUEST, table_request
from crackfront.sweep.rows import labelled_columns
from crackfront.sweep.sweep import Sweep

_MOST_ADHESION = 100.0
"""Works of adhesion and energies above this are damage. (Units: w_int)"""

_WINDOW = ("lowest_radius", "highest_radius")
"""Ends of the steady window."""


def columns_dataset(
    sweep: Sweep, columns: Mapping[str, NDArray[np.generic]], realisations: range
) -> xr.Dataset:
    """Dataset of rows: columns over all spectra, all amplitudes and some realisations."""
    axes = labelled_fields(_axes(sweep, realisations))
    return xr.Dataset(labelled_columns(columns), axes, _attributes(sweep))


def write_hysteresis(
    path: Path,
    sweep: Sweep,
    shards: Sequence[Sequence[dict[str, NDArray[np.generic]]]],
    origin: Provenance,
) -> None:
    """Write the file of a sweep: for each spectrum the columns of its shards, in their order.

    The shards of a spectrum have all its realisations. Their columns are taken out of them, so that
    they need not be in memory twice.
    """
    columns = {}
    for variable in variables(sweep.row_type):
        spectra = [
            np.concatenate([shard.pop(variable.name) for shard in parts], axis=2)
            for parts in shards
        ]
        columns[variable.name] = np.concatenate(spectra)
    dataset = columns_dataset(sweep, columns, range(sweep.n_realisation))
    request = {REQUEST: table_request(sweep).digest}
    with _small_chunk_caches():
        write_derived(path, dataset.assign_attrs(request), origin)


@contextlib.contextmanager
def _small_chunk_caches() -> Iterator[None]:
    """Let netCDF cache a megabyte of each variable that it writes instead of 64.

    A column is written at once and never read, but its cache stays until the file is closed.
    """
    before = netCDF4.get_chunk_cache()
    netCDF4.set_chunk_cache(10**6, *before[1:])
    try:
        yield
    finally:
        netCDF4.set_chunk_cache(*before)


def read_table(path: Path) -> SweepTable:
    """Arrays of a sweep that a fit needs, from a file that :func:`write_hysteresis` wrote.

    UnreadableFileError if the file is missing, truncated, or not the table of a sweep, or if a
    value exceeds what any contact can have.
    """
    stored = [item for item in fields(SweepTable) if item.name in COLUMNS]
    required = [item.name for item in stored if item.default is MISSING]
    dataset = _read(path, (*required, *_WINDOW))
    names = [item.name for item in stored if item.name in dataset]
    columns = {name: np.asarray(dataset[name]) for name in names}
    for name in ("e_el", "w_rms", "w_appr", "w_retr"):
        values = np.abs(columns[name])
        largest = np.max(values, where=np.isfinite(values), initial=0.0) / WORK_OF_ADHESION
        if largest > _MOST_ADHESION:
            raise UnreadableFileError(
                f"{path}: {name} is up to {largest:.3g} w_int, a value that no contact can have; "
                "aggregate the sweep again"
            )
    columns["contact_radius"] = np.mean([dataset[name] for name in _WINDOW], axis=0)
    columns["spectrum"] = columns["spectrum"].astype(np.str_)
    return SweepTable(**columns)


def read_statuses(path: Path) -> Counter[str]:
    """Number of simulations of every status in the file of a sweep; as :func:`read_table`."""
    return Counter(flag_words(_read(path, ("status",)).status).ravel().tolist())


def _read(path: Path, names: Collection[str]) -> xr.Dataset:
    """Dataset of a file with variables that it must have, `status` with the words of its flags."""
    dataset = read_derived(path, names)
    missing = [name for name in names if name not in dataset]
    if "status" in dataset and "flag_meanings" not in dataset.status.attrs:
        missing.append("the flags of status")
    if missing:
        raise UnreadableFileError(f"{path} lacks {', '.join(missing)}; aggregate the sweep again")
    return dataset


def _axes(sweep: Sweep, realisations: range) -> SweepAxes:
    """Coordinates of a sweep, and of some of its realisations."""
    spectra = [item.spectrum for item in sweep.spectra]
    energies = np.array(sweep.elastic_energies)
    simulations = [sweep.one_per_amplitude(item) for item in sweep.spectra]
    self_affine = all(isinstance(spectrum, SelfAffineSpectrum) for spectrum in spectra)
    is_plain = self_affine and all(item.ensemble == GAUSSIAN for item in sweep.spectra)
    texts = [
        json.dumps(first.stated_parameters, default=np.ndarray.tolist) for first, *_ in simulations
    ]

    def stated(name: str) -> NDArray[Any]:
        value = attrgetter(name)
        return np.array([[value(simulation) for simulation in row] for row in simulations])

    return SweepAxes(
        spectrum=np.array([item.name for item in sweep.spectra]),
        short_cutoff=np.array([spectrum.short_cutoff for spectrum in spectra]),
        roll_off=np.array([spectrum.longest_feature for spectrum in spectra]),
        hurst=np.array([getattr(spectrum, "hurst", math.nan) for spectrum in spectra]),
        correlation_length=stated("correlation_length")[:, 0],
        spring=np.array(
            [[_spring(simulation.schedule) for simulation in row] for row in simulations]
        ),
        n_angle=stated("resolution.n_angle"),
        sample_spacing=stated("resolution.spacing"),
        tile_side=stated("resolution.tile_side"),
        n_point=stated("resolution.n_point"),
        tolerance=stated("solver.tolerance"),
        series=stated("series"),
        amplitude=energies,
        w_rms_requested=2 * np.sqrt(energies),
        realisation=np.array(realisations),
        parameters=None if is_plain else np.array(texts),
    )


def _spring(schedule: Schedule) -> float:
    """Length of the springs of a front (Units: reduced lateral length); NaN without springs."""
    return schedule.spring if isinstance(schedule, OnSprings) else math.nan


def _attributes(sweep: Sweep) -> dict[str, str | float]:
    """Attributes of the file of a sweep."""
    attributes: dict[str, str | float] = {
        "title": f"adhesion hysteresis, {sweep.kind}",
        "kind": sweep.kind,
        "definition": STEADY_DEFINITION,
        "sweep_seed": sweep.seed,
    }
    if "jumps" in sweep.record:
        attributes["jump_definition"] = JUMP_DEFINITION
    if sweep.scales is not None:
        attributes |= {f"{CONFIGURED}{name}": value for name, value in asdict(sweep.scales).items()}
        attributes |= {
            "lateral_unit_in_metres": sweep.scales.lateral,
            "vertical_unit_in_metres": sweep.scales.vertical,
            "force_unit_in_newtons": sweep.scales.force,
        }
    return attributes
