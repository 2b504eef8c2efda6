"""The command of measured loops."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.cli import main
from tests.measured.loops.made import W_APPR, W_RETR, loop


@pytest.fixture
def table(tmp_path):
    """A table with semicolons and decimal commas."""
    one, path = loop(0), tmp_path / "rig.csv"
    rows = zip(1e3 * one.force, 1e6 * one.radius, strict=True)
    lines = [f"{force:.6f};{radius:.4f}".replace(".", ",") for force, radius in rows]
    path.write_text("Rig 7\nForce (mN);Contact radius (um)\n" + "\n".join(lines) + "\n")
    return path


ROOT = Path(__file__).parents[2]
SCAN = ROOT / "examples/scans/nanodiamond-detail.al3d"
ON_SCAN = ("--radius", "1.25mm", "--scans", SCAN)


def run(*arguments):
    return CliRunner().invoke(main, ["loop", *map(str, arguments)])


def test_a_table_becomes_works_of_adhesion_and_a_figure(table, tmp_path):
    sphere = ("--radius", "1.25mm", "--modulus", "0.7MPa")
    done = run(table, *sphere, "--figure", tmp_path / "loop.png", "--json")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    for name, truth in (("w_appr", W_APPR), ("w_retr", W_RETR)):
        assert found[name]["low"] < truth < found[name]["high"]
    assert (tmp_path / "loop.png").stat().st_size > 1e4
    done = run(table, *sphere)
    assert done.stdout.startswith("hysteresis")


def test_the_example_of_the_page_has_the_simulated_hysteresis():
    options = "--radius 100um --modulus 0.7MPa"
    assert f"crackfront loop examples/rig.csv {options}" in (ROOT / "docs/loops.md").read_text()
    done = run(ROOT / "examples/rig.csv", *options.split(), "--json")
    found = json.loads(done.stdout)["hysteresis"]
    assert found["low"] < 11.29e-3 < found["high"]
    assert found["high"] - found["low"] < 4e-3


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--radius", "1.25"), "without a unit"),
        (("--radius", "1.25mm", "--window", "50um"), "give two contact radii"),
        (("--radius", "1.25mm", "--stiffness", "3kg"), "not a unit of stiffness"),
        (("--radius", "1.25mm", "--poisson", "0.3"), "--poisson has an effect only with --modulus"),
        (("--radius", "1.25mm", "--scans", "a.al3d"), "--work-of-adhesion"),
        (("--radius", "1.25mm", "--force", "Kraft"), "lacks a column 'Kraft'"),
        (("--radius", "1.25mm", "--size", "5"), "--size is of scans; name --scans too"),
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
    found = json.loads(done.stdout)
    assert found["predicted"]["outcome"] == "applies with reservations"
    ratio = found["ratio"]
    expected = found["hysteresis"]["value"] / found["predicted"]["hysteresis"]["value"]
    assert np.isclose(ratio["value"], expected)
    assert ratio["low"] < ratio["value"] < ratio["high"]


def test_options_of_reading_apply_to_the_scans(table):
    adhesion = ("--work-of-adhesion", "63mJ/m2", "--json")
    fine, coarse = (
        json.loads(run(table, *ON_SCAN, *adhesion, "--tip-radius", radius).stdout)["predicted"]
        for radius in ("1nm", f"{SCAN.name}=200nm")
    )
    assert coarse["hysteresis"]["high"] > fine["hysteresis"]["high"]


def test_a_loop_whose_prediction_is_refused_is_kept(table, tmp_path):
    figure = tmp_path / "loop.png"
    done = run(table, *ON_SCAN, "--work-of-adhesion", "1uJ/m2", "--json", "--figure", figure)
    assert done.exit_code == 2
    assert "the theory does not apply" in done.stderr
    found = json.loads(done.stdout)
    assert found["w_appr"]["low"] < W_APPR < found["w_appr"]["high"]
    assert "predicted" not in found
    assert figure.is_file()
