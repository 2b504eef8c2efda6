"""Measured points: what their files may be, and the work of adhesion that fits."""

import numpy as np
import pytest
from pydantic_core import PydanticCustomError

from crackfront.core import jkr
from crackfront.core.units import Scales
from studies.paper.measured import (
    ForceRadius,
    fitted_adhesion,
    read_force_radius,
    read_profile_density,
)

RUBBER = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "points.csv"
    path.write_bytes(text.encode(encoding))
    return path


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


def test_points_may_have_any_separator_and_any_unit_of_their_dimension(tmp_path):
    expected = read_force_radius(written(tmp_path, "\n".join(GOOD)))
    rows = ["# rig 1", "radius [nm];force / uN;branch", "70000;-100;approach"]
    rows += ["90000;100;approach", "110000;500;approach"]
    points = read_force_radius(written(tmp_path, "\n".join(rows)))
    np.testing.assert_allclose(points.force, expected.force, rtol=1e-12)
    np.testing.assert_allclose(points.radius, expected.radius, rtol=1e-12)


@pytest.mark.parametrize(
    ("header", "key"),
    [
        ("force,radius (um),branch", "force lacks a unit"),
        ("force (kg),radius (um),branch", "kg"),
        ("force (mN),branch", "column radius is missing"),
        ("force (mN),radius (um),radius (nm),branch", "column radius stands twice"),
    ],
)
def test_headers_without_a_column_or_its_unit_are_named(tmp_path, header, key):
    cells = ["1"] * header.count(",")
    with pytest.raises(PydanticCustomError, match=key):
        read_force_radius(written(tmp_path, f"{header}\n{','.join(cells)},approach"))


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
    softer = Scales(RUBBER.radius, 50e-3, RUBBER.contact_modulus)
    again = fitted_adhesion(synthetic(rng, 0.0), softer, 11.1e-3, 3.0)
    assert again[0] == pytest.approx(63e-3, rel=1e-6)
