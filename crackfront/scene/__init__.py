"""One simulation of a sweep: from its parameters to its surface, its field and its cycle."""

from crackfront.scene.contact import (
    contact_field,
    simulation_adhesion,
    simulation_field,
    tile_contact,
)
from crackfront.scene.parameters import (
    FieldKind,
    Numerics,
    Resolution,
    Simulation,
    correlation_length,
    resolution,
)
from crackfront.scene.run import (
    PartialRun,
    SimulationResult,
    compile_solver,
    run_simulation,
)

__all__ = [
    "FieldKind",
    "Numerics",
    "PartialRun",
    "Resolution",
    "Simulation",
    "SimulationResult",
    "compile_solver",
    "contact_field",
    "correlation_length",
    "resolution",
    "run_simulation",
    "simulation_adhesion",
    "simulation_field",
    "tile_contact",
]
