"""Forces of the front's model on edges."""

from types import SimpleNamespace

import numpy as np
import pytest

from studies.boundary_elements.edges import edge_forces


def test_forces_balance_on_edges_of_the_front_and_not_on_those_that_are_twice_as_rough(case, front):
    mean, load = np.mean(front.radius, axis=1, keepdims=True), front.states.penetration
    balance, twice = (
        edge_forces(case, SimpleNamespace(radius=radius, penetration=load), front)
        for radius in (front.radius, 2 * front.radius - mean)
    )
    assert balance.left < 0.12 * balance.pinning
    assert balance.share == pytest.approx(1, abs=0.03)
    np.testing.assert_allclose(balance.needed, balance.line, atol=0.05 * np.ptp(balance.line))
    assert twice.slope == pytest.approx(2 * balance.slope, rel=0.1)
    assert twice.share < 0.7
