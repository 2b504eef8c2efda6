"""Adhesion hysteresis of rough spheres by crack-front pinning.

>>> import crackfront as cf
>>> surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
>>> loop = cf.run_loop(surface, step=0.25)
>>> axes = cf.plot_loop(loop)
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crackfront.core.spectrum import SelfAffineSpectrum as SelfAffineSpectrum
    from crackfront.core.units import Scales as Scales
    from crackfront.data.version import __version__ as __version__
    from crackfront.plots.library import plot_fronts as plot_fronts
    from crackfront.plots.library import plot_instabilities as plot_instabilities
    from crackfront.plots.library import plot_loop as plot_loop
    from crackfront.plots.library import plot_spectrum as plot_spectrum
    from crackfront.plots.library import plot_surface as plot_surface
    from crackfront.simulate.loops import find_instabilities as find_instabilities
    from crackfront.simulate.loops import run_loop as run_loop
    from crackfront.simulate.si_units import in_reduced_units as in_reduced_units
    from crackfront.simulate.si_units import in_si_units as in_si_units
    from crackfront.simulate.surfaces import random_surface as random_surface

_HOMES = {
    "core.spectrum": ("SelfAffineSpectrum",),
    "core.units": ("Scales",),
    "data.version": ("__version__",),
    "plots.library": (
        "plot_fronts",
        "plot_instabilities",
        "plot_loop",
        "plot_spectrum",
        "plot_surface",
    ),
    "simulate.loops": ("find_instabilities", "run_loop"),
    "simulate.si_units": ("in_reduced_units", "in_si_units"),
    "simulate.surfaces": ("random_surface",),
}
"""Where the parts of the library stand."""

__all__ = sorted(name for names in _HOMES.values() for name in names)

if not TYPE_CHECKING:
    # Every rank and every `--help` imports the package; xarray alone costs a second.
    def __getattr__(name: str) -> object:
        """A part of the library, imported when it is first used."""
        for home, names in _HOMES.items():
            if name in names:
                return getattr(importlib.import_module(f"crackfront.{home}"), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names that the package offers."""
    return [*globals(), *__all__]
