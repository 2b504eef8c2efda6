"""Files of the surfaces of a sweep: units, seeds, and values as they are simulated."""

import shutil
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crackfront.core.units import WORK_OF_ADHESION, Scales
from crackfront.simulate.simulation import simulation_adhesion
from crackfront.simulate.tiles import surface_values
from crackfront.sweep.parameters import load_sweep
from tests.commands import done, refused
from tests.yaml_texts import from_yaml, to_yaml

TEST = Path(__file__).parents[2] / "config/test.yaml"
SCALES = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.93e6)


@pytest.fixture
def in_metres(tmp_path):
    """The configuration `test` for a sphere in SI units."""
    content = from_yaml(TEST.read_text("utf-8"))
    for spectrum in content["spectra"]:
        for name in {"short_cutoff", "roll_off"} & set(spectrum):
            spectrum[name] *= SCALES.lateral
    for name in ("max_penetration", "step"):
        content["load"][name] *= SCALES.vertical
    path = tmp_path / "sweep.yaml"
    path.write_text(to_yaml(content | {"scales": asdict(SCALES)}))
    return path


def test_files_have_the_surfaces_that_are_simulated_with_their_seeds(tmp_path):
    done("surfaces", TEST, "--output", tmp_path)
    sweep = load_sweep(TEST)
    for item in sweep.spectra:
        surfaces = xr.load_dataset(tmp_path / f"surfaces/{item.name}.nc")
        assert len(surfaces.data_vars) == 2 * 2 * 2
        for simulation in sweep.simulations(item):
            name = f"e{simulation.elastic_energy:g}_r{simulation.realisation}"
            height, w_loc = surfaces[f"height_{name}"], surfaces[f"w_loc_{name}"]
            np.testing.assert_array_equal(height, surface_values(simulation.surface))
            adhesion = simulation_adhesion(simulation).work_of_adhesion
            np.testing.assert_allclose(w_loc, adhesion / WORK_OF_ADHESION, rtol=1e-14)
            assert (height.attrs["seed"], w_loc.attrs["reduced_unit"]) == (simulation.seed, "w_int")


def test_surfaces_of_a_sphere_in_si_units_are_scans_that_the_command_surface_analyses(
    tmp_path, in_metres
):
    done("surfaces", in_metres, "--output", tmp_path, "--spectrum", "rough")
    path = tmp_path / "surfaces/rough.nc"
    assert [file.name for file in path.parent.glob("*.nc")] == ["rough.nc"]
    surfaces, simulation = xr.load_dataset(path), next(load_sweep(in_metres).simulations())
    side = surfaces.sizes["x_e0.1"] * float(np.diff(surfaces["x_e0.1"])[0])
    assert side == pytest.approx(SCALES.lateral * simulation.resolution.tile_side)
    height, w_loc = surfaces["height_e0.1_r0"], surfaces["w_loc_e0.1_r0"]
    assert (height.attrs["units"], w_loc.attrs["units"]) == ("m", "J / m^2")
    assert float(w_loc.mean()) == pytest.approx(0.9 * SCALES.work_of_adhesion, rel=0.05)
    shown = done("surface", path, "--channel", "height_e0.1_r0").stdout
    assert f"{1e6 * side:.3g} um" in shown


def test_surfaces_that_cannot_be_written_leave_the_earlier_file(tmp_path, monkeypatch):
    done("surfaces", TEST, "--output", tmp_path, "--spectrum", "flat")
    path = tmp_path / "surfaces/flat.nc"
    before = shutil.copy(path, tmp_path / "before.nc")
    monkeypatch.setattr(
        "crackfront.sweep.surface_files.surface_values",
        lambda surface: (_ for _ in ()).throw(ValueError("no values")),
    )
    assert "no values" in refused("surfaces", TEST, "--output", tmp_path, "--spectrum", "flat")
    assert path.read_bytes() == Path(before).read_bytes()
    assert len([*path.parent.iterdir()]) == 2
