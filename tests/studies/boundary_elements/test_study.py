"""Validations by the command: what they write, tell and find again, and their errors."""

import math
import sys

import pytest
from click.testing import CliRunner

from crackfront.analysis.csv_records import csv_rows, csv_text
from crackfront.analysis.validity import ValidityRow
from crackfront.simulate.storage import UnreadableFileError
from studies.boundary_elements.averages import limit_settings, rows_by_zone
from studies.boundary_elements.commands import commands
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.hysteresis import Hysteresis
from studies.boundary_elements.report import validation_report
from studies.records import read_records


def run(configuration, *options):
    output = ["--output", str(configuration.parent / "results")]
    arguments = ["validate", str(configuration), *(output if "--output" not in options else [])]
    return CliRunner().invoke(commands, [*arguments, *options])


def results(configuration):
    outcome = run(configuration)
    assert outcome.exit_code == 0, outcome.output
    return configuration.parent / "results"


@pytest.fixture(scope="module")
def loop_results(loops):
    return results(loops)


@pytest.fixture(scope="module")
def branch_results(branches):
    return results(branches)


@pytest.mark.slow
def test_loops_are_compared_state_by_state_with_a_crack_that_turns_and_one_that_does_not(
    loop_results,
):
    rows = read_records(loop_results / "differences.nc", Differences, "case")
    assert [(row.n_point, row.rotated, row.elastic_energy > 0) for row in rows] == [
        (48, 1, False),
        (48, 1, True),
        (48, 0, True),
    ]
    assert all(0 < row.force_rms < 0.1 for row in rows if row.rotated)
    assert 3 * rows[1].perimeter_all < rows[2].perimeter_all < 0.5
    hysteresis_record = read_records(loop_results / "hysteresis.nc", Hysteresis, "case")
    assert [row.n_point for row in hysteresis_record] == [48, 48]
    text = (loop_results / "validation.md").read_text()
    assert text.startswith(validation_report(hysteresis_record, rows))


@pytest.mark.slow
def test_both_models_find_the_smooth_sphere_and_the_hysteresis_of_a_rough_one(branch_results):
    smooth, *rough = read_records(branch_results / "hysteresis.nc", Hysteresis, "case")
    assert smooth.front_approach == pytest.approx(1, abs=2e-3)
    assert smooth.front_retraction == pytest.approx(1, abs=2e-3)
    assert smooth.boundary_approach == pytest.approx(1, abs=0.05)
    assert smooth.boundary_retraction == pytest.approx(1, abs=0.05)
    assert abs(smooth.front_difference) < 1e-3
    for row in rough:
        assert row.boundary_approach < 0.9 * smooth.boundary_approach
        assert row.hurst < 1 or row.front_difference > 0.02
        assert row.least_released >= -1e-12


@pytest.mark.slow
def test_tables_figures_and_sentence_are_those_of_the_rows(branch_results):
    rows = read_records(branch_results / "hysteresis.nc", Hysteresis, "case")
    text = (branch_results / "validation.md").read_text()
    assert text.startswith(validation_report(rows, []))
    rows_of_all = [row for (*_, zone), row in rows_by_zone(rows, 0.6).items() if not zone]
    told = csv_rows(csv_text(rows_of_all), ValidityRow)
    limits = limit_settings(rows)
    assert [[row.n_point for row in limit.rows] for limit in limits] == [[64]]
    assert [row.ratio for row in told] == pytest.approx(
        [math.exp(float(limit.excess(0.0).value)) for limit in limits], rel=1e-4, nan_ok=True
    )
    assert [(row.surfaces, row.fine) for row in told] == [(2, 1)]
    for name in ("validation", "hysteresis"):
        assert (branch_results / f"{name}.png").stat().st_size > 5_000


@pytest.mark.slow
@pytest.mark.usefixtures("loop_results")
def test_a_validation_that_is_repeated_computes_no_cycle_again(loops, monkeypatch):
    # What it draws again is not in question.
    monkeypatch.setattr("studies.boundary_elements.study.save_figure", lambda *_: ())
    outcome = run(loops)
    assert outcome.exit_code == 0
    assert "approach to" not in outcome.output


@pytest.mark.slow
def test_a_damaged_cycle_is_refused(loops, loop_results):
    path = min(loop_results.glob("n48-*.nc"))
    kept = path.read_bytes()
    path.write_bytes(kept[: len(kept) // 2])
    outcome = run(loops)
    path.write_bytes(kept)
    assert isinstance(outcome.exception, UnreadableFileError)


@pytest.mark.parametrize("name", ["ContactMechanics", "finufft"])
def test_a_validation_without_its_extra_is_refused_before_it_computes(
    monkeypatch, tmp_path, loops, name
):
    monkeypatch.setitem(sys.modules, name, None)
    outcome = run(loops, "--output", str(tmp_path / "x"))
    assert f"need {name}, which is not installed" in str(outcome.exception)
    assert "pip install '.[bem]'" in str(outcome.exception)
    assert not (tmp_path / "x").exists()
