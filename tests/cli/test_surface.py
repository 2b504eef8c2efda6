"""`crackfront surface` and `crackfront predict`: what they say, write and refuse."""

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import crackfront as cf
from crackfront.analysis.estimate import Estimate
from crackfront.core.variables import variables
from crackfront.measured.prediction.prediction import Prediction, predicted
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.surfaces.surface_array import read_field
from tests.commands import refused, run
from tests.measured.made import (
    DETAIL,
    OVERVIEW,
    SCENE,
    draw_little,
    measure_surfaces_once,
    run_simulations_once,
    shipped_surface,
    write_smooth,
)
from tests.places import ROOT

SPHERE = {
    "--modulus": "0.7MPa",
    "--poisson": "0.5",
    "--radius": "1.25mm",
    "--work-of-adhesion": "63mJ/m2",
}


def sphere(**changes):
    """Options of the sphere; None leaves one out."""
    named = SPHERE | {f"--{name.replace('_', '-')}": value for name, value in changes.items()}
    return [part for item in named.items() if item[1] is not None for part in item]


def reservations(content):
    """Sentences of the reservations in JSON."""
    return [
        remark["sentence"] for remark in content["remarks"] if remark["severity"] == "reservation"
    ]


@pytest.fixture(autouse=True)
def computed_once(monkeypatch):
    """Commands measure equal files once by few draws, and run equal simulations once."""
    draw_little(monkeypatch)
    measure_surfaces_once(monkeypatch)
    run_simulations_once(monkeypatch)


@pytest.fixture
def surface():
    """Surface of the scans that are shipped."""
    return shipped_surface(DETAIL, OVERVIEW)


@pytest.fixture(scope="module")
def smooth(tmp_path_factory):
    """Scan of a surface that the theory applies to without reservations."""
    return write_smooth(tmp_path_factory.mktemp("scans") / "smooth.al3d")


@pytest.fixture
def predict():
    """Result of a prediction for the shipped scans, without the seconds that figures take."""

    def command(*more, scans=(DETAIL, OVERVIEW), **changes):
        return run("predict", *scans, *sphere(**changes), "--no-figure", *more)

    return command


def test_a_batch_of_scans_is_a_table_with_a_row_for_each_sample(tmp_path, smooth):
    table, absent = tmp_path / "samples.csv", tmp_path / "absent.al3d"
    scans = {OVERVIEW: "applies with reservations", smooth: "applies", absent: "invalid"}
    command = ("predict", *sphere(), "--csv", table)
    assert run(*command, *scans).exit_code == 4
    with table.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {Path(row["scan"]): row["outcome"] for row in rows} == scans
    expected = cf.predict(smooth, SCENE)
    assert float(rows[1]["w_retr_high"]) == expected.w_retr.high
    assert float(rows[1]["e_el"]) == expected.e_el.value
    assert float(rows[1]["rms_slopes"]) == expected.surface.measures[2].rms.value
    assert "small slopes" in rows[0]["remarks"]
    assert "absent.al3d" in rows[2]["remarks"]
    assert (rows[2]["w_retr"], rows[1]["remarks"]) == ("", "")
    assert run(*command, "--strict", OVERVIEW).exit_code == 3
    assert "--csv writes rows alone" in refused(*command, "--json", OVERVIEW)


def test_channels_are_listed_without_the_options_that_a_prediction_needs():
    for command in ("predict", "surface"):
        listed = run(command, OVERVIEW, "--list-channels")
        told = f"{OVERVIEW}\n  0 'Default' (height), 144 x 144 points, default\n"
        assert (listed.output, listed.exit_code) == (told, 0)


def test_each_outcome_has_its_exit_code(predict, smooth):
    for code, outcome, more in (
        (0, "applies", {"scans": (smooth,)}),
        (0, "applies with reservations", {}),
        (3, "applies with reservations", {"strict": True}),
        (4, "does not apply", {"modulus": "100GPa"}),
    ):
        strict = ["--strict"] * more.pop("strict", False)
        result = predict("--json", *strict, **more)
        content = json.loads(result.stdout)
        assert (result.exit_code, content["outcome"]) == (code, outcome)
        assert (content["prediction"] is None) == (code == 4)


def test_a_theory_that_does_not_apply_is_a_short_page_of_reasons_and_remedies(predict):
    page = predict(modulus="3MPa").output.splitlines()
    assert len(page) < 12
    assert all(len(line) <= 100 for line in page)
    assert "THE THEORY DOES NOT APPLY" in page[0]
    assert "It would be met with a contact modulus" in " ".join(" ".join(page).split())
    everything = predict("--long", modulus="3MPa").output
    assert everything.splitlines()[: len(page)] == page
    assert "rms of slopes" in everything
    assert "The numbers are for an e_el of" not in everything


def test_the_short_text_is_the_beginning_of_the_long_one(predict):
    result = predict("--long")
    assert result.exit_code == 0, result.output
    short = result.output.split("\n\n")[0].splitlines()
    assert predict().output.splitlines() == short
    for name in ("nanodiamond-overview.al3d", "hurst", "w_appr", "w_retr", "L_kappa"):
        assert name in result.output


def test_json_has_units_for_everything_that_is_predicted(predict, surface):
    prediction = predicted(surface, SCENE)
    content = json.loads(predict("--json").stdout)
    assert set(content["prediction"]) == {item.name for item in variables(Prediction)}
    for item in variables(Prediction):
        estimate, entry = getattr(prediction, item.name), content["prediction"][item.name]
        assert (entry["units"], entry["long_name"]) == (item.units, item.attributes["long_name"])
        number = {"value": estimate}
        if isinstance(estimate, Estimate):
            number = {name: getattr(estimate, name) for name in ("value", "low", "high")}
        for name, expected in number.items():
            is_finite = np.isfinite(expected)
            assert entry[name] == (pytest.approx(expected, rel=1e-12) if is_finite else None)
    assert [item["checksum"] for item in content["measurements"]] == [
        scan.measurement.checksum for scan in surface.scans
    ]
    density = content["measurements"][1]["density"]
    assert len(density["wavevector"]) == len(density["value"]) > 10
    assert content["measurements"][1]["limits"][0]["cause"] == "pixels"
    shares = content["spectrum"]["share_of_e_el"]
    assert shares["measured"] + shares["continued"] == pytest.approx(1)
    assert shares["measured"] > 0.9
    assert content["simulation"] is None


def test_simulations_find_what_is_predicted(predict):
    """A scene with few sites: long waves of the overview under a small sphere."""
    result = predict(
        *("--simulate", "--realisations", "3", "--seed", "1", "--json"),
        scans=(OVERVIEW,),
        radius="0.5mm",
        modulus="1.2MPa",
    )
    assert result.exit_code == 0, result.output
    content = json.loads(result.stdout)
    simulation_json, law = content["simulation"], content["prediction"]
    assert simulation_json["realisations"] == 3
    assert simulation_json["remark"] == ""
    assert (
        simulation_json["w_appr"]["low"]
        < simulation_json["w_appr"]["value"]
        < simulation_json["w_appr"]["high"]
    )
    simulated_factor = content["factors"]["both"]
    k = simulation_json["k"]
    law_half_width = (k["high"] - k["low"]) / 2
    assert abs(k["value"] - simulated_factor["value"]) < np.hypot(
        law_half_width, (simulated_factor["high"] - simulated_factor["low"]) / 2
    )
    assert law["k_appr"]["value"] == content["factors"]["approach"]["factor"]["value"]
    for works in (simulation_json, simulation_json["corrected"]):
        appr, retr, lost = (works[name]["value"] for name in ("w_appr", "w_retr", "hysteresis"))
        assert lost == pytest.approx(retr - appr)
    ratio = content["excess"]["ratio"]["value"]
    assert simulation_json["hysteresis"]["value"] == pytest.approx(ratio * lost)
    # The front beside the front, what is corrected beside the headline.
    for simulated, prediction in (
        (simulation_json, law["front_hysteresis"]),
        (simulation_json["corrected"], law["hysteresis"]),
    ):
        assert prediction["low"] < simulated["hysteresis"]["value"] < prediction["high"]


def test_a_map_becomes_a_field_that_a_cycle_runs_on(tmp_path):
    field, out = tmp_path / "field.nc", tmp_path / "out.nc"
    coarse = sphere(radius="20um")
    result = run("surface", OVERVIEW, *coarse, "--shortest", "4um", "--field", field)
    assert result.exit_code == 0, result.output
    assert "the power law would add" in result.output
    adhesion = surface_adhesion(read_field(field))
    scales = cf.Scales("20um", SCENE.work_of_adhesion, SCENE.contact_modulus)
    assert cf.load_result(field).identical(cf.read_scan(OVERVIEW, scales, shortest="4um"))
    assert adhesion.work_of_adhesion.shape == (288, 288)
    scene = replace(SCENE, radius=20e-6)
    assert adhesion.pixel * scene.lateral == pytest.approx(0.3e-6)
    more = ("--max-penetration", 0.2, "--step", 0.4)
    result = run("cycle", "--field", field, *more, "--output", out)
    assert result.exit_code == 0, result.output
    assert cf.load_result(out).penetration.size > 1


def test_a_surface_alone_has_no_energy_and_with_a_sphere_it_has(surface):
    alone = run("surface", DETAIL, OVERVIEW)
    assert alone.exit_code == 0, alone.output
    assert "e_el  " not in alone.output
    assert "e_el  " in run("surface", DETAIL, OVERVIEW, *sphere()).output
    content = json.loads(run("surface", DETAIL, OVERVIEW, *sphere(), "--json").stdout)
    energy = surface.conformity_energy(SCENE.contact_modulus)
    assert content["e_el"]["value"] == pytest.approx(energy.value)
    assert content["prediction"] is None


def test_no_command_overwrites_what_it_reads(tmp_path):
    scan, second_scan = (shutil.copy(OVERVIEW, tmp_path / f"{name}.al3d") for name in "ab")
    line, grid = tmp_path / "line.csv", tmp_path / "grid.nc"
    line.write_text("x (um),z (nm)\n0,1\n1,3\n2,2\n")
    xr.DataArray(np.eye(4), dims=("x", "y"), name="height").to_netcdf(grid)
    table = Path(shutil.copy(ROOT / "examples/samples.csv", tmp_path / "samples.csv"))
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    for words in (
        ("predict", scan, *sphere(), "--csv", scan),
        ("predict", second_scan, *sphere(), "--csv", scan),  # the name of the table was forgotten
        ("predict", second_scan, *sphere(), "--csv", line),
        ("surface", scan, *sphere(), "--field", scan),
        ("surface", second_scan, *sphere(), "--field", grid),
        ("surface", second_scan, *sphere(), "--field", scan),
        ("samples", table, *sphere(), "--csv", table),
        ("samples", table, *sphere(), "--csv", scan),
    ):
        sentence = refused(*words)
        assert "which the command reads" in sentence or "has not written" in sentence
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--seed", "1"), "--seed has an effect only with --simulate"),
        (("--realisations", "2"), "--realisations has an effect only with --simulate"),
        (("--no-figure", "--panel", "c"), "--panel has no effect with --no-figure"),
        (("--json", "--long"), "--long has no effect with --json"),
        (("--csv", "."), "cannot be used: Is a directory"),
        (("--hurst", "0.8"), "by SCANS and --hurst"),
    ],
)
def test_an_option_without_an_effect_is_refused_before_any_work(words, sentence):
    assert sentence in refused("predict", OVERVIEW, *sphere(), *words)


def test_a_field_needs_the_whole_sphere_and_one_scan(tmp_path):
    field = ("--field", tmp_path / "field.nc")
    assert "the sphere is incomplete" in refused("surface", OVERVIEW, *field)
    assert "the sphere is incomplete" in refused("surface", OVERVIEW, *sphere(radius=None), *field)
    assert "--field takes one scan" in refused("surface", OVERVIEW, DETAIL, *sphere(), *field)
    assert not (tmp_path / "field.nc").exists()


NUMBERS = ("--rms", "20nm", "--roll-off", "2um", "--hurst", "0.8", "--short-cutoff", "20nm")


def test_a_surface_may_be_given_by_a_density_or_by_numbers(tmp_path):
    spectrum = cf.SelfAffineSpectrum(20e-9, 2e-6, 0.8)
    spectrum = spectrum.amplified(20e-9**2 / spectrum.mean_square(0.0))
    q = 2 * np.pi / np.geomspace(8e-6, 20e-9, 50)
    path = tmp_path / "psd.csv"
    rows = zip(q, spectrum.density(q), strict=True)
    path.write_text("q (1/m),C2D (m^4)\n" + "".join(f"{a},{b}\n" for a, b in rows))
    surfaces = (("--psd", path), NUMBERS)
    answers = []
    for surface in surfaces:
        result = run("predict", *surface, *sphere(), "--no-figure", "--json")
        assert result.exit_code == 0, result.output
        answers.append(json.loads(result.output))
    energies = [content["prediction"]["e_el"]["value"] for content in answers]
    assert energies[0] == pytest.approx(energies[1], rel=0.01)
    assert energies[1] == pytest.approx(SCENE.contact_modulus / 4 * spectrum.mean_square(0.5))
    for content in answers:
        assert content["measurements"] == []
        assert any("Without heights" in text for text in reservations(content))
    page = run("predict", *NUMBERS, *sphere(), "--figure", tmp_path / "figure.png", "--long")
    assert "rms height 20 nm, roll-off 2 um, H 0.8" in page.output
    assert (tmp_path / "figure.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("surface", "sentence"),
    [
        ((), "the surface is given in no way; name scans"),
        ((DETAIL, *NUMBERS), "by SCANS and --rms"),
        (("--psd", "psd.csv", *NUMBERS), "by --psd and --rms"),
        ((DETAIL, "--psd-sides", "one"), "--psd-sides is of a density; name it with --psd"),
        ((*NUMBERS, "--unit", "um"), "--unit is of scans; leave it out"),
        ((*NUMBERS, "--csv", "out.csv"), "--csv writes a row for each scan"),
        ((*NUMBERS, "--panel", "d"), "panel is d, which shows scans"),
        (("--rms", "20nm"), "needs rms, hurst, and either"),
        (("--psd", "psd.csv", "--psd-kind", "3d"), "--psd-kind is '3d'; it must be '1d'"),
    ],
)
def test_a_surface_is_given_in_one_way(tmp_path, monkeypatch, surface, sentence):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "psd.csv").write_text("q,PSD\n1,2\n2,1\n")
    assert sentence in refused("predict", *surface, *sphere())
