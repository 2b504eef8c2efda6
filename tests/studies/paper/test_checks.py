"""Checks of figures: how each ends, and how it is told."""

from dataclasses import replace

import pytest

from studies.paper.checks import Check, checks_table, close_to, counted


def row(check):
    """Row of a check in its table."""
    [shown] = checks_table([check]).records()
    return shown


def test_a_check_that_fails_says_so():
    assert row(close_to("a", 1.0, 2.0, 0.5))["result"] == "FAIL"
    assert row(Check("a", "1", "1", passed=True))["result"] == "agrees"


def test_a_difference_that_the_law_predicts_is_told_with_its_number():
    predicted = close_to("k", 2.1, 3.0, 0.5, law=(2.2, 0.2))
    assert predicted.result == "differs as the law of k says"
    assert (row(predicted)["result"], row(predicted)["reason"]) == (predicted.result, "2.20 ± 0.20")
    assert close_to("k", 2.9, 3.0, 0.5, law=(2.2, 0.2)).result == "agrees"
    assert close_to("k", 1.9, 3.0, 0.5, law=(2.2, 0.2)).result == "FAIL"


@pytest.mark.parametrize("passed", [True, False])
def test_what_a_scale_cannot_decide_neither_agrees_nor_fails(passed):
    check = Check("order", "all", "2 of 3", passed, undecided="errors overlap")
    assert check.result == "cannot be decided"
    assert (row(check)["result"], row(check)["reason"]) == (check.result, "errors overlap")


def test_an_expectation_that_is_not_met_is_no_failure_and_has_its_source():
    statement = Check("k is 3", "3", "3", passed=True)
    expectation = Check("tau", "1.28", "1.0", passed=False, expectation="Theory of depinning.")
    assert expectation.result == "is not met"
    shown = checks_table([expectation, statement]).records()
    assert [line["kind"] for line in shown] == ["expectation", "statement"]
    assert [line["source"] for line in shown] == ["Theory of depinning.", ""]
    met = replace(expectation, passed=True)
    assert met.result == "agrees"


def test_both_groups_are_counted_by_themselves():
    passed = Check("a", "", "", passed=True)
    wrong = Check("b", "", "", passed=False)
    expected = Check("c", "", "", passed=False, expectation="theory")
    statements, expectations = counted(
        [checks_table([passed, passed]), checks_table([wrong, expected])]
    )
    assert "2 of 3 agree" in statements
    assert statements.endswith("1 fail.")
    assert "0 of 1 met, 1 not met" in expectations
    assert len(counted([checks_table([passed])])) == 1
