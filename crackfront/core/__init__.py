"""The physics of a crack front, on numpy, scipy and numba.

>>> import numpy as np
>>> from crackfront import core
>>> adhesion = core.chemical_adhesion(np.zeros((8, 8)), pixel=0.5)
>>> record = core.run_cycle(core.contact_field(adhesion, 0.5), core.LoadSchedule(0.5, step=0.25))
>>> record.status.name
'LOST_CONTACT'
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crackfront.core.adhesion import chemical_adhesion as chemical_adhesion
    from crackfront.core.adhesion import rough_adhesion as rough_adhesion
    from crackfront.core.contact import contact_field as contact_field
    from crackfront.core.cycle.follow import Load as Load
    from crackfront.core.cycle.follow import follow as follow
    from crackfront.core.cycle.record import Recorder as Recorder
    from crackfront.core.cycle.run import run_cycle as run_cycle
    from crackfront.core.cycle.schedule import LoadSchedule as LoadSchedule
    from crackfront.core.cycle.touch import first_touch as first_touch
    from crackfront.core.geometry.line import line_field as line_field
    from crackfront.core.solver.relax import SOLVERS as SOLVERS
    from crackfront.core.spectrum import SelfAffineSpectrum as SelfAffineSpectrum
    from crackfront.core.synthesis import gaussian_field as gaussian_field

_HOMES = {
    "SOLVERS": "solver.relax",
    "Load": "cycle.follow",
    "LoadSchedule": "cycle.schedule",
    "Recorder": "cycle.record",
    "SelfAffineSpectrum": "spectrum",
    "chemical_adhesion": "adhesion",
    "contact_field": "contact",
    "first_touch": "cycle.touch",
    "follow": "cycle.follow",
    "gaussian_field": "synthesis",
    "line_field": "geometry.line",
    "rough_adhesion": "adhesion",
    "run_cycle": "cycle.run",
}
"""Modules of the names that core offers."""

__all__ = sorted(_HOMES)

if not TYPE_CHECKING:
    # numba takes half a second to import, and most of the package does without.
    def __getattr__(name: str) -> object:
        """Something that core offers, imported when it is first used."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"crackfront.core.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """Names that core offers."""
    return [*globals(), *__all__]
