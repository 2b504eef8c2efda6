"""Main Fig. 1d: the loop of a smooth sphere with two works of adhesion."""

from dataclasses import replace

import pytest

from studies.paper.figure import figure
from tests.studies.paper.made import computed, failed, parameters

SCENE = figure("main-1d")


@pytest.fixture(scope="module")
def smooth():
    return computed("main-1d", parameters("main-1d"))


def test_a_smooth_loop_follows_the_closed_forms(smooth):
    assert failed(smooth) == []


def test_a_wrong_smooth_loop_fails_its_checks(smooth):
    wrong = replace(smooth, radius=smooth.radius * 1.01, force=smooth.force * 1.01)
    assert [check.passed for check in SCENE.checks(wrong)] == [False, False, False, True]
