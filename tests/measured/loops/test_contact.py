"""JKR relations between radius, force and penetration."""

import numpy as np
import pytest

from crackfront.measured.loops.contact_relations import penetration_at, radius_at


def test_edges_of_all_kinds_have_the_radius_of_their_force_and_penetration():
    radius = np.linspace(0.3, 2.5, 60)
    for work in (0.01, 1.0, 2.0):
        force = radius**3 - np.sqrt(6 * work * radius**3)
        assert radius_at(force, penetration_at(radius, force)) == pytest.approx(radius, rel=1e-6)
