"""The physics of a crack front, on numpy, scipy and numba.

>>> import numpy as np
>>> from crackfront import core
>>> adhesion = core.chemical_adhesion(np.zeros((8, 8)), pixel=0.5)
>>> record = core.run_cycle(core.contact_field(adhesion, 0.5), core.LoadSchedule(0.5, step=0.25))
>>> record.status.name
'LOST_CONTACT'
"""

from typing import TYPE_CHECKING

from crackfront.core.lazy import lazy_names

if TYPE_CHECKING:
    from crackfront.core.adhesion import chemical_adhesion as chemical_adhesion
    from crackfront.core.adhesion import rough_adhesion as rough_adhesion
    from crackfront.core.cycle.follow import Load as Load
    from crackfront.core.cycle.follow import follow as follow
    from crackfront.core.cycle.load_schedule import LoadSchedule as LoadSchedule
    from crackfront.core.cycle.load_schedule import protocol as protocol
    from crackfront.core.cycle.record import Recorder as Recorder
    from crackfront.core.cycle.run import run_cycle as run_cycle
    from crackfront.core.cycle.touch import first_touch as first_touch
    from crackfront.core.geometry.line import line_field as line_field
    from crackfront.core.geometry.sphere import contact_field as contact_field
    from crackfront.core.solver.relax import SOLVERS as SOLVERS
    from crackfront.core.spectrum import SelfAffineSpectrum as SelfAffineSpectrum
    from crackfront.core.synthesis import gaussian_field as gaussian_field

if not TYPE_CHECKING:
    __all__, __getattr__, __dir__ = lazy_names(__name__)
