"""The comparisons that are kept, the page that quotes them, and the table that is shipped."""

import math
from itertools import combinations
from operator import attrgetter

import numpy as np
import pytest

from crackfront.analysis.csv_records import csv_text
from crackfront.analysis.validity import (
    excess_coefficient,
    front_excess,
    shipped_validity,
)
from crackfront.simulate.storage import read_attributes
from studies.boundary_elements.averages import (
    limit_settings,
    rough_settings,
    rows_by_zone,
)
from studies.boundary_elements.hysteresis import Hysteresis
from studies.boundary_elements.page import kept_validity, page_parts
from studies.boundary_elements.parameters import load_validation, validation_cases
from studies.numbers import stored
from studies.records import read_records
from tests.places import ROOT

REFERENCES = ROOT / "docs/reference/validation"
BOUNDARY = attrgetter("boundary_difference")
KNOWN = 0.177, 0.05, 768


@pytest.fixture(scope="module")
def surfaces():
    """Rows of the kept surfaces, by the name of their configuration."""
    surfaces_by_case = {}
    for name in ("strong", "fine"):
        path = REFERENCES / f"hysteresis-{name}.nc"
        told = read_attributes(path)
        assert f"config/validation-{name}.yaml" in told["command"]
        assert "dirty" not in told["git_commit"]
        surfaces_by_case[name] = read_records(path, Hysteresis, "case")
    return surfaces_by_case


@pytest.fixture(scope="module")
def kept(surfaces):
    return surfaces["strong"]


def test_the_shipped_table_is_that_of_the_kept_surfaces(surfaces):
    told = kept_validity(surfaces)
    assert csv_text(shipped_validity()) == csv_text(told)
    counts = [(row.surfaces, row.fine) for row in told]
    assert counts[:8] == [(24, 5), *[(12, 5)] * 3, (48, 5), *[(24, 5)] * 3]
    sizes = {(row.roll_off, round(row.elastic_energy, 2)): row.size for row in told[:8]}
    for row in told[8:]:
        assert row.surfaces >= 3
        coarser = sizes[row.roll_off, round(row.elastic_energy, 2)]
        assert row.size == pytest.approx(3 * coarser, rel=0.02)
    for rough_setting in rough_settings(limit_settings(surfaces["strong"])):
        mean = rough_setting.mean(BOUNDARY)
        assert float(mean.standard_error) < 0.3 * float(mean.value)
    coefficient, error = excess_coefficient(told)
    assert coefficient > 4 * error
    deviations = [
        (math.log(row.ratio) - coefficient * row.elastic_energy) / row.error for row in told
    ]
    assert np.max(np.abs(deviations)) < 2


def test_finer_surfaces_that_the_law_has_not_seen_lie_inside_its_interval(surfaces):
    """Two surfaces of the scene with most are left out, and predicted by all the others."""
    strong, fine = surfaces["strong"], surfaces["fine"]
    scene = [row for row in fine if (row.asked_energy, row.roll_off, row.n_point) == KNOWN]
    inside = []
    for left in combinations(scene, 2):
        told = kept_validity({"strong": strong, "fine": [r for r in fine if r not in left]})
        (rest,) = (row for row in told if row.size > 3)
        smooth = [row for row in fine if not row.asked_energy]
        (pair,) = rows_by_zone([*smooth, *left], 0.05).values()
        law = front_excess(rest.elastic_energy, rest.size, told).ratio
        (seen,) = rows_by_zone([*smooth, *(r for r in scene if r not in left)], 0.05).values()
        deviation = math.log(pair.ratio * rest.ratio / seen.ratio / law.value)
        inside.append(
            abs(deviation) < math.hypot(math.log(law.high / law.value), 1.96 * rest.error)
        )
    assert len(inside) == 10
    assert np.mean(inside) >= 0.9


def test_the_pages_show_the_kept_comparisons_with_their_commits(monkeypatch):
    monkeypatch.chdir(ROOT)
    study = stored("boundary-elements")
    shown, numbers = {}, {}
    for tables, quoted, data in page_parts():
        shown |= tables
        numbers |= {name: (number.value, number.error) for name, number in quoted.items()}
        entries = [study.tables[name] for name in tables] + [study.numbers[name] for name in quoted]
        assert {entry.commit for entry in entries} == {data["git_commit"]}
    assert shown == {name: entry.table for name, entry in study.tables.items()}
    assert numbers == {name: (number.value, number.error) for name, number in study.numbers.items()}
    assert len(shown["ratios"].rows) == 12
    assert [(row["range"], row["step"]) for row in shown["averages"].records()] == 9 * [
        ("0", "0.1")
    ]


def test_the_kept_comparison_has_the_cases_of_its_configuration_and_no_energy_rose(kept):
    cases = validation_cases(load_validation(ROOT / "config/validation-strong.yaml"))
    asked = {
        (case.seed, case.n_point, case.interaction_range, case.loads.step, case.roll_off)
        for case in cases
        if case.elastic_energy
    }
    kept_cases = {
        (row.seed, row.n_point, row.interaction_range, row.step, row.roll_off)
        for row in kept
        if row.asked_energy
    }
    assert kept_cases == asked
    assert all(row.least_released > 0 and row.barriers == 0 for row in kept)
