"""Canaries of the law of k."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from crackfront.simulate.run_simulation import run_simulation
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import row_columns, sweep_row
from crackfront.sweep.table_file import columns_dataset
from studies.law.cells import law_cells, measured_cells
from studies.law.fitting import fitted_law
from studies.law.spheres import SCENES, scene_rows
from studies.numbers import Number

_SAME_SURFACES = "standard error that the numerics leave: the surfaces are the same"


def _fronts() -> Mapping[str, Number]:
    """Straight fronts of one spectrum, amplitude and spring."""
    sweep = load_sweep(Path("config/line-quick.yaml"))
    sweep = replace(sweep, spectra=sweep.spectra[-1:], elastic_energies=sweep.elastic_energies[-1:])
    rows = [sweep_row(run_simulation(simulation)) for simulation in sweep.simulations()]
    columns = row_columns(rows, (1, 1, sweep.n_realisation))
    (cell,) = law_cells(sweep, columns_dataset(sweep, columns, range(sweep.n_realisation)))
    return {"k": Number(cell.both, cell.numerical_error, reason=_SAME_SURFACES)}


def _fit() -> Mapping[str, Number]:
    """Fit to the stored fronts."""
    law = fitted_law(measured_cells())
    error = float(np.sqrt(law.covariance[0][0]))
    return {
        "k at vanishing disorder": Number(law.coefficients[0], error, reason="standard error"),
        "exponent": Number(*law.exponent, reason="standard error"),
        "rms difference": Number(law.rms, 0.0005, reason="last digit on the page"),
    }


def _sphere() -> Mapping[str, Number]:
    """One of the spheres to which nothing was fitted."""
    scenes = [scene for scene in SCENES if scene.name == "from-0"]
    (row,) = scene_rows(scenes, realisations=2)
    return {"k": Number(row.both, row.numerical_error, reason=_SAME_SURFACES)}


CANARIES = {"fronts": _fronts, "fit": _fit, "sphere": _sphere}
