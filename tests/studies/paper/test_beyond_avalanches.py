"""Avalanches: their law, their lengths, and what makes the checks fail."""

from dataclasses import replace

import numpy as np
import pytest

from studies.paper.avalanches import AvalancheRecord
from studies.paper.events import event_record
from tests.studies.paper.made import computed, failed, parameters

pytestmark = pytest.mark.usefixtures("_few_draws")


@pytest.fixture(scope="module")
def record():
    small = parameters(
        "beyond-avalanches",
        short_cutoff=0.07,
        n_surface=1,
        first_penetration=-0.2,
        last_penetration=-0.7,
        precision=3e-4,
        smallest_area=0.05,
        springs=(5.0, 10.0),
        n_tile=1,
    )
    # More than a site a Larkin length, so that short springs have events.
    fine = {"elastic_energy": 0.9, "pixels_per_cutoff": 3.0, "smallest_area": 5.0, "length": 5.0}
    small = small.model_copy(update={"line": small.line.model_copy(update=fine)})
    return computed("beyond-avalanches", small)


def scaling_events(exponent, roughness=0.388, count=4000):
    """Areas of whole events on three springs, quantiles of their law at equal distances."""
    samples = []
    for spring in SPRINGS:
        grid = np.geomspace(4.0, 300 * spring ** (1 + roughness), 20001)
        scaled = grid / spring ** (1 + roughness)
        mass = np.cumsum(grid ** (1 - exponent) * np.exp(0.5 * np.sqrt(scaled) - scaled**1.1 / 3))
        samples.append(np.interp((np.arange(count) + 0.5) / count, mass / mass[-1], grid))
    return np.concatenate(samples)


SPRINGS = np.array([100.0, 300.0, 1000.0])


def synthetic(rng, exponent=1.28, count=1500, *, event_exponent=1.28, roughness=0.388):
    """Avalanches whose areas follow the law, and whose energies and extents go with them."""
    events = scaling_events(event_exponent, roughness)
    springs = np.repeat(np.arange(SPRINGS.size), events.size // SPRINGS.size)
    areas = rng.uniform(size=60 * count) ** (-1 / (exponent - 1))
    areas = 1e-3 * areas[rng.uniform(size=areas.size) < np.exp(-areas / 200)][: 2 * count]
    disorder = np.repeat([0, 1], areas.size // 2)
    return AvalancheRecord(
        front_length=10.0,
        sites_per_larkin_length=1.2,
        smallest_event=40.0,
        spring=SPRINGS,
        swept_area=np.ones(SPRINGS.size),
        smooth_event_area=np.full(SPRINGS.size, 0.01),
        event_spring=springs,
        event_area=events,
        event_extent=events ** (1 / (1 + roughness)),
        patch_spring=springs,
        patch_area=scaling_events(2 * event_exponent - 1, roughness),
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


def test_avalanches_of_the_theory_pass(rng):
    assert failed(synthetic(rng)) == []


@pytest.mark.slow
def test_whole_events_sweep_the_way_of_the_load(record):
    assert record.swept_area == pytest.approx(1.0, abs=1e-3)
    assert np.all(record.smooth_event_area < 0.2)
    for index in (0, 1):
        whole = record.event_area[record.event_spring == index]
        parts = record.patch_area[record.patch_spring == index]
        assert whole.size > 50
        # What follows a patch elastically moves no further than a site may in a smooth step.
        assert 0.9 * whole.sum() < parts.sum() <= whole.sum() * (1 + 1e-12)
    # Tiles have 60 short cutoffs or more, of 3 sites.
    assert 20 < record.event_extent.max() * record.sites_per_larkin_length < 200


@pytest.mark.slow
def test_a_finer_precision_finds_the_same_whole_events():
    line = parameters("beyond-avalanches").line.model_copy(update={"length": 5.0})
    coarse, fine = (
        event_record(
            line.model_copy(update={"precision": precision}), (6.0,), 1, 7, lambda line: None
        )
        for precision in (0.08, 0.02)
    )
    assert coarse.event_area.size == pytest.approx(fine.event_area.size, rel=0.05)
    largest = [np.sort(events.event_area)[-20:] for events in (coarse, fine)]
    assert np.median(np.abs(largest[0] / largest[1] - 1)) < 0.05


def test_wrong_energies_and_extents_fail(rng):
    good = synthetic(rng)
    wrong = failed(replace(good, energy=-good.energy, extent=30 * good.extent))
    assert sum("energy" in claim for claim in wrong) == 2
    assert sum("circle" in claim for claim in wrong) == 2
    assert any("grows" in claim for claim in failed(replace(good, extent=good.area**0.72)))


@pytest.mark.slow
def test_avalanches_and_smooth_steps_sweep_the_whole_area(record):
    for index in (0, 1):
        areas = record.area[record.disorder_index == index]
        assert areas.size > 20
        assert 0 < record.smooth_area[index] < 0.6
    assert np.all(record.energy > 0)
    assert np.all(record.extent > 0)
    assert np.all(np.diff(record.penetration[record.disorder_index == 0]) < 0)
