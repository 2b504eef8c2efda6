"""Scans and surfaces that several tests use."""

import pytest

from crackfront.measured.prediction.prediction import predicted
from tests.measured.made import (
    DETAIL,
    OVERVIEW,
    SCENE,
    draw_little,
    map_heights,
    shipped_surface,
    write_al3d,
)


@pytest.fixture
def noise(rng):
    """Heights without correlation, of a small map."""
    return 1e-7 * rng.standard_normal((48, 48))


@pytest.fixture
def heights(rng):
    """Heights of a map."""
    return map_heights(rng)


@pytest.fixture
def scan(tmp_path, heights):
    """File of these heights."""
    return write_al3d(tmp_path / "scan.al3d", heights)


@pytest.fixture(scope="session")
def surface():
    """Surface of the scans that are shipped."""
    return shipped_surface(DETAIL, OVERVIEW)


@pytest.fixture(scope="session")
def prediction(surface):
    """Its prediction."""
    return predicted(surface, SCENE)


@pytest.fixture
def few_draws(monkeypatch):
    """One small batch of draws."""
    draw_little(monkeypatch)
