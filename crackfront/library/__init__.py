"""What `import crackfront` offers: make a surface, run a cycle, plot it.

Pure functions, xarray objects in and out. All of these are attributes of the package itself,
which imports them when they are first used.
"""

from crackfront.dataset import in_reduced_units, in_si_units
from crackfront.library.drawing import (
    plot_fronts,
    plot_instabilities,
    plot_loop,
    plot_spectrum,
    plot_surface,
)
from crackfront.library.loops import find_instabilities, run_loop
from crackfront.library.surfaces import random_surface
from crackfront.spectrum import SelfAffineSpectrum
from crackfront.units import Scales

__all__ = [
    "Scales",
    "SelfAffineSpectrum",
    "find_instabilities",
    "in_reduced_units",
    "in_si_units",
    "plot_fronts",
    "plot_instabilities",
    "plot_loop",
    "plot_spectrum",
    "plot_surface",
    "random_surface",
    "run_loop",
]
