"""
Hysteresis against roughness
============================

The same surface, scaled to several amplitudes. The line is what the paper finds for fine roughness,
2 k e_el with k = 3. Roughness as coarse as this one causes less hysteresis, and almost none where
it is so weak that the front follows the load without jumps. A sweep over realisations,
``crackfront simulate``, averages over surfaces and gives k an interval.
"""

import numpy as np
import xarray as xr
from matplotlib import pyplot

import crackfront as cf

cutoff = 0.08
loops = [
    cf.run_loop(cf.random_surface(cutoff, energy, seed=2), max_penetration=1.5, fronts=False)
    for energy in (0.005, 0.01, 0.02, 0.04, 0.08, 0.15)
]
names = ["e_el", "hysteresis", "w_appr_error", "w_retr_error"]
table = xr.concat([loop[names] for loop in loops], dim="amplitude")
table

# %%
# Bars are standard errors; those that reach zero end at the lower edge of the logarithmic axis.

figure, axes = pyplot.subplots(layout="constrained")
error = np.hypot(table.w_appr_error, table.w_retr_error)
axes.errorbar(table.e_el, table.hysteresis, yerr=error, fmt="o", label="one surface")
axes.plot(table.e_el, 6 * table.e_el, "k--", label="$2k\\,e_\\mathrm{el}$ with $k = 3$ (paper)")
axes.set_xscale("log")
axes.set_yscale("log")
axes.set_xlabel(r"$e_\mathrm{el}$ / $w_\mathrm{int}$")
axes.set_ylabel(r"$(w_\mathrm{retr} - w_\mathrm{appr})$ / $w_\mathrm{int}$")
legend = axes.legend()
