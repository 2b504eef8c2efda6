"""
Rough or chemically heterogeneous
=================================

A flat surface whose work of adhesion varies pins the front like a rough one of the same rms. It
lacks the energy of full conformity, so that both branches lie around the intrinsic work of
adhesion.
"""

import xarray as xr
from matplotlib import pyplot

import crackfront as cf

figure, panels = pyplot.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
loops = {}
for kind, axes in zip(("roughness", "chemical"), panels, strict=True):
    surface = cf.random_surface(0.1, 0.04, kind=kind, seed=5)
    loops[kind] = cf.run_loop(surface, max_penetration=1.5)
    cf.plot_loop(loops[kind], axes)
    axes.set_title(kind)

# %%
names = ["w_rms", "w_appr", "w_retr", "hysteresis"]
xr.concat([loop[names] for loop in loops.values()], dim="kind").assign_coords(kind=list(loops))
