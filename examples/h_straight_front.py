"""
A straight front
================

What the edge of a sphere is locally: a front that springs pull over a rough tile, and back. After a
period of the tile all repeats, so that w_appr and w_retr are those of the tile. The front, 4 long,
has ten times the length of its springs, as those by which the law of k was measured.
``crackfront cycle --field surface.nc --spring 0.4 --loads 0,6,0 --step 0.05`` does the same.
"""

import crackfront as cf

surface = cf.random_surface(short_cutoff=0.1, elastic_energy=0.05, side=4, error=0.1, seed=1)
loop = cf.run_loop(cf.straight_front(surface, spring=0.4), loads=[0, 6, 0], step=0.05)
print(loop.attrs["result"])
axes = cf.plot_loop(loop)
