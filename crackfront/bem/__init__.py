"""The same rough sphere by boundary elements, to validate the crack-front model.

The libraries that it needs (the extra `bem`) are imported where a contact is made, so that nothing
else of the package depends on them.
"""

from crackfront.bem.contact import HalfSpaceContact, half_space_contact
from crackfront.bem.cycle import RUNNING, BoundaryCycle, boundary_cycle, contact_loads
from crackfront.bem.minimise import Equilibrium, equilibrium
from crackfront.bem.parameters import Case, ValidationParameters, validation_cases
from crackfront.bem.perimeter import perimeter

__all__ = [
    "RUNNING",
    "BoundaryCycle",
    "Case",
    "Equilibrium",
    "HalfSpaceContact",
    "ValidationParameters",
    "boundary_cycle",
    "contact_loads",
    "equilibrium",
    "half_space_contact",
    "perimeter",
    "validation_cases",
]
