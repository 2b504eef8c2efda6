"""Results of a version do not move: states by PHYSICS_VERSION, rows and fits by ROWS_VERSION."""

import functools

import numpy as np
import pytest

from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.solver.relax import SOLVERS, Newton
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from tests.golden.closed_forms import CLOSED_FORMS
from tests.golden.files import FORCES, PHYSICS, ROWS
from tests.golden.fronts import FRONTS, TIGHT, forces_and_energies
from tests.golden.golden import (
    COMMAND,
    TOLERANCE,
    Golden,
    NotRaisedError,
    advice,
    movements,
    read_golden,
    renewed,
)
from tests.golden.rows import completed, rows_and_fits

AT_DEFAULT = 5e-7
"""Allowed difference between states at the default tolerance of forces, 1e-8, and the tight one.

The largest that was measured is 7e-8.
"""

golden = functools.cache(read_golden)

each_scene = pytest.mark.parametrize("scene", FRONTS)


def check_movement(path, version, computed, tolerance=TOLERANCE):
    """Fail if scenes moved, with how much and what to do."""
    moved = movements(golden(path).scenes, computed, tolerance)
    if moved:
        pytest.fail(advice(moved, version), pytrace=False)


@pytest.mark.parametrize("scene", CLOSED_FORMS)
def test_closed_forms_and_surfaces_have_not_moved(scene):
    check_movement(PHYSICS, "PHYSICS_VERSION", {scene: CLOSED_FORMS[scene]()})


def test_forces_and_energies_of_given_fronts_have_not_moved():
    check_movement(PHYSICS, "PHYSICS_VERSION", {FORCES: forces_and_energies()})


@each_scene
@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_finds_the_states_of_the_version(scene, solver):
    values = FRONTS[scene](SOLVERS[solver](TIGHT))
    check_movement(PHYSICS, "PHYSICS_VERSION", {scene: values})


@each_scene
def test_the_default_tolerance_finds_the_same_states_to_its_precision(scene):
    values = FRONTS[scene](Newton(DEFAULT_TOLERANCE))
    check_movement(PHYSICS, "PHYSICS_VERSION", {scene: values}, AT_DEFAULT)


def test_a_simulation_without_stored_states_is_simulated_and_others_are_not():
    inputs = golden(ROWS).given
    scenes = completed({name: states for name, states in inputs.items() if name != "line 0"})
    assert [name for name in inputs if scenes[name] is not inputs[name]] == ["line 0"]
    assert set(scenes["line 0"]) == set(inputs["line 0"])
    assert scenes["line 0"]["status"] == inputs["line 0"]["status"]


def test_rows_and_fits_of_stored_states_have_not_moved():
    check_movement(ROWS, "ROWS_VERSION", rows_and_fits(golden(ROWS).given))


@pytest.mark.parametrize(
    ("path", "version"), [(PHYSICS, PHYSICS_VERSION), (ROWS, ROWS_VERSION)], ids=["states", "rows"]
)
def test_a_golden_file_belongs_to_the_version_of_the_sources(path, version):
    assert golden(path).version == version, f"run `{COMMAND}`"


def test_a_golden_file_has_no_scene_that_is_no_longer_computed():
    assert set(golden(PHYSICS).scenes) == {*CLOSED_FORMS, FORCES, *FRONTS}


SOME = Golden(3, {"scene": {"force": np.array([2.0, -1.0])}})


@pytest.mark.parametrize(
    "values",
    [
        {"force": np.array([2.0, np.nan])},
        {"force": np.array([2.0])},
        {},
        SOME.scenes["scene"] | {"other": np.array(1.0)},
    ],
    ids=["missing value", "fewer values", "no quantity", "a new quantity"],
)
def test_other_entries_of_a_scene_are_a_movement(values):
    assert len(movements(SOME.scenes, {"scene": values})) == 1


def test_moved_numbers_are_not_renewed_before_the_version_is_raised():
    moved = {"scene": {"force": np.array([2.1, -1.0])}}
    with pytest.raises(NotRaisedError, match="VERSION is still 3"):
        renewed(SOME, 3, moved, "VERSION")
    assert renewed(SOME, 4, moved, "VERSION") == Golden(4, moved)
