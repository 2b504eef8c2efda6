"""The physics of a crack front, on numpy, scipy and numba.

>>> import numpy as np
>>> from crackfront import core
>>> adhesion = core.chemical_adhesion(np.zeros((8, 8)), pixel=0.5)
>>> record = core.run_cycle(core.contact_field(adhesion, 0.5), core.LoadSchedule(0.5, step=0.25))
>>> record.status.name
'LOST_CONTACT'
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
