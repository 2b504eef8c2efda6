"""What is taken off the heights of a scan."""

import numpy as np

from crackfront.measured.scan.levelling import levelled


def test_levelling_by_order_takes_such_a_polynomial_off(rng):
    x, y = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 30), indexing="ij")
    rough = 1e-3 * rng.standard_normal(x.shape)
    everywhere = np.ones(x.shape, dtype=bool)
    trend = 2 + x - 3 * y + x * y**2 + 4 * x**3
    third = levelled(rough + trend, everywhere, 3)
    np.testing.assert_allclose(third, levelled(rough, everywhere, 3), atol=1e-12)
    assert np.std(levelled(rough + trend, everywhere, 2)) > 0.1
    for name, order in (("center", 0), ("height", 1), ("curvature", 2)):
        np.testing.assert_array_equal(
            levelled(rough + trend, everywhere, name), levelled(rough + trend, everywhere, order)
        )
