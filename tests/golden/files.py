"""The two golden files: where they are, whose version they have, and how they are computed."""

from dataclasses import replace
from pathlib import Path

from crackfront.core.solver.relax import Newton
from crackfront.core.versions import PHYSICS_VERSION, ROWS_VERSION
from tests.golden.closed_forms import CLOSED_FORMS
from tests.golden.fronts import FRONTS, TIGHT, forces_and_energies
from tests.golden.golden import Golden, Scenes, read_golden, renewed
from tests.golden.rows import completed, rows_and_fits

FOLDER = Path(__file__).parent
PHYSICS, ROWS = FOLDER / "physics.json", FOLDER / "rows.json"

FORCES = "forces and energies"
"""Name of the scene of given fronts."""


def physics() -> Scenes:
    """All scenes of the physics."""
    scenes = {name: compute() for name, compute in CLOSED_FORMS.items()}
    scenes[FORCES] = forces_and_energies()
    return scenes | {name: solve(Newton(TIGHT)) for name, solve in FRONTS.items()}


def renewed_files() -> dict[Path, Golden]:
    """Both files as they are to be written; NotRaisedError as :func:`renewed` says."""
    states, rows = read_golden(PHYSICS), read_golden(ROWS)
    rows = replace(rows, given=completed(rows.given))
    return {
        PHYSICS: renewed(states, PHYSICS_VERSION, physics(), "PHYSICS_VERSION"),
        ROWS: renewed(rows, ROWS_VERSION, rows_and_fits(rows.given), "ROWS_VERSION"),
    }
