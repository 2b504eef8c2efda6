"""The pages hold the numbers of the law of k."""

from pathlib import Path

import numpy as np
import pytest

from crackfront.analysis.finding import crossing, stated_breadths
from crackfront.analysis.law import law_value, pinning_factor, shipped_law
from studies.law.page import law_numbers, law_parts, limit_part
from studies.law.spheres import read_spheres
from studies.numbers import stored


def test_what_is_kept_for_the_pages_are_the_numbers_of_the_law(monkeypatch):
    monkeypatch.chdir(Path(__file__).parents[3])
    paths = [Path("docs/reference") / name for name in ("spheres.csv", "held-out.csv")]
    spheres, known = read_spheres(paths), stored("law")
    # Otherwise: python -m studies law numbers --keep
    assert {name: table.text for name, table in known.tables.items()} == law_parts(spheres)
    for name, number in law_numbers(spheres).items():
        assert known.numbers[name].value == pytest.approx(number.value, rel=1e-9)


def test_the_table_of_the_limit_holds_its_values_and_where_k_is_that_of_the_paper():
    text = limit_part()
    for breadth in stated_breadths().values():
        k = pinning_factor(0.4, np.inf, breadth=breadth).factor
        assert f"| {k.value:.2f} ({k.low:.2f} to {k.high:.2f}) |" in text
    s, low, high = crossing()
    assert float(law_value(shipped_law().coefficients, s, np.inf)) == pytest.approx(3)
    assert pinning_factor(low, np.inf).factor.low == pytest.approx(3)
    assert pinning_factor(high, np.inf).factor.high == pytest.approx(3)
