"""No table that the package ships is clamped, without a word, beyond what was measured."""

from importlib.resources import files

import pytest

from crackfront.analysis.law import pinning_factor, shipped_law
from crackfront.analysis.validity import front_excess, shipped_validity
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.simulate.laws import measured_energies
from crackfront.simulate.settings import chosen_settings

FLAT = SelfAffineSpectrum(0.02, 0.02, 1.0)


def errors_of_the_numerics():
    """An error is refused."""
    least, most = measured_energies()
    for energy in (0.9 * least, 1.1 * most):
        with pytest.raises(ValueError, match="errors were measured for e_el/w_int from"):
            chosen_settings(0.03, "roughness", FLAT, energy)


def law_of_k():
    """There is a warning, and a wider interval."""
    law = shipped_law()
    for s, g, breadth in (
        (1.1 * law.disorder[1], 5.0, 1.0),
        (0.3, 0.9 * law.size[0], 1.0),
        (0.3, 5.0, 1.5 * law.breadth[1]),
    ):
        assert pinning_factor(s, g, breadth=breadth).warning


def range_of_validity():
    """Nothing is divided by what was not compared, and the interval says so."""
    rows = shipped_validity()
    energy, size = max(row.elastic_energy for row in rows), max(row.size for row in rows)
    for found in (front_excess(2 * energy, size), front_excess(energy, 2 * size)):
        assert found.ratio.high > 1.5
        assert f"e_el/w_int = {energy:.2g}" in found.sentence


TABLES = {
    "laws.csv": errors_of_the_numerics,
    "law.json": law_of_k,
    "validity.csv": range_of_validity,
}


def test_every_table_is_held_against_its_ends():
    shipped = {
        path.name
        for folder in files("crackfront").iterdir()
        if folder.is_dir()
        for path in folder.iterdir()
        if path.name.endswith((".csv", ".json"))
    }
    assert shipped == set(TABLES)


@pytest.mark.parametrize("name", TABLES)
def test_no_table_is_clamped_beyond_its_ends(name):
    TABLES[name]()
