"""
Heights in nanometres, forces in millinewtons
=============================================

Inside the package lengths and forces are reduced. A sphere, its work of adhesion and its contact
modulus define what one unit is; two functions convert. Here the sphere is the one of the
experiments in the paper, of soft PDMS on rough nanocrystalline diamond.
"""

import numpy as np

import crackfront as cf

sphere = cf.Scales(radius="1.25mm", work_of_adhesion="63mJ/m2", modulus="0.7MPa", poisson=0.5)
f"{1e6 * sphere.lateral:.1f} um, {1e6 * sphere.vertical:.2f} um, {1e3 * sphere.force:.3f} mN"

# %%
# A surface of one's own: an array of heights on a periodic tile, its side, its units. Here it is a
# sum of waves; a measured map would stand here as well. Loads are penetrations in reduced units.

x, y = 2 * np.pi * np.mgrid[:150, :150] / 150
waves = np.cos(24 * x) * np.cos(7 * y) + np.sin(5 * x - 31 * y)
surface = cf.surface(120 * waves, side="120um", units="nm", sphere=sphere)
loop = cf.in_si_units(cf.run_loop(surface, loads=[0, 1, 0.4, 1, -2], step=0.02), sphere)
loop[["penetration", "mean_radius", "force"]]

# %%
# All results are in SI units, which their attributes state, and are drawn in these units.

axes = cf.plot_loop(loop)

# %%
# Energy of full conformity, and hysteresis of the two branches (J / m²).

loop[["e_el", "w_appr", "w_retr", "hysteresis"]]
