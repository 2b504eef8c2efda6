"""Jumps of a sweep: a list of all in its curves, their numbers and sizes in its table."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crackfront.analysis.jump_measures import JumpMeasures
from crackfront.core.variables import variables
from crackfront.simulate.labels import stated_unit
from crackfront.simulate.run_simulation import run_simulation
from crackfront.sweep import tasks
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.rows import sweep_row
from crackfront.sweep.run_sweep import run_sweep
from crackfront.sweep.store import Store
from tests.commands import done, refused, run, table
from tests.places import ROOT

COLUMNS = {item.name for item in variables(JumpMeasures)}


def written(path, record="[jumps]"):
    """Configuration of two straight fronts on soft springs."""
    text = (ROOT / "tests/line-test.yaml").read_text(encoding="utf-8")
    text = text.replace("springs: [2, 8]", "springs: [2]").replace(
        "realisations: 2", "realisations: 1"
    )
    path.write_text(text + f"record: {record}\n", encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Configuration and folder of a sweep that records jumps."""
    folder = tmp_path_factory.mktemp("jumps")
    configuration = written(folder / "sweep.yaml")
    run_sweep(configuration, folder / "sweep", progress=False)
    return configuration, folder / "sweep"


def curves_of(folder):
    [path] = folder.glob("curves/*/*.nc")
    return xr.load_dataset(path)


def test_the_table_has_numbers_and_sizes_of_the_jumps_in_the_curves(recorded):
    _, folder = recorded
    rows, curves = xr.load_dataset(folder / "hysteresis.nc"), curves_of(folder)
    assert rows.variables.keys() >= COLUMNS
    first = rows.isel(amplitude=0, spectrum=0, realisation=0)
    jumps = curves.isel(jump=slice(0, int(curves.n_jump[0])))
    backward = curves.direction.values[: int(curves.n_state[0])] < 0
    period = np.flatnonzero(backward)[-int(first.n_retraction) :]
    inside = np.isin(jumps.jump_state, period)
    assert first.n_jump_retr == np.count_nonzero(inside) > 10
    assert first.jump_energy_retr == pytest.approx(float(jumps.jump_energy[inside].sum()))
    for name in ("energy", "area", "extent"):
        sizes = jumps[f"jump_{name}"].values[inside]
        assert first[f"jump_{name}_mean_retr"] == pytest.approx(np.mean(sizes))
        assert first[f"jump_{name}_median_retr"] == pytest.approx(np.median(sizes))
        assert first[f"jump_{name}_max_retr"] == np.max(sizes)


def test_every_variable_of_jumps_states_its_unit_and_meaning(recorded):
    _, folder = recorded
    rows, curves = xr.load_dataset(folder / "hysteresis.nc"), curves_of(folder)
    named = [rows[name] for name in COLUMNS]
    named += [curves[name] for name in curves if name.startswith("jump_")]
    assert all(item.attrs["units"] and item.attrs["long_name"] for item in named)
    assert all(
        "reduced_unit" in curves[f"jump_{name}"].attrs for name in ("energy", "area", "extent")
    )
    assert stated_unit(curves.jump_load.attrs) == stated_unit(curves.spring_position.attrs)
    assert curves.n_jump.attrs["sample_dimension"] == "jump"


def test_stored_jumps_are_those_of_the_simulation_and_give_its_row_again(recorded):
    configuration, folder = recorded
    rows = xr.load_dataset(folder / "hysteresis.nc")
    simulation = next(load_sweep(configuration).simulations())
    stored = Store(folder).result(load_sweep(configuration), simulation)
    expected = run_simulation(simulation).record.jumps
    for item in variables(type(expected)):
        values = (getattr(jumps, item.name) for jumps in (stored.record.jumps, expected))
        np.testing.assert_array_equal(*values)
    again = sweep_row(stored)
    for name in COLUMNS:
        assert getattr(again, name) == rows[name].isel(amplitude=0).item()


def test_a_folder_with_and_without_jumps_keeps_both_tables_apart(recorded, tmp_path):
    _, folder = recorded
    again = shutil.copytree(folder, tmp_path / "sweep")
    plain = run_sweep(written(tmp_path / "sweep.yaml", "[]"), again, progress=False)
    assert not COLUMNS & plain.variables.keys()
    with_jumps = {"jump_area" in xr.load_dataset(path) for path in again.glob("curves/*/*.nc")}
    assert with_jumps == {True, False}
    run_sweep(written(tmp_path / "sweep.yaml"), again, progress=False)
    assert table(again / "hysteresis.nc").equals(table(folder / "hysteresis.nc"))
    names = ["w_appr", "w_retr", "iterations", "front_rms"]
    assert (
        plain[names]
        .drop_vars("series")
        .equals(xr.load_dataset(again / "hysteresis.nc")[names].drop_vars("series"))
    )


def test_a_simulation_without_a_value_has_no_jumps(recorded, tmp_path, monkeypatch):
    configuration, folder = recorded
    sweep = load_sweep(configuration)
    failing, _ = sweep.simulations()

    def fail(simulation, **options):
        if simulation == failing:
            raise ValueError("too rough")
        return Store(folder).result(sweep, simulation)

    monkeypatch.setattr(tasks, "run_simulation", fail)
    with pytest.warns(UserWarning, match="too rough"):
        rows = run_sweep(configuration, tmp_path / "sweep", progress=False).squeeze()
    assert rows.n_jump_appr[0] == 0
    assert np.isnan(rows.jump_energy_appr[0])
    assert rows.n_jump_appr[1] > 10


def test_a_plan_states_what_the_jumps_cost(tmp_path):
    costs = []
    for record in ("[]", "[jumps]"):
        configuration = written(tmp_path / "sweep.yaml", record)
        options = ("plan", configuration, "--output", tmp_path / "out")
        costs.append(json.loads(done(*options, "--json").stdout))
        assert ("record: [jumps]" in done(*options).stdout) == (record == "[jumps]")
    plain, jumps = costs
    assert plain["jump_core_seconds"] == 0
    added = jumps["core_seconds"] - plain["core_seconds"]
    assert jumps["jump_core_seconds"] == pytest.approx(added)
    assert 0.3 < jumps["jump_core_seconds"] < 3


@pytest.mark.parametrize("record", ["[avalanches]", "jumps"])
def test_what_cannot_be_recorded_names_all_that_can(tmp_path, record):
    sentence = refused("plan", written(tmp_path / "sweep.yaml", record))
    assert "record" in sentence
    assert all(name in sentence for name in ("fronts", "energy", "jumps"))


@pytest.mark.slow
def test_ranks_record_the_same_jumps(recorded, tmp_path):
    configuration, folder = recorded
    command = ["-m", "crackfront", "simulate", configuration, "--output", tmp_path / "ranks"]
    mpiexec = Path(sys.executable).with_name("mpiexec")
    subprocess.run([mpiexec, "-n", "3", sys.executable, *command], check=True, timeout=300)
    assert run("aggregate", configuration, "--output", tmp_path / "ranks").exit_code == 0
    assert table(tmp_path / "ranks/hysteresis.nc").equals(table(folder / "hysteresis.nc"))
