"""Measures of a tile from its modes."""

import numpy as np
import pytest

from crackfront.surfaces.tile_measures import tile_modes


@pytest.mark.parametrize("shape", [(8, 8), (9, 7), (8, 7)])
def test_the_modes_of_a_tile_have_its_variance(rng, shape):
    values = rng.standard_normal(shape)
    assert np.sum(tile_modes(values, 0.5).power) == pytest.approx(np.var(values), rel=1e-9)
