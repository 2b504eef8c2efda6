"""Figures of the paper: their configurations, data and checks."""

import ast
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from crackfront.core.variables import variable
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import UnreadableFileError, read_attributes
from crackfront.sweep.section import ConfigurationError
from studies.numbers import stored
from studies.paper.figure import FIGURES, SCALES, figure, load_figure, sweep_of_figure
from studies.records import read_record, write_record
from tests.studies.paper.made import CONFIGURATIONS

REFERENCES = Path(__file__).parents[3] / "docs" / "reference"


def test_every_figure_has_a_configuration():
    assert {path.stem for path in CONFIGURATIONS.glob("*.yaml")} == set(FIGURES)


def test_figures_that_took_longer_than_a_minute_tell_about_how_long_they_take(monkeypatch):
    monkeypatch.chdir(REFERENCES.parents[1])
    told = {
        name: re.search(r"Scale (\w+), (\d+) s of one core", part.text).groups()
        for name, part in stored("paper").tables.items()
        if name in FIGURES
    }
    slow = [
        (name, scale, float(seconds))
        for name, (scale, seconds) in told.items()
        if float(seconds) > 60
    ]
    assert len(slow) >= 4
    ratios = {
        name: figure(name).seconds(load_figure(CONFIGURATIONS / f"{name}.yaml", scale)) / seconds
        for name, scale, seconds in slow
    }
    # The speed of the machine that measured them is common to all.
    common = np.median([*ratios.values()])
    assert all(1 / 3 < ratio / common < 3 for ratio in ratios.values()), ratios


def test_the_workflow_names_those_that_take_longest_and_those_that_move():
    rules = (REFERENCES.parents[1] / "workflow/rules/paper.smk").read_text()
    longest, moving = (
        set(ast.literal_eval(re.search(rf"^{name} = (\[.*?\])$", rules, re.M | re.S)[1]))
        for name in ("LONGEST", "ANIMATED")
    )
    assert moving == {name for name in FIGURES if figure(name).animate}
    for scale in SCALES:
        seconds = {
            name: figure(name).seconds(load_figure(CONFIGURATIONS / f"{name}.yaml", scale))
            for name in FIGURES
        }
        assert set(sorted(FIGURES, key=seconds.get)[-5:]) == longest


def test_the_sweep_of_a_figure_is_known_without_what_computes_the_figure(tmp_path):
    given = CONFIGURATIONS / "si-5.yaml"
    for scale in SCALES:
        assert sweep_of_figure(given, scale) == Path(load_figure(given, scale).sweep)
    wrong = tmp_path / "si-5.yaml"
    wrong.write_text(given.read_text().replace("sweep:", "swept:"))
    with pytest.raises(ConfigurationError, match="swept"):
        sweep_of_figure(wrong, "quick")


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", FIGURES)
def test_every_configuration_is_valid_at_every_scale(name, scale):
    parameters = load_figure(CONFIGURATIONS / f"{name}.yaml", scale)
    assert isinstance(parameters, figure(name).parameters)


GOOD = "{approach: 0.6, retraction: 1.4, max_penetration: 1.0, step: 0.1}"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (f"parameters: {GOOD}\nquick: {{}}", "key paper is missing; the keys here are"),
        (f"parameters: {GOOD}\nquick: {{}}\npaper: {{}}\nfine: {{}}", "unknown key fine"),
        (f"parameters: {GOOD}\nquick: {{step: 1.0}}\npaper: {{}}", "stands in parameters and in"),
        (f"parameters: {GOOD}\nquick: 3\npaper: {{}}", "quick must be a mapping"),
        ("parameters: {}\nquick: {}\npaper: {}", "key approach is missing"),
        (f"parameters: {GOOD}\nquick: {{stepp: 1.0}}\npaper: {{}}", "did you mean step"),
        (f"parameters: {GOOD.replace('0.6', '1.6')}\nquick: {{}}\npaper: {{}}", "not be above"),
        (f"parameters: {GOOD.replace('0.1', '-0.1')}\nquick: {{}}\npaper: {{}}", "step is -0.1"),
    ],
)
def test_a_wrong_configuration_is_refused_with_a_sentence(tmp_path, text, sentence):
    path = tmp_path / "main-1d.yaml"
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=sentence):
        load_figure(path, "quick")


def test_a_figure_that_does_not_exist_is_refused():
    with pytest.raises(ConfigurationError, match="'main-9' is not a figure; the names"):
        load_figure(Path("main-9.yaml"), "quick")


@dataclass(frozen=True)
class Short:
    force: np.ndarray = variable("force", "1", "state")


@dataclass(frozen=True)
class Long(Short):
    stiffness: float = variable("stiffness", "1")


def test_a_file_that_lacks_data_is_refused(tmp_path):
    path = tmp_path / "short.nc"
    write_record(path, Short(np.arange(3.0)), provenance())
    with pytest.raises(UnreadableFileError, match="Long: stiffness is missing"):
        read_record(path, Long)


@pytest.mark.usefixtures("_few_draws")
@pytest.mark.parametrize("path", sorted(REFERENCES.glob("*.nc")), ids=lambda path: path.stem)
def test_the_kept_data_can_be_read_and_say_where_they_come_from(path):
    scene = figure(path.stem)
    assert any(check.passed for check in scene.checks(read_record(path, scene.record)))
    origin = read_attributes(path)
    assert origin["scale"] == "paper"
    assert f"figure config/figures/{path.stem}.yaml --scale paper" in origin["command"]
    assert "dirty" not in origin["git_commit"]
