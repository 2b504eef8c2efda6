"""A small rough sphere, and configurations that run in seconds."""

from dataclasses import replace
from pathlib import Path

import pytest

from studies.boundary_elements.cases import Loads
from studies.boundary_elements.front import front_cycle
from studies.boundary_elements.parameters import load_validation, validation_cases

LOOPS = """
seed: 5
short_cutoff: 0.6
side: 5.12
tolerance: 1.0e-4
loads: {max_penetration: 0.45, step: 0.15, shown_penetration: 0.3}
front: {n_angle: 64, spacing: 0.05}
cases:
  - {n_point: 48, interaction_range: 0.70, elastic_energies: [0, 0.02]}
"""

BRANCHES = """
seed: 5
short_cutoff: 0.6
side: 5.12
tolerance: 1.0e-4
loads:
  max_penetration: 0.6
  step: 0.1
  shown_penetration: 0.2
  steady: {first: 0.2, last: 0.4, turned: 0.3, end: 0.1}
front: {n_angle: 64, spacing: 0.05}
cases:
  - {n_point: 64, interaction_range: 0.61, elastic_energies: [0.4], surfaces: 1}
  - {n_point: 48, interaction_range: 0.70, elastic_energies: [0, 0.4], surfaces: 2}
  - {n_point: 48, interaction_range: 0.70, elastic_energies: [0.4], roll_off: 0.9, hurst: 0.8,
     surfaces: 2}
"""


def written(factory: pytest.TempPathFactory, text: str) -> Path:
    path = factory.mktemp("validation") / "tiny.yaml"
    path.write_text(text)
    return path


@pytest.fixture(scope="session")
def loops(tmp_path_factory):
    """Configuration of whole loops."""
    return written(tmp_path_factory, LOOPS)


@pytest.fixture(scope="session")
def branches(tmp_path_factory):
    """Configuration of the steady parts of both branches."""
    return written(tmp_path_factory, BRANCHES)


@pytest.fixture(scope="session")
def smooth_case(loops):
    return validation_cases(load_validation(loops))[0]


@pytest.fixture(scope="session")
def case(loops):
    """A rough sphere over a whole loop."""
    return validation_cases(load_validation(loops))[1]


@pytest.fixture(scope="session")
def front(case):
    return front_cycle(case, 64, 0.05)


@pytest.fixture(scope="session")
def small(case):
    """A rough sphere whose loop takes a dozen load steps."""
    loads = Loads(max_penetration=0.3, step=0.15, shown_penetration=0.15)
    shape = {"short_cutoff": 0.4, "roll_off": 0.4, "elastic_energy": 0.03}
    return replace(case, n_point=64, interaction_range=0.61, loads=loads, **shape)
