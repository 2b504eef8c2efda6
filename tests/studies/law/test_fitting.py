"""The fit behind the law of k."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront.analysis.law import law_value, shipped_law
from crackfront.analysis.table import PLACE
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import write_derived
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import failed_row
from studies.__main__ import main
from studies.law.cells import COLUMNS, MEASURED, LawCell, law_cells, measured_cells
from studies.law.fitting import fitted_law
from studies.law.front_sweeps import front_sweeps
from tests.commands import dataset_of_rows
from tests.places import ROOT


@pytest.mark.slow
def test_the_fit_finds_the_law_that_was_planted(rng):
    truth = (3.6, 0.5, 0.1, 0.05, 1.0, 1.2, 2.0, 1.2, 0.2, 0.05)
    template = measured_cells()[0]
    cells = [
        planted_cell(template, truth, s, g, breadth, 1 + 0.01 * rng.standard_normal())
        for s, breadth in zip(
            (0.1, 0.2, 0.4, 0.6, 0.84, 1.1), (1, 2.0, 3.0, 1, 3.0, 0.5), strict=True
        )
        for g in np.geomspace(0.3, 100, 10)
    ]
    law = fitted_law(cells)
    s, g = np.array([0.1, 0.4, 0.84]), np.array([1.0, 10.0, np.inf])
    np.testing.assert_allclose(
        law_value(law.coefficients, s[:, None], g),
        law_value(truth, s[:, None], g),
        rtol=0.03,
    )
    assert law.rms < 0.02
    assert law.exponent[0] == pytest.approx(0.612, abs=3 * law.exponent[1])


def planted_cell(template: LawCell, truth, s, g, breadth, noise):
    """A cell whose k is that of the law times the noise."""
    k = float(law_value(truth, s, g, breadth)) * noise
    place = {"disorder": s, "size": g, "breadth": breadth}
    return replace(template, **place, both=k, error=0.01 * k, numerical_error=0.0)


def test_the_command_fits_the_law_of_the_package_to_the_kept_cells(tmp_path):
    done = CliRunner().invoke(main, ["law", "fit", "--output", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "cells.csv").read_text() == MEASURED.read_text()
    shipped, again = shipped_law(), json.loads((tmp_path / "law.json").read_text())
    np.testing.assert_allclose(again["coefficients"], shipped.coefficients, rtol=1e-6, atol=1e-6)
    assert again["rms"] == pytest.approx(shipped.rms, rel=1e-6)
    assert again["size"] == pytest.approx(shipped.size)
    assert sum(row[-1] for row in again["departures"]) == sum(
        cell.size >= shipped.size[0] for cell in measured_cells()
    )
    np.testing.assert_allclose(again["departures"], shipped.departures, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize(
    ("verb", "name"), [("fit", "config/line-quick.yaml"), ("spheres", "config/default.yaml")]
)
def test_the_table_of_another_configuration_is_refused(tmp_path, monkeypatch, verb, name):
    text = (ROOT / name).read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    path = Path("sweep.yaml")
    path.write_text(text)
    sweep = load_sweep(path)
    rows = [failed_row(simulation, "invalid", "a test") for simulation in sweep.simulations()]
    table = dataset_of_rows(sweep, rows)
    write_derived(Path("results/sweep/hysteresis.nc"), table, provenance(text))
    path.write_text(re.sub(r"^seed: \d+", "seed: 77", text, flags=re.M))
    done = CliRunner().invoke(main, ["law", verb, str(path), "--output", "out"])
    assert done.exit_code == 2
    assert "hysteresis.nc is the table of another configuration than the one given" in done.output


def test_spacings_are_extrapolated_to_none_in_either_order_of_the_amplitudes(tmp_path):
    sweep = front_sweeps(tmp_path)["line-weak"]
    sweep, energies = replace(sweep, spectra=sweep.spectra[:1]), sweep.elastic_energies
    energy = np.array(energies)[None, :, None] * np.ones((1, 2, 3))
    depth = energy * np.array([3.0, 2.0])[None, :, None]
    values = dict.fromkeys((*COLUMNS, "front_rms", "negative_share"), 0.01 * energy)
    values |= {"e_el": energy, "w_appr": 1 - energy - depth, "w_retr": 1 - energy + depth}
    table = xr.Dataset({name: (PLACE, value) for name, value in values.items()})
    [extrapolated] = law_cells(sweep, table)
    [again] = law_cells(
        replace(sweep, elastic_energies=energies[::-1]), table.isel(amplitude=[1, 0])
    )
    assert again.both == pytest.approx(extrapolated.both)
    assert extrapolated.both == pytest.approx(3.0 + energies[0] / (energies[1] - energies[0]))
