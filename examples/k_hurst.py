"""
How k depends on the Hurst exponent
===================================

The figure of the worked study in :doc:`/sweeps`. The table is ``hysteresis.nc`` of ``make
SWEEP=config/hurst.yaml``, as stored in ``docs/reference/hurst.nc``. The lines are the law of k,
which was not fitted to these simulations.
"""

import sys
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import pyplot
from scipy import stats

from crackfront import SelfAffineSpectrum
from crackfront.analysis.law_spheres import sphere_factors

table = xr.open_dataset(Path(sys.argv[0]).parents[1] / "docs/reference/hurst.nc")
table

# %%
# Every simulation gives a k. The interval of a mean over realisations is Student's t.

k = table.hysteresis / (2 * table.e_el)
mean = k.mean("realisation")
n = table.sizes["realisation"]
half_width = k.std("realisation", ddof=1) * stats.t.ppf(0.975, n - 1) / np.sqrt(n)

# %%
# The law needs the spectrum, e_el and the radius of the contact, here the middle of the window
# over which both branches are averaged. Points of one H are shifted sideways, so that no bar hides
# another.

radius = ((table.lowest_radius + table.highest_radius) / 2).mean(["spectrum", "realisation"])
hurst = np.linspace(0.1, 0.9, 17)
spectra = [SelfAffineSpectrum(short_cutoff=0.0025, roll_off=0.04, hurst=h) for h in hurst]
count = table.sizes["amplitude"]
shades = pyplot.get_cmap("viridis")(np.linspace(0, 0.85, count))
shifts = 0.012 * (np.arange(count) - (count - 1) / 2)

figure, axes = pyplot.subplots(layout="constrained", figsize=(6, 4), dpi=150)
for energy, colour, shift in zip(table.amplitude.values, shades, shifts, strict=True):
    contact = float(radius.sel(amplitude=energy))
    law = [sphere_factors("roughness", item, energy, contact).both.value for item in spectra]
    axes.plot(hurst, law, color=colour, linewidth=1)
    points, bars = mean.sel(amplitude=energy), half_width.sel(amplitude=energy)
    label = rf"$e_\mathrm{{el}} = {energy:g}\,w_\mathrm{{int}}$"
    axes.errorbar(table.hurst + shift, points, bars, fmt="o", color=colour, capsize=3, label=label)
axes.plot([], [], color="0.4", linewidth=1, label="law of $k$")
axes.set_xlabel("Hurst exponent $H$")
axes.set_ylabel(r"$k = (w_\mathrm{retr} - w_\mathrm{appr})\,/\,2 e_\mathrm{el}$")
legend = axes.legend()
