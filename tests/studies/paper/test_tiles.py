"""Mean squares of surfaces on a tile, beside those of many."""

import numpy as np
import pytest

from crackfront.core.adhesion import half_derivative_mean_square
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.synthesis import gaussian_field
from studies.paper.tile_sizes import tile_mean_square

SHAPES = [SelfAffineSpectrum(0.1, 0.1, 0.8), SelfAffineSpectrum(0.05, 0.25, 0.8)]
LENGTH = 1.0


@pytest.mark.parametrize("order", [0.0, 0.5])
@pytest.mark.parametrize("spectrum", SHAPES)
def test_mean_squares_of_tiles_scatter_around_their_expected_one(spectrum, order):
    squares = []
    for seed in range(100):
        heights = gaussian_field(spectrum, 64, LENGTH, np.random.default_rng(seed))
        measured = half_derivative_mean_square(heights, LENGTH / 64) if order else np.var(heights)
        squares.append(measured)
    expected, deviation = tile_mean_square(spectrum, LENGTH, order)
    assert np.mean(squares) == pytest.approx(expected, abs=4 * deviation / 10)
    assert np.std(squares) == pytest.approx(deviation, rel=0.3)


def test_a_large_tile_has_the_mean_square_of_its_spectrum():
    expected, deviation = tile_mean_square(SHAPES[1], 20.0, 0.5)
    assert expected == pytest.approx(SHAPES[1].mean_square(0.5), rel=1e-3)
    assert deviation < 0.02 * expected
