"""Avalanches: their law, their lengths, and what makes the checks fail."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from pydantic import ValidationError

from crackfront.studies.paper.beyond_avalanches import AvalancheRecord, size_law
from crackfront.studies.paper.figure import figure, load_figure
from crackfront.studies.paper.rough import STRONG

CONFIGURATION = Path(__file__).parents[1] / "config" / "figures" / "beyond-avalanches.yaml"
SCENE = figure("beyond-avalanches")


def parameters(**changes):
    return load_figure(CONFIGURATION, "quick").model_copy(update=changes)


@pytest.fixture(scope="module")
def record():
    small = parameters(
        short_cutoff=0.07,
        n_surface=1,
        first_penetration=-0.2,
        last_penetration=-0.7,
        precision=3e-4,
        smallest_area=0.05,
    )
    return SCENE.compute(small, lambda line: None)


def synthetic(rng, exponent=1.28, count=1500):
    """Avalanches whose areas follow the law, and whose energies and extents go with them."""
    areas = rng.uniform(size=60 * count) ** (-1 / (exponent - 1))
    areas = 1e-3 * areas[rng.uniform(size=areas.size) < np.exp(-areas / 200)][: 2 * count]
    disorder = np.repeat([0, 1], areas.size // 2)
    return AvalancheRecord(
        short_cutoff=0.02,
        correlation_length=0.027,
        precision=1e-4,
        seed=1,
        elastic_energy=np.array([0.05, 0.0125]),
        rms=np.array([0.45, 0.22]),
        larkin_length=np.array([0.01, 0.04]),
        smallest_area=np.array([1e-3, 1e-3]),
        circle_length=np.array([4.0, 4.0]),
        smooth_area=np.array([0.05, 0.05]),
        disorder_index=disorder,
        surface=np.zeros(areas.size, dtype=int),
        penetration=-np.linspace(0.5, 0.8, areas.size),
        area=areas,
        extent=(1 + 0.5 * disorder) * areas**0.72,
        n_patch=np.ones(areas.size, dtype=int),
        energy=areas,
    )


def failed(record):
    return [check.claim for check in SCENE.checks(record) if not check.passed]


def test_avalanches_of_the_theory_pass(rng):
    assert failed(synthetic(rng)) == []


def test_avalanches_of_another_exponent_fail(rng):
    assert sum("exponent" in claim for claim in failed(synthetic(rng, exponent=1.6))) == 2


def test_wrong_energies_and_extents_fail(rng):
    good = synthetic(rng)
    assert sum("energy" in claim for claim in failed(replace(good, energy=-good.energy))) == 2
    assert sum("circle" in claim for claim in failed(replace(good, extent=30 * good.extent))) == 2
    assert any("grows" in claim for claim in failed(replace(good, extent=good.area**0.72)))


def test_the_interval_does_not_depend_on_when_it_is_asked_for(rng):
    data = synthetic(rng, count=200)
    assert size_law(data, STRONG) == size_law(data, STRONG)


def test_avalanches_and_smooth_steps_sweep_the_whole_area(record):
    for index in (0, 1):
        areas = record.area[record.disorder_index == index]
        assert areas.size > 20
        assert 0 < record.smooth_area[index] < 0.6
    assert np.all(record.energy > 0)
    assert np.all(record.extent > 0)
    assert np.all(np.diff(record.penetration[record.disorder_index == 0]) < 0)


def test_few_statistics_are_told_as_such(record):
    (claim, *_) = SCENE.checks(record)
    assert "decades" in claim.remark


def test_penetrations_in_the_wrong_order_are_refused():
    with pytest.raises(ValidationError, match="penetrations must fall from max_penetration"):
        SCENE.parameters.model_validate(parameters().model_dump() | {"last_penetration": 0.0})


def test_its_drawing_has_three_labelled_panels(rng):
    drawn = figure("beyond-avalanches").draw(synthetic(rng))
    assert isinstance(drawn, Figure)
    assert all(axes.get_xlabel() and axes.get_ylabel() for axes in drawn.axes)
