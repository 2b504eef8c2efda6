"""The measured hysteresis on nanodiamond stands beside what models say of it."""

from pathlib import Path

import pytest

from studies.paper.experiment import hystereses, hystereses_figure, hystereses_table
from studies.paper.nanodiamond import NanodiamondContact
from studies.records import read_record

REFERENCE = Path(__file__).parents[3] / "docs/reference/main-5bc.nc"


@pytest.fixture(scope="module")
def shown():
    return hystereses(read_record(REFERENCE, NanodiamondContact))


def test_the_measured_hysteresis_is_above_all_that_is_computed(shown):
    measured, paper, front, elements = (row.value.value for row in shown)
    assert measured > paper > front > elements
    assert paper == pytest.approx(0.0668, abs=1e-4)


def test_the_table_and_the_figure_have_them_all(shown):
    table = hystereses_table(shown)
    assert len(table.rows) == len(shown)
    assert table.rows[0] == ("measured", "80", "", "", "1.0")
    [axes] = hystereses_figure(shown).axes
    assert [label.get_text() for label in axes.get_yticklabels()] == [row.name for row in shown]
