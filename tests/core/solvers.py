"""Tests of fronts run with every solver."""

import pytest

from crackfront.core.solver.relax import SOLVERS

every_solver = pytest.mark.parametrize("solver", sorted(SOLVERS))
