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
    from crackfront.measured.loops.measured_loop import measured_loop as measured_loop
    from crackfront.measured.options import PredictionOptions as PredictionOptions
    from crackfront.measured.options import ReadingOptions as ReadingOptions
    from crackfront.measured.predict import predict as predict
    from crackfront.measured.predict import read_psd as read_psd
    from crackfront.measured.predict import read_scan as read_scan
    from crackfront.measured.predict import self_affine_surface as self_affine_surface
    from crackfront.measured.scan.instruments import list_channels as list_channels
    from crackfront.plots.figures import plot_fronts as plot_fronts
    from crackfront.plots.figures import plot_instabilities as plot_instabilities
    from crackfront.plots.figures import plot_loop as plot_loop
    from crackfront.plots.figures import plot_spectrum as plot_spectrum
    from crackfront.plots.figures import plot_surface as plot_surface
    from crackfront.simulate.provenance import __version__ as __version__
    from crackfront.surfaces.given_surface import surface as surface
    from crackfront.surfaces.loops import find_instabilities as find_instabilities
    from crackfront.surfaces.loops import run_loop as run_loop
    from crackfront.surfaces.random_surface import random_surface as random_surface
    from crackfront.surfaces.saving import load_result as load_result
    from crackfront.surfaces.saving import save_result as save_result
    from crackfront.surfaces.scales import Scales as Scales
    from crackfront.surfaces.si_units import in_reduced_units as in_reduced_units
    from crackfront.surfaces.si_units import in_si_units as in_si_units
    from crackfront.surfaces.straight_front import straight_front as straight_front
    from crackfront.sweep.run_sweep import run_sweep as run_sweep

if not TYPE_CHECKING:
    __all__, __getattr__, __dir__ = lazy_names(__name__)
