"""The boundary elements: against their libraries and against JKR."""

from types import SimpleNamespace

import numpy as np
import pytest
from NuMPI.Optimization import tr_newton_bounded
from scipy.optimize import brentq

from crackfront.core import jkr
from studies.boundary_elements.contact import HalfSpaceContact, equilibrium, half_space_contact
from studies.boundary_elements.cycle import EDGE, perimeter

SIDE, RANGE = 5.12, 0.61
"""Domain, and the range of attraction that 64 points resolve."""


@pytest.fixture(scope="module")
def rough(small):
    return small.contact()


@pytest.fixture(scope="module")
def smooth():
    return half_space_contact(np.zeros((64, 64)), SIDE / 64, RANGE, max_penetration=1.0)


def at_rest(contact, penetration, displacement=None, tolerance=1e-6):
    side = 2 * contact.n_point
    start = np.zeros((side, side)) if displacement is None else displacement
    return equilibrium(contact, start, penetration, tolerance=tolerance, radius=1.0)


def test_energy_gradient_and_curvature_are_those_of_the_libraries(rough, rng):
    displacement = at_rest(rough, 0.3).displacement + 0.01 * rng.standard_normal((128, 128))
    energy, gradient = rough.evaluate(displacement, 0.3)
    area = rough.pixel**2
    theirs, their_gradient = rough.system.objective(0.3, gradient=True)(displacement)
    assert energy * area == pytest.approx(theirs, rel=1e-12)
    np.testing.assert_allclose(area * gradient, their_gradient.reshape(128, 128), atol=1e-14)
    step = rng.standard_normal((128, 128))
    curved = rough.elastic_pressure(step)
    curved[:64, :64] += rough.softening(displacement, 0.3) * step[:64, :64]
    their_product = rough.system.hessian_product_function(0.3)(displacement, step)
    np.testing.assert_allclose(area * curved, their_product, atol=1e-12)


def test_the_state_at_rest_is_that_of_the_libraries_optimiser(rough):
    start = at_rest(rough, 0.30).displacement
    ours = at_rest(rough, 0.31, start)
    lowest = np.full((128, 128), -np.inf)
    lowest[:64, :64] = rough.surface + 0.31
    theirs = tr_newton_bounded(
        rough.system.objective(0.31, gradient=True),
        start.ravel(),
        rough.system.hessian_product_function(0.31),
        jac=True,
        bounds_lo=lowest.ravel(),
        gtol=1e-6 * rough.largest_tension * rough.pixel**2,
        maxiter=1000,
    )
    assert theirs.success
    np.testing.assert_allclose(ours.displacement.ravel(), theirs.x, atol=1e-5)


class Rippled:
    """An attraction whose energy is wavy along the gap."""

    def __init__(self, height):
        self.height = height

    def evaluate(self, gap, potential=True, gradient=False, curvature=False):
        wave = 2 * np.pi * gap
        return (
            -self.height * np.cos(wave),
            2 * np.pi * self.height * np.sin(wave),
            4 * np.pi**2 * self.height * np.cos(wave),
        )


def spring_over_ripples(height):
    """One point on a spring whose rest is far to the left, over ripples of unit wavelength."""
    ones = np.ones((2, 2))
    return HalfSpaceContact(
        system=SimpleNamespace(interaction=Rippled(height)),
        surface=np.full((1, 1), -100.0),
        pixel=1.0,
        interaction_range=1.0,
        stiffness=ones,
        compliance=ones,
    )


def at(place):
    displacement = np.zeros((2, 2))
    displacement[0, 0] = place
    return displacement


def test_a_step_that_would_pass_over_a_barrier_is_shortened():
    ripples = spring_over_ripples(2.0)
    expected = brentq(lambda u: u + 4 * np.pi * np.sin(2 * np.pi * u), 4.8, 5.0)
    turned_back = []
    for trust in (0.1, 1.0):
        state = equilibrium(ripples, at(5.3), 0.0, tolerance=1e-6, radius=trust)
        assert state.displacement[0, 0] == pytest.approx(expected, abs=1e-5)
        assert state.released > 0
        turned_back.append(state.barriers)
    assert turned_back[0] == 0 < turned_back[1]


def test_a_state_without_forces_that_is_no_minimum_is_left():
    ripples = spring_over_ripples(0.5)
    top = brentq(lambda u: u + np.pi * np.sin(2 * np.pi * u), 0.5, 0.7)
    state = equilibrium(ripples, at(top), 0.0, tolerance=1e-6, radius=0.1)
    assert state.saddles == 1
    assert abs(state.displacement[0, 0] - top) > 0.2
    assert state.released > 0.1


def test_a_coarse_smooth_sphere_has_the_force_and_the_radius_of_jkr(smooth):
    displacement = at_rest(smooth, 0.0).displacement
    for penetration in (0.5, 0.0):
        displacement = at_rest(smooth, penetration, displacement).displacement
        radius = jkr.equilibrium_radius(penetration)
        force = np.sum(smooth.elastic_pressure(displacement)[:64, :64]) * smooth.pixel**2
        assert force == pytest.approx(jkr.equilibrium_force(radius), abs=0.03 * 1.5)
        radii = perimeter(smooth.gap(displacement, penetration), smooth.pixel, EDGE * RANGE)
        assert radii.mean() == pytest.approx(radius, rel=0.02)
        assert np.ptp(radii) < smooth.pixel
