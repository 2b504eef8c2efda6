"""
A measured loop beside its prediction
=====================================

A rig presses a sphere on a surface and pulls it off; its table holds force and contact radius.
Here the rig is simulated: a sphere on the very scan, with noise. Copies of the tables that it
writes, ``rig.csv`` and ``density.csv``, are beside this file.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib import pyplot

import crackfront as cf

scan = Path(sys.argv[0]).with_name("scans") / "nanodiamond-overview.al3d"
sphere = cf.Scales(radius="100um", work_of_adhesion="63mJ/m2", modulus="0.7MPa", poisson=0.5)
surface = cf.read_scan(scan, sphere)
cycle = cf.in_si_units(cf.run_loop(surface, max_penetration=3, step=0.04, fronts=False), sphere)

# %%
# What the rig records: rows without contact, the states with noise, rows without contact.

rng = np.random.default_rng(0)
force, radius = (np.pad(cycle[name], 20) for name in ("force", "mean_radius"))
force = force + 0.002 * np.abs(force).max() * rng.normal(size=force.size)
radius = radius * (1 + 0.003 * rng.normal(size=radius.size))
rows = pd.DataFrame({"Force (uN)": 1e6 * force, "Contact radius (um)": 1e6 * radius})
results = Path("results")
results.mkdir(exist_ok=True)
rows.to_csv(results / "rig.csv", index=False, float_format="%.4g")

# %%
# The works of adhesion from the table alone, and those of the simulation (J / m²).

loop = cf.measured_loop(
    results / "rig.csv", radius=sphere.radius, contact_modulus=sphere.contact_modulus
)
print(loop)
cycle[["w_appr", "w_retr", "hysteresis"]]

# %%
# The prediction from the scan is for surfaces of its spectrum, of which this one is an example.

predicted = cf.predict(scan, sphere)
predicted

# %%
# The works of adhesion of the rig and of the prediction, with their 95% intervals.

figure, axes = pyplot.subplots(layout="constrained")
names = ["w_appr", "w_retr", "hysteresis"]
for label, found, marker in (("measured", loop, "o"), ("predicted", predicted, "s")):
    works = [getattr(found, name) for name in names]
    values, low, high = (
        1e3 * np.array([getattr(work, part) for work in works]) for part in ("value", "low", "high")
    )
    place = np.arange(3) + (0.1 if label == "predicted" else 0)
    axes.errorbar(place, values, yerr=[values - low, high - values], fmt=marker, label=label)
axes.set_xticks(np.arange(3), names)
axes.set_ylabel("work of adhesion (mJ/m²)")
legend = axes.legend()

# %%
# A table of the spectral density serves as well as the scan, but has no interval of e_el.

spectrum = predicted.surface.spectrum
wavevectors = 2e-6 * np.pi / np.array(spectrum.wavelengths)
table = pd.DataFrame({"q (1/um)": wavevectors, "C (um^4)": 1e24 * np.array(spectrum.densities)})
table.to_csv(results / "density.csv", index=False, float_format="%.4g")
cf.predict(cf.read_psd(results / "density.csv"), sphere).e_el
