"""The commands of the study: scenes are measured, whatever was measured is reported."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

from studies.__main__ import main
from studies.accuracy.files import STUDIES
from studies.accuracy.scenes import SCENES
from studies.accuracy.study import scene_errors, trial_seconds
from studies.numbers import stored


def run(*arguments):
    """Result of a command of the study."""
    return CliRunner().invoke(main, ["accuracy", *map(str, arguments)])


def measure(folder, study):
    """Measure three surfaces of the smallest scene."""
    arguments = ("--study", study, "--realisations", 3, "--output", folder)
    done = run("scene", "small-0.04", *arguments)
    assert done.exit_code == 0, done.output
    return done.output


def test_an_empty_folder_has_nothing_to_report(tmp_path):
    empty = run("report", "--output", tmp_path)
    assert empty.exit_code == 2
    assert "run python -m studies accuracy scene" in empty.output


@pytest.mark.slow
@pytest.mark.parametrize(
    ("study", "tables"),
    [
        ("requested", {"Time to an error of the hysteresis", "Errors that were requested"}),
        ("unseen", {"Errors on unseen surfaces"}),
        ("expected", {"Errors on many surfaces"}),
        ("coverage", {"Stated and true errors"}),
    ],
)
def test_one_measured_scene_is_reported_and_kept(study, tables, tmp_path, monkeypatch):
    assert "requested 0.03: " in measure(tmp_path, study)
    monkeypatch.chdir(tmp_path)
    reported = run("report", "--output", tmp_path, "--keep")
    assert reported.exit_code == 0, reported.output
    text = (tmp_path / "accuracy.md").read_text()
    assert set(re.findall("^## (.*)", text, re.MULTILINE)) - {"Settings, small-0.04"} == tables
    assert "| small-0.04 | 0.01 |" in text
    assert tables == stored("accuracy").tables.keys()


@pytest.mark.slow
def test_the_cost_of_a_study_is_that_of_its_runs():
    scene = SCENES["small-0.04"]
    errors = scene_errors(scene, scene.requested_trials(), range(2))
    reference = trial_seconds(scene, [])
    # The reference says how fast this machine is.
    expected = np.mean(errors.reference_seconds) / reference
    expected *= STUDIES["requested"].seconds(scene) - reference
    spent = sum(np.mean(error.seconds) for error in errors.errors)
    assert spent / 4 < expected < 4 * spent
