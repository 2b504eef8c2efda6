"""Measured forces and radii: what their files may be, and the work of adhesion that fits."""

import numpy as np
import pytest
from pydantic_core import PydanticCustomError

from crackfront.core import jkr
from crackfront.core.units import Scales
from studies.paper.film import fitted_adhesion
from studies.paper.force import adhesion_from_forces
from studies.paper.measured import ForceRadius, read_force_radius

RUBBER = Scales(radius=1.25e-3, work_of_adhesion=63e-3, contact_modulus=0.7e6 / 0.75)


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
    """An approach of k = 3 on a film of e_el = 11.1 mJ/m2 in SI units, and a retraction."""
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


def test_points_are_read_in_si_units_whatever_the_units_of_the_file(tmp_path):
    path = tmp_path / "measured.csv"
    path.write_text(
        "# any remark\nbranch,time (s),force (uN),radius (nm)\n\n"
        "approach,0,-100,7e4\napproach,1,100,9e4\n approach ,2,500,1.1e5\nretraction,3,90,9e4\n"
    )
    points = read_force_radius(path)
    np.testing.assert_allclose(points.force, [-1e-4, 1e-4, 5e-4, 9e-5])
    np.testing.assert_allclose(points.radius, [7e-5, 9e-5, 1.1e-4, 9e-5])
    assert points.direction.tolist() == [1, 1, 1, -1]


GOOD = ["force (mN),radius (um),branch", "-0.1,70,approach", "0.1,90,approach", "0.5,110,approach"]


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        ([], "is empty"),
        (GOOD[:1], "has a header but no rows"),
        (["force (mN),branch", "1,approach"], "line 1: column radius is missing"),
        (["force (mN),force (mN),radius (um),branch"], "line 1: column force stands twice"),
        (["force (kg),radius (um),branch"], "line 1: force is in kg; write force .unit. with one"),
        (["force (mN),radius,branch"], "line 1: radius has no unit"),
        ([*GOOD, "nan,120,approach"], "line 5: force is 'nan'; it must be a finite number"),
        ([*GOOD, "0.6,-1,approach"], "line 5: radius is '-1'; it must be a positive number"),
        ([*GOOD, "0.6,much,approach"], "line 5: radius is 'much'"),
        ([*GOOD, "0.6,120"], "line 5 has 2 values for 3 columns"),
        ([*GOOD, "0.6,120,up"], "line 5: branch is 'up'; it must be approach or retraction"),
        ([*GOOD, "0,90,retraction", "0.1,90,approach"], "line 6: an approach follows"),
        (GOOD[:3], "line 3: the approach has 2 points"),
        ([GOOD[0], *GOOD[:0:-1]], "line 4: the approach ends at -0.0001 N and begins at 0.0005"),
        ([*GOOD, '0.6,"120,approach'], "line 5: unexpected end of data"),
    ],
)
def test_a_wrong_csv_is_refused_with_its_line(tmp_path, rows, sentence):
    path = tmp_path / "measured.csv"
    path.write_text("\n".join(rows))
    with pytest.raises(PydanticCustomError, match=sentence):
        read_force_radius(path)


def test_a_csv_that_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(PydanticCustomError, match="cannot be read: No such file"):
        read_force_radius(tmp_path / "none.csv")
    (tmp_path / "latin.csv").write_bytes("force (µN)".encode("latin-1"))
    with pytest.raises(PydanticCustomError, match="no UTF-8"):
        read_force_radius(tmp_path / "latin.csv")
