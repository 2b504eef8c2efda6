"""
A field and loads of one's own
==============================

Patches of weaker and stronger adhesion on a flat surface, pressed, relieved half-way, pressed
again, and pulled off. ``cf.save_result(surface, "patches.nc")`` makes the file that
``crackfront cycle --field patches.nc --loads 0,1,0.3,1,-2 --step 0.05`` runs the same loop on.
"""

import numpy as np

import crackfront as cf

wave = np.cos(2 * np.pi * 12 * np.arange(96) / 96)
surface = cf.surface(1 + 0.8 * np.outer(wave, wave), side=4, kind="chemical", units="w_int")
loop = cf.run_loop(surface, loads=[0, 1, 0.3, 1, -2], step=0.05)
print(loop.attrs["result"])
axes = cf.plot_loop(loop)
