"""Adhesion hysteresis of rough spheres by crack-front pinning.

>>> import crackfront as cf
>>> surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
>>> loop = cf.run_loop(surface, step=0.25)
>>> axes = cf.plot_loop(loop)
"""

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crackfront.library import (
        Scales,
        SelfAffineSpectrum,
        find_instabilities,
        in_reduced_units,
        in_si_units,
        plot_fronts,
        plot_instabilities,
        plot_loop,
        plot_spectrum,
        plot_surface,
        random_surface,
        run_loop,
    )
    from crackfront.version import __version__

__all__ = [
    "Scales",
    "SelfAffineSpectrum",
    "__version__",
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

if not TYPE_CHECKING:
    # Every rank and every `--help` imports the package; xarray alone costs a second.
    def __getattr__(name: str) -> object:
        """The version or a part of the library, imported when it is first used."""
        if name in __all__:
            home = "crackfront.version" if name == "__version__" else "crackfront.library"
            return getattr(importlib.import_module(home), name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names that the package offers."""
    return [*globals(), *__all__]
