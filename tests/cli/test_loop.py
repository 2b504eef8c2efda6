"""The command of measured loops."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.cli import main
from tests.measured.loops.made import W_APPR, W_RETR, loop
from tests.measured.made import draw_little, measure_surfaces_once
from tests.places import ROOT


@pytest.fixture
def table(tmp_path):
    """A table with semicolons and decimal commas."""
    simulated, path = loop(0), tmp_path / "rig.csv"
    rows = zip(1e3 * simulated.force, 1e6 * simulated.radius, strict=True)
    lines = [f"{force:.6f};{radius:.4f}".replace(".", ",") for force, radius in rows]
    path.write_text("Rig 7\nForce (mN);Contact radius (um)\n" + "\n".join(lines) + "\n")
    return path


SCAN = ROOT / "examples/scans/nanodiamond-detail.al3d"
ON_SCAN = ("--radius", "1.25mm", "--scans", SCAN)


@pytest.fixture(autouse=True)
def computed_once(monkeypatch):
    """Commands measure equal files once by few draws."""
    draw_little(monkeypatch)
    measure_surfaces_once(monkeypatch)


def run(*arguments):
    return CliRunner().invoke(main, ["loop", *map(str, arguments)])


def test_a_table_becomes_works_of_adhesion_and_a_figure(table, tmp_path):
    sphere = ("--radius", "1.25mm", "--modulus", "0.7MPa", "--poisson", "0.5")
    done = run(table, *sphere, "--figure", tmp_path / "loop.png", "--json")
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    for name, truth in (("w_appr", W_APPR), ("w_retr", W_RETR)):
        assert content[name]["low"] < truth < content[name]["high"]
    assert (tmp_path / "loop.png").stat().st_size > 1e4
    done = run(table, *sphere)
    assert done.stdout.startswith("hysteresis")


def test_the_example_of_the_page_has_the_simulated_hysteresis():
    options = "--radius 100um --modulus 0.7MPa --poisson 0.5"
    assert f"crackfront loop examples/rig.csv {options}" in (ROOT / "docs/loops.md").read_text()
    done = run(ROOT / "examples/rig.csv", *options.split(), "--json")
    hysteresis = json.loads(done.stdout)["hysteresis"]
    assert hysteresis["low"] < 11.29e-3 < hysteresis["high"]
    assert hysteresis["high"] - hysteresis["low"] < 4e-3


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--radius", "1.25"), "without a unit"),
        (("--radius", "1.25mm", "--window", "50um"), "give two contact radii"),
        (("--radius", "1.25mm", "--stiffness", "3kg"), "not a unit of stiffness"),
        (("--radius", "1.25mm", "--poisson", "0"), "--poisson has an effect only with --modulus"),
        (("--radius", "1.25mm", "--modulus", "1MPa"), "effect only with --poisson; give both"),
        (("--radius", "1.25mm", "--modulus", "1MPa", "--poisson", "0.6"), "--poisson is '0.6'"),
        (
            ("--radius", "1.25mm", "--work-of-adhesion-error", "3mJ/m2"),
            "--work-of-adhesion-error is of a prediction; name --scans too",
        ),
        (("--radius", "1.25mm", "--scans", "a.al3d"), "--work-of-adhesion"),
        (("--radius", "1.25mm", "--force", "Kraft"), "lacks a column 'Kraft'"),
        (("--radius", "1.25mm", "--size", "5"), "--size is of a prediction; name --scans too"),
        (
            (*ON_SCAN, "--work-of-adhesion", "63mJ/m2", "--tip-radius", "20"),
            "--tip-radius is '20', without a unit",
        ),
    ],
)
def test_what_cannot_be_used_is_refused_with_what_to_do(table, options, sentence):
    done = run(table, *options)
    assert done.exit_code == 2
    assert sentence in done.output


def test_a_scan_beside_the_loop_gives_their_ratio(table):
    done = run(table, *ON_SCAN, "--work-of-adhesion", "63mJ/m2", "--json")
    assert done.exit_code == 0, done.output
    content = json.loads(done.stdout)
    assert content["predicted"]["outcome"] == "applies with reservations"
    ratio = content["ratio"]
    expected = content["hysteresis"]["value"] / content["predicted"]["hysteresis"]["value"]
    assert np.isclose(ratio["value"], expected)
    assert ratio["low"] < ratio["value"] < ratio["high"]


def test_an_error_of_w_int_widens_the_prediction_as_in_predict(table):
    sphere = (*ON_SCAN, "--work-of-adhesion", "63mJ/m2")
    exact, uncertain = (
        json.loads(run(table, *sphere, *error, "--json").stdout)
        for error in ((), ("--work-of-adhesion-error", "5mJ/m2"))
    )
    assert uncertain["w_retr"] == exact["w_retr"]
    widths = [
        content["predicted"]["w_retr"]["high"] - content["predicted"]["w_retr"]["low"]
        for content in (exact, uncertain)
    ]
    assert widths[1] > widths[0] + 10e-3


def test_a_loop_whose_prediction_is_refused_is_kept(table, tmp_path):
    figure = tmp_path / "loop.png"
    done = run(table, *ON_SCAN, "--work-of-adhesion", "1uJ/m2", "--json", "--figure", figure)
    assert done.exit_code == 2
    assert "the theory does not apply" in done.stderr
    content = json.loads(done.stdout)
    assert content["w_appr"]["low"] < W_APPR < content["w_appr"]["high"]
    assert "predicted" not in content
    assert figure.is_file()
