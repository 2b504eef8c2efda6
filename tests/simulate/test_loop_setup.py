"""Runs on a user's surface: what they refuse, and what their results say of themselves."""

import numpy as np
import pytest

import crackfront as cf


@pytest.fixture(scope="module")
def patches():
    """A chemical surface of side 2 with one wave along the front and four along its motion."""
    x, y = np.meshgrid(np.arange(32) / 32, np.arange(32) / 32, indexing="ij")
    values = 1 + 0.4 * np.cos(8 * np.pi * x) * np.cos(2 * np.pi * y)
    return cf.surface(values, side=2.0, kind="chemical", units="w_int")


def pulled(surface, spring):
    """Loop of a straight front over four periods of the surface, and back."""
    return cf.run_loop(cf.straight_front(surface, spring), loads=[0, 8, 0], step=0.1)


def test_a_front_shorter_than_ten_springs_says_that_its_hysteresis_is_too_large(patches):
    long, short = pulled(patches, 0.2), pulled(patches, 0.5)
    assert np.isfinite(long.hysteresis)
    assert "L_kappa" not in long.attrs["result"]
    sentence = "the front is 4 L_kappa long, below the 10 of the law of k: its hysteresis is too"
    assert sentence in short.attrs["result"]


def test_a_front_shorter_than_its_springs_is_refused(patches):
    with pytest.raises(ValueError, match=r"spring is 2\.5, longer than the front, 2, which is"):
        pulled(patches, 2.5)
