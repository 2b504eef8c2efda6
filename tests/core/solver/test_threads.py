"""Several threads on one front: the same bits, and filters in parts."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from crackfront.cli import main
from crackfront.core.field.fields import polar_field
from crackfront.core.geometry.sphere import sphere
from crackfront.core.solver import threads
from crackfront.core.solver.filters import (
    ROWS,
    apply_filter,
    make_filter,
    make_transform,
    set_filter,
)
from crackfront.core.solver.forces import line_force
from crackfront.core.solver.relax import Newton, Reference, relax
from crackfront.core.solver.team import LARGE, MOST, make_team


@pytest.fixture
def given_back():
    """One thread again at the end, whatever a test asks for."""
    give = threads.set_threads
    yield
    give(1)


@pytest.mark.parametrize("kind", [np.complex128, np.complex64])
@pytest.mark.parametrize("count", [4, 16, 17, 30, 101, LARGE + 2, LARGE + 8])
def test_a_filter_is_what_it_does_to_every_mode(count, kind):
    geometry, like = sphere(count), np.empty(0, kind)
    digit = float(np.finfo(kind).eps)
    front = np.random.default_rng(count).standard_normal(count).astype(like.real.dtype)
    team, transform, found = make_team(count), make_transform(count, like), np.empty_like(front)
    filtering = make_filter(transform)
    set_filter(team, transform, filtering, geometry, 0.0, False)
    product = apply_filter(team, transform, filtering, front, found)
    expected = line_force(geometry, front.astype(float))
    scale = np.max(np.abs(expected))
    assert np.allclose(found, expected, rtol=0, atol=400 * digit * scale)
    assert product == pytest.approx(front @ expected, rel=4000 * digit)
    set_filter(team, transform, filtering, geometry, 1.0, True)
    apply_filter(team, transform, filtering, (expected + front).astype(front.dtype), found)
    assert np.allclose(found, front, rtol=0, atol=4000 * digit)


def test_large_fronts_alone_are_transformed_in_parts():
    like = np.empty(0, np.complex64)
    sizes = (LARGE - 8, LARGE, LARGE + 2)
    assert [len(make_transform(count, like).sine) for count in sizes] == [1, ROWS, 1]


@pytest.fixture(scope="module")
def field():
    """Rays of a large contact, of patches of 64 sites."""
    patches = np.repeat(np.random.default_rng(5).standard_normal((40, LARGE // 64)), 64, axis=1)
    return polar_field(np.linspace(0.2, 2.6, 40), (1 + 0.5 * patches) / np.pi, "cubic")


def cycle_of_a_large_front(field, solver):
    """Fronts of a large contact with windows, steps of the whole front, and loss of contact."""
    front, fronts = np.full(LARGE, 1.2), []
    for load, direction in ((0.0, 1), (-0.1, -1), (-3.0, -1)):
        found = relax(front, load, direction, field, solver)
        front = found.front
        fronts.append((found.status, found.sweeps, found.updates, found.residual, front.tobytes()))
    return fronts


def test_one_two_and_eight_threads_find_the_same_bits(field, given_back):
    found = []
    for number in (1, 2, 8):
        threads.set_threads(number)
        found.append(cycle_of_a_large_front(field, Newton(1e-6)))
    assert found[0] == found[1] == found[2]


@pytest.mark.slow
def test_threads_find_the_fronts_of_the_reference(field, given_back):
    threads.set_threads(2)
    expected = cycle_of_a_large_front(field, Reference(1e-6))
    for one, other in zip(cycle_of_a_large_front(field, Newton(1e-6)), expected, strict=True):
        assert one[0] is other[0]
        if one[0].value.startswith("converged"):
            difference = np.frombuffer(one[-1]) - np.frombuffer(other[-1])
            assert np.max(np.abs(difference)) < 1e-4


@pytest.mark.parametrize("number", [0, -1, MOST + 1])
def test_a_number_of_threads_that_cannot_be_is_refused(number):
    with pytest.raises(ValueError, match=f"number of threads is {number}; give one from 1 to 16"):
        threads.set_threads(number)


def test_simulate_gives_its_threads_to_the_solver(tmp_path, monkeypatch, given_back):
    given = []
    monkeypatch.setattr(threads, "set_threads", given.append)
    configuration = Path(__file__).parents[3] / "config/test.yaml"
    options = [str(configuration), "--spectrum", "rough", "--output", str(tmp_path / "out")]
    assert CliRunner().invoke(main, ["simulate", *options, "--threads", "3"]).exit_code == 0
    assert given == [3]
    refused = CliRunner().invoke(main, ["simulate", *options, "--threads", "17"])
    assert refused.exit_code == 2
    assert "16" in refused.output
