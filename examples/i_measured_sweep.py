"""
A sweep of a measured surface
=============================

Surfaces of the spectrum of a scan, at its own heights and at 70% of them. The configuration
``film.yaml`` names the scan beside it; ``crackfront simulate film.yaml`` and ``crackfront
aggregate film.yaml`` make the same table.
"""

import sys
from pathlib import Path

from matplotlib import pyplot

import crackfront as cf

film = Path(sys.argv[0]).with_name("film.yaml")
table = cf.run_sweep(film, "results/film", progress=False)
print(table.w_appr.values, table.w_retr.values, sep="\n")

# %%
# Both works of adhesion of every surface against its own energy of full conformity, in w_int.

figure, axes = pyplot.subplots(layout="constrained")
for name, marker in (("w_appr", "o"), ("w_retr", "s")):
    axes.plot(table.e_el.values.ravel(), table[name].values.ravel(), marker, label=name)
axes.set_xlabel(r"$e_\mathrm{el}$ / $w_\mathrm{int}$")
axes.set_ylabel(r"work of adhesion / $w_\mathrm{int}$")
legend = axes.legend()
