"""Adhesion hysteresis of rough spheres by crack-front pinning.

>>> import crackfront as cf
>>> surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
>>> loop = cf.run_loop(surface, step=0.25)
>>> axes = cf.plot_loop(loop)
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crackfront.analysis.law import pinning_factor as pinning_factor
    from crackfront.core.spectrum import SelfAffineSpectrum as SelfAffineSpectrum
    from crackfront.data.provenance import __version__ as __version__
    from crackfront.plots.library import plot_fronts as plot_fronts
    from crackfront.plots.library import plot_instabilities as plot_instabilities
    from crackfront.plots.library import plot_loop as plot_loop
    from crackfront.plots.library import plot_spectrum as plot_spectrum
    from crackfront.plots.library import plot_surface as plot_surface
    from crackfront.simulate.files import load_result as load_result
    from crackfront.simulate.files import save_result as save_result
    from crackfront.simulate.loops import find_instabilities as find_instabilities
    from crackfront.simulate.loops import run_loop as run_loop
    from crackfront.simulate.si_units import Scales as Scales
    from crackfront.simulate.si_units import in_reduced_units as in_reduced_units
    from crackfront.simulate.si_units import in_si_units as in_si_units
    from crackfront.simulate.surfaces import random_surface as random_surface
    from crackfront.sweep.library import sweep as sweep
    from crackfront.topography.library import predict as predict
    from crackfront.topography.library import read_scan as read_scan

_HOMES = {
    "pinning_factor": "analysis.law",
    "SelfAffineSpectrum": "core.spectrum",
    "__version__": "data.provenance",
    "plot_fronts": "plots.library",
    "plot_instabilities": "plots.library",
    "plot_loop": "plots.library",
    "plot_spectrum": "plots.library",
    "plot_surface": "plots.library",
    "load_result": "simulate.files",
    "save_result": "simulate.files",
    "find_instabilities": "simulate.loops",
    "run_loop": "simulate.loops",
    "Scales": "simulate.si_units",
    "in_reduced_units": "simulate.si_units",
    "in_si_units": "simulate.si_units",
    "random_surface": "simulate.surfaces",
    "sweep": "sweep.library",
    "predict": "topography.library",
    "read_scan": "topography.library",
}
"""Where the parts of the library stand."""

__all__ = sorted(_HOMES)

if not TYPE_CHECKING:
    # Every rank and every `--help` imports the package; xarray alone costs a second.
    def __getattr__(name: str) -> object:
        """A part of the library, imported when it is first used."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"crackfront.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """Names that the package offers."""
    return [*globals(), *__all__]
