import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crackfront.core import jkr
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

# facts.md: radius, penetration and force of the smooth sphere at w = w_int.
STATES = {
    "pull-off at fixed penetration": (0.550321208, -0.908560296, -5 / 6),
    "pull-off at fixed force": (1.144714243, -0.436790232, -3 / 2),
    "zero penetration": (1.386722549, 0.0, -4 / 3),
    "zero force": (1.817120593, 1.100642416, 0.0),
    "unit penetration": (1.783484193282, 1.0, -0.161241120956),
}
DIGIT = 6e-10

radii = st.floats(0.05, 4.0)
penetrations = st.floats(-2.0, 3.0)
adhesions = st.floats(0.1, 3.0)


def derivative(function, at, step=1e-5):
    """Central difference of fourth order."""
    near = function(at + step) - function(at - step)
    far = function(at + 2 * step) - function(at - 2 * step)
    return (8 * near - far) / (12 * step)


@pytest.mark.parametrize("state", STATES)
def test_a_tabulated_state_is_in_equilibrium_and_both_expressions_give_its_force(state):
    radius, penetration, force = STATES[state]
    assert jkr.equilibrium_penetration(radius) == pytest.approx(penetration, abs=5 * DIGIT)
    assert jkr.equilibrium_force(radius) == pytest.approx(force, abs=5 * DIGIT)
    assert jkr.force(radius, penetration) == pytest.approx(force, abs=5 * DIGIT)
    if state != "pull-off at fixed penetration":
        assert jkr.equilibrium_radius(penetration) == pytest.approx(radius, abs=5 * DIGIT)


def test_pull_off_is_at_the_closed_form_values():
    assert jkr.pull_off_radius() == pytest.approx(0.550321208, abs=DIGIT)
    assert jkr.pull_off_penetration() == pytest.approx(-0.908560296, abs=DIGIT)
    assert jkr.pull_off_force() == -1.5


@given(adhesions)
def test_radius_penetration_and_force_scale_with_powers_of_the_adhesion(adhesion):
    assert jkr.pull_off_radius(adhesion) == pytest.approx(
        adhesion ** (1 / 3) * jkr.pull_off_radius(), rel=1e-13
    )
    assert jkr.pull_off_penetration(adhesion) == pytest.approx(
        adhesion ** (2 / 3) * jkr.pull_off_penetration(), rel=1e-13
    )
    assert jkr.pull_off_force(adhesion) == pytest.approx(adhesion * jkr.pull_off_force(), rel=1e-14)


@given(radii, adhesions)
def test_equilibrium_means_that_the_release_rate_is_the_work_of_adhesion(radius, adhesion):
    penetration = jkr.equilibrium_penetration(radius, adhesion)
    assert jkr.apparent_work_of_adhesion(radius, penetration) == pytest.approx(adhesion, rel=1e-10)


@given(st.floats(-0.9, 5.0), st.floats(1.0, 3.0))
def test_equilibrium_radius_inverts_equilibrium_penetration_on_the_stable_branch(
    penetration, adhesion
):
    radius = jkr.equilibrium_radius(penetration, adhesion)
    assert radius >= jkr.pull_off_radius(adhesion)
    assert jkr.equilibrium_penetration(radius, adhesion) == pytest.approx(penetration, abs=1e-13)


@given(radii, penetrations)
def test_force_is_the_derivative_of_the_elastic_energy_in_penetration(radius, penetration):
    slope = derivative(lambda b: float(jkr.stored_energy(radius, b)), penetration, step=1e-2)
    assert jkr.force(radius, penetration) == pytest.approx(slope, rel=1e-9, abs=1e-9)


@given(radii, penetrations)
def test_release_rate_is_the_derivative_of_the_elastic_energy_in_area(radius, penetration):
    slope = derivative(lambda a: float(jkr.stored_energy(a, penetration)), radius, step=1e-3)
    release = jkr.stress_intensity(radius, penetration) ** 2 / (2 * CONTACT_MODULUS)
    assert 2 * np.pi * radius * release == pytest.approx(slope, rel=1e-7, abs=1e-7)


@given(radii, st.floats(-2.0, 0.0))
def test_release_rate_has_its_closed_form_where_the_edge_is_open(radius, penetration):
    closed = 3 / 8 * (radius**2 - penetration) ** 2 / radius / np.pi
    assert jkr.energy_release_rate(radius, penetration) == pytest.approx(closed, rel=1e-13)


@given(radii, st.floats(1e-6, 2.0))
def test_an_edge_in_compression_releases_nothing(radius, excess):
    penetration = radius**2 + excess
    assert jkr.stress_intensity(radius, penetration) < 0
    assert jkr.energy_release_rate(radius, penetration) == 0
    assert jkr.apparent_work_of_adhesion(radius, penetration) == 0


@given(st.floats(0.3, 3.0), st.floats(0.3, 2.0))
def test_release_rate_hardens_as_the_closed_form_says(radius, adhesion):
    penetration = float(jkr.equilibrium_penetration(radius, adhesion))
    slope = derivative(lambda a: float(jkr.energy_release_rate(a, penetration)), radius)
    closed = np.sqrt(6 * adhesion * radius) - adhesion / radius
    assert slope / WORK_OF_ADHESION == pytest.approx(closed, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize(
    ("state", "limit"),
    [
        ((-1.0,), r"penetration -1.0 is below pull-off \(-0.90856\)"),
        ((-0.9, 0.5), r"of 0\.5 w_int"),
    ],
)
def test_a_penetration_below_pull_off_is_refused_with_the_limit(state, limit):
    with pytest.raises(ValueError, match=limit):
        jkr.equilibrium_radius(*state)


@pytest.mark.parametrize("state", STATES)
def test_the_neck_opens_as_the_stress_intensity_says(state):
    radius, penetration, _ = STATES[state]
    ahead = 1e-6
    surface = jkr.surface_displacement(radius + ahead, radius, penetration)
    opening = surface - (penetration - (radius + ahead) ** 2 / 2)
    # SI Eqs. (8), (9): u = sqrt(8 / pi) K / E' sqrt(xi).
    intensity = np.sqrt(8 / np.pi) * jkr.stress_intensity(radius, penetration) / CONTACT_MODULUS
    assert opening == pytest.approx(intensity * np.sqrt(ahead), rel=1e-4)


@pytest.mark.parametrize("state", STATES)
def test_far_from_the_contact_the_surface_feels_a_point_force(state):
    radius, penetration, force = STATES[state]
    far = 1e3
    surface = jkr.surface_displacement(far, radius, penetration)
    assert surface * np.pi * CONTACT_MODULUS * far == pytest.approx(force, abs=1e-4)


@pytest.mark.parametrize("adhesion", [0.3, 1.0])
def test_the_radius_at_a_force_is_the_stable_one(adhesion):
    pull_off = jkr.pull_off_force(adhesion)
    assert jkr.radius_at_force(pull_off, adhesion) ** 3 == pytest.approx(1.5 * adhesion)
    for force in (pull_off / 2, 0.0, 4.0):
        radius = jkr.radius_at_force(force, adhesion)
        assert jkr.equilibrium_force(radius, adhesion) == pytest.approx(force, abs=1e-12)
        assert radius**3 > 1.5 * adhesion
    with pytest.raises(ValueError, match="below pull-off"):
        jkr.radius_at_force(1.001 * pull_off, adhesion)
