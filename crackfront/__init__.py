"""Adhesion hysteresis of rough spheres by crack-front pinning.

>>> import crackfront as cf
>>> surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
>>> loop = cf.run_loop(surface, step=0.25)
>>> axes = cf.plot_loop(loop)
"""

from typing import TYPE_CHECKING

from crackfront.core.lazy import lazy_names

if TYPE_CHECKING:
    from crackfront.analysis.law import pinning_factor as pinning_factor
    from crackfront.core.spectrum import SelfAffineSpectrum as SelfAffineSpectrum
    from crackfront.data.provenance import __version__ as __version__
    from crackfront.experiment.library import measured_loop as measured_loop
    from crackfront.plots.library import plot_fronts as plot_fronts
    from crackfront.plots.library import plot_instabilities as plot_instabilities
    from crackfront.plots.library import plot_loop as plot_loop
    from crackfront.plots.library import plot_spectrum as plot_spectrum
    from crackfront.plots.library import plot_surface as plot_surface
    from crackfront.simulate.files import load_result as load_result
    from crackfront.simulate.files import save_result as save_result
    from crackfront.simulate.line.loop import straight_front as straight_front
    from crackfront.simulate.loops import find_instabilities as find_instabilities
    from crackfront.simulate.loops import run_loop as run_loop
    from crackfront.simulate.si_units import Scales as Scales
    from crackfront.simulate.si_units import in_reduced_units as in_reduced_units
    from crackfront.simulate.si_units import in_si_units as in_si_units
    from crackfront.simulate.surfaces import random_surface as random_surface
    from crackfront.simulate.user_surface import surface as surface
    from crackfront.sweep.library import run_sweep as run_sweep
    from crackfront.topography.library import predict as predict
    from crackfront.topography.library import read_psd as read_psd
    from crackfront.topography.library import read_scan as read_scan
    from crackfront.topography.library import self_affine_surface as self_affine_surface
    from crackfront.topography.options import PredictionOptions as PredictionOptions
    from crackfront.topography.options import ReadingOptions as ReadingOptions
    from crackfront.topography.scan.instruments import list_channels as list_channels

if not TYPE_CHECKING:
    __all__, __getattr__, __dir__ = lazy_names(__name__)
