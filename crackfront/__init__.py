"""Adhesion hysteresis of rough spheres by crack-front pinning.

>>> import crackfront as cf
>>> surface = cf.random_surface(short_cutoff=0.4, elastic_energy=0.02, side=4, seed=1)
>>> loop = cf.run_loop(surface, step=0.25)
>>> axes = cf.plot_loop(loop)
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
