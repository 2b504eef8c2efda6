"""Measured points: what their files may be, and the work of adhesion that fits."""

import numpy as np
import pytest
from pydantic_core import PydanticCustomError

from crackfront.core import jkr
from crackfront.core.units import Scales
from studies.paper.measured import (
    ForceRadius,
    Quantity,
    adhesion_from_forces,
    fitted_adhesion,
    read_force_radius,
    read_measured,
    read_profile_density,
)

LENGTH = Quantity("length", {"m": 1.0, "um": 1e-6}, positive=True)
LOAD = Quantity("load", {"N": 1.0, "mN": 1e-3})
RUBBER = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "points.csv"
    path.write_bytes(text.encode(encoding))
    return path


def test_columns_come_in_si_units_whatever_their_order_and_notes(tmp_path):
    path = written(tmp_path, "# by hand\nload (mN),branch,length (um)\n-2,in,3\n\n4, out ,5\n")
    table = read_measured(path, (LENGTH, LOAD), words=("branch",))
    np.testing.assert_allclose(table.numbers, [[3e-6, 5e-6], [-2e-3, 4e-3]])
    assert table.words.tolist() == [["in", "out"]]
    assert table.lines.tolist() == [3, 5]


def test_a_file_of_a_spreadsheet_with_a_byte_order_mark_is_read(tmp_path):
    path = written(tmp_path, "length (m)\r\n1\r\n2\r\n", encoding="utf-8-sig")
    assert read_measured(path, (LENGTH,)).numbers.tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("load (N)\n1\n", "line 1: column length is missing; the header has load"),
        ("length (m),length (m)\n1,1\n", "line 1: column length stands twice; remove one"),
        ("length (inch)\n1\n", "line 1: length is in inch; write length .unit. with one of m, um"),
        ("length\n1\n", "line 1: length lacks a unit"),
        ("length (m)\n1\n# note\nx\n", "line 4: length is 'x'; it must be a positive number"),
        ("length (m)\n0\n", "line 2: length is '0'; it must be a positive number"),
        ("length (m)\ninf\n", "line 2: length is 'inf'; it must be a positive number"),
        ("length (m)\n1,2\n", "line 2 has 2 values for 1 columns; complete it"),
        ('length (m)\n1\n"2\n', "line 3: unexpected end of data"),
        ("length (m)\n", "has a header but no rows"),
        ("", "is empty; it needs a header and rows"),
    ],
)
def test_a_wrong_file_is_refused_with_its_line(tmp_path, text, sentence):
    with pytest.raises(PydanticCustomError, match=sentence):
        read_measured(written(tmp_path, text), (LENGTH,))


def test_a_file_that_is_no_text_or_missing_is_refused(tmp_path):
    with pytest.raises(PydanticCustomError, match="save it as UTF-8"):
        read_measured(written(tmp_path, "length (µm)\n1\n", encoding="latin-1"), (LENGTH,))
    with pytest.raises(PydanticCustomError, match="cannot be read: No such file"):
        read_measured(tmp_path / "none.csv", (LENGTH,))


GOOD = ["force (mN),radius (um),branch", "-0.1,70,approach", "0.1,90,approach", "0.5,110,approach"]
PROFILE = "q (1/m),C1D (m^3)"


@pytest.mark.parametrize(
    ("read", "rows", "sentence"),
    [
        (read_force_radius, [*GOOD, "nan,9,approach"], "line 5: force is 'nan'; it must be a fin"),
        (
            read_force_radius,
            [*GOOD, "0.6,120,up"],
            "line 5: branch is 'up'; it must be approach or",
        ),
        (read_force_radius, [*GOOD, "0,90,retraction", GOOD[1]], "line 6: an approach follows"),
        (read_force_radius, GOOD[:3], "line 3: the approach has 2 points"),
        (read_force_radius, [GOOD[0], *GOOD[:0:-1]], "line 4: the approach ends at -0.0001 N and"),
        (read_profile_density, [PROFILE, "1,1", "3,1", "2,1"], "line 4: q is 2 1/m after 3 1/m"),
        (read_profile_density, [PROFILE, "1,1"], "line 2 is the only row"),
    ],
)
def test_wrong_points_are_refused_with_their_line(tmp_path, read, rows, sentence):
    with pytest.raises(PydanticCustomError, match=sentence):
        read(written(tmp_path, "\n".join(rows)))


def test_forces_are_read_with_their_branches(tmp_path):
    points = read_force_radius(written(tmp_path, "\n".join([*GOOD, "0.09,90,retraction"])))
    np.testing.assert_allclose(points.force, [-1e-4, 1e-4, 5e-4, 9e-5])
    np.testing.assert_allclose(points.radius, [7e-5, 9e-5, 1.1e-4, 9e-5])
    assert points.direction.tolist() == [1, 1, 1, -1]


def test_a_fit_finds_the_work_of_adhesion_within_its_interval(rng):
    radius = np.linspace(0.8, 2.0, 25)
    inside = []
    for _ in range(400):
        force = jkr.equilibrium_force(radius, 0.3) + 0.05 * rng.standard_normal(radius.size)
        fit = adhesion_from_forces(radius, force)
        inside.append(fit.low <= 0.3 <= fit.high)
    assert np.mean(inside) == pytest.approx(0.95, abs=0.04)


def test_too_few_points_have_no_interval():
    with pytest.raises(ValueError, match="2 points are too few"):
        adhesion_from_forces(np.array([1.0, 2.0]), np.array([0.0, 1.0]))


def synthetic(rng, noise):
    """An approach of k = 3 on a film of e_el = 11.1 mJ/m2 in SI units."""
    radius = np.linspace(60e-6, 130e-6, 30)
    force = RUBBER.force * jkr.equilibrium_force(radius / RUBBER.lateral, (63 - 4 * 11.1) / 63)
    force += noise * rng.standard_normal(radius.size)
    return ForceRadius(force, radius, np.ones(radius.size, dtype=int))


def test_w_int_is_recovered_from_synthetic_points(rng):
    _, low, high = fitted_adhesion(synthetic(rng, 1e-5), RUBBER, 11.1e-3, 3.0)
    assert low < 63e-3 < high
    assert high - low < 1e-3
    other = Scales(RUBBER.radius, 50e-3, RUBBER.contact_modulus)
    again = fitted_adhesion(synthetic(rng, 0.0), other, 11.1e-3, 3.0)
    assert again[0] == pytest.approx(63e-3, rel=1e-6)
