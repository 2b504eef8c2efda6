"""What every test shares: floating-point errors raise, random numbers are seeded."""

import os
from collections.abc import Iterator

import hypothesis
import numpy as np
import pytest

SEED = 20240229

hypothesis.settings.register_profile("local", deadline=None)
hypothesis.settings.register_profile("reproducible", deadline=None, derandomize=True)
hypothesis.settings.load_profile("reproducible" if os.environ.get("CI") else "local")


@pytest.fixture(autouse=True)
def _floating_point_errors_raise() -> Iterator[None]:
    before = np.seterr(all="raise", under="ignore")
    yield
    np.seterr(**before)


@pytest.fixture
def rng() -> np.random.Generator:
    """A generator that starts equal in every test."""
    return np.random.default_rng(np.random.SeedSequence(SEED))
