"""The comparisons that are kept, the page that quotes them, and the table that is shipped."""

import math
from itertools import combinations
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from crackfront.analysis.estimate import student_estimate
from crackfront.analysis.validity import (
    excess_coefficient,
    front_excess,
    shipped_validity,
    validity_text,
)
from crackfront.simulate.storage import read_attributes
from studies.boundary_elements.averages import (
    limit_settings,
    range_limits,
    rough_settings,
    rows_by_zone,
    settings,
)
from studies.boundary_elements.differences import Differences
from studies.boundary_elements.hysteresis import Hysteresis
from studies.boundary_elements.page import kept_validity, page_parts
from studies.boundary_elements.parameters import load_validation, validation_cases
from studies.boundary_elements.picture import ValidationPicture, hysteresis_figure
from studies.numbers import stored
from studies.records import read_record, read_records

ROOT = Path(__file__).parents[3]
REFERENCES = ROOT / "docs/reference/validation"
BOUNDARY = attrgetter("boundary_difference")
KNOWN = 0.177, 0.05, 768


@pytest.fixture(scope="module")
def surfaces():
    """Rows of the kept surfaces, by the name of their configuration."""
    found = {}
    for name in ("strong", "fine"):
        path = REFERENCES / f"hysteresis-{name}.nc"
        told = read_attributes(path)
        assert f"config/validation-{name}.yaml" in told["command"]
        assert "dirty" not in told["git_commit"]
        found[name] = read_records(path, Hysteresis, "case")
    return found


@pytest.fixture(scope="module")
def kept(surfaces):
    return surfaces["strong"]


def test_the_shipped_table_is_that_of_the_kept_surfaces(surfaces):
    told = kept_validity(surfaces)
    assert validity_text(shipped_validity()) == validity_text(told)
    counts = [(row.surfaces, row.fine) for row in told]
    assert counts[:8] == [(24, 5), *[(12, 5)] * 3, (48, 5), *[(24, 5)] * 3]
    sizes = {(row.roll_off, round(row.elastic_energy, 2)): row.size for row in told[:8]}
    for row in told[8:]:
        assert row.surfaces >= 3
        coarser = sizes[row.roll_off, round(row.elastic_energy, 2)]
        assert row.size == pytest.approx(3 * coarser, rel=0.02)
    for one in rough_settings(limit_settings(surfaces["strong"])):
        found = one.mean(BOUNDARY)
        assert float(found.standard_error) < 0.3 * float(found.value)
    coefficient, error = excess_coefficient(told)
    assert coefficient > 4 * error
    apart = [(math.log(row.ratio) - coefficient * row.elastic_energy) / row.error for row in told]
    assert np.max(np.abs(apart)) < 2


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
        apart = math.log(pair.ratio * rest.ratio / seen.ratio / law.value)
        inside.append(abs(apart) < math.hypot(math.log(law.high / law.value), 1.96 * rest.error))
    assert len(inside) == 10
    assert np.mean(inside) >= 0.9


def test_two_surfaces_lie_inside_the_interval_of_the_law_and_of_the_others(kept):
    """Two of the five surfaces with both ranges are compared with the others of every scene."""
    fine = [row for row in range_limits(kept) if row.asked_energy]
    seeds = sorted({row.seed for row in fine})
    inside = []
    for left in (seeds[:2], seeds[1:3], seeds[3:]):
        others = rows_by_zone([row for row in kept if row.seed not in left], 0.15)
        for told in (row for (*_, zone), row in others.items() if not zone):
            ratio = front_excess(told.elastic_energy, told.size).ratio
            scene = [row for row in fine if row.roll_off == pytest.approx(0.15 * told.roll_off)]
            scene = [r for r in scene if 0.7 < r.elastic_energy / told.elastic_energy < 1.3]
            rest = {
                row.seed: row.boundary_difference - row.front_difference / ratio.value
                for row in scene
            }
            known = [value for seed, value in rest.items() if seed not in left]
            front = np.mean([row.front_difference for row in scene if row.seed in left])
            by_law = front * (1 / ratio.low - 1 / ratio.high) / 2
            by_surface = student_estimate(0.0, np.std(known, ddof=1) / math.sqrt(2), 2).high
            apart = np.mean([value for seed, value in rest.items() if seed in left]) - 0.0018
            inside.append(abs(apart) < math.hypot(by_law, float(by_surface)))
    assert np.mean(inside) >= 0.9


def test_a_ratio_of_one_surface_is_drawn_without_a_bar(kept):
    _, ratios = hysteresis_figure(kept, 0.15).axes
    names = [text.get_text() for text in ratios.get_legend().get_texts()]
    assert names[0].startswith("flat, ")
    assert "H = 0.8" in names[1]
    near, _, others, _ = ratios.containers
    shown = rough_settings(settings(kept))
    assert len(near[0].get_xdata()) + len(others[0].get_xdata()) == len(shown)
    bars = [bar for one in (near, others) for bar in one[2][0].get_segments() if len(bar)]
    assert len(bars) == sum(one.surfaces > 1 for one in shown) < len(shown)
    assert min(np.ptp(bar[:, 1]) for bar in bars) > 0


def test_the_pages_show_the_kept_comparisons_with_their_commits(monkeypatch):
    monkeypatch.chdir(ROOT)
    known = stored("boundary-elements")
    shown, numbers = {}, {}
    for tables, quoted, data in page_parts():
        shown |= tables
        numbers |= {name: (number.value, number.error) for name, number in quoted.items()}
        entries = [known.tables[name] for name in tables] + [known.numbers[name] for name in quoted]
        assert {entry.commit for entry in entries} == {data["git_commit"]}
    assert shown == {name: table.text for name, table in known.tables.items()}
    assert numbers == {name: (number.value, number.error) for name, number in known.numbers.items()}
    assert shown["ratios"].count("\n") == 15
    assert shown["averages"].count("| 0 | 0.1 |") == 9


def test_the_kept_comparison_has_the_cases_of_its_configuration_and_no_energy_rose(kept):
    cases = validation_cases(load_validation(ROOT / "config/validation-strong.yaml"))
    asked = {
        (case.seed, case.n_point, case.interaction_range, case.loads.step, case.roll_off)
        for case in cases
        if case.elastic_energy
    }
    known = {
        (row.seed, row.n_point, row.interaction_range, row.step, row.roll_off)
        for row in kept
        if row.asked_energy
    }
    assert known == asked
    assert all(row.least_released > 0 and row.barriers == 0 for row in kept)


def test_the_kept_loops_differ_little_and_more_with_a_crack_that_does_not_turn():
    rows = read_records(REFERENCES / "differences-512.nc", Differences, "case")
    found, held = (row for row in rows if row.elastic_energy > 0)
    assert (found.n_point, found.interaction_range) == (512, 0.24)
    assert found.force_rms < 0.02 * 1.5
    assert 4 * found.perimeter_approach < held.perimeter_approach
    assert found.jumps_shared >= 0.95 * found.jumps_front
    assert held.jumps_shared < 0.7 * held.jumps_front
    picture = read_record(REFERENCES / "picture-512.nc", ValidationPicture)
    lowest = picture.boundary_force.min() - picture.front_force.min()
    assert lowest == pytest.approx(found.pull_off_force)
    apart = np.mean(np.abs(picture.boundary_radius - picture.front_radius), axis=1)
    expected = np.array([found.perimeter_approach, found.perimeter_retraction])
    np.testing.assert_allclose(apart / picture.short_cutoff, expected, rtol=1e-9)
