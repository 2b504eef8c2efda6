"""What a sweep costs, and what it would cost for other numerical errors of k."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from crackfront.simulate.costs import expected_cost
from crackfront.sweep.parameters import load_sweep
from crackfront.sweep.sweep_cost import error_costs
from tests.commands import done, refused

CONFIG = Path(__file__).parents[2] / "config"


def test_smaller_errors_cost_more_and_one_that_is_out_of_reach_says_what_is_left():
    prices = [*error_costs(load_sweep(CONFIG / "default.yaml"), (0.1, 0.03, 0.01, 1e-4))]
    seconds = [price.cost.core_seconds for price in prices]
    assert seconds == sorted(seconds)
    assert seconds[2] > 2 * seconds[0]
    assert [price.remaining_error > price.error for price in prices] == [False] * 3 + [True]


def test_a_sweep_costs_for_its_own_error_what_its_simulations_cost():
    sweep = load_sweep(CONFIG / "default.yaml")
    [price] = error_costs(sweep, [0.03])
    seconds = [expected_cost(simulation).seconds for simulation in sweep.simulations()]
    assert price.cost.core_seconds == pytest.approx(sum(seconds))
    assert price.cost.longest_seconds == max(seconds)


def test_errors_are_not_predicted_where_they_were_not_measured():
    sweep = replace(load_sweep(CONFIG / "default.yaml"), elastic_energies=(0.9,))
    with pytest.raises(ValueError, match="e_el"):
        [*error_costs(sweep, [0.03])]


def test_a_plan_shows_the_cost_for_each_error_in_a_table_and_as_json(tmp_path):
    plan = "plan", CONFIG / "test.yaml", "--output", tmp_path, "--errors"
    rows = [line.split() for line in done(*plan, "0.03,0.003").stdout.splitlines()]
    content = json.loads(done(*plan, "0.03,0.003", "--json").stdout)["errors"]
    assert [price["error"] for price in content] == [0.03, 0.003]
    assert {"0.03", "0.003"} <= {row[0] for row in rows if row}
    assert "much" in refused(*plan, "0.03,much")
