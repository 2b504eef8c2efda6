"""Configurations of a validation, and the cases that they stand for."""

from pathlib import Path

import pytest

from crackfront.sweep.section import ConfigurationError
from studies.boundary_elements.cases import Loads
from studies.boundary_elements.parameters import load_validation, validation_cases

CONFIGURATIONS = Path(__file__).parents[3] / "config"


@pytest.mark.parametrize("path", sorted(CONFIGURATIONS.glob("validation*.yaml")))
def test_every_configuration_of_the_validation_is_valid(path):
    assert validation_cases(load_validation(path))


def test_cases_are_smooth_spheres_and_then_surface_after_surface(branches):
    configuration = load_validation(branches)
    cases = validation_cases(configuration)
    listed = [(case.n_point, case.elastic_energy, case.roll_off) for case in cases]
    first, second = (48, 0.4, 0.6), (48, 0.4, 0.9)
    assert listed == [(48, 0, 0.6), (64, 0.4, 0.6), first, second, first, second]
    seeds = [case.seed for case in cases]
    assert len({*seeds[:4]}) == len({*seeds[4:]}) == 1
    assert seeds[3] != seeds[4]
    second = configuration.cases[2].model_copy(update={"surfaces": 1, "skipped": 1})
    assert validation_cases(configuration.model_copy(update={"cases": (second,)})) == cases[5:]


def test_a_loop_begins_before_the_surfaces_attract_each_other():
    loads = Loads(max_penetration=0.2, step=0.1, shown_penetration=0.1).loads(0.25)
    visited = [next(loads) for _ in range(8)]
    assert [load.value for load in visited] == pytest.approx(
        [-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.1, 0]
    )
    assert [load.direction for load in visited] == [1, 1, 1, 1, 1, 1, -1, -1]


@pytest.mark.parametrize(
    ("kind", "old", "new", "sentence"),
    [
        ("branches", "n_point: 64", "n_point: 40", r"cases\[0\]: pixel is 0.128; .* range 0.61"),
        ("loops", "side: 5.12", "side: 2.56", r"cases\[0\]: domain of side 2.56 is too small"),
        ("loops", "cutoff: 0.6", "cutoff: 0.1", r"cases\[0\]: short_cutoff 0.1 is not above two"),
        ("loops", "tion: 0.3}", "tion: 0.4}", r"cases\[0\]: shown_penetration 0.4 is"),
        ("loops", "tolerance: 1.0e-4", "tolerance: 0", r"tolerance is 0.*greater than 0"),
        ("loops", "range: 0.70", "range: 10", r"interaction_range is 10.*equal to 1"),
        (
            "loops",
            "spacing: 0.05",
            "spacing: 5",
            r"front: spacing 5 misses waves .*take 0.3 or less",
        ),
        ("loops", "seed: 5", "sead: 5", r"unknown key sead; did you mean seed"),
        ("branches", "first: 0.2", "first: 0.5", r"steady parts are first=0.5 last=0.4"),
        ("branches", "roll_off: 0.9", "roll_off: 0.3", r"cases\[2\]: roll_off 0.3 is shorter"),
    ],
)
def test_a_validation_that_cannot_be_run_is_refused(tmp_path, request, kind, old, new, sentence):
    path = tmp_path / "wrong.yaml"
    path.write_text(request.getfixturevalue(kind).read_text().replace(old, new))
    with pytest.raises(ConfigurationError, match=sentence):
        load_validation(path)
