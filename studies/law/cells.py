"""k of straight fronts, to which the law is fitted: from sweeps of them to rows of `cells.csv`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from crackfront.analysis.csv_records import csv_rows
from crackfront.analysis.estimate import mean_estimate
from crackfront.analysis.law import spectral_breadth
from crackfront.core.adhesion import (
    FieldKind,
    adhesion_rms,
    force_correlation_length,
    larkin_length,
    mean_adhesion,
)
from crackfront.core.variables import variable
from crackfront.simulate.line.line_loads import LineLoad
from crackfront.sweep.sweep import Sweep

COLUMNS = ("e_el", "w_appr", "w_retr", "w_appr_numerical_error", "w_retr_numerical_error")
"""Columns of a sweep's table that k is made of."""

MEASURED = Path(__file__).with_name("cells.csv")
"""Straight fronts that the law of the package is fitted to."""


HELD_OUT = ("h05", "gaussian")
"""Spectra of straight fronts that have no part in the fit."""


@dataclass(frozen=True)
class Means:
    """e_el and k of one spectrum and amplitude, with standard errors over realisations."""

    elastic_energy: float
    realisations: int
    approach: float
    approach_error: float
    retraction: float
    retraction_error: float
    both: float
    both_error: float
    numerical_error: float


@dataclass(frozen=True, slots=True)
class LawCell:
    """One spectrum, amplitude and spring: a row of `cells.csv`."""

    spectrum: str = variable("name of the spectrum", "1")
    breadth: float = variable("breadth of the spectrum of the slope of w_loc", "1")
    disorder: float = variable("s, rms of w_loc; 0 where sites are uncorrelated", "w_int")
    size: float = variable("g, length of the springs over the Larkin length", "1")
    realisations: int = variable("tiles", "1")
    approach: float = variable("k_appr", "1")
    retraction: float = variable("k_retr", "1")
    both: float = variable("k, the mean of the two", "1")
    error: float = variable("standard error of k over the tiles", "1")
    numerical_error: float = variable("standard error of k that the numerics leave", "1")
    front_rms: float = variable("rms of the front over the force's correlation length", "1")
    negative_share: float = variable("part of the tile where w_loc is negative", "1")


def measured_cells() -> tuple[LawCell, ...]:
    """Rows of the kept `cells.csv`."""
    return csv_rows(MEASURED.read_text(encoding="utf-8"), LawCell)


def mean_factors(kind: FieldKind, columns: Mapping[str, ArrayLike]) -> Means:
    """Mean k of realisations by the columns :data:`COLUMNS`; those without a value are left out."""
    e_el, w_appr, w_retr, w_appr_error, w_retr_error = (
        np.asarray(columns[name], dtype=float) for name in COLUMNS
    )
    e_el = np.where(np.isfinite(w_appr + w_retr), e_el, np.nan)
    mean = mean_adhesion(kind, e_el)
    lowering, raising = (mean - w_appr) / e_el, (w_retr - mean) / e_el
    approach, retraction = mean_estimate(lowering)[0], mean_estimate(raising)[0]
    both, count = mean_estimate((lowering + raising) / 2)
    numerical_error = (w_appr_error + w_retr_error) / (2 * e_el)
    return Means(
        elastic_energy=float(mean_estimate(e_el)[0].value),
        realisations=int(count),
        approach=float(approach.value),
        approach_error=float(approach.standard_error),
        retraction=float(retraction.value),
        retraction_error=float(retraction.standard_error),
        both=float(both.value),
        both_error=float(both.standard_error),
        numerical_error=float(mean_estimate(numerical_error)[0].value),
    )


def cell_means(kind: FieldKind, dataset: xr.Dataset) -> dict[tuple[int, int], Means]:
    """Means of every spectrum and amplitude of a sweep, by their places in it."""
    columns = {name: dataset[name].values for name in COLUMNS}
    n_spectrum, n_amplitude = columns["e_el"].shape[:2]
    return {
        (place, amplitude): mean_factors(
            kind, {name: values[place, amplitude] for name, values in columns.items()}
        )
        for place in range(n_spectrum)
        for amplitude in range(n_amplitude)
    }


def law_cells(sweep: Sweep, dataset: xr.Dataset) -> list[LawCell]:
    """Cells of a sweep of straight fronts from its table; spheres are a ValueError."""
    load = sweep.schedule
    if not isinstance(load, LineLoad):
        raise ValueError("the sweep runs spheres; the law is measured on straight fronts")
    cells = []
    for (place, amplitude), means in cell_means(sweep.kind, dataset).items():
        item, requested = sweep.spectra[place], sweep.elastic_energies[amplitude]
        simulation = sweep.simulation(item, requested, 0)
        larkin = larkin_length(sweep.kind, item.spectrum, adhesion_rms(requested))
        depth = force_correlation_length(sweep.kind, item.spectrum)
        cell = dataset.isel(spectrum=place, amplitude=amplitude)
        # A spectrum has an entry for every spring, whose name ends with the spring's.
        name = item.name.rpartition("-L")[0]
        cells.append(
            LawCell(
                spectrum=name if sweep.kind == "roughness" else f"{name}-{sweep.kind}",
                breadth=spectral_breadth(sweep.kind, item.spectrum),
                disorder=0.0 if load.uncorrelated else adhesion_rms(means.elastic_energy),
                size=simulation.schedule.spring_at(1.0) / larkin,
                realisations=means.realisations,
                approach=means.approach,
                retraction=means.retraction,
                both=means.both,
                error=means.both_error,
                numerical_error=means.numerical_error,
                front_rms=float(cell.front_rms.mean()) / depth,
                negative_share=float(cell.negative_share.mean()),
            )
        )
    return _without_spacing(sweep, cells) if load.uncorrelated else cells


def _without_spacing(sweep: Sweep, cells: Sequence[LawCell]) -> list[LawCell]:
    """Extrapolation of two spacings of uncorrelated sites to none, linear in the spacing.

    ValueError if there are not two amplitudes, whose spacings these are.
    """
    energies = sweep.elastic_energies
    if len(energies) != 2:
        raise ValueError(f"uncorrelated sites have {len(energies)} amplitudes; give two")
    fine, coarse = sorted(energies)
    # The spacing is a pixel; in units of the Larkin length it goes with e_el.
    weight = fine / (coarse - fine)
    extrapolated, order = [], 1 if energies[0] == fine else -1
    for pair in zip(cells[::2], cells[1::2], strict=True):
        first, second = pair[::order]
        numbers = {
            name: getattr(first, name) + weight * (getattr(first, name) - getattr(second, name))
            for name in ("approach", "retraction", "both", "front_rms")
        }
        remainder = abs(numbers["both"] - first.both) / 3
        extrapolated.append(
            replace(
                first,
                **numbers,
                spectrum=f"{first.spectrum}-weak",
                error=float(np.hypot((1 + weight) * first.error, weight * second.error)),
                numerical_error=float(np.hypot(first.numerical_error, remainder)),
            )
        )
    return extrapolated
