"""What tests of figures share: bootstraps of few draws, where their number is not tested."""

from unittest import mock

import pytest


@pytest.fixture(scope="module")
def _few_draws():
    """Intervals of power laws from fewer draws, which scatter by a seventh to a quarter."""
    with mock.patch.multiple("studies.paper.power_law", _N_BOOTSTRAP=25, _N_JOINT_BOOTSTRAP=8):
        yield
