"""The simulations behind a prediction."""

from dataclasses import replace

import pytest

from crackfront.measured.prediction.prediction import predicted
from crackfront.measured.prediction.simulated_prediction import prediction_plan, simulated
from crackfront.simulate.line.line_loads import LineSchedule
from crackfront.simulate.sphere.steady_branches import SteadySchedule
from tests.measured.made import OVERVIEW, SCENE, shipped_surface


@pytest.fixture
def small_limits(monkeypatch):
    """Limits on sites, by name, so that small scenes are too large."""

    def limit(**changes):
        for name, value in changes.items():
            monkeypatch.setattr(
                f"crackfront.measured.prediction.simulated_prediction.{name}", value
            )

    return limit


LONG_WAVES = replace(SCENE, radius=0.5e-3, contact_modulus=1.2e6 / 0.75)


@pytest.fixture(scope="module")
def coarse():
    """The surface of the overview alone, with few sites under a sphere."""
    return shipped_surface(OVERVIEW)


@pytest.mark.slow
def test_a_sphere_with_too_many_sites_is_a_straight_front_on_its_springs(coarse, small_limits):
    sphere_plan = prediction_plan(coarse, LONG_WAVES, 2, 1)
    assert sphere_plan.remark == ""
    assert isinstance(sphere_plan.simulations[0].schedule, SteadySchedule)
    small_limits(_MOST_SITES=100)
    plan = prediction_plan(coarse, LONG_WAVES, 2, 1)
    schedule = plan.simulations[0].schedule
    assert isinstance(schedule, LineSchedule)
    prediction = predicted(coarse, LONG_WAVES)
    spring = prediction.l_kappa / LONG_WAVES.lateral
    assert schedule.spring == pytest.approx(spring)
    assert schedule.length >= 9.99 * spring
    simulations = simulated(plan, LONG_WAVES)
    assert simulations.remark == plan.remark
    assert "a straight front is simulated, on springs of the length L_kappa" in plan.remark
    assert simulations.k.value == pytest.approx(prediction.factors.both.value, rel=0.15)


def test_what_is_too_large_in_every_way_is_refused(coarse, small_limits):
    small_limits(_MOST_MEMORY=1e6)
    with pytest.raises(ValueError, match=r"no simulation is small enough: .* without --simulate"):
        prediction_plan(coarse, LONG_WAVES, 1, 1)
