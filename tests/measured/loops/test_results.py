"""What a result of a loop can do: draw itself, become JSON, and become a page to send."""

import json

import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from crackfront import measured_loop
from crackfront.analysis.estimate import Estimate, normal_estimate
from crackfront.cli import main
from crackfront.measured.loops.analysis import analyse_loop
from crackfront.measured.loops.comparison import comparison_lines, mean_work
from crackfront.measured.loops.rig import Rig
from crackfront.measured.prediction.remarks import Verdict
from tests.measured.loops.made import MODULUS, RADIUS, W_APPR, W_RETR, in_contact, loop


@pytest.fixture(scope="module")
def result():
    return analyse_loop(loop(0), Rig(RADIUS, MODULUS))


@pytest.fixture
def table(tmp_path):
    """File of two loops."""
    path = tmp_path / "rig.csv"
    rows = [
        f"{force},{radius}"
        for seed in range(2)
        for force, radius in zip(loop(seed).force, loop(seed).radius, strict=True)
    ]
    path.write_text("Force (N),Radius (m)\n" + "\n".join(rows) + "\n")
    return path


def run(*arguments):
    return CliRunner().invoke(main, ["loop", *map(str, arguments)])


def test_a_result_draws_its_rows_on_axes(result):
    figure, axes = plt.subplots()
    assert result.plot(axes) is axes
    assert np.nanmax(axes.get_lines()[0].get_ydata()) == pytest.approx(
        np.nanmax(result.contact_radius), rel=0.01
    )
    plt.close(figure)
    new = result.plot()
    assert new.get_legend() is not None
    plt.close(new.figure)


def test_a_branch_alone_is_drawn():
    axes = analyse_loop(loop(0), Rig(RADIUS, MODULUS, segment="retract")).plot()
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "retraction" in labels
    assert "approach" not in labels
    plt.close(axes.figure)


def test_a_dictionary_of_a_result_is_json_of_the_command(result):
    numbers = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert numbers["w_retr"]["value"] == result.w_retr.value
    assert numbers["remarks"] == list(result.remarks)


def test_the_command_writes_a_page_with_numbers_remarks_and_figure(table, tmp_path):
    page = tmp_path / "page.html"
    done = run(
        table,
        "--loop",
        "2",
        "--radius",
        "1.25mm",
        "--modulus",
        "0.7MPa",
        "--poisson",
        "0.5",
        "--report",
        page,
    )
    assert done.exit_code == 0, done.output
    text = page.read_text()
    assert text.startswith("<!doctype html>")
    for line in done.stdout.splitlines()[:-2]:
        assert line[18:].strip() in text or line in text
    assert "data:image/png;base64," in text
    assert "rig.csv" in text


def test_a_page_does_not_overwrite_a_file_of_another_program(table, tmp_path):
    page = tmp_path / "notes.html"
    page.write_text("my notes")
    done = run(table, "--loop", "2", "--radius", "1.25mm", "--report", page)
    assert done.exit_code == 2
    assert "--report" in done.output
    assert page.read_text() == "my notes"


def test_the_command_asks_for_one_of_several_loops_and_inverts_a_force(table):
    done = run(table, "--radius", "1.25mm")
    assert done.exit_code == 2
    assert "2 loops" in done.output
    done = run(table, "--radius", "1.25mm", "--loop", "1", "--invert", "force")
    assert done.exit_code == 2
    assert "--invert force" in done.output
    done = run(table, "--radius", "1.25mm", "--loop", "1", "--segment", "approach", "--json")
    assert json.loads(done.stdout)["w_appr"]["value"] == pytest.approx(W_APPR, rel=0.05)


def test_a_measured_dataset_with_a_penetration_is_not_a_simulated_cycle():
    columns = in_contact(force_noise=0.0, radius_noise=0.0)
    data = xr.Dataset({name: ("row", values) for name, values in columns.items()})
    data = data.assign(penetration=("row", columns["displacement"]))
    result = measured_loop(data, radius=RADIUS, contact_modulus=MODULUS)
    assert result.w_retr.value == pytest.approx(W_RETR, rel=1e-6)


class Predicted:
    """The works of a prediction, relative to those of a loop."""

    verdict = Verdict(())

    def __init__(self, measured, *, times=1.0, relative_error=0.0, w_int=0.05):
        for name in ("w_appr", "w_retr", "hysteresis"):
            value = getattr(measured, name).value / times
            error = relative_error * value
            setattr(self, name, Estimate(value, error, value - error, value + error))
        self.work_of_adhesion = w_int
        self.e_el = normal_estimate(0.005, 0.0005)


@pytest.mark.parametrize(
    ("times", "relative_error", "sentence"),
    [
        (2.66, 1.8, "agree within their intervals"),
        (2.66, 0.2, "is larger than the predicted one"),
        (1.5, 0.01, "is larger than the predicted one"),
        (0.3, 0.1, "is smaller than the predicted one"),
        (0.9, 0.5, "agree within their intervals"),
    ],
)
def test_the_interval_of_the_ratio_decides(result, times, relative_error, sentence):
    predicted = Predicted(result, times=times, relative_error=relative_error)
    text = "\n".join(comparison_lines(result, predicted))
    assert sentence in text
    assert ("docs/questions.md" in text) == ("agree" not in sentence)


def test_the_mean_of_both_works_is_compared_with_w_int_less_e_el(result):
    right = "\n".join(comparison_lines(result, Predicted(result, w_int=0.05)))
    wrong = "\n".join(comparison_lines(result, Predicted(result, w_int=0.07)))
    for text in (right, wrong):
        assert "mean of both    45" in text
        assert "w_int - e_el" in text
    assert "give a w_int of" not in right
    assert "give a w_int of 50" in wrong
    assert "not 70 mJ/m2" in wrong


def test_the_mean_has_the_errors_that_both_works_share(result):
    """Shared errors are those of sum and difference: 0.01 each, and 0.002 of the difference."""
    shared, single = 0.01, 0.001
    error = np.hypot(shared, single)
    works = Predicted(result)
    works.w_appr, works.w_retr = normal_estimate(0.03, error), normal_estimate(0.06, error)
    works.hysteresis = normal_estimate(0.03, np.sqrt(2) * single)
    mean = mean_work(works)
    assert mean.value == pytest.approx(0.045)
    assert mean.standard_error == pytest.approx(np.hypot(shared, single / np.sqrt(2)))


def test_a_branch_alone_is_compared_with_its_prediction(result):
    alone = analyse_loop(loop(0), Rig(RADIUS, MODULUS, segment="retract"))
    text = "\n".join(comparison_lines(alone, Predicted(result)))
    assert "w_retr" in text
    assert "w_appr" not in text
    assert "nan" not in text
