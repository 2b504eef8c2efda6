"""The file of a whole sweep: every simulation's apparent work of adhesion, status and cost."""

from __future__ import annotations

import functools
import json
import math
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import asdict, fields
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from crackfront.analysis.steady import (
    STEADY_DEFINITION,
    SteadyAdhesion,
    SteadyMeasures,
    mean_adhesion,
)
from crackfront.analysis.table import (
    PLACE,
    REALISATION,
    SPECTRUM,
    SweepAxes,
    SweepRow,
    SweepTable,
)
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.fingerprint import fingerprint
from crackfront.core.outcome import Status
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.variables import ADHESION, variables
from crackfront.data.files import UnreadableFileError, read_dataset, write_dataset
from crackfront.data.labels import flag_words, label, labelled_fields
from crackfront.data.provenance import Provenance
from crackfront.simulate.numerics import stated_error
from crackfront.simulate.run import SimulationResult
from crackfront.simulate.simulation import Simulation
from crackfront.sweep.sweep import Sweep

COMPLETE = ("lost_contact", "steady")
"""Statuses of a simulation that has values: a full cycle, or the steady parts of both branches."""

SWEEP_FINGERPRINT = "sweep_fingerprint"
"""Attribute that says of which configuration a table is."""

_WINDOW = ("lowest_radius", "highest_radius")
"""Ends of the steady window."""

NO_STEADY_PART = "no_steady_part"
"""Status of a complete cycle without enough steady states."""

_STATUSES = (*(one.name.lower() for one in Status), NO_STEADY_PART, "refused", "defect")
"""What `status` may be; the file of a sweep has their places."""


def rows_dataset(sweep: Sweep, rows: Sequence[SweepRow], realisations: range) -> xr.Dataset:
    """Rows of all spectra and amplitudes of a sweep and some of its realisations.

    They stand in the order of :meth:`crackfront.sweep.sweep.Sweep.simulations`.
    """
    axes = _axes(sweep, realisations)
    shape = axes.spectrum.size, axes.amplitude.size, axes.realisation.size
    columns = {}
    for variable in variables(SweepRow, *PLACE):
        values = np.array([getattr(row, variable.name) for row in rows])
        words = _STATUSES if variable.name == "status" else ()
        if words:
            values = np.array([words.index(value) for value in values], np.int8)
        columns[variable.name] = (variable.dims, values.reshape(shape), label(variable, words))
    return xr.Dataset(columns, labelled_fields(axes), _attributes(sweep))


def write_hysteresis(
    path: Path, sweep: Sweep, shards: Sequence[Sequence[xr.Dataset]], origin: Provenance
) -> None:
    """Write the file of a sweep: for each spectrum its shards, one after the other.

    The shards of a spectrum are datasets of :func:`rows_dataset` that have all its realisations in
    their order.
    """
    spectra = [
        xr.concat([one.drop_vars(list(one.coords)) for one in parts], REALISATION)
        for parts in shards
    ]
    axes = labelled_fields(_axes(sweep, range(sweep.n_realisation)))
    # What the files say of their storage is theirs, as the length of their longest text.
    whole = xr.concat(spectra, SPECTRUM).drop_encoding().assign_coords(axes)
    write_dataset(path, whole.drop_attrs(deep=False).assign_attrs(_attributes(sweep)), origin)


def read_table(path: Path) -> SweepTable:
    """Arrays of a sweep that a fit needs, from a file that :func:`write_hysteresis` wrote.

    UnreadableFileError if the file is missing, truncated or that of something else.
    """
    names = sorted(set(SweepTable.__dataclass_fields__) - {"contact_radius", "parameters"})
    dataset = _read(path, (*names, *_WINDOW))
    columns = {name: np.asarray(dataset[name]) for name in names}
    if "parameters" in dataset:  # of spectra that are not self-affine
        columns["parameters"] = np.asarray(dataset["parameters"])
    columns["contact_radius"] = np.mean([dataset[name] for name in _WINDOW], axis=0)
    columns["spectrum"] = columns["spectrum"].astype(np.str_)
    return SweepTable(**columns)


def read_statuses(path: Path) -> Counter[str]:
    """Number of simulations of every status in the file of a sweep; as :func:`read_table`."""
    return Counter(flag_words(_read(path, ("status",)).status).ravel().tolist())


def _read(path: Path, names: Collection[str]) -> xr.Dataset:
    """Dataset of a file with variables that it must have, `status` with the words of its flags."""
    dataset = read_dataset(path, names)
    missing = [name for name in names if name not in dataset]
    if "status" in dataset and "flag_meanings" not in dataset.status.attrs:
        missing.append("the flags of status")
    if missing:
        raise UnreadableFileError(f"{path} lacks {', '.join(missing)}; aggregate the sweep again")
    return dataset


def sweep_row(result: SimulationResult) -> SweepRow:
    """What the file of a sweep says about one simulation."""
    record, simulation = result.record, result.simulation
    length = simulation.correlation_length
    mean = 1 - result.measures.e_el if simulation.kind == "roughness" else 1.0
    steady = mean_adhesion(record, length, simulation.schedule.n_period, mean)
    status, sentence = _status(record, steady)
    known, cycle = status in COMPLETE, status == COMPLETE[0]
    numerical = stated_error(simulation, steady, length) if known else (np.nan, np.nan)
    measures: dict[str, Any] = {
        item.name: getattr(steady, item.name) if known or item.units != ADHESION else np.nan
        for item in variables(SteadyMeasures)
    }
    return SweepRow(
        **measures | asdict(result.measures),
        w_appr_numerical_error=numerical[0],
        w_retr_numerical_error=numerical[1],
        iterations=int(np.sum(record.states.iterations)),
        n_step=record.states.direction.size,
        pull_off_force=float(np.min(record.states.force, initial=np.inf)) if cycle else np.nan,
        end_penetration=record.end_load,
        status=status,
        status_sentence=sentence,
        seed=simulation.seed,
        curve=f"{simulation.stem}.nc",
    )


def failed_row(simulation: Simulation, status: str, sentence: str) -> SweepRow:
    """The same about a simulation that cannot be done, and why, in a word and in a sentence."""
    unknown: dict[str, Any] = {item.name: math.nan for item in fields(SweepRow)}
    nothing = dict.fromkeys(("iterations", "n_step", "n_approach", "n_retraction"), 0)
    known = {"status": status, "status_sentence": sentence, "seed": simulation.seed, "curve": ""}
    return SweepRow(**(unknown | nothing | known))


@functools.cache
def row_fingerprint() -> str:
    """Twelve hexadecimal digits that change with any module that makes a row of a result."""
    return fingerprint(__name__)


def _status(record: CycleRecord, steady: SteadyAdhesion) -> tuple[str, str]:
    """How a simulation ended, in a word and in a sentence."""
    status = record.status.name.lower()
    if status in COMPLETE and steady.sentence:
        return NO_STEADY_PART, steady.sentence
    return status, record.status.value


def _axes(sweep: Sweep, realisations: range) -> SweepAxes:
    """Coordinates of a sweep, and of some of its realisations."""
    spectra = [item.spectrum for item in sweep.spectra]
    energies = np.array(sweep.elastic_energies)
    firsts = [sweep.one_per_amplitude(item) for item in sweep.spectra]
    stated = all(isinstance(one, SelfAffineSpectrum) for one in spectra)
    texts = [json.dumps(one.parameters, default=np.ndarray.tolist) for one in spectra]

    def each(name: str) -> NDArray[Any]:
        return np.array([[attrgetter(name)(one) for one in row] for row in firsts])

    return SweepAxes(
        spectrum=np.array([item.name for item in sweep.spectra]),
        short_cutoff=np.array([spectrum.short_cutoff for spectrum in spectra]),
        roll_off=np.array([spectrum.longest_feature for spectrum in spectra]),
        hurst=np.array([getattr(spectrum, "hurst", math.nan) for spectrum in spectra]),
        correlation_length=each("correlation_length")[:, 0],
        spring=each("schedule.spring"),
        n_angle=each("resolution.n_angle"),
        sample_spacing=each("resolution.spacing"),
        tile_side=each("resolution.tile_side")[:, 0],
        n_point=each("resolution.n_point"),
        tolerance=each("solver.tolerance"),
        amplitude=energies,
        w_rms_requested=2 * np.sqrt(energies),
        realisation=np.array(realisations),
        parameters=None if stated else np.array(texts),
    )


def _attributes(sweep: Sweep) -> dict[str, str | float]:
    """Attributes of the file of a sweep."""
    attributes: dict[str, str | float] = {
        "title": f"adhesion hysteresis, {sweep.kind}",
        "kind": sweep.kind,
        "definition": STEADY_DEFINITION,
        "sweep_seed": sweep.seed,
        SWEEP_FINGERPRINT: sweep.table_fingerprint,
    }
    if sweep.scales is not None:
        attributes |= {f"scale_{name}": value for name, value in asdict(sweep.scales).items()}
        attributes |= {
            "lateral_unit_in_metres": sweep.scales.lateral,
            "vertical_unit_in_metres": sweep.scales.vertical,
            "force_unit_in_newtons": sweep.scales.force,
        }
    return attributes
