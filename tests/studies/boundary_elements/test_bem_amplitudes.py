"""Hysteresis of both models by amplitude: what is measured, told and shipped."""

import math
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.analysis.validity import (
    ValidityRow,
    largest_energy,
    shipped_validity,
    validity_of,
    validity_sentence,
    validity_text,
)
from crackfront.cli import main
from crackfront.core import jkr
from crackfront.data.files import read_attributes
from crackfront.data.records import read_record, read_records
from crackfront.data.section import ConfigurationError
from studies.boundary_elements.amplitude_picture import AmplitudePicture
from studies.boundary_elements.amplitude_report import amplitude_report
from studies.boundary_elements.amplitudes import (
    SurfaceComparison,
    apparent_adhesion,
    regions,
    within,
)
from studies.boundary_elements.averages import (
    Setting,
    limit_settings,
    range_limits,
    validity_row,
)
from studies.boundary_elements.cycle import ALL_LOADS, BoundaryCycle
from studies.boundary_elements.front import front_cycle
from studies.boundary_elements.parameters import amplitude_cases, load_validation
from studies.boundary_elements.picture import ValidationPicture
from studies.boundary_elements.report import loop_validity

TEXT = """
seed: 5
short_cutoff: 0.6
side: 5.12
tolerance: 1.0e-4
loads: {first: 0.2, last: 0.4, max_penetration: 0.6, turned: 0.3, end: 0.1}
front: {n_angle: 64, spacing: 0.05}
elastic_energies: [0.4]
spectra:
  - {roll_off: 0.6, hurst: 1.0}
  - {roll_off: 0.9, hurst: 0.8}
grids:
  - {n_point: 48, interaction_range: 0.70, step: 0.1, surfaces: 2}
  - {n_point: 64, interaction_range: 0.61, step: 0.1, surfaces: 1, roll_offs: [0.6]}
"""


@pytest.fixture(scope="module")
def configuration(tmp_path_factory):
    path = tmp_path_factory.mktemp("amplitudes") / "tiny.yaml"
    path.write_text(TEXT)
    return path


def run(configuration, *options):
    arguments = ["validate", str(configuration), "--output", str(configuration.parent / "results")]
    return CliRunner().invoke(main, [*arguments, *options], catch_exceptions=False)


@pytest.fixture(scope="module")
def results(configuration):
    outcome = run(configuration)
    assert outcome.exit_code == 0, outcome.output
    return configuration.parent / "results"


@pytest.fixture(scope="module")
def rows(results):
    return read_records(results / "differences.nc", SurfaceComparison, "case")


def test_every_scene_surface_and_grid_is_compared_the_first_surface_first(configuration, rows):
    cases = amplitude_cases(load_validation(configuration))
    assert [(row.n_point, row.seed, row.asked_energy) for row in rows] == [
        (case.n_point, case.seed, case.elastic_energy) for case in cases
    ]
    assert [row.asked_energy for row in rows] == [0, 0.4, 0.4, 0.4, 0.4, 0.4]
    assert len({row.seed for row in rows}) == 2
    assert rows[0].seed == rows[3].seed != rows[4].seed


def test_both_models_find_the_smooth_sphere_and_the_hysteresis_of_a_rough_one(rows):
    smooth, *rough = rows
    for found in (smooth.front_approach, smooth.front_retraction):
        assert found == pytest.approx(1, abs=2e-3)
    for found in (smooth.boundary_approach, smooth.boundary_retraction):
        assert found == pytest.approx(1, abs=0.05)
    assert abs(smooth.front_hysteresis) < 1e-3
    for row in rough:
        assert row.boundary_approach < 0.9 * smooth.boundary_approach
        assert row.hurst < 1 or row.front_hysteresis > 0.02
        assert row.hurst < 1 or row.boundary_dissipated < row.front_dissipated
    assert all(row.least_released >= -1e-12 for row in rows)


def test_tables_figures_and_sentence_are_those_of_the_rows(results, rows):
    assert (results / "validation.md").read_text() == amplitude_report(rows, 0.6)
    told = validity_of((results / "validity.csv").read_text())
    limits = limit_settings(rows)
    assert [[row.n_point for row in one.rows] for one in limits] == [[64]]
    assert [row.ratio for row in told] == pytest.approx(
        [float(one.hysteresis_ratio().value) for one in limits], rel=1e-4
    )
    assert [(row.surfaces, row.fine) for row in told] == [(2, 1)]
    assert validity_sentence(told) in (results / "validation.md").read_text()
    for name in ("validation", "contacts"):
        assert (results / f"{name}.png").stat().st_size > 5_000
    picture = read_record(results / "picture.nc", AmplitudePicture)
    assert picture.n_point == 64
    assert set(np.unique(picture.contact)) <= {0, 1, 2, 3}


def test_finished_cases_are_compared_and_no_other_is_computed(configuration, results):
    before = {path.name for path in results.glob("n*.nc")}
    lost = min(results.glob("n64-*.nc"))
    kept = lost.read_bytes()
    lost.unlink()
    outcome = run(configuration, "--finished")
    lost.write_bytes(kept)
    assert outcome.exit_code == 0, outcome.output
    assert "approach to" not in outcome.output
    assert len(read_records(results / "differences.nc", SurfaceComparison, "case")) == 5
    assert {path.name for path in results.glob("n*.nc")} == before
    assert read_record(lost, BoundaryCycle).status == ALL_LOADS


def test_finished_is_refused_where_nothing_is_finished_or_cases_are_listed(tmp_path, configuration):
    outcome = run(configuration, "--finished", "--output", str(tmp_path))
    assert outcome.exit_code == 2
    assert "holds no finished case" in outcome.output
    other = Path(__file__).parents[3] / "config" / "validation.yaml"
    assert "is for configurations with elastic_energies" in run(other, "--finished").output


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("first: 0.2", "first: 0.5", r"first 0.5 to last 0.4"),
        ("max_penetration: 0.6", "max_penetration: 0.4", r"max_penetration 0.4 must be above last"),
        ("roll_off: 0.9", "roll_off: 0.3", r"spectra\[1\]: roll_off 0.3 is shorter"),
        ("roll_offs: [0.6]", "roll_offs: [0.5]", r"grids\[1\]: roll_offs holds 0.5; there is none"),
        (
            "0.70, step: 0.1",
            "0.70, step: 0.15",
            r"grids\[0\]: step 0.15 does not lead to first 0.2",
        ),
        ("n_point: 64", "n_point: 40", r"grids\[1\]: pixel is 0.128"),
    ],
)
def test_amplitudes_that_cannot_be_run_are_refused_with_a_sentence(tmp_path, old, new, sentence):
    path = tmp_path / "wrong.yaml"
    path.write_text(TEXT.replace(old, new))
    with pytest.raises(ConfigurationError, match=sentence):
        load_validation(path)


def test_the_work_of_adhesion_of_a_force_is_that_of_the_open_edge():
    radius = np.array([0.9, 1.3, 1.8])
    for work in (0.5, 1.0, 1.5):
        penetration = jkr.equilibrium_penetration(radius, work)
        force = jkr.equilibrium_force(radius, work)
        assert apparent_adhesion(force, penetration) == pytest.approx([work] * 3)


def test_regions_tell_pockets_islands_and_overhangs_apart():
    pixel, circle = 0.05, np.full(720, 1.0)
    closed = within(circle, 64, pixel)
    assert np.count_nonzero(closed) * pixel**2 == pytest.approx(math.pi, rel=0.01)
    closed[30:34, 30:34] = False  # a pocket
    closed[31, 60:62] = True  # an island
    closed[12:22, 31] = False  # a cleft from the edge inwards
    reach = np.where(np.abs(np.arange(720) - 180) < 4, 1.5, 1.0)
    found = regions(closed, reach, circle, pixel)
    assert np.count_nonzero(found.pockets) == 16
    assert np.count_nonzero(found.islands) == 2
    assert np.count_nonzero(found.closed_outside) == 2
    assert np.count_nonzero(found.overhangs & (np.arange(64)[:, None] < 22)) >= 9
    assert np.count_nonzero(found.open_inside) == 25


def comparison(**changes):
    row = SurfaceComparison(*(0,) * len(fields(SurfaceComparison)))
    return replace(row, roll_off=1.0, hurst=1.0, asked_energy=0.1, **changes)


def test_the_ratio_of_hystereses_is_that_of_the_means_with_the_error_of_the_jackknife():
    pairs = ((0.2, 0.1), (0.4, 0.3), (0.3, 0.2))
    rows = [
        comparison(seed=seed, front_hysteresis=one, boundary_hysteresis=other)
        for seed, (one, other) in enumerate(pairs)
    ]
    found = Setting(tuple(rows)).hysteresis_ratio()
    assert float(found.value) == pytest.approx(1.5)
    left = np.array([0.7 / 0.5, 0.5 / 0.3, 0.6 / 0.4])
    expected = math.sqrt(2 / 3 * np.sum((left - left.mean()) ** 2))
    assert float(found.standard_error) == pytest.approx(expected)
    assert math.isnan(Setting(tuple(rows[:1])).hysteresis_ratio().standard_error)


def test_a_limit_has_the_longer_range_of_all_surfaces_and_its_change_on_some(rng):
    def row(seed, length, value):
        return comparison(
            seed=seed, interaction_range=length, boundary_hysteresis=value, front_hysteresis=1.0
        )

    long = rng.uniform(0.2, 0.3, 6)
    rows = [row(seed, 0.4, value) for seed, value in enumerate(long)]
    rows += [row(seed, 0.2, long[seed] + change) for seed, change in enumerate((0.07, 0.14))]
    (limit,) = limit_settings(rows)
    assert (limit.surfaces, len(limit.rows)) == (6, 2)
    # Halved, the range leaves a seventh of what it changes: 0.08 and 0.16 in all.
    assert float(limit.hysteresis("boundary").value) == pytest.approx(long.mean() + 0.12)
    left = [np.delete(long, seed).mean() + (0.16, 0.08, 0.12)[min(seed, 2)] for seed in range(6)]
    error = math.sqrt(5 / 6 * np.sum((np.array(left) - np.mean(left)) ** 2))
    assert float(limit.hysteresis("boundary").standard_error) == pytest.approx(error)
    assert float(limit.hysteresis("front").standard_error) == pytest.approx(0, abs=1e-12)
    assert float(limit.hysteresis_ratio().value) == pytest.approx(1 / (long.mean() + 0.12))


def test_a_vanishing_range_is_extrapolated_by_its_cube():
    def row(length, **changes):
        return comparison(
            interaction_range=length,
            boundary_approach=0.6 + 2 * length**3,
            boundary_hysteresis=0.4 - 3 * length**3,
            front_hysteresis=0.41,
            **changes,
        )

    (limit,) = range_limits([row(0.4), row(0.2, n_point=512), row(0.3)])
    assert limit.interaction_range == 0
    assert limit.n_point == 512
    assert limit.boundary_approach == pytest.approx(0.6)
    assert limit.boundary_hysteresis == pytest.approx(0.4)
    assert limit.zone_hysteresis == 0.41
    assert range_limits([row(0.2), row(0.3, seed=1), row(0.4, step=0.1)]) == []


def test_a_cohesive_zone_weakens_the_pinning_and_leaves_the_smooth_sphere(configuration):
    cases = amplitude_cases(load_validation(configuration))
    sharp, blunt = (front_cycle(cases[1], 64, 0.05, zone=zone) for zone in (0.0, 0.1))
    spread = [np.mean(found.states.rms_radius) for found in (sharp, blunt)]
    assert spread[1] < 0.8 * spread[0]
    smooth = front_cycle(cases[0], 64, 0.05, zone=0.1)
    np.testing.assert_allclose(smooth.states.apparent_work_of_adhesion, 1, rtol=1e-5)


def test_the_square_of_the_stress_intensity_changes_the_works_and_leaves_the_smooth_sphere(rows):
    smooth, *rough = rows
    assert smooth.squared_approach == pytest.approx(smooth.front_approach, abs=1e-12)
    for row in rough:
        change = abs(row.squared_hysteresis - row.front_hysteresis)
        assert 1e-4 < change < row.elastic_energy
        means = [
            (getattr(row, f"{name}_approach") + getattr(row, f"{name}_retraction")) / 2
            for name in ("squared", "front")
        ]
        assert means[0] == pytest.approx(means[1], abs=row.elastic_energy)


def test_the_range_ends_below_the_first_amplitude_that_is_outside_for_any_spectrum():
    def row(energy, ratio, hurst=1.0):
        return ValidityRow(1.0, hurst, energy, ratio, 0.02, 4, 4, 256, 0.2)

    rows = [row(0.03, 1.02), row(0.06, 0.85), row(0.1, 1.02), row(0.03, 1.24, 0.8)]
    assert largest_energy(rows, 0.25) == 0.1
    assert largest_energy(rows, 0.1) == 0
    assert largest_energy(rows[:3], 0.1) == 0.03
    assert largest_energy([row(0.03, 1.115)], 0.1) == 0.03  # within its error of 0.02
    assert largest_energy([row(0.03, 1.13)], 0.1) == 0
    assert (
        "to 10% nowhere from e_el/w_int = 0.03 on, and to 25% up to e_el/w_int = 0.1, the "
        "strongest that was compared; at worst it is 1.2 ± 0.0 times theirs, at e_el/w_int = 0.03."
    ) in validity_sentence(rows)
    assert "to 25%" not in validity_sentence(rows[:1])
    assert validity_of(validity_text(rows)) == tuple(rows)


@pytest.fixture(scope="module")
def kept():
    folder = Path(__file__).parents[3] / "docs" / "reference" / "validation"
    return folder / "differences-strong.nc"


def test_the_shipped_table_and_sentence_are_those_of_the_kept_comparison(kept):
    rows = read_records(kept, SurfaceComparison, "case")
    limits = [one for one in limit_settings(rows) if one.rows[0].asked_energy > 0]
    assert validity_text(shipped_validity()) == validity_text(
        [validity_row(one, 0.15) for one in limits]
    )
    counts = [(row.surfaces, row.fine) for row in shipped_validity()]
    assert counts == [(24, 5), *[(12, 5)] * 3, (48, 5), *[(24, 5)] * 3]
    for one in limits:
        found = one.hysteresis("boundary")
        assert float(found.standard_error) < 0.101 * float(found.value)
    assert largest_energy(shipped_validity(), 0.1) == 0
    assert largest_energy(shipped_validity(), 0.25) == pytest.approx(0.1, rel=0.05)
    assert "at worst it is 1.5 ± 0.1 times theirs" in validity_sentence()


def test_the_documentation_has_the_extrapolated_rows_and_the_sentence(kept):
    page = (Path(__file__).parents[3] / "docs/validation.md").read_text()
    report = amplitude_report(read_records(kept, SurfaceComparison, "case"), 0.15)
    told = [line for line in report.splitlines() if "512 | 0 |" in line or "1024 | 0 |" in line]
    assert len(told) == 9
    assert "\n".join(told[1:]) in page
    assert validity_sentence() in page


def test_the_kept_comparison_says_where_it_comes_from_and_that_no_energy_rose(kept):
    rows = read_records(kept, SurfaceComparison, "case")
    counts = {row.resolution: 0 for row in rows}
    for row in rows:
        counts[row.resolution] += row.asked_energy > 0
    assert counts == {
        (256, 0.281, 0.1): 180,
        (512, 0.199, 0.1): 40,
        (512, 0.281, 0.1): 1,
        (1024, 0.141, 0.1): 1,
        (256, 0.281, 0.02): 8,
    }
    assert all(row.least_released > 0 and row.barriers == 0 for row in rows)
    told = read_attributes(kept)
    assert told["command"] == "crackfront validate config/validation-strong.yaml --finished"
    assert "dirty" not in told["git_commit"]


def test_the_whole_loop_at_weak_roughness_agrees(kept):
    found = loop_validity(read_record(kept.with_name("picture-512.nc"), ValidationPicture))
    assert found.elastic_energy == pytest.approx(0.03, rel=0.02)
    assert 0.9 < found.ratio < 1
