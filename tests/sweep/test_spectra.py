"""Spectra of configurations that are not self-affine, and surfaces that are not Gaussian."""

from pathlib import Path

import numpy as np
import pytest

import crackfront as cf
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.section import ConfigurationError, movable_text
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
        load_sweep(path)
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
