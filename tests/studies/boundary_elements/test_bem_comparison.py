"""Jumps, differences, costs and tables of the validation by boundary elements."""

import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from pydantic import ValidationError

from crackfront.cli import main
from crackfront.core import jkr
from crackfront.data.files import read_attributes
from crackfront.data.records import read_record, read_records
from crackfront.data.section import ConfigurationError
from studies.boundary_elements.comparison import (
    Comparison,
    Jump,
    comparison,
    jumps,
    matched_jumps,
)
from studies.boundary_elements.cycle import N_ANGLE, BoundaryCycle
from studies.boundary_elements.front import (
    force_error,
    front_cycle,
    perimeter_at,
    shared_states,
)
from studies.boundary_elements.minimiser import row as boundary_row
from studies.boundary_elements.parameters import (
    AmplitudeParameters,
    ValidationParameters,
    amplitude_cases,
    load_validation,
    validation_cases,
)
from studies.boundary_elements.picture import ValidationPicture, validation_figure
from studies.boundary_elements.report import power_of, validation_report
from studies.boundary_elements.rotated_cost import row as rotated_row
from studies.boundary_elements.study import RotationEffect, Speed, extrapolated

CONFIGURATIONS = Path(__file__).parents[3] / "config"

TEXT = """
seed: 5
short_cutoff: 0.6
side: 5.12
max_penetration: 0.45
step: 0.15
shown_penetration: 0.3
tolerance: 1.0e-4
front: {n_angle: 64, spacing: 0.05}
statistics: {surfaces: 2, n_point: 32, elastic_energy: 0.02}
cases:
  - {n_point: 48, interaction_range: 0.70, elastic_energy: 0}
  - {n_point: 48, interaction_range: 0.70, elastic_energy: 0.02}
  - {n_point: 64, interaction_range: 0.61, elastic_energy: 0.02}
"""


@pytest.fixture(scope="module")
def configuration(tmp_path_factory):
    path = tmp_path_factory.mktemp("validation") / "tiny.yaml"
    path.write_text(TEXT)
    return path


@pytest.fixture(scope="module")
def case(configuration):
    return validation_cases(load_validation(configuration))[1]


@pytest.fixture(scope="module")
def front(case):
    return front_cycle(case, 64, 0.05)


@pytest.fixture(scope="module")
def boundary(case, front):
    """A cycle that is that of the front, as boundary elements would record it."""
    states = front.states
    count = states.penetration.size
    nothing = np.zeros((case.n_point, case.n_point))
    return BoundaryCycle(
        status="lost contact",
        n_point=case.n_point,
        pixel=case.pixel,
        interaction_range=case.interaction_range,
        elastic_energy=case.elastic_energy,
        shown_penetration=case.shown_penetration,
        penetration=states.penetration,
        direction=states.direction,
        force=states.force,
        closed_area=states.contact_area,
        radius=front.radius,
        energy=front.energy,
        released=np.zeros(count),
        barriers=np.zeros(count, dtype=np.int64),
        saddles=np.zeros(count, dtype=np.int64),
        closed=np.zeros((count, case.n_point**2 // 8), dtype=np.uint8),
        iterations=np.ones(count, dtype=np.int64),
        products=np.ones(count, dtype=np.int64),
        residual=np.zeros(count),
        seconds=np.ones(count),
        shown_pressure=np.zeros((2, case.n_point, case.n_point), dtype=np.float32),
        pressure=nothing,
        trust_radius=1.0,
    )


@pytest.fixture
def circle():
    return np.ones(360)


def test_an_arc_that_moves_far_is_a_jump_where_it_moved_furthest(circle):
    angle = 2 * np.pi * np.arange(360) / 360
    bump = 0.1 * np.exp(-((np.rad2deg(angle) - 20) ** 2) / 50)
    other = 0.6 * np.roll(bump, 90)
    radius = np.stack([circle, circle + bump + other, circle + bump + other])
    found = jumps(np.array([0.0, 0.1, 0.2]), np.array([1, 1, 1]), radius, 0.05)
    found.sort(key=lambda jump: jump.angle)
    assert [jump.penetration for jump in found] == [0.1, 0.1]
    assert np.rad2deg([jump.angle for jump in found]) == pytest.approx([20, 110])
    assert [jump.distance for jump in found] == pytest.approx([0.1, 0.06])


def test_turning_round_is_no_jump(circle):
    radius = np.stack([circle, circle + 0.1])
    assert jumps(np.array([0.1, 0.0]), np.array([1, -1]), radius, 0.05) == []


def test_a_receding_arc_is_a_jump_in_retraction_only(circle):
    radius = np.stack([circle, circle - 0.1 * (np.arange(360) < 30)])
    loads = np.array([0.1, 0.0])
    assert len(jumps(loads, np.array([-1, -1]), radius, 0.05)) == 1
    assert jumps(loads, np.array([1, 1]), radius, 0.05) == []


def test_jumps_are_matched_once_at_one_place_the_closest_first():
    ours = [Jump(0.1, 1, 0.0, 0.1), Jump(0.3, 1, 0.0, 0.1), Jump(0.3, -1, 3.0, 0.1)]
    theirs = [Jump(0.28, 1, 2 * np.pi - 0.01, 0.1), Jump(0.3, 1, 3.0, 0.1)]
    assert matched_jumps(ours, theirs, angle=0.1, penetration=0.3) == [(ours[1], theirs[0])]
    assert matched_jumps(ours, theirs, angle=0.005, penetration=0.3) == []


def test_a_front_does_not_differ_from_itself(case, boundary, front):
    found = comparison(case, boundary, front)
    assert found.force_largest == 0
    assert found.perimeter_all == pytest.approx(0, abs=1e-12)
    assert found.area_rms == pytest.approx(0, abs=1e-8)
    assert found.jumps_shared == found.jumps_front == found.jumps_boundary > 0
    assert found.jump_spread == 0


def test_differences_are_those_of_the_boundary_elements_minus_the_front(case, boundary, front):
    shifted = replace(boundary, force=boundary.force - 0.1, radius=1.01 * boundary.radius)
    found = comparison(case, shifted, front)
    assert found.force_mean == pytest.approx(-0.1)
    assert found.force_rms == pytest.approx(0.1)
    assert found.area_mean == pytest.approx(0.0201)
    assert found.pull_off_force == pytest.approx(-0.1)
    radius = front.states.mean_radius[np.isclose(front.states.penetration, 0.3)][0]
    assert found.perimeter_approach == pytest.approx(0.01 * radius / 0.6, rel=1e-6)


def test_a_crack_that_does_not_turn_gives_another_front(case, boundary):
    found = comparison(case, boundary, front_cycle(case, 64, 0.05, rotated=False))
    assert found.perimeter_all > 0.01


def test_approach_is_compared_where_the_jump_into_contact_is_forgotten(case, boundary, front):
    held = boundary.radius.copy()
    held[1, 100] = held[0, 100]  # one ray that has not moved yet
    found = comparison(case, replace(boundary, radius=held), front)
    assert found.begin == pytest.approx(0.3)


def test_the_front_of_a_smooth_sphere_is_jkr(configuration):
    smooth = validation_cases(load_validation(configuration))[0]
    found = front_cycle(smooth, 64, 0.05)
    expected = [jkr.equilibrium_radius(b) for b in found.states.penetration]
    np.testing.assert_allclose(found.states.mean_radius, expected, rtol=1e-4)
    everywhere = np.repeat(np.array(expected)[:, None], N_ANGLE, axis=1)
    np.testing.assert_allclose(found.radius, everywhere, rtol=1e-4)


def test_what_two_ranges_have_in_common_is_extrapolated_by_their_squares(boundary):
    fine = replace(boundary, interaction_range=0.3, force=boundary.force + 0.3**2)
    coarse = replace(boundary, interaction_range=0.6, force=boundary.force + 0.6**2)
    limit = extrapolated(coarse, fine)
    np.testing.assert_allclose(limit.force, boundary.force, atol=1e-12)
    np.testing.assert_allclose(limit.radius, boundary.radius)
    with pytest.raises(ValueError, match=r"are 0.3 and 0.6; the second must be the smaller"):
        extrapolated(fine, coarse)


def test_states_are_shared_by_penetration_and_direction(front):
    states = front.states
    fewer = replace(
        front,
        states=replace(
            states,
            penetration=states.penetration[1:],
            direction=states.direction[1:],
            force=states.force[1:] + 0.5,
        ),
    )
    one, other = shared_states(states, fewer.states)
    np.testing.assert_array_equal(one, np.arange(1, states.penetration.size))
    np.testing.assert_array_equal(other, one - 1)
    assert force_error(fewer, front) == pytest.approx(0.5)


def test_perimeters_are_asked_for_where_there_is_contact(front):
    states, fronts = front.states, front.radius
    here = perimeter_at(0.3, -1, states, fronts)
    np.testing.assert_array_equal(
        here, fronts[(states.direction == -1) & np.isclose(states.penetration, 0.3)][0]
    )
    with pytest.raises(ValueError, match=r"no contact at penetration -3 in retraction; raise"):
        perimeter_at(-3.0, -1, states, fronts)


def test_the_exponent_of_a_power_law_is_found():
    assert power_of([0.01, 0.03, 0.1], [2e-4, 18e-4, 0.02]) == pytest.approx(2)


@pytest.fixture(scope="module")
def results(configuration):
    folder = configuration.parent / "results"
    arguments = ["validate", str(configuration), "--output", str(folder)]
    run = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert run.exit_code == 0, run.output
    return folder


def test_a_validation_writes_its_numbers_its_tables_and_its_figure(results):
    rows = read_records(results / "differences.nc", Comparison, "case")
    assert [(row.n_point, row.rotated, row.elastic_energy > 0) for row in rows] == [
        (48, 1, False),
        (48, 1, True),
        (48, 0, True),
        (64, 1, True),
        (64, 0, True),
        (64, 1, True),
    ]
    assert rows[-1].interaction_range == 0
    assert all(0 < row.force_rms < 0.1 for row in rows if row.rotated)
    for turning, fixed in ((rows[1], rows[2]), (rows[3], rows[4])):
        assert 3 * turning.perimeter_all < fixed.perimeter_all < 0.5
    speeds = read_records(results / "speed.nc", Speed, "case")
    assert len(speeds) == 1
    assert speeds[0].front_error <= speeds[0].boundary_error
    effects = read_records(results / "rotation.nc", RotationEffect, "surface")
    assert len(effects) == 2
    for effect in effects:
        assert 0.5 < effect.approach_fixed < 1.5
        assert effect.retraction != effect.retraction_fixed
    jumps_of = [
        read_records(results / f"jumps-{of}.nc", Jump, "jump") for of in ("boundary", "front")
    ]
    assert [len(found) for found in jumps_of] == [rows[3].jumps_shared] * 2
    for theirs, ours in zip(*jumps_of, strict=True):
        assert abs(theirs.penetration - ours.penetration) <= 0.1
        assert theirs.direction == ours.direction
    text = (results / "validation.md").read_text()
    assert text.startswith(validation_report(rows, speeds, effects))
    assert text.count("| 64 |") == 5
    assert (results / "validation.png").stat().st_size > 10_000


def test_a_validation_that_is_repeated_computes_no_cycle_again(configuration, results):
    arguments = ["validate", str(configuration), "--output", str(results)]
    run = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert run.exit_code == 0
    assert "approach to" not in run.output


@pytest.mark.slow
def test_a_damaged_cycle_is_told_set_aside_and_computed_anew_and_no_other(configuration, results):
    path = min(results.glob("n48-*.nc"))
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    expected = read_record(results / "picture.nc", ValidationPicture)
    arguments = ["validate", str(configuration), "--output", str(results)]
    run = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert run.exit_code == 0
    assert f"{path} is damaged" in run.output
    assert f"computed anew, and set aside as {path.name}.damaged" in run.output
    assert len({line.split(":")[0] for line in run.output.splitlines() if "approach" in line}) == 1
    found = read_record(results / "picture.nc", ValidationPicture)
    np.testing.assert_equal(asdict(found), asdict(expected))


def test_the_figure_shows_the_forces_their_difference_and_the_contact(results):
    drawn = validation_figure(read_record(results / "picture.nc", ValidationPicture))
    force, difference, contact = drawn.axes[:3]
    assert len(force.get_legend().get_texts()) == 4
    assert difference.get_shared_x_axes().joined(force, difference)
    assert len(contact.images) == 2
    assert len(contact.lines) == 4


@pytest.mark.parametrize("path", sorted(CONFIGURATIONS.glob("validation*.yaml")))
def test_every_configuration_of_the_validation_is_valid(path):
    parameters = load_validation(path)
    strong = isinstance(parameters, AmplitudeParameters)
    assert amplitude_cases(parameters) if strong else validation_cases(parameters)
    assert strong == (path.stem == "validation-strong")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("n_point: 64", "n_point: 40", r"cases\[2\]: pixel is 0.128; an attraction of range 0.61"),
        ("side: 5.12", "side: 2.56", r"cases\[0\]: domain of side 2.56 is too small"),
        ("short_cutoff: 0.6", "short_cutoff: 0.1", r"cases\[0\]: short_cutoff 0.1 is below two"),
        ("shown_penetration: 0.3", "shown_penetration: 0.4", r"0.4 is no state of cases\[0\]"),
        ("shown_penetration: 0.3", "shown_penetration: 0.45", r"and below max_penetration 0.45"),
        ("n_point: 64, interaction_range: 0.61", "n_point: 48, interaction_range: 0.70", "twice"),
        ("tolerance: 1.0e-4", "tolerance: 0", r"tolerance is 0.*greater than 0"),
        ("seed: 5", "sead: 5", r"unknown key sead; did you mean seed"),
    ],
)
def test_validations_that_cannot_be_run_are_refused_with_a_sentence(tmp_path, old, new, sentence):
    path = tmp_path / "wrong.yaml"
    path.write_text(TEXT.replace(old, new))
    with pytest.raises(ConfigurationError, match=sentence):
        load_validation(path)
    run = CliRunner().invoke(main, ["validate", str(path), "--output", str(tmp_path / "out")])
    assert run.exit_code == 2
    assert "Traceback" not in run.output


def test_the_cost_of_a_validation_is_told_before_it_is_computed(tmp_path, monkeypatch):
    def computed(*_, **__):
        raise ValueError("computed")

    monkeypatch.setattr("studies.boundary_elements.report.write_validation", computed)
    path = Path(__file__).parents[3] / "config/validation-512.yaml"
    run = CliRunner().invoke(main, ["validate", str(path), "--output", str(tmp_path)])
    assert run.stderr == "about 46.8 min of processor time\nError: computed\n"
    [_, rough] = validation_cases(load_validation(path))
    (tmp_path / f"{rough.stem}.nc").touch()
    run = CliRunner().invoke(main, ["validate", str(path), "--output", str(tmp_path)])
    assert run.stderr == "about 7.81 min of processor time\nError: computed\n"


@pytest.mark.parametrize("name", ["ContactMechanics", "finufft"])
def test_a_validation_without_its_extra_is_refused_before_it_computes(
    monkeypatch, tmp_path, configuration, name
):
    monkeypatch.setitem(sys.modules, name, None)
    run = CliRunner().invoke(
        main, ["validate", str(configuration), "--output", str(tmp_path / "x")]
    )
    assert run.exit_code == 2
    assert f"need {name}, which is not installed" in run.output
    assert "pip install '.[bem]'" in run.output
    assert not (tmp_path / "x").exists()


def test_parameters_are_frozen(configuration):
    parameters = load_validation(configuration)
    assert isinstance(parameters, ValidationParameters)
    with pytest.raises(ValidationError, match=r"frozen"):
        parameters.seed = 2


def test_a_load_step_of_numpis_optimiser_ends_in_the_same_state(case):
    cells = boundary_row(case).strip("| ").split(" | ")
    assert float(cells[-1]) < 1e-2  # apart, relative to the range
    assert int(cells[3]) < int(cells[5])  # products


def test_a_point_of_a_ray_costs_less_than_the_sum_over_its_modes():
    cells = rotated_row(256, 0.05).strip("| ").split(" | ")
    assert int(cells[2]) == round(np.pi * (5.12 / 0.05) ** 2 / 2)
    assert float(cells[4]) < float(cells[5])


REFERENCES = Path(__file__).parents[3] / "docs" / "reference" / "validation"


def test_the_kept_validation_says_where_it_comes_from_and_what_it_found():
    rows = read_records(REFERENCES / "differences-512.nc", Comparison, "case")
    found, held = (row for row in rows if row.elastic_energy > 0)
    assert (found.n_point, found.interaction_range) == (512, 0.24)
    assert found.force_rms < 0.02 * 1.5
    assert 4 * found.perimeter_approach < held.perimeter_approach
    assert found.jumps_shared >= 0.95 * found.jumps_front
    assert held.jumps_shared < 0.7 * held.jumps_front
    for name in ("differences-512.nc", "picture-512.nc"):
        told = read_attributes(REFERENCES / name)
        assert told["command"] == "crackfront validate config/validation-512.yaml"
        assert "dirty" not in told["git_commit"]


def test_the_kept_picture_is_that_of_the_kept_differences():
    picture = read_record(REFERENCES / "picture-512.nc", ValidationPicture)
    rows = read_records(REFERENCES / "differences-512.nc", Comparison, "case")
    found = next(row for row in rows if row.elastic_energy > 0 and row.rotated)
    lowest = picture.boundary_force.min() - picture.front_force.min()
    assert lowest == pytest.approx(found.pull_off_force)
    apart = np.mean(np.abs(picture.boundary_radius - picture.front_radius), axis=1)
    expected = np.array([found.perimeter_approach, found.perimeter_retraction])
    np.testing.assert_allclose(apart / picture.short_cutoff, expected, rtol=1e-9)
