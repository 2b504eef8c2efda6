import numpy as np
import pytest

from crackfront.core.geometry.sphere import polar_field, sphere
from crackfront.core.outcome import Status
from crackfront.core.solver.filters import apply_filter, make_filter, set_inverse, set_stiffness
from crackfront.core.solver.forces import line_force
from crackfront.core.solver.relax import Newton, Reference, relax


@pytest.mark.parametrize("kind", [np.complex128, np.complex64])
@pytest.mark.parametrize("count", [4, 16, 17, 30, 101, 16385, 16386, 16392])
def test_a_filter_is_what_it_does_to_every_mode(count, kind):
    geometry, like = sphere(count), np.empty(0, kind)
    digit = float(np.finfo(kind).eps)
    front = np.random.default_rng(count).standard_normal(count).astype(like.real.dtype)
    filtered, filtering = np.empty_like(front), make_filter(count, like)
    set_stiffness(filtering, geometry)
    product = apply_filter(filtering, front, filtered)
    expected = line_force(geometry, front.astype(float))
    scale = np.max(np.abs(expected))
    assert np.allclose(filtered, expected, rtol=0, atol=400 * digit * scale)
    assert product == pytest.approx(front @ expected, rel=4000 * digit)
    set_inverse(filtering, geometry, 1.0)
    apply_filter(filtering, (expected + front).astype(front.dtype), filtered)
    assert np.allclose(filtered, front, rtol=0, atol=4000 * digit)


@pytest.mark.slow
def test_a_large_front_of_an_odd_number_of_sites_comes_to_rest():
    patches = np.repeat(np.random.default_rng(5).standard_normal((40, 257)), 64, axis=1)
    adhesion = (1 + 0.5 * patches[:, :16385]) / np.pi
    field = polar_field(np.linspace(0.2, 2.6, 40), adhesion, "cubic")
    front = np.full(16385, 1.2)
    for load, direction in ((0.0, 1), (-0.1, -1)):
        outcome = relax(front, load, direction, field, Newton(1e-6))
        assert outcome.status is Status.CONVERGED
        assert np.max(np.abs(outcome.front - front)) > 0.01
        # By the forces of the reference.
        again = relax(outcome.front, load, direction, field, Reference(1.1e-6))
        assert (again.status, again.sweeps) == (Status.CONVERGED, 1)
        front = outcome.front
