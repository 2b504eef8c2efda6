"""A row of a sweep's table is run again, bit for bit."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import crackfront as cf
from crackfront.core.adhesion import rough_adhesion
from crackfront.simulate.simulation import simulation_adhesion
from tests.commands import slow
from tests.yaml_texts import from_yaml, to_yaml

CONFIG = Path(__file__).parents[2] / "config"
KINDS = ["spheres", slow("chemical"), "fronts"]


@pytest.fixture(scope="module", params=KINDS)
def table(request, tmp_path_factory):
    """Table of a small sweep of a kind, as its file has it."""
    folder = tmp_path_factory.mktemp(request.param)
    content = from_yaml((CONFIG / "test.yaml").read_text("utf-8"))
    if request.param == "fronts":
        line = {"springs": [1], "length": 10, "period": 20, "transient": 3, "step": 0.5}
        content["load"] = {"line": line}
        content["numerics"]["tile"] = {"roll_offs": 4, "cutoffs": 40}
    if request.param == "chemical":
        content |= {"field": "chemical", "amplitudes": {"work_of_adhesion_rms": [0.3, 0.6]}}
    content |= {"record": ["fronts"], "realisations": 2}
    path = folder / "sweep.yaml"
    path.write_text(to_yaml(content))
    cf.run_sweep(path, folder / "out", progress=False)
    return xr.load_dataset(folder / "out/hysteresis.nc")


def row_of(table):
    """A row that is not the first along any dimension."""
    return table.isel(spectrum=1, amplitude=1, realisation=1)


def test_a_row_is_repeated_bit_for_bit_with_what_was_recorded(table):
    row = row_of(table)
    again = cf.simulation(row).run()
    for name in ("w_appr", "w_retr", "w_appr_error", "e_el", "w_rms", "pull_off_force", "n_step"):
        np.testing.assert_array_equal(again[name], row[name])
    assert again.sizes["step"] == row.n_step
    assert {"radius", "position"} & again.variables.keys()
    works = re.findall(r"(w_\w+|hysteresis) ([\d.-]+)", again.attrs["result"])
    assert {name: float(value) for name, value in works} == {
        name: pytest.approx(row[name].item(), abs=5e-4)
        for name in ("w_appr", "w_retr", "hysteresis")
    }


def test_the_surface_of_a_row_is_the_one_that_it_was_simulated_on(table):
    simulation = cf.simulation(row_of(table))
    surface, values = simulation.surface, simulation.surface.values
    if surface.name == "height":
        values = rough_adhesion(values, float(surface.x[1] - surface.x[0])).work_of_adhesion
    else:
        values = values / np.pi
    adhesion = simulation_adhesion(simulation.parameters).work_of_adhesion
    np.testing.assert_allclose(values, adhesion, rtol=1e-12, atol=1e-13)
    assert surface.attrs["short_cutoff"] == row_of(table).short_cutoff


def test_several_rows_and_other_versions_are_no_row_that_can_be_run(table):
    with pytest.raises(ValueError, match="sel"):
        cf.simulation(table.isel(spectrum=0))
    with pytest.raises(ValueError, match="run the sweep again"):
        cf.simulation(row_of(table).assign_attrs(physics_version=0))
    with pytest.raises(TypeError, match="row"):
        cf.simulation(row_of(table).w_appr)
