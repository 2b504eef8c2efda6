"""Spectra of configurations that are not self-affine, and surfaces that are not Gaussian."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import crackfront as cf
from crackfront.simulate.simulation import simulation_adhesion
from crackfront.simulate.tiles import gaussian_values as surface_values
from crackfront.sweep.feasibility import check_feasible
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.section import ConfigurationError, movable_text
from tests.commands import done
from tests.places import ROOT
from tests.yaml_texts import from_yaml, to_yaml

SPHERE = {"radius": 1.25e-3, "work_of_adhesion": 63e-3, "contact_modulus": 0.9333e6}


def configuration(folder, spectrum, name="sweep.yaml", **changes):
    """Path of the configuration `test` with a single spectrum and other changes."""
    content = from_yaml((ROOT / "config/test.yaml").read_text("utf-8"))
    path = Path(folder, name)
    path.write_text(to_yaml(content | {"spectra": [{"name": "s"} | spectrum]} | changes))
    return path


def in_metres(folder, spectrum, **changes):
    """Path of such a configuration with a sphere and lengths in metres."""
    load = {"max_penetration": 1e-6, "step": 1e-7}
    return configuration(folder, spectrum, **{"scales": SPHERE, "load": load} | changes)


def message_of(path):
    """What a configuration cannot be used for."""
    with pytest.raises(ConfigurationError) as caught:
        check_feasible(load_sweep(path), path)
    return str(caught.value)


def density_file(path, factor=1.0):
    """File of an isotropic density that falls as q^-3.6, times a factor."""
    wavevector = np.geomspace(1.0, 50.0, 40)  # 1/um
    rows = np.column_stack([wavevector, factor * 1e-4 * wavevector**-3.6])
    np.savetxt(path, rows, delimiter=",", header="q (1/um),C (um^4)", comments="")
    return path


def test_a_density_in_a_file_is_the_spectrum_that_a_prediction_has(tmp_path):
    density = density_file(tmp_path / "density.csv")
    sweep = load_sweep(in_metres(tmp_path, {"density": {"file": "density.csv"}}))
    expected, [item] = cf.read_psd(density).spectrum, sweep.spectra
    lengths = np.array(item.spectrum.wavelengths) * sweep.scales.lateral
    assert lengths == pytest.approx(np.array(expected.wavelengths), rel=1e-4)
    assert item.spectrum.identity[1] == pytest.approx(expected.identity[1], rel=1e-4)


def test_amplitudes_may_be_multiples_of_the_heights_of_a_density(tmp_path):
    energies = []
    for factor in (1.0, 4.0):
        density_file(tmp_path / "density.csv", factor)
        path = in_metres(
            tmp_path,
            {"density": {"file": "density.csv"}},
            amplitudes={"measured": [1.0]},
            fit={"lowest_elastic_energy": 1e-4, "highest_elastic_energy": 0.9, "bootstrap": 500},
        )
        energies += load_sweep(path).elastic_energies
    surface = cf.read_psd(tmp_path / "density.csv")
    expected = surface.conformity_energy(SPHERE["contact_modulus"]).value / 63e-3
    assert energies == pytest.approx([expected / 4, expected], rel=1e-3)


def test_simulations_change_with_the_content_of_a_file_of_densities(tmp_path):
    stems = []
    for factor in (1.0, 2.0):
        density_file(tmp_path / "density.csv", factor)
        path = in_metres(tmp_path, {"density": {"file": "density.csv"}})
        sweep, stored = load_sweep(path), tmp_path / "stored.yaml"
        stored.write_text(movable_text(path))
        assert load_sweep(stored) == sweep
        stems.append({simulation.stem for simulation in sweep.simulations()})
    assert not stems[0] & stems[1]


@pytest.mark.parametrize(
    ("density", "words"),
    [
        ({"file": "nowhere.csv"}, ("spectra[0].density", "nowhere.csv", "No such file")),
        ({"file": "density.csv", "psd_kind": "2D"}, ("psd_kind", "'2D'", "'2d'")),
        ({"file": "density.csv", "kind": "2d"}, ("unknown key kind", "psd_kind")),
        ({"file": "density.csv", "psd_units": "1/um,nm"}, ("density.csv", "'nm'", "psd-units")),
    ],
)
def test_a_file_of_densities_that_cannot_be_used_is_named_with_a_remedy(tmp_path, density, words):
    density_file(tmp_path / "density.csv")
    sentence = message_of(in_metres(tmp_path, {"density": density}))
    assert [word for word in words if word not in sentence] == []


def test_a_density_in_metres_needs_a_sphere(tmp_path):
    density_file(tmp_path / "density.csv")
    sentence = message_of(configuration(tmp_path, {"density": {"file": "density.csv"}}))
    assert "spectrum 's'" in sentence
    assert "give the section scales" in sentence


WIDE = from_yaml((ROOT / "config/test.yaml").read_text("utf-8"))["numerics"]
WIDE |= {"tile": {"roll_offs": 10, "cutoffs": 160}}
GROOVES = {"short_cutoff": 0.2, "anisotropy": {"ratio": 4.0, "angle": 30.0}}


def realisations(path):
    """Works of adhesion of all realisations of the first amplitude, and the requested e_el."""
    sweep = load_sweep(path)
    [item] = sweep.spectra
    energy = sweep.elastic_energies[0]
    simulations = [s for s in sweep.simulations(item) if s.elastic_energy == energy]
    return [simulation_adhesion(simulation) for simulation in simulations], energy


@pytest.mark.parametrize("ratio", [None, 2.0, 8.0])
def test_an_anisotropic_surface_has_the_energy_that_is_requested(tmp_path, ratio):
    spectrum = {"short_cutoff": 0.1}
    if ratio:
        spectrum["anisotropy"] = {"ratio": ratio, "angle": 40.0}
    maps, energy = realisations(configuration(tmp_path, spectrum, numerics=WIDE, realisations=4))
    assert np.mean([item.e_el for item in maps]) == pytest.approx(energy, rel=0.02)
    for item in maps:
        assert item.w_rms**2 == pytest.approx(4 * item.e_el, rel=1e-9)


def test_waves_are_longer_along_the_grooves_than_across_by_the_ratio(tmp_path):
    sweep = load_sweep(configuration(tmp_path, GROOVES, numerics=WIDE))
    surface = next(sweep.simulations()).surface
    slopes = np.gradient(surface_values(surface), surface.pixel)
    angle = np.radians(30.0)
    along = np.cos(angle) * slopes[0] + np.sin(angle) * slopes[1]
    across = np.cos(angle) * slopes[1] - np.sin(angle) * slopes[0]
    assert np.std(across) / np.std(along) == pytest.approx(4.0, rel=0.1)


def test_simulations_change_with_the_ratio_and_the_angle(tmp_path):
    series = set()
    stretches = [{"ratio": 2.0}, {"ratio": 3.0}, {"ratio": 2.0, "angle": 10.0}]
    for anisotropy in [None, *stretches]:
        spectrum = {"short_cutoff": 0.1} | ({"anisotropy": anisotropy} if anisotropy else {})
        series.add(next(load_sweep(configuration(tmp_path, spectrum)).simulations()).series)
    assert len(series) == 4


def test_a_sweep_of_anisotropic_surfaces_has_values_but_no_k_by_the_law(tmp_path):
    path = configuration(tmp_path, GROOVES)
    table = cf.run_sweep(path, tmp_path / "results", progress=False)
    assert np.all(np.isfinite(table.w_retr))
    assert np.all(np.isnan(table.w_appr_numerical_error))
    plan = json.loads(done("plan", path, "--output", tmp_path / "results", "--json").stdout)
    assert [cell["factor"] for cell in plan["expected"]["s"]] == [None, None]
    assert plan["missing"] == 0
    done("fit", path, "--output", tmp_path / "results")
    fit = xr.load_dataset(tmp_path / "results/fit.nc")
    assert np.all(np.isfinite(fit.factor.sel(bound="value")))
    assert np.all(np.isnan(fit.cell_law_factor))
    assert "does not cover s" in (tmp_path / "results/fit.md").read_text()
    row = table.isel(spectrum=0, amplitude=0, realisation=1)
    simulation = cf.simulation(row)
    assert simulation.surface.attrs["anisotropy"] == 4.0
    assert float(simulation.run().w_appr) == float(row.w_appr)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"numerics": {"error": 0.03}}, ("error is 0.03", "isotropic", "give the resolution")),
        ({"anisotropy": {"ratio": 0.5}}, ("anisotropy.ratio", "0.5", "1")),
        ({"anisotropy": {"angle": 30.0}}, ("anisotropy.ratio is missing",)),
    ],
)
def test_anisotropy_that_cannot_be_simulated_is_named_with_a_remedy(tmp_path, changes, words):
    numerics = changes.pop("numerics", None)
    kept = {"tile": {"roll_offs": 4, "cutoffs": 20}, "max_sweeps": 9, "solver": "newton"}
    others = {"numerics": numerics | kept} if numerics else {}
    sentence = message_of(configuration(tmp_path, GROOVES | changes, **others))
    assert [word for word in words if word not in sentence] == []


def test_straight_fronts_need_isotropic_spectra(tmp_path):
    line = from_yaml((ROOT / "tests/line-test.yaml").read_text("utf-8"))["load"]
    sentence = message_of(configuration(tmp_path, GROOVES, load=line))
    assert "spectrum 's' is anisotropic" in sentence
    assert "remove anisotropy" in sentence
