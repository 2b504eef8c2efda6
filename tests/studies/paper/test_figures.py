"""Figures of the paper: their configurations, data, checks, drawings and commands."""

import inspect
import json
import re
import subprocess
import sys
import textwrap
from dataclasses import dataclass, replace
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.figure import Figure

from crackfront.cli import main
from crackfront.core.variables import variable
from crackfront.data.comparison import comparison
from crackfront.data.files import UnreadableFileError, read_attributes
from crackfront.data.provenance import provenance
from crackfront.data.records import read_record, write_record
from crackfront.data.section import ConfigurationError
from studies.paper.figure import (
    FIGURES,
    SCALES,
    Check,
    checks_table,
    close_to,
    figure,
    load_figure,
)
from studies.paper.main_1d import SmoothLoop

REFERENCES = Path(__file__).parents[3] / "docs" / "reference"
CONFIGURATIONS = Path(__file__).parents[3] / "config" / "figures"


STATES = ("direction", "penetration", "radius", "force")


def ignore(line):
    """No progress."""


@pytest.fixture
def smooth():
    parameters = load_figure(CONFIGURATIONS / "main-1d.yaml", "quick")
    return figure("main-1d").compute(parameters, ignore)


def test_every_figure_has_a_configuration_and_a_drawing():
    assert {path.stem for path in CONFIGURATIONS.glob("*.yaml")} == set(FIGURES)
    assert all(callable(figure(name).draw) for name in FIGURES)


def test_figures_that_took_longer_than_a_minute_tell_about_how_long_they_take():
    page = (REFERENCES.parent / "gallery.md").read_text(encoding="utf-8")
    told = re.findall(r"Scale (\w+), (\d+) s of one core.*?config/figures/([\w-]+)\.yaml", page)
    slow = [(name, scale, float(seconds)) for scale, seconds, name in told if float(seconds) > 60]
    assert len(slow) >= 5
    for name, scale, seconds in slow:
        expected = figure(name).seconds(load_figure(CONFIGURATIONS / f"{name}.yaml", scale))
        assert seconds / 4 < expected < 4 * seconds, name


def test_the_cost_of_a_figure_is_told_before_it_is_computed(tmp_path):
    def computed(*_):
        raise ValueError("computed")

    shown = replace(figure("beyond-avalanches"), compute=computed)
    with mock.patch("studies.paper.figure.figure", return_value=shown):
        arguments = ["figure", str(CONFIGURATIONS / "beyond-avalanches.yaml"), "--scale", "paper"]
        result = CliRunner().invoke(main, [*arguments, "--output", str(tmp_path)])
    assert result.exit_code == 2
    assert result.stderr == "about 31.4 min of processor time\nError: computed\n"


def test_a_figure_imports_no_other_figure_whose_changes_its_fingerprint_would_miss():
    for name in FIGURES:
        source = Path(inspect.getfile(figure(name).compute)).read_text("utf-8")
        assert re.findall(r"crackfront\.studies\.paper\.(main|si|beyond)_", source) == []


def test_who_computes_and_checks_a_figure_needs_no_matplotlib():
    script = """
        import sys
        from pathlib import Path
        from studies.paper.figure import FIGURES, figure, load_figure
        figures = {name: figure(name) for name in FIGURES}
        shown = figures["main-1d"]
        parameters = load_figure(Path(sys.argv[1]), "quick")
        assert all(check.passed for check in shown.checks(shown.compute(parameters, print)))
        assert "matplotlib" not in sys.modules
    """
    command = [sys.executable, "-c", textwrap.dedent(script), CONFIGURATIONS / "main-1d.yaml"]
    subprocess.run(command, check=True)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", FIGURES)
def test_every_configuration_is_valid_at_every_scale(name, scale):
    parameters = load_figure(CONFIGURATIONS / f"{name}.yaml", scale)
    assert isinstance(parameters, figure(name).parameters)


def edited(tmp_path, text):
    path = tmp_path / "main-1d.yaml"
    path.write_text(text)
    return path


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
    with pytest.raises(ConfigurationError, match=sentence):
        load_figure(edited(tmp_path, text), "quick")


def test_a_figure_that_does_not_exist_is_refused():
    with pytest.raises(ConfigurationError, match="there is no figure 'main-9'; the names"):
        load_figure(Path("main-9.yaml"), "quick")


def test_data_come_back_from_their_file_as_they_were(smooth, tmp_path):
    path = tmp_path / "main-1d.nc"
    write_record(path, smooth, provenance(), title="smooth")
    again = read_record(path, SmoothLoop)
    assert again.approach == smooth.approach
    np.testing.assert_array_equal(again.force, smooth.force)


@dataclass(frozen=True)
class Longer(SmoothLoop):
    stiffness: float = variable("stiffness", "1")


def test_a_file_that_lacks_data_is_refused(smooth, tmp_path):
    path = tmp_path / "main-1d.nc"
    write_record(path, smooth, provenance(), title="smooth")
    with pytest.raises(UnreadableFileError, match="holds no Longer: stiffness is missing"):
        read_record(path, Longer)


def test_a_smooth_loop_follows_the_closed_forms(smooth):
    assert all(check.passed for check in figure("main-1d").checks(smooth))


def test_a_wrong_smooth_loop_fails_its_checks(smooth):
    wrong = replace(smooth, radius=smooth.radius * 1.01, force=smooth.force * 1.01)
    assert [check.passed for check in figure("main-1d").checks(wrong)] == [
        False,
        False,
        False,
        True,
    ]


def test_a_check_that_fails_says_so():
    assert "**FAIL**" in "\n".join(checks_table([close_to("a", 1.0, 2.0, 0.5)]))
    assert "| agrees |" in "\n".join(checks_table([Check("a", "1", "1", passed=True)]))


def test_a_difference_that_the_law_foretells_is_told_with_its_number():
    foretold = close_to("k", 2.1, 3.0, 0.5, law=(2.2, 0.2))
    assert foretold.result == "differs as the law of k says"
    assert "differs as the law of k says: 2.20 ± 0.20 |" in "\n".join(checks_table([foretold]))
    assert close_to("k", 2.9, 3.0, 0.5, law=(2.2, 0.2)).result == "agrees"
    assert close_to("k", 1.9, 3.0, 0.5, law=(2.2, 0.2)).result == "FAIL"


def test_commands_compute_draw_and_check_a_figure(tmp_path):
    def run(*arguments):
        return CliRunner().invoke(main, [str(item) for item in arguments])

    output = tmp_path / "figures"
    computed = run("figure", CONFIGURATIONS / "main-1d.yaml", "--output", output)
    assert computed.exit_code == 0, computed.output
    data = output / "quick" / "main-1d.nc"
    assert run("draw-figure", data).exit_code == 0
    assert data.with_suffix(".pdf").stat().st_size > 1000
    assert run("check-figures", "--output", output).exit_code == 0
    assert "4 of 4 agree, 0 differ" in (output / "checks.md").read_text()
    told = json.loads(run("check-figures", "--output", output, "--json").stdout)
    assert [(one["figure"], one["scale"], one["passed"]) for one in told] == [
        ("main-1d", "quick", True)
    ] * 4
    page = tmp_path / "docs" / "gallery.md"
    assert run("gallery", "--output", output, "--page", page).exit_code == 0
    assert "![Main Fig. 1d" in page.read_text()
    assert (page.parent / "figures" / "main-1d.png").stat().st_size > 1000


@pytest.mark.parametrize("path", sorted(REFERENCES.glob("*.nc")), ids=lambda path: path.stem)
def test_the_kept_data_can_be_read_and_say_where_they_come_from(path):
    scene = figure(path.stem)
    checks = scene.checks(read_record(path, scene.record))
    assert any(check.passed for check in checks)
    told = read_attributes(path)
    assert told["scale"] == "paper"
    command = f"crackfront figure config/figures/{path.stem}.yaml --scale paper"
    assert told["command"].startswith(command)
    assert "dirty" not in told["git_commit"]


def test_data_are_compared_with_a_reference_variable_by_variable(smooth, tmp_path):
    paths = [tmp_path / f"{name}.nc" for name in ("one", "other", "short")]
    changed = replace(smooth, force=smooth.force * (1 + 1e-6))
    shorter = replace(smooth, **{name: getattr(smooth, name)[1:] for name in STATES})
    for path, loop in zip(paths, (smooth, changed, shorter), strict=True):
        write_record(path, loop, provenance(), title="smooth")
    found = comparison(paths[1], paths[0]).by_variable()
    assert found.pop("force").largest == pytest.approx(1e-6, rel=1e-3)
    assert {item.largest for item in found.values()} == {0.0}
    assert all(item.in_bits for item in found.values())
    assert comparison(paths[2], paths[0]).by_variable()["radius"].largest == np.inf
    result = CliRunner().invoke(main, ["compare", str(paths[1]), str(paths[0])])
    assert result.exit_code == 1
    assert "force                                1.0e-06" in result.output
    arguments = ["compare", str(paths[2]), str(paths[0]), "--json"]
    told = json.loads(CliRunner().invoke(main, arguments).stdout)
    assert told["variables"]["radius"] is None
    assert told["variables"]["approach"] == 0.0
    loose = ["compare", str(paths[1]), str(paths[0]), "--tolerance", "1e-5"]
    result = CliRunner().invoke(main, loose)
    assert result.exit_code == 0
    assert "1 files agree in values, not in bits within 1.0e-06" in result.output


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_computed(
    tmp_path, monkeypatch
):
    (tmp_path / "taken").write_text("a file")
    shown = replace(figure("main-1d"), compute=None)
    monkeypatch.setattr("studies.paper.figure.figure", lambda name: shown)
    arguments = [CONFIGURATIONS / "main-1d.yaml", "--output", tmp_path / "taken"]
    result = CliRunner().invoke(main, ["figure", *map(str, arguments)])
    assert result.exit_code == 2
    assert "cannot be used: Not a directory" in result.output


def test_the_figure_of_a_sweep_that_was_not_run_says_how_to_run_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").symlink_to(CONFIGURATIONS.parent)
    result = CliRunner().invoke(main, ["figure", "config/figures/si-5.yaml"])
    assert result.exit_code == 2
    assert "run the sweep first: make SWEEP=config/default.yaml" in result.output


def test_commands_refuse_what_is_no_figure(tmp_path):
    result = CliRunner().invoke(main, ["draw-figure", str(tmp_path / "other.nc")])
    assert result.exit_code == 2
    assert "is no data of a figure" in result.output
    result = CliRunner().invoke(main, ["check-figures", "--output", str(tmp_path)])
    assert "holds no data of figures" in result.output
    result = CliRunner().invoke(main, ["gallery", "--output", str(tmp_path)])
    assert "holds no data of figures" in result.output


def test_a_figure_of_the_smooth_loop_has_labelled_axes(smooth):
    drawn = figure("main-1d").draw(smooth)
    assert isinstance(drawn, Figure)
    assert "force" in drawn.axes[0].get_ylabel()


def test_a_figure_of_the_smooth_loop_names_its_jumps_and_the_pull_off_force(smooth):
    axes = figure("main-1d").draw(smooth).axes[0]
    texts = " ".join(text.get_text() for text in axes.texts).replace("\n", " ")
    for name in ("jump into contact", "jump out of contact", "pull-off force"):
        assert name in texts
    assert axes.get_ylim()[0] < 1.1 * smooth.force.min()
