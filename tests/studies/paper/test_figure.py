"""Figures of the paper: their configurations, data and checks."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from crackfront.core.variables import variable
from crackfront.simulate.provenance import provenance
from crackfront.simulate.storage import UnreadableFileError, read_attributes
from crackfront.sweep.section import ConfigurationError
from studies.paper.figure import FIGURES, SCALES, figure, load_figure, sweep_of_figure
from studies.records import read_record, write_record
from tests.studies.paper.made import CONFIGURATIONS

REFERENCES = Path(__file__).parents[3] / "docs" / "reference"


def test_the_sweep_of_a_figure_is_known_without_what_computes_the_figure(tmp_path):
    path = CONFIGURATIONS / "si-5.yaml"
    for scale in SCALES:
        assert sweep_of_figure(path, scale) == Path(load_figure(path, scale).sweep)
    wrong = tmp_path / "si-5.yaml"
    wrong.write_text(path.read_text().replace("sweep:", "swept:"))
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
        (f"parameters: {GOOD}\nquick: {{stepp: 1.0}}\npaper: {{}}", "did you mean step"),
        (f"parameters: {GOOD.replace('0.6', '1.6')}\nquick: {{}}\npaper: {{}}", "not be above"),
    ],
)
def test_a_wrong_configuration_is_refused_with_a_sentence(tmp_path, text, sentence):
    path = tmp_path / "main-1d.yaml"
    path.write_text(text)
    with pytest.raises(ConfigurationError, match=sentence):
        load_figure(path, "quick")


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
@pytest.mark.parametrize("name", [name for name in FIGURES if (REFERENCES / f"{name}.nc").exists()])
def test_the_kept_data_can_be_read_and_say_where_they_come_from(name):
    path, scene = REFERENCES / f"{name}.nc", figure(name)
    assert any(check.passed for check in scene.checks(read_record(path, scene.record)))
    origin = read_attributes(path)
    assert origin["scale"] == "paper"
    assert f"figure config/figures/{name}.yaml --scale paper" in origin["command"]
    assert "dirty" not in origin["git_commit"]
