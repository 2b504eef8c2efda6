"""What tests of figures share: bootstraps of few draws, where their number is not tested."""

from unittest import mock

import pytest


@pytest.fixture(scope="module")
def _few_draws():
    """Intervals of power laws from fewer draws, which scatter by a tenth to a fifth."""
    with mock.patch.multiple("studies.paper.power_law", _N_BOOTSTRAP=50, _N_JOINT_BOOTSTRAP=15):
        yield
