"""Spectra of configurations that are not self-affine, and surfaces that are not Gaussian."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import crackfront as cf
from crackfront.core.synthesis import gaussian_field, resampled
from crackfront.plots.parts import spectrum_label
from crackfront.simulate.ensembles import GAUSSIAN
from crackfront.simulate.simulation import simulation_adhesion
from crackfront.simulate.tiles import surface_values
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.sweep.feasibility import check_feasible
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.section import ConfigurationError, movable_text
from crackfront.sweep.table_file import read_table
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
    load = {"max_penetration": 6e-6, "step": 3e-7}
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
WIDE |= {"tile": {"roll_offs": 10, "cutoffs": 60}}
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
    assert '"anisotropy": 4.0' in simulation.surface.attrs["parameters"]
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
    sections = {"numerics": numerics | kept} if numerics else {}
    sentence = message_of(configuration(tmp_path, GROOVES | changes, **sections))
    assert [word for word in words if word not in sentence] == []


def test_straight_fronts_need_isotropic_spectra(tmp_path):
    line = from_yaml((ROOT / "tests/line-test.yaml").read_text("utf-8"))["load"]
    sentence = message_of(configuration(tmp_path, GROOVES, load=line))
    assert "spectrum 's' is anisotropic" in sentence
    assert "remove anisotropy" in sentence


SKEWED = {"short_cutoff": 0.1, "marginal": {"distribution": "pearson3", "skew": -1.0}}


def first_surface(path, **changes):
    """Surface of the first simulation of a configuration, with changes of the simulation."""
    simulation = replace(next(load_sweep(path).simulations()), **changes)
    return simulation.surface


def moment(values, order):
    """Central moment of an order, over the power of the rms."""
    return float(np.mean((values - np.mean(values)) ** order) / np.std(values) ** order)


@pytest.mark.parametrize(
    ("marginal", "skewness", "kurtosis"),
    [
        ({"distribution": "pearson3", "skew": -1.0}, -1.0, 4.5),
        ({"distribution": "pearson3", "skew": 1.0}, 1.0, 4.5),
        ({"distribution": "uniform"}, 0.0, 1.8),
    ],
)
def test_heights_have_the_distribution_that_is_requested_and_the_modes_of_gaussian_ones(
    tmp_path, marginal, skewness, kurtosis
):
    path = configuration(tmp_path, {"short_cutoff": 0.1, "marginal": marginal}, numerics=WIDE)
    surface = first_surface(path)
    heights = surface_values(surface)
    assert moment(heights, 3) == pytest.approx(skewness, abs=0.1)
    assert moment(heights, 4) == pytest.approx(kurtosis, rel=0.1)
    gaussian = surface_values(replace(surface, ensemble=GAUSSIAN))
    assert moment(gaussian, 3) == pytest.approx(0.0, abs=0.05)
    modes, gaussian_modes = (np.abs(np.fft.rfft2(item)) for item in (heights, gaussian))
    np.testing.assert_allclose(modes, gaussian_modes, atol=1e-10 * np.max(modes))


def test_a_skewed_surface_is_the_same_on_every_grid(tmp_path):
    path, surfaces = configuration(tmp_path, SKEWED), []
    for n_point in (48, 96):
        resolution = replace(next(load_sweep(path).simulations()).resolution, n_point=n_point)
        surfaces.append(surface_values(first_surface(path, resolution=resolution)))
    np.testing.assert_allclose(surfaces[0], surfaces[1][::2, ::2], atol=1e-12)


def test_works_of_adhesion_of_chemical_surfaces_may_be_skewed(tmp_path):
    changes = {"field": "chemical", "amplitudes": {"work_of_adhesion_rms": [0.4]}}
    fit = {"lowest_elastic_energy": 0.01, "highest_elastic_energy": 0.1, "bootstrap": 500}
    path = configuration(tmp_path, SKEWED, numerics=WIDE, fit=fit, **changes)
    [adhesion, *_], _ = realisations(path)
    assert moment(adhesion.work_of_adhesion, 3) == pytest.approx(-1.0, abs=0.1)
    assert adhesion.w_rms == pytest.approx(0.4, rel=0.02)


def test_a_sweep_compares_distributions_on_the_same_modes(tmp_path):
    path = configuration(tmp_path, SKEWED)
    content = from_yaml(path.read_text())
    content["spectra"] = [{"name": "plain", "short_cutoff": 0.1}, *content["spectra"]]
    path.write_text(to_yaml(content))
    table = cf.run_sweep(path, tmp_path / "results", progress=False)
    np.testing.assert_allclose(table.e_el[0], table.e_el[1], rtol=1e-12)
    assert np.all(np.abs(table.w_retr[0] / table.w_retr[1] - 1) > 1e-6)
    assert np.all(np.isfinite(table.w_appr_numerical_error[0]))
    assert np.all(np.isnan(table.w_appr_numerical_error[1]))
    done("fit", path, "--output", tmp_path / "results")
    fit = xr.load_dataset(tmp_path / "results/fit.nc")
    assert np.all(np.isfinite(fit.cell_law_factor.sel(spectrum="plain", bound="value")))
    assert np.all(np.isnan(fit.cell_law_factor.sel(spectrum="s")))
    assert np.all(np.isfinite(fit.cell_size))
    page = (tmp_path / "results/fit.md").read_text()
    assert re.search(r"k by the law: \d\.\d\d \(of plain alone\);", page)
    read = read_table(tmp_path / "results/hysteresis.nc")
    assert [spectrum_label(read, index).partition(":")[0] for index in (0, 1)] == ["plain", "s"]
    row = table.sel(spectrum="s", amplitude=0.1, realisation=0)
    simulation = cf.simulation(row)
    assert "pearson3 skew -1" in simulation.surface.attrs["parameters"]
    assert float(simulation.run().w_retr) == float(row.w_retr)


def test_files_of_surfaces_state_their_skewness(tmp_path):
    path = configuration(tmp_path, SKEWED)
    done("surfaces", path, "--output", tmp_path)
    surfaces = xr.load_dataset(tmp_path / "surfaces/s.nc")
    for variable in surfaces.data_vars.values():
        assert variable.attrs["skewness"] == pytest.approx(moment(variable.values, 3))
        assert variable.attrs["excess_kurtosis"] == pytest.approx(moment(variable.values, 4) - 3)


def test_a_skewed_surface_keeps_its_heights(tmp_path):
    heights = surface_values(first_surface(configuration(tmp_path, SKEWED)))
    # A change of these numbers changes the skewed surfaces of all sweeps.
    kept = [0.0320237903888325, 0.04809745408877467, 0.02841162851443033]
    assert heights[0, :3] == pytest.approx(kept, rel=1e-9)


@pytest.mark.parametrize(
    ("marginal", "words"),
    [
        ({"distribution": "pearson"}, ("distribution 'pearson'", "did you mean pearson3?")),
        ({"distribution": "gamma"}, ("parameter a of gamma is missing", "add it")),
        ({"distribution": "gamma", "b": 2}, ("gamma lacks a parameter b", "a")),
        ({"distribution": "gamma", "a": "two"}, ("a is 'two'", "number")),
        ({"distribution": "gamma", "a": -1}, ("gamma with a -1", "finite variance")),
        ({"distribution": "cauchy"}, ("cauchy", "finite variance")),
        ({"skew": -1.0}, ("marginal.distribution is missing", "add it")),
    ],
)
def test_a_distribution_that_cannot_be_made_is_named_with_a_remedy(tmp_path, marginal, words):
    path = configuration(tmp_path, SKEWED | {"marginal": marginal})
    sentence = message_of(path)
    assert [word for word in words if word not in sentence] == []


def test_no_error_is_known_of_surfaces_that_are_not_gaussian(tmp_path):
    numerics = {name: WIDE[name] for name in ("tile", "max_sweeps", "solver")} | {"error": 0.05}
    sentence = message_of(configuration(tmp_path, SKEWED, numerics=numerics))
    assert "error is 0.05" in sentence
    assert "give the resolution" in sentence


def map_file(path, seed, side=80e-6, n_point=64, factor=1.0):
    """netCDF file of a random map with waves of eight pixels or more, in metres."""
    spectrum = cf.SelfAffineSpectrum(8 * side / n_point, 16 * side / n_point, 0.8)
    heights = gaussian_field(
        spectrum.with_elastic_energy(1.0), n_point, side, np.random.default_rng(seed)
    )
    heights *= factor * 1e-8 / np.std(heights)
    places = np.arange(n_point) * side / n_point
    coordinates = {axis: (axis, places, {"units": "m"}) for axis in ("x", "y")}
    values = xr.DataArray(heights, coordinates, ("x", "y"), attrs={"units": "m"})
    values.to_dataset(name="height").to_netcdf(path)
    return path


TILES = {"tiles": {"file": ["a.nc", "b.nc"], "detrend": "center"}}


@pytest.fixture
def maps(tmp_path):
    """Folder with two maps."""
    for seed, name in enumerate(("a.nc", "b.nc")):
        map_file(tmp_path / name, seed)
    return tmp_path


def test_each_realisation_is_the_map_of_its_file(maps):
    sweep = load_sweep(in_metres(maps, TILES))
    sphere, surfaces = sweep.scales, [s.surface for s in sweep.simulations()]
    assert [surface.realisation for surface in surfaces] == [0, 1, 0, 1]
    for surface, name in zip(surfaces, ("a.nc", "b.nc"), strict=False):
        tile = cf.read_scan(maps / name, sphere, detrend="center")
        expected = resampled(tile.values, surface.shape)
        values = surface_values(surface)
        np.testing.assert_allclose(values / np.std(values), expected / np.std(expected), atol=1e-9)
        assert surface.sides[0] == pytest.approx(tile.sizes["x"] * float(tile.x[1] - tile.x[0]))


def test_one_factor_scales_all_maps_to_the_mean_energy_that_is_requested(maps):
    map_file(maps / "b.nc", 1, factor=2.0)
    path = in_metres(maps, TILES, numerics=WIDE)
    adhesions, energy = realisations(path)
    energies = [adhesion.e_el for adhesion in adhesions]
    assert np.mean(energies) == pytest.approx(energy, rel=1e-6)
    assert energies[1] / energies[0] == pytest.approx(4.0, rel=0.2)


def test_maps_may_keep_their_own_heights(maps):
    fit = {"lowest_elastic_energy": 1e-6, "highest_elastic_energy": 0.9, "bootstrap": 500}
    path = in_metres(maps, TILES, amplitudes={"measured": [1.0]}, fit=fit, numerics=WIDE)
    sphere = load_sweep(path).scales
    adhesions, _ = realisations(path)
    for adhesion, name in zip(adhesions, ("a.nc", "b.nc"), strict=True):
        expected = surface_adhesion(cf.read_scan(maps / name, sphere, detrend="center"))
        assert adhesion.e_el == pytest.approx(expected.e_el, rel=1e-3)


def test_a_sweep_of_maps_runs_and_changes_with_their_contents(maps):
    path, results = in_metres(maps, TILES), maps / "results"
    table = cf.run_sweep(path, results, progress=False)
    assert np.all(np.isfinite(table.w_retr))
    done("fit", path, "--output", results)
    row = table.isel(spectrum=0, amplitude=1, realisation=1)
    assert float(cf.simulation(row).run().w_retr) == float(row.w_retr)
    assert json.loads(done("plan", path, "--output", results, "--json").stdout)["missing"] == 0
    map_file(maps / "b.nc", 7)
    assert json.loads(done("plan", path, "--output", results, "--json").stdout)["missing"] == 4


@pytest.mark.parametrize(
    ("spectrum", "changes", "words"),
    [
        ({"tiles": {"file": ["a.nc", "c.nc"]}}, {}, ("tiles", "c.nc", "No such file")),
        ({"tiles": {"file": ["a.nc", "wide.nc"]}}, {}, ("wide.nc", "a.nc", "equal sides")),
        ({"tiles": {"file": ["a.nc", "a.nc"]}}, {}, ("a.nc' stands twice", "remove")),
        ({"tiles": {"file": ["a.nc"]}}, {}, ("realisations is 2", "1 file", "lower realisations")),
        (TILES, {"scales": None}, ("spectrum 's'", "give the section scales")),
        (TILES | {"marginal": {"distribution": "uniform"}}, {}, ("tiles", "marginal", "remove")),
        (TILES | {"short_cutoff": 1e-6}, {}, ("tiles", "short_cutoff", "remove")),
        ({"tiles": {"file": ["a.nc"], "mask": "m.txt"}}, {}, ("mask", "remove it")),
        ({"tiles": {"file": ["a.nc"], "chanel": 0}}, {}, ("chanel", "did you mean channel?")),
    ],
)
def test_maps_that_cannot_be_used_are_named_with_a_remedy(maps, spectrum, changes, words):
    map_file(maps / "wide.nc", 5, side=90e-6)
    path = in_metres(maps, spectrum)
    if changes:
        content = from_yaml(path.read_text())
        del content["scales"]
        path.write_text(to_yaml(content))
    sentence = message_of(path)
    assert [word for word in words if word not in sentence] == []
