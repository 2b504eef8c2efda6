"""
The jumps of a retraction
=========================

The contact line moves smoothly and in jumps. Every patch is what one elastic instability has swept,
its colour the energy that it dissipated: this is where the hysteresis comes from.
"""

import numpy as np

import crackfront as cf

surface = cf.random_surface(short_cutoff=0.1, elastic_energy=0.05, error=0.1, seed=7)
jumps = cf.find_instabilities(surface, error=0.1)
axes = cf.plot_instabilities(jumps)

# %%
# Load steps were halved until the front either moved smoothly or jumped at every size of the step.

jumps

# %%
# Over the retraction the jumps dissipate nearly all of the work that is not stored.

loop = cf.run_loop(surface, error=0.1, energy=True, step=0.004, fronts=False)
retraction = loop.dissipated_energy.where(loop.direction < 0).sum()
float(np.round(jumps.dissipated_energy.sum() / retraction, 3))
