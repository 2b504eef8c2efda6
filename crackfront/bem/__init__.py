"""The same rough sphere by boundary elements, to validate the crack-front model.

The libraries that it needs (the extra `bem`) are imported where a contact is made, so that nothing
else of the package depends on them.
"""

from crackfront.bem.comparison import Comparison, comparison, shared_jumps
from crackfront.bem.contact import HalfSpaceContact, half_space_contact
from crackfront.bem.cycle import RUNNING, BoundaryCycle, boundary_cycle, contact_loads
from crackfront.bem.front import FrontCycle, force_error, front_cycle, shared_states
from crackfront.bem.jumps import Jump, jumps, matched_jumps
from crackfront.bem.minimise import Equilibrium, equilibrium
from crackfront.bem.parameters import Case, ValidationParameters, validation_cases
from crackfront.bem.perimeter import perimeter
from crackfront.bem.picture import ValidationPicture, validation_picture
from crackfront.bem.report import validation_report
from crackfront.bem.study import Validation, refuse_missing_libraries, validation
from crackfront.bem.trends import (
    RotationEffect,
    Speed,
    extrapolated,
    rotation_effects,
    speed,
)

__all__ = [
    "RUNNING",
    "BoundaryCycle",
    "Case",
    "Comparison",
    "Equilibrium",
    "FrontCycle",
    "HalfSpaceContact",
    "Jump",
    "RotationEffect",
    "Speed",
    "Validation",
    "ValidationParameters",
    "ValidationPicture",
    "boundary_cycle",
    "comparison",
    "contact_loads",
    "equilibrium",
    "extrapolated",
    "force_error",
    "front_cycle",
    "half_space_contact",
    "jumps",
    "matched_jumps",
    "perimeter",
    "refuse_missing_libraries",
    "rotation_effects",
    "shared_jumps",
    "shared_states",
    "speed",
    "validation",
    "validation_cases",
    "validation_picture",
    "validation_report",
]
