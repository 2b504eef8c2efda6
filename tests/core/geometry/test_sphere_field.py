"""The field of a sphere on a given tile."""

from dataclasses import replace

import numpy as np
import pytest

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap, chemical_adhesion
from crackfront.core.field.fields import last_place
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.units import WORK_OF_ADHESION


@pytest.fixture
def adhesion(rng):
    """A tile of uncorrelated points."""
    return chemical_adhesion(0.3 * rng.standard_normal((16, 16)), pixel=0.2)


@pytest.mark.parametrize("strength", [0.0, 0.5, 3.0])
def test_a_smooth_contact_of_the_strongest_adhesion_stays_inside_the_field(adhesion, strength):
    adhesion = replace(adhesion, work_of_adhesion=adhesion.work_of_adhesion * strength + 0.01)
    field = contact_field(adhesion, 0.7)
    strongest = np.max(adhesion.work_of_adhesion) / WORK_OF_ADHESION
    assert last_place(field) > jkr.equilibrium_radius(0.7, max(strongest, 1.0))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("count", [1, 64])
def test_a_tile_that_is_not_finite_is_refused_with_its_place_before_its_contact_is_sized(
    value, count
):
    values = np.full((8, 8), WORK_OF_ADHESION)
    values.flat[-count:] = value
    row, column = np.unravel_index(64 - count, (8, 8))
    more_values = r" \(64 values are not finite\)" if count > 1 else ""
    with pytest.raises(
        ValueError, match=rf"{value} at x index {row}, y index {column}{more_values}; "
    ):
        contact_field(AdhesionMap(values, 0.1, 0.0, 0.0), 0.5)


def test_a_given_tile_is_resolved_by_its_pixels(adhesion):
    field = contact_field(adhesion, 1.0)
    assert (field.cubic, field.spacing) == (True, adhesion.pixel / 2)
    straight = contact_field(adhesion, 1.0, interpolation="linear")
    assert (straight.cubic, straight.spacing) == (False, adhesion.pixel / 4)
    assert field.geometry.n_site >= 2 * np.pi * jkr.equilibrium_radius(1.0) / adhesion.pixel
    chosen = contact_field(adhesion, 1.0, n_site=12, spacing=adhesion.pixel / 3)
    assert (chosen.geometry.n_site, chosen.spacing) == (12, adhesion.pixel / 3)
