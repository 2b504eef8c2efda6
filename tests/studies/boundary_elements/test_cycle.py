"""Cycles by boundary elements: against JKR, and resumed."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core import jkr
from crackfront.simulate.provenance import provenance
from studies.boundary_elements.cases import Loads
from studies.boundary_elements.cycle import LOST_CONTACT, boundary_cycle, perimeter
from studies.records import read_record, write_record


def test_the_perimeter_of_a_disc_is_its_circle():
    pixel = 0.05
    position = pixel * (np.arange(64) - 32)
    gap = np.maximum(np.hypot(position[:, None], position) - 1.0, 0.0)
    np.testing.assert_allclose(perimeter(gap, pixel, 0.1), 1.1, atol=pixel / 20)
    assert not np.any(perimeter(gap + 1, pixel, 0.1))


@pytest.fixture(scope="module")
def cycle_and_parts(small):
    parts = []
    cycle = boundary_cycle(small, keep=parts.append)
    return cycle, parts


def test_a_cycle_begins_and_ends_without_contact(small, cycle_and_parts):
    cycle, _ = cycle_and_parts
    assert cycle.status == LOST_CONTACT
    assert cycle.force[0] == 0
    assert cycle.force[-1] == pytest.approx(0, abs=1e-7)
    assert not np.any(cycle.radius[-1])
    assert cycle.force.min() < -1.3
    assert np.all(cycle.residual <= 1e-4)
    shown = np.flatnonzero(np.isclose(cycle.penetration, 0.15))
    forces = np.sum(cycle.shown_pressure, axis=(1, 2)) * small.pixel**2
    np.testing.assert_allclose(forces, cycle.force[shown], rtol=1e-4)


def test_the_energy_never_rises_at_a_penetration_and_no_load_step_ends_on_a_saddle(cycle_and_parts):
    cycle, _ = cycle_and_parts
    assert np.all(cycle.released >= -1e-12)
    work = np.diff(cycle.penetration) * (cycle.force[1:] + cycle.force[:-1]) / 2
    jumped = work - np.diff(cycle.energy)
    assert np.sum(jumped) == pytest.approx(np.sum(work), abs=1e-6)
    assert np.all(cycle.energy[[0, -1]] == pytest.approx(0, abs=1e-8))


def test_a_cycle_goes_on_from_the_file_of_any_load_step(small, cycle_and_parts, tmp_path):
    whole, parts = cycle_and_parts
    path = tmp_path / "part.nc"
    write_record(path, parts[4], provenance())
    part = read_record(path, type(whole))
    again = boundary_cycle(small, resume=part)
    np.testing.assert_array_equal(again.penetration, whole.penetration)
    np.testing.assert_allclose(again.force, whole.force, atol=1e-3)
    assert again.status == whole.status


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n_point", "interaction_range", "bound"), [(128, 0.43, 0.02), (256, 0.30, 0.012)]
)
def test_the_force_of_a_smooth_sphere_is_that_of_jkr_to_a_part_of_the_pull_off_force(
    small, n_point, interaction_range, bound
):
    smooth = replace(
        small,
        n_point=n_point,
        interaction_range=interaction_range,
        elastic_energy=0.0,
        loads=Loads(max_penetration=1.0, step=0.1, shown_penetration=0.5),
    )
    cycle = boundary_cycle(smooth)
    stable = (cycle.penetration > -0.75) & (cycle.force < -1e-9) & (cycle.penetration >= -0.2)
    expected = [
        float(jkr.equilibrium_force(jkr.equilibrium_radius(b))) for b in cycle.penetration[stable]
    ]
    assert np.max(np.abs(cycle.force[stable] - expected)) < bound * 1.5
