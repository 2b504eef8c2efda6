"""
A straight front
================

What the edge of a sphere is locally: a front that springs pull over a rough tile, and back. After a
period of the tile all repeats, so that w_appr and w_retr are those of the tile.
``crackfront cycle --field surface.nc --spring 8 --loads 0,12,0 --step 0.25`` does the same.
"""

import crackfront as cf

surface = cf.random_surface(short_cutoff=0.1, elastic_energy=0.05, side=4, error=0.1, seed=1)
loop = cf.run_loop(cf.straight_front(surface, spring=8), loads=[0, 12, 0], step=0.25)
print(loop.attrs["result"])
axes = cf.plot_loop(loop)
