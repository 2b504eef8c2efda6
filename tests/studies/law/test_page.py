"""The pages hold the numbers of the law of k."""

from pathlib import Path

import pytest

from studies.law.page import law_numbers, law_parts
from studies.law.spheres import read_spheres
from studies.numbers import stored


def test_what_is_kept_for_the_pages_are_the_numbers_of_the_law(monkeypatch):
    monkeypatch.chdir(Path(__file__).parents[3])
    paths = [Path("docs/reference") / name for name in ("spheres.csv", "held-out.csv")]
    spheres, stored_numbers = read_spheres(paths), stored("law")
    # Otherwise: python -m studies law numbers --keep
    assert {name: entry.table for name, entry in stored_numbers.tables.items()} == law_parts(
        spheres
    )
    for name, number in law_numbers(spheres).items():
        assert stored_numbers.numbers[name].value == pytest.approx(number.value, rel=1e-9)
