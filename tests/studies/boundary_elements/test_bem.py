"""The boundary elements: against their libraries, against JKR, and a cycle that is resumed."""

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from NuMPI.Optimization import tr_newton_bounded
from scipy.optimize import brentq

from crackfront.core import jkr
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.data.provenance import provenance
from crackfront.data.records import read_record, write_record
from studies.boundary_elements.contact import (
    HalfSpaceContact,
    equilibrium,
    half_space_contact,
)
from studies.boundary_elements.cycle import (
    EDGE,
    LOST_CONTACT,
    boundary_cycle,
    contact_loads,
    perimeter,
)
from studies.boundary_elements.parameters import Case

SIDE, RANGE = 5.12, 0.61
"""Domain, and the range of attraction that 64 points resolve."""


CASE = Case(
    seed=5,
    short_cutoff=0.4,
    side=SIDE,
    shown_penetration=0.15,
    tolerance=1e-4,
    n_point=64,
    interaction_range=RANGE,
    elastic_energy=0.03,
    schedule=LoadSchedule(0.3, 0.15),
)


@pytest.fixture(scope="module")
def rough():
    return CASE.contact()


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


def test_nothing_is_out_of_balance_at_rest(rough):
    found = at_rest(rough, 0.2)
    pressure = rough.elastic_pressure(found.displacement)
    gap = rough.gap(found.displacement, 0.2)
    tension = np.where(
        gap < RANGE, rough.largest_tension * np.clip(1 - gap / RANGE, 0, 1) ** 2, 0.0
    )
    unbalanced = (pressure[:64, :64] + tension)[gap > 0]
    assert np.max(np.abs(unbalanced)) < 2e-6 * rough.largest_tension
    assert np.min((pressure[:64, :64] + tension)[gap == 0]) > -2e-6 * rough.largest_tension
    pressure[:64, :64] = 0
    assert np.max(np.abs(pressure)) < 2e-6 * rough.largest_tension
    assert np.min(gap) >= 0


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
        found = equilibrium(ripples, at(5.3), 0.0, tolerance=1e-6, radius=trust)
        assert found.displacement[0, 0] == pytest.approx(expected, abs=1e-5)
        assert found.released > 0
        turned_back.append(found.barriers)
    assert turned_back[0] == 0 < turned_back[1]


def test_a_state_without_forces_that_is_no_minimum_is_left():
    ripples = spring_over_ripples(0.5)
    top = brentq(lambda u: u + np.pi * np.sin(2 * np.pi * u), 0.5, 0.7)
    found = equilibrium(ripples, at(top), 0.0, tolerance=1e-6, radius=0.1)
    assert found.saddles == 1
    assert abs(found.displacement[0, 0] - top) > 0.2
    assert found.released > 0.1


def test_the_energy_never_rises_at_a_penetration_and_no_load_step_ends_on_a_saddle(
    cycle_and_parts,
):
    cycle, _ = cycle_and_parts
    assert np.all(cycle.released >= -1e-12)
    work = np.diff(cycle.penetration) * (cycle.force[1:] + cycle.force[:-1]) / 2
    jumped = work - np.diff(cycle.energy)
    assert np.sum(jumped) == pytest.approx(np.sum(work), abs=1e-6)
    assert np.all(cycle.energy[[0, -1]] == pytest.approx(0, abs=1e-8))


def test_a_coarse_smooth_sphere_has_the_force_and_the_radius_of_jkr(smooth):
    displacement = at_rest(smooth, 0.0).displacement
    for penetration in (0.5, 0.0):
        displacement = at_rest(smooth, penetration, displacement).displacement
        radius = jkr.equilibrium_radius(penetration)
        force = np.sum(smooth.elastic_pressure(displacement)[:64, :64]) * smooth.pixel**2
        assert force == pytest.approx(jkr.equilibrium_force(radius), abs=0.03 * 1.5)
        found = perimeter(smooth.gap(displacement, penetration), smooth.pixel, EDGE * RANGE)
        assert found.mean() == pytest.approx(radius, rel=0.02)
        assert np.ptp(found) < smooth.pixel


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n_point", "interaction_range", "bound"), [(128, 0.43, 0.02), (256, 0.30, 0.012)]
)
def test_the_force_of_a_smooth_sphere_is_that_of_jkr_to_a_part_of_the_pull_off_force(
    n_point, interaction_range, bound
):
    smooth = replace(
        CASE,
        n_point=n_point,
        interaction_range=interaction_range,
        elastic_energy=0.0,
        shown_penetration=0.5,
        schedule=LoadSchedule(1.0, 0.1),
    )
    found = boundary_cycle(smooth)
    stable = (found.penetration > -0.75) & (found.force < -1e-9) & (found.penetration >= -0.2)
    expected = [
        float(jkr.equilibrium_force(jkr.equilibrium_radius(b))) for b in found.penetration[stable]
    ]
    assert np.max(np.abs(found.force[stable] - expected)) < bound * 1.5


def test_the_perimeter_of_a_disc_is_its_circle():
    pixel = 0.05
    position = pixel * (np.arange(64) - 32)
    gap = np.maximum(np.hypot(position[:, None], position) - 1.0, 0.0)
    np.testing.assert_allclose(perimeter(gap, pixel, 0.1), 1.1, atol=pixel / 20)
    assert not np.any(perimeter(gap + 1, pixel, 0.1))


def test_loads_begin_before_the_surfaces_attract_each_other():
    loads = contact_loads(LoadSchedule(0.2, 0.1), 0.25)
    visited = [next(loads) for _ in range(8)]
    assert [load.value for load in visited] == pytest.approx(
        [-0.3, -0.2, -0.1, 0, 0.1, 0.2, 0.1, 0]
    )
    assert [load.direction for load in visited] == [1, 1, 1, 1, 1, 1, -1, -1]


@pytest.fixture(scope="module")
def cycle_and_parts():
    parts = []
    cycle = boundary_cycle(CASE, keep=parts.append)
    return cycle, parts


def test_a_cycle_begins_and_ends_without_contact(cycle_and_parts):
    cycle, _ = cycle_and_parts
    assert cycle.status == LOST_CONTACT
    assert cycle.force[0] == 0
    assert cycle.force[-1] == pytest.approx(0, abs=1e-7)
    assert not np.any(cycle.radius[-1])
    assert cycle.force.min() < -1.3
    assert np.all(cycle.residual <= 1e-4)
    assert np.all(cycle.contact_area >= cycle.closed_area)
    shown = np.flatnonzero(np.isclose(cycle.penetration, 0.15))
    forces = np.sum(cycle.shown_pressure, axis=(1, 2)) * cycle.pixel**2
    np.testing.assert_allclose(forces, cycle.force[shown], rtol=1e-4)


def test_a_cycle_goes_on_from_the_file_of_any_load_step(cycle_and_parts, tmp_path):
    whole, parts = cycle_and_parts
    path = tmp_path / "part.nc"
    write_record(path, parts[4], provenance())
    part = read_record(path, type(whole))
    again = boundary_cycle(CASE, resume=part)
    np.testing.assert_array_equal(again.penetration, whole.penetration)
    np.testing.assert_allclose(again.force, whole.force, atol=1e-3)
    assert again.status == whole.status


def test_a_cycle_of_another_load_is_not_resumed(cycle_and_parts):
    _, parts = cycle_and_parts
    with pytest.raises(ValueError, match=r"penetration -0.75 where -0.7 is asked for"):
        boundary_cycle(replace(CASE, schedule=LoadSchedule(0.3, 0.1)), resume=parts[0])


@pytest.mark.parametrize(
    ("n_point", "side", "sentence"),
    [
        (
            128,
            5.12,
            r"pixel is 0.04; .* needs 2 \(g_c / 3\)\^2 = 0.0128 or less, so take n_point 400",
        ),
        (512, 3.6, r"domain of side 3.6 is too small for .* take a side of 3.8 or more"),
    ],
)
def test_grids_that_cannot_hold_the_contact_are_refused(n_point, side, sentence):
    with pytest.raises(ValueError, match=sentence):
        half_space_contact(np.zeros((n_point, n_point)), side / n_point, 0.24, max_penetration=1.0)


def test_a_missing_extra_is_refused_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "Adhesion.Interactions", None)
    with pytest.raises(ValueError, match=r"need Adhesion, .* pip install '.\[bem\]'"):
        half_space_contact(np.zeros((64, 64)), SIDE / 64, RANGE, max_penetration=1.0)


def test_nobody_who_runs_a_sweep_imports_the_boundary_elements():
    program = (
        "import sys, crackfront.cli, crackfront.sweep.configuration, crackfront.sweep.parallel\n"
        "print({'ContactMechanics', 'Adhesion', 'NuMPI', 'finufft'} & set(sys.modules))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stdout.strip() == "set()"
