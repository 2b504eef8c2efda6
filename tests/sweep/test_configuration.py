"""Configurations: what is accepted, and one clear sentence for everything that is not."""

import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

import crackfront as cf
from crackfront.analysis.law import spectral_breadth
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.core.units import Scales
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import read_measurements
from crackfront.measured.spectrum.measured_surface import measured_surface
from crackfront.simulate.provenance import provenance
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from crackfront.simulate.storage import write_derived
from crackfront.sweep.configuration import load_configuration
from crackfront.sweep.feasibility import check_feasible
from crackfront.sweep.parameters import configured_sweep, load_sweep
from crackfront.sweep.rows import failed_row
from crackfront.sweep.section import ConfigurationError, movable_text, yaml_mapping
from crackfront.sweep.table_file import read_table
from tests.commands import dataset_of_rows
from tests.places import ROOT
from tests.yaml_texts import from_yaml, to_yaml

GOOD = """
seed: 1
field: roughness
spectra:
  - {name: flat, short_cutoff: 0.1, hurst: 1.0}
  - {name: rough, short_cutoff: 0.1, roll_off: 0.2, hurst: 0.8}
amplitudes: {elastic_energy: [0.02, 0.1]}
realisations: 2
numerics:
  angles_per_cutoff: 2
  samples_per_cutoff: 4
  interpolation: cubic
  pixels_per_cutoff: 4
  tile: {roll_offs: 10, cutoffs: 20}
  tolerance: 1e-6
  max_sweeps: 100000
  solver: reference
load: {max_penetration: 1.0, step: 0.1}
fit: {lowest_elastic_energy: 0.01, highest_elastic_energy: 0.1, bootstrap: 500}
"""


def written(tmp_path, text):
    """File with a text."""
    path = tmp_path / "sweep.yaml"
    path.write_text(text)
    return path


def changed(old, new):
    """The good text with a change that does happen."""
    assert GOOD.count(old) == 1
    return GOOD.replace(old, new)


def refusal(tmp_path, text):
    """What a text is refused for, without the name of the file."""
    path = written(tmp_path, text)
    with pytest.raises(ConfigurationError) as caught:
        check_feasible(load_sweep(path), path)
    message = str(caught.value)
    assert all(line.startswith(str(path)) for line in message.splitlines())
    return message.replace(str(path), "").lstrip(": ")


@pytest.mark.parametrize("name", ["test", "default", "paper", "fig3c", "spheres", "hurst", "jumps"])
def test_the_configurations_of_the_project_are_valid(name):
    sweep = load_sweep(ROOT / "config" / f"{name}.yaml")
    assert len({item.name for item in sweep.spectra}) == len(sweep.spectra)


def test_an_rms_is_converted_to_the_energy_of_full_conformity(tmp_path):
    text = changed("elastic_energy: [0.02, 0.1]", "work_of_adhesion_rms: [0.2, 0.6]")
    energies = load_sweep(written(tmp_path, text)).elastic_energies
    assert energies == pytest.approx((0.01, 0.09), rel=1e-15)


@pytest.mark.parametrize(
    ("fit", "fitted"),
    [
        ("fit: {lowest_elastic_energy: 0.05}", [0.1]),
        ("fit: {highest_elastic_energy: 0.05, bootstrap: 500}", [0.02]),
        ("fit: {bootstrap: 500}", [0.02, 0.1]),
        ("", [0.02, 0.1]),
    ],
)
def test_a_fit_takes_all_amplitudes_unless_an_end_leaves_some_out(tmp_path, fit, fitted):
    sweep = load_sweep(written(tmp_path, GOOD[: GOOD.index("fit:")] + fit))
    assert sweep.fit.chosen(sweep.elastic_energies) == fitted


def test_lengths_in_metres_are_those_of_the_reduced_sweep(tmp_path):
    scales = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.93e6)
    content = from_yaml(GOOD)
    content["numerics"]["tolerance"] = 1e-6
    content["scales"] = {"radius": 1.25e-3, "work_of_adhesion": 63e-3, "contact_modulus": 0.93e6}
    for spectrum in content["spectra"]:
        for name in {"short_cutoff", "roll_off"} & set(spectrum):
            spectrum[name] *= scales.lateral
    for name in ("max_penetration", "step"):
        content["load"][name] *= scales.vertical
    reduced = load_sweep(written(tmp_path, GOOD))
    metres = load_sweep(written(tmp_path, to_yaml(content)))
    for in_reduced, in_metres in zip(reduced.spectra, metres.spectra, strict=True):
        assert in_metres.spectrum.short_cutoff == pytest.approx(
            in_reduced.spectrum.short_cutoff, rel=1e-14
        )
        assert in_metres.spectrum.roll_off == pytest.approx(in_reduced.spectrum.roll_off, rel=1e-14)
        # The same surface, although the lengths differ by round-off.
        assert (
            metres.simulation(in_metres, 0.1, 0).seed == reduced.simulation(in_reduced, 0.1, 0).seed
        )
    assert metres.schedule.max_penetration == pytest.approx(1.0, rel=1e-14)
    assert metres.scales == scales


@pytest.mark.parametrize(
    ("deepest", "cutoff", "key", "remedy"),
    [
        (1.5, 1e-6, "load.max_penetration", "1.5 in reduced units is 4.755e-06 m"),
        (1e-6, 0.005, "short_cutoff of flat", "0.005 in reduced units is 3.147e-07 m"),
    ],
)
def test_reduced_lengths_in_a_sweep_in_metres_are_errors_that_convert_them(
    tmp_path, deepest, cutoff, key, remedy
):
    content = from_yaml(GOOD)
    content["scales"] = {"radius": 1.25e-3, "work_of_adhesion": 63e-3, "contact_modulus": 0.93e6}
    content["spectra"] = [{"name": "flat", "short_cutoff": cutoff}]
    content["load"] = {"max_penetration": deepest, "step": 0.1 * deepest}
    message = refusal(tmp_path, to_yaml(content))
    assert key in message
    assert remedy in message


def asking(error):
    """The good text with an error in the place of all that it decides."""
    start, end = GOOD.index("  angles_per_cutoff"), GOOD.index("  tile:")
    text = GOOD[:start] + f"  error: {error}\n" + GOOD[end:]
    return text.replace("  tolerance: 1e-6\n", "")


def settings_of(sweep, item, energy):
    return sweep.numerics.settings_of(sweep.kind, item.spectrum, energy)


def test_an_error_chooses_the_numerics_of_every_spectrum_and_amplitude(tmp_path):
    sweep = load_sweep(written(tmp_path, asking(0.03)))
    numerics = sweep.numerics
    assert (numerics.error, numerics.tile_cutoffs, numerics.max_sweeps) == (0.03, 20, 100000)
    flat = sweep.named("flat")
    weak, strong = (settings_of(sweep, flat, energy) for energy in sweep.elastic_energies)
    assert strong.angles_per_cutoff > weak.angles_per_cutoff
    finer = settings_of(load_sweep(written(tmp_path, asking(0.01))), flat, 0.1)
    assert finer.angles_per_cutoff > strong.angles_per_cutoff
    simulation = sweep.simulation(flat, 0.1, 0)
    assert simulation.solver.tolerance == strong.tolerance
    assert simulation.resolution.spacing == pytest.approx(0.1 / strong.samples_per_cutoff)


def test_an_error_below_that_of_the_finest_numerics_is_refused(tmp_path):
    sentence = refusal(tmp_path, asking(1e-5))
    assert "numerics: error is 1e-05, but the finest numerics leave" in sentence
    assert "for flat at e_el 0.02; allow that, or give the settings" in sentence


def test_settings_that_are_missing_without_an_error_are_named(tmp_path):
    text = asking(0.03).replace("  error: 0.03\n", "  angles: 64\n  interpolation: cubic\n")
    assert (
        "numerics: samples_per_cutoff, pixels_per_cutoff, tolerance missing; add what is missing "
        "or ask for an error" in refusal(tmp_path, text)
    )


@pytest.mark.parametrize("error", ["0.0", "1.0", "-0.1", ".nan", "small"])
def test_an_error_that_no_numerics_have_is_refused(tmp_path, error):
    assert "numerics.error is" in refusal(tmp_path, asking(error))


def test_steady_loads_are_read_in_both_units(tmp_path):
    text = GOOD.replace("step: 0.1", "steady: {start: 0.25, travel: 2.0, error: 0.1}")
    assert load_sweep(written(tmp_path, text)).schedule == SteadySchedule(0.25, 1.0, 2.0, 0.1)
    scales = Scales(radius=1e-3, work_of_adhesion=0.05, contact_modulus=1e6)
    content = from_yaml(text)
    content["scales"] = {"radius": 1e-3, "work_of_adhesion": 0.05, "contact_modulus": 1e6}
    for spectrum in content["spectra"]:
        for name in {"short_cutoff", "roll_off"} & set(spectrum):
            spectrum[name] *= scales.lateral
    content["load"]["max_penetration"] *= scales.vertical
    content["load"]["steady"]["start"] *= scales.vertical
    metres = load_sweep(written(tmp_path, to_yaml(content))).schedule
    assert metres.start == pytest.approx(0.25, rel=1e-14)
    assert (metres.travel, metres.standard_error) == (2.0, 0.1)


BAD = {
    "seed beyond what a file holds": (
        ("seed: 1", "seed: 18446744073709551616"),
        "seed is 18446744073709551616; it must lie between 0 and 9.22337e+18",
    ),
    "realisations without end": (
        ("realisations: 2", "realisations: 1000000000"),
        "realisations: 4e+09 simulations would need 2 TB of memory; here are",
    ),
    "cutoff below an atom": (
        ("{name: flat, short_cutoff: 0.1", "{name: flat, short_cutoff: 1e-12"),
        "short_cutoff is 1e-12 reduced lateral lengths; it must lie between 1e-09 and 1e+09",
    ),
    "tile larger than any machine": (
        ("roll_offs: 10", "roll_offs: 1e+12"),
        "tiles of 4e+12 x 4e+12 points would need 5.12e+08 EB of memory; here are",
    ),
    "front larger than any machine": (
        ("angles_per_cutoff: 2", "angles: 1000000000000"),
        "fronts of 1e+12 sites would need 512 TB of memory; here are",
    ),
    "unknown key": (
        ("realisations: 2", "realisation: 2\nrealisations: 2"),
        "unknown key realisation; did you mean realisations?",
    ),
    "unknown key deep down": (
        ("cutoffs: 20", "cutoffs: 20, sides: 3"),
        "unknown key numerics.tile.sides; the keys here are roll_offs, cutoffs",
    ),
    "missing key": (("seed: 1\n", ""), "key seed is missing; add it"),
    "length with a unit": (
        ("roll_off: 0.2", "roll_off: 0.2um"),
        "spectra[1].roll_off is '0.2um'; it must be a number without a unit",
    ),
    "key twice": (
        ("seed: 1", "seed: 1\nseed: 2"),
        "is not valid YAML in line 3: key 'seed' stands",
    ),
    "hurst above one": (
        ("hurst: 0.8", "hurst: 1.2"),
        "spectra[1]: hurst is 1.2; it must lie in (0, 1]",
    ),
    "roll-off below the cutoff": (
        ("roll_off: 0.2", "roll_off: 0.05"),
        "spectra[1]: roll_off 0.05 is shorter than short_cutoff 0.1; lower the cutoff",
    ),
    "cutoff below two pixels": (
        ("pixels_per_cutoff: 4", "pixels_per_cutoff: 1.5"),
        "numerics.pixels_per_cutoff is 1.5; it must lie between 2 and 1000",
    ),
    "no full conformity": (
        ("[0.02, 0.1]", "[0.02, 1.0]"),
        "amplitudes.elastic_energy[1] is 1.0; it must be less than 1",
    ),
    "no amplitude": (
        ("[0.02, 0.1]", "[]"),
        "amplitudes.elastic_energy is []; it must have at least one entry",
    ),
    "amplitude twice": (("[0.02, 0.1]", "[0.1, 0.1]"), "amplitude 0.1 stands twice"),
    "no measure of amplitude": (
        ("amplitudes: {elastic_energy: [0.02, 0.1]}", "amplitudes: {}"),
        "amplitudes need exactly one of elastic_energy, work_of_adhesion_rms and measured; give",
    ),
    "two measures of amplitude": (
        ("[0.02, 0.1]", "[0.02, 0.1], work_of_adhesion_rms: [0.2]"),
        "amplitudes need exactly one of elastic_energy, work_of_adhesion_rms and measured; remove",
    ),
    "energy of a chemical field": (
        ("field: roughness", "field: chemical"),
        "amplitudes.elastic_energy is meaningless for a chemical field; give",
    ),
    "unknown field": (
        ("field: roughness", "field: rough"),
        "field is 'rough'; it must be 'roughness' or 'chemical'",
    ),
    "not a number": (("step: 0.1", "step: .nan"), "load.step is nan; it must be"),
    "no contact": (
        ("max_penetration: 1.0", "max_penetration: -0.5"),
        "load: max penetration -0.5 never makes contact; the sphere touches at 0",
    ),
    "steady beside step": (
        ("step: 0.1}", "step: 0.1, steady: {start: 0.5, travel: 2, error: 0.1}}"),
        "exactly one of step (full cycles) and steady (parts of them); remove one",
    ),
    "steady start too deep": (
        ("step: 0.1}", "steady: {start: 1.0, travel: 2, error: 0.1}}"),
        "load: steady start is 1.0; it must be 0 or more, and below the largest penetration 1.0",
    ),
    "step zero": (("step: 0.1", "step: 0"), "load.step is 0; it must be greater than 0"),
    "name twice": (("name: rough", "name: flat"), "spectrum name 'flat' stands twice"),
    "name of a path": (
        ("name: rough", "name: a/b"),
        "spectra[1].name is 'a/b'; it must consist of letters, digits, _ and -",
    ),
    "no spectra": (
        (GOOD[GOOD.index("spectra:") : GOOD.index("amplitudes:")], "spectra: []\n"),
        "spectra is []; it must have at least one entry",
    ),
    "list for a mapping": (
        ("load: {max_penetration: 1.0, step: 0.1}", "load: [1.0, 0.1]"),
        "load is [1.0, 0.1]; it must be a mapping of keys",
    ),
    "unknown solver": (
        ("solver: reference", "solver: none-such"),
        "numerics.solver is 'none-such'; it must be one of",
    ),
    "angles twice": (
        ("angles_per_cutoff: 2", "angles_per_cutoff: 2\n  angles: 128"),
        "numerics need exactly one of angles and angles_per_cutoff; remove one",
    ),
    "too few angles": (
        ("angles_per_cutoff: 2", "angles: 20"),
        "per short cutoff of flat, with which k comes out too large; use 225 or more, as "
        "angles_per_cutoff: 2 does",
    ),
    "too few points": (
        (
            "pixels_per_cutoff: 4\n  tile: {roll_offs: 10, cutoffs: 20}",
            "pixels_per_cutoff: 2\n  tile: {roll_offs: 1, cutoffs: 1}",
        ),
        "tiles of flat have 2 points a side; use at least 4",
    ),
    "too few cubic samples": (
        ("samples_per_cutoff: 4", "samples_per_cutoff: 1.9"),
        "numerics: samples_per_cutoff is 1.9, with which cubic pieces miss waves of flat and k "
        "comes out too small; use 2 or more",
    ),
    "fit upside down": (
        ("lowest_elastic_energy: 0.01", "lowest_elastic_energy: 0.5"),
        "fit: lowest_elastic_energy 0.5 is above highest_elastic_energy 0.1; swap them",
    ),
    "fit without amplitude": (
        ("highest_elastic_energy: 0.1", "highest_elastic_energy: 0.015"),
        "no amplitude lies in the range of the fit, e_el from 0.01 to 0.015",
    ),
    "tolerance below round-off": (
        ("tolerance: 1e-6", "tolerance: 1e-14"),
        "below the round-off of the 240 sites of flat",
    ),
    "tolerance above the forces": (
        ("tolerance: 1e-6", "tolerance: 0.03"),
        "numerics: tolerance is 0.03, above e_el 0.02 of flat, to which forces of pinning are "
        "proportional, so that k comes out too large; use 0.002 or less",
    ),
    "no YAML": (("seed: 1", "seed: [1"), "is not valid YAML in line"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_refused_with_a_sentence(tmp_path, case):
    (old, new), sentence = BAD[case]
    message = refusal(tmp_path, changed(old, new))
    assert sentence in message
    assert len(message.splitlines()) == 1
    assert "Value error" not in message


def test_every_error_has_its_own_sentence(tmp_path):
    text = changed("seed: 1", "seed: -1").replace("step: 0.1", "step: -1")
    assert len(refusal(tmp_path, text).splitlines()) == 2


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "is empty; write a configuration like config/test.yaml"),
        ("- 1\n- 2\n", "contains a list, not keys with values; write"),
        ("just text", "contains a single value, not keys with values; write"),
        ("!!python/object/apply:os.getcwd []", "is not valid YAML in line 1"),
    ],
)
def test_a_file_that_is_no_mapping_is_refused(tmp_path, text, sentence):
    assert sentence in refusal(tmp_path, text)


def test_a_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(ConfigurationError, match=r"none.yaml cannot be read: No such file"):
        load_sweep(tmp_path / "none.yaml")


SCANS = ROOT / "examples/scans"
SCENE = "scales: {radius: 1.25e-3, work_of_adhesion: 63e-3, contact_modulus: 0.9333e6}\n"
MEASURED = f"""
spectra:
  - name: film
    surface: {{file: [{SCANS}/nanodiamond-detail.al3d, {SCANS}/nanodiamond-overview.al3d]}}
"""


def with_surface(spectra=MEASURED, scales=SCENE, **changes):
    """The good text with the spectra of surfaces, in metres."""
    start, end = GOOD.index("spectra:"), GOOD.index("amplitudes:")
    text = GOOD[:start] + scales + spectra.lstrip() + GOOD[end:]
    text = text.replace("{max_penetration: 1.0, step: 0.1}", "{max_penetration: 1e-6, step: 1e-7}")
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.fixture(scope="module", autouse=True)
def _few_draws():
    """Spectra of scans from fewer draws, whose number is not tested here."""
    with mock.patch.multiple("crackfront.measured.spectrum.draws", BATCH=2**10, BATCHES=(1,)):
        yield


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    """The sweep over the spectrum of two scans and over a flat one."""
    spectra = MEASURED + "  - {name: flat, short_cutoff: 2e-6, hurst: 0.8}\n"
    return load_sweep(written(tmp_path_factory.mktemp("film"), with_surface(spectra)))


def test_a_spectrum_may_be_that_of_measurements(film):
    item = film.spectra[0]
    surface = measured_surface(read_measurements(sorted(SCANS.glob("*.al3d"))))
    spectrum = surface.joint.spectrum
    assert item.name == f"film-{surface.checksum}"
    lengths = np.array(item.spectrum.wavelengths) * film.scales.lateral
    assert lengths == pytest.approx(np.array(spectrum.wavelengths), rel=1e-4)
    ratios = np.array(item.spectrum.densities) / np.array(spectrum.densities)
    assert ratios == pytest.approx(np.full(ratios.size, ratios[0]), rel=1e-4)
    first, *_ = film.simulations(item)
    assert first.seed != replace(first, spectrum=item.spectrum.in_units(2.0)).seed
    assert first.key == replace(first, spectrum=item.spectrum.amplified(2.0)).key


def test_files_are_relative_to_the_configuration_and_amplitudes_to_what_they_hold(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    home = tmp_path / "elsewhere"
    home.mkdir()
    shutil.copy(SCANS / "nanodiamond-detail.al3d", home / "scan.al3d")
    np.savetxt(home / "mask.txt", np.eye(144, dtype=int), fmt="%d")
    spectra = "spectra: [{name: film, surface: {file: scan.al3d, mask: mask.txt}}]\n"
    text = with_surface(spectra, **{"elastic_energy: [0.02, 0.1]": "measured: [0.5, 1]"})
    path = written(home, text)
    sweep = load_sweep(Path("elsewhere", path.name))
    options = ReadingOptions(mask=(home / "mask.txt",))
    surface = measured_surface(read_measurements([home / "scan.al3d"], options))
    energy = surface.conformity_energy(sweep.scales.contact_modulus).value
    energy /= sweep.scales.work_of_adhesion
    assert sweep.elastic_energies == pytest.approx((energy / 4, energy), rel=1e-3)
    # The copy that stands with the results means the same.
    (tmp_path / "copy.yaml").write_text(movable_text(path))
    assert load_sweep(tmp_path / "copy.yaml") == sweep
    with pytest.raises(ConfigurationError, match=r"measured: 9 times the heights have an energy"):
        load_sweep(written(home, text.replace("[0.5, 1]", "[1, 9]")))


def test_a_spectrum_may_be_a_table_of_densities(tmp_path):
    table = "{name: ring, table: {wavelengths: [0.12, 0.1], densities: [1.0, 2.0]}}"
    text = changed("{name: flat, short_cutoff: 0.1, hurst: 1.0}", table)
    sweep = load_sweep(written(tmp_path, text))
    assert sweep.spectra[0].name == "ring"
    assert sweep.spectra[0].spectrum == TabulatedSpectrum((0.12, 0.1), (1.0, 2.0))


def test_a_surface_is_read_in_the_words_of_the_commands(tmp_path):
    words = "channel: 0, crop: '1um:6um,1um:6um', detrend: 3, mask: '2um:3um,2um:3um'"
    file = SCANS / "nanodiamond-detail.al3d"
    spectra = f"spectra:\n  - {{name: film, surface: {{file: {file}, shortest: 0.3um, {words}}}}}\n"
    sweep = load_sweep(written(tmp_path, with_surface(spectra)))
    square = ((2e-6, 3e-6), (2e-6, 3e-6))
    crop = ((1e-6, 6e-6), (1e-6, 6e-6))
    options = ReadingOptions(channel="0", crop=crop, detrend=3, mask=(square,))
    expected = measured_surface(read_measurements([file], options), 0.3e-6).joint.spectrum
    lengths = np.array(sweep.spectra[0].spectrum.wavelengths) * sweep.scales.lateral
    assert lengths == pytest.approx(np.array(expected.wavelengths), rel=1e-4)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("crop: 3", "crop is 3; give a text, as in '2um:8um"),
        ("chanel: 0", "unknown key chanel; did you mean channel?"),
    ],
)
def test_words_of_a_surface_that_cannot_be_used_are_refused(tmp_path, words, sentence):
    file = SCANS / "nanodiamond-detail.al3d"
    spectra = f"spectra:\n  - {{name: film, surface: {{file: {file}, {words}}}}}\n"
    with pytest.raises(ConfigurationError, match=sentence) as refusal:
        load_sweep(written(tmp_path, with_surface(spectra)))
    assert "spectra[0].surface: " in str(refusal.value)


def test_reading_a_configuration_opens_no_scan_and_chooses_no_settings(tmp_path):
    spectra = "spectra: [{name: film, surface: {file: /nowhere.al3d}}]\n"
    content = from_yaml(with_surface(spectra))
    kept = {name: content["numerics"][name] for name in ("tile", "max_sweeps", "solver")}
    content["numerics"] = {"error": 1e-5} | kept
    configuration = load_configuration(written(tmp_path, to_yaml(content)))
    assert configuration.numerics.error == 1e-5
    with pytest.raises(ConfigurationError, match=r"nowhere.al3d cannot be read"):
        configured_sweep(configuration)


@pytest.mark.slow
def test_a_sweep_without_a_measured_surface_imports_nothing_that_reads_scans(tmp_path):
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from crackfront.sweep.run_sweep import opened\n"
        f"sweep, *_ = opened(Path({str(ROOT / 'config/default.yaml')!r}), Path('out'))\n"
        "assert sweep.series(sweep.spectra[0])\n"
        "print([name for name in sys.modules if name.startswith('crackfront.measured')])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=600
    )
    assert (done.stdout, done.stderr) == ("[]\n", "")


def test_the_table_of_a_sweep_keeps_measured_spectra(film, tmp_path):
    rows = [failed_row(simulation, "invalid", "a test") for simulation in film.simulations()]
    dataset = dataset_of_rows(film, rows)
    write_derived(tmp_path / "hysteresis.nc", dataset, provenance("text"))
    table = read_table(tmp_path / "hysteresis.nc")
    measured, flat = (item.spectrum for item in film.spectra)
    assert table.shape_of(0).wavelengths == measured.wavelengths
    assert table.shape_of(0).densities == pytest.approx(measured.identity[1], rel=1e-12)
    assert table.shape_of(1) == flat
    breadth = spectral_breadth("roughness", measured)
    assert spectral_breadth("roughness", table.shape_of(0)) == pytest.approx(breadth)
    assert np.isnan(table.hurst[0])


def test_the_table_of_a_sweep_in_metres_is_converted_for_the_sphere_that_it_states(tmp_path):
    scales = {"radius": 1.25e-3, "work_of_adhesion": 63e-3, "contact_modulus": 0.93e6}
    content = from_yaml(GOOD) | {"scales": scales}
    content["spectra"] = [{"name": "flat", "short_cutoff": 6e-6}]
    content["load"] = {"max_penetration": 3e-6, "step": 1e-6}
    sweep = load_sweep(written(tmp_path, to_yaml(content)))
    rows = [failed_row(simulation, "invalid", "a test") for simulation in sweep.simulations()]
    table = dataset_of_rows(sweep, rows)
    converted = cf.in_si_units(table)
    assert converted.short_cutoff.values == pytest.approx(6e-6, rel=1e-12)
    assert converted.short_cutoff.attrs["units"] == "m"
    assert converted.identical(cf.in_si_units(table, cf.Scales(**scales)))
    again = cf.in_reduced_units(converted, cf.Scales(**scales))
    assert converted.tile_side.dims == converted.n_point.dims == ("spectrum", "amplitude")
    assert again.tile_side.values == pytest.approx(table.tile_side.values, rel=1e-12)


def test_an_error_chooses_no_pixels_of_uncorrelated_sites(tmp_path):
    """Their disorder is that of a pixel, so that amplitudes would not compare."""
    text = (ROOT / "config/line-quick.yaml").read_text(encoding="utf-8")
    assert load_sweep(written(tmp_path, text))
    text = text.replace("step: 0.5", "step: 0.5, uncorrelated: true")
    with pytest.raises(ConfigurationError, match=r"numerics\.error is 0\.03, which chooses other"):
        load_sweep(written(tmp_path, text))


def test_a_flat_spectrum_needs_no_hurst_exponent_and_a_longer_roll_off_does(tmp_path):
    entry = "{name: flat, short_cutoff: 0.1, hurst: 1.0}"
    flat = load_sweep(written(tmp_path, GOOD)).spectra
    for text in ("{name: flat, short_cutoff: 0.1}", entry.replace("hurst: 1.0", "roll_off: 0.1")):
        assert load_sweep(written(tmp_path, changed(entry, text))).spectra == flat
    rough = changed(entry, entry.replace("hurst: 1.0", "roll_off: 1"))
    assert "spectra[0]: key hurst is missing; add it" in refusal(tmp_path, rough)


def test_shards_of_a_measured_spectrum_change_with_the_file(tmp_path):
    scan = tmp_path / "scan.al3d"
    spectra = f"spectra:\n  - {{name: film, surface: {{file: {scan}}}}}\n"
    content = (SCANS / "nanodiamond-overview.al3d").read_bytes()
    stems = []
    for comment in (b"SYNTHETIC", b"Synthetic"):
        scan.write_bytes(content.replace(b"SYNTHETIC", comment))
        sweep = load_sweep(written(tmp_path, with_surface(spectra)))
        stems.append([simulation.stem for simulation in sweep.simulations()])
    assert not set(stems[0]) & set(stems[1])
    scan.write_bytes(content)
    again = load_sweep(written(tmp_path, with_surface(spectra)))
    assert [simulation.stem for simulation in again.simulations()] == stems[0]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            with_surface(scales=""),
            "spectrum 'film' describes a surface in metres; give the section scales",
        ),
        (
            with_surface(
                **{
                    "field: roughness": "field: chemical",
                    "{elastic_energy": "{work_of_adhesion_rms",
                }
            ),
            "spectrum 'film' is the spectrum of heights; field must be roughness",
        ),
        (
            with_surface(MEASURED.rstrip() + "\n    hurst: 0.8\n"),
            "spectra[0]: surface already decides hurst; remove one or the other",
        ),
        (
            with_surface("spectra:\n  - {name: film, surface: {file: /nowhere.al3d}}\n"),
            "spectra[0].surface: /nowhere.al3d cannot be read: No such file or directory",
        ),
        (
            changed(
                "{name: flat, short_cutoff: 0.1, hurst: 1.0}",
                "{name: table, table: {wavelengths: [1, 2], densities: [1, 1]}}",
            ),
            "spectra[0].table: the wavelengths of a table must fall",
        ),
        (
            changed("{name: flat, short_cutoff: 0.1, hurst: 1.0}", "{name: flat, hurst: 1.0}"),
            "spectra[0]: key short_cutoff is missing; add it, or one of surface",
        ),
    ],
)
def test_a_spectrum_that_is_no_measured_one_is_refused(tmp_path, text, sentence):
    assert refusal(tmp_path, text).startswith(sentence)


HARSH = {
    "an anchor that refers to itself": (
        "x: &a {b: [*a]}\n",
        "more than 200000 values, or nested without end",
    ),
    "depth": ("x: " + "[" * 700 + "]" * 700, "more than 200000 values, or nested without end"),
    "size": ("#" * 10**6, "has 1 MB; more than 0.5 MB are not read"),
    "a date": ("x: 2026-99-99\n", "is not valid YAML: month must be in 1..12"),
    "a key twice as number and text": ("1: a\n'1': b\n", "line 2: key '1' stands twice"),
    "an octal number of old": (
        "a:\n  b: 010\n",
        "in line 2: 010 begins with 0, as octal numbers do elsewhere; remove the 0",
    ),
    "another version": (
        "%YAML 1.1\n---\na: yes\n",
        "it is read as YAML 1.2; remove the line %YAML",
    ),
    "unknown keys": (
        "".join(f"key_{k}: {k}\n" for k in range(1_000)),
        "more such keys and values",
    ),
}


@pytest.mark.parametrize("case", HARSH)
def test_yaml_that_nobody_writes_is_refused_with_a_sentence(tmp_path, case):
    text, sentence = HARSH[case]
    message = refusal(tmp_path, text)
    assert sentence in message
    assert len(message) < 5000


def test_numbers_and_words_are_those_of_yaml_1_2(tmp_path):
    path = written(tmp_path, "a: [1e-3, 0.5, 1E+2, 0o10, 0x10, 1:30, on, No, yes, 0, 0.10, true]\n")
    values = yaml_mapping(path)["a"]
    assert values == (0.001, 0.5, 100.0, 8, 16, "1:30", "on", "No", "yes", 0, 0.1, True)
    assert [type(number) for number in values[:4]] == [float, float, float, int]


def test_many_realisations_are_no_reason_to_refuse_but_samples_that_no_memory_holds(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("crackfront.core.resources.memory_at_hand", lambda: 1e9)
    text = changed("realisations: 2", "realisations: 100000").replace("p: 500", "p: 5000")
    assert load_sweep(written(tmp_path, text)).n_simulation == 400_000
    message = refusal(tmp_path, text.replace("p: 5000", "p: 10000000"))
    assert "fit: 10000000 bootstrap samples would need 2 GB of memory" in message


def test_realisations_that_together_take_longer_than_anybody_waits_are_refused(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("crackfront.core.resources.MOST_SECONDS", 100.0)
    path = written(tmp_path, GOOD)
    check_feasible(load_sweep(path), path)
    message = refusal(tmp_path, changed("realisations: 2", "realisations: 100000"))
    assert "the simulations would take" in message
