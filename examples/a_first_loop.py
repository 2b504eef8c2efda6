"""
A loop in five lines
====================

A rough sphere approaches an elastic half-space and is pulled off again. The edge of the contact is
pinned by the roughness, so that the force is lower, the contact stickier, on the way back.
"""

import crackfront as cf

surface = cf.random_surface(short_cutoff=0.05, elastic_energy=0.05, seed=1)
loop = cf.run_loop(surface)
axes = cf.plot_loop(loop)

# %%
# The surface is an :class:`xarray.DataArray` of heights in reduced units. Its energy of full
# conformity is 5% of the work of adhesion.

surface

# %%
# The loop is an :class:`xarray.Dataset`. It holds the curves, the fronts and, as averages over the
# steady parts of both branches, the apparent works of adhesion.

loop

# %%
# Without roughness they would both be 1 (in units of the intrinsic work of adhesion). They come
# with their statistical errors, those of one surface, and with what the numerics leave.

loop[["w_appr", "w_retr", "hysteresis", "w_retr_error", "w_retr_numerical_error"]]

# %%
# The fronts lie over the work of adhesion that is equivalent to the roughness.

axes = cf.plot_fronts(loop, surface)
