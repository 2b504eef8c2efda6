"""
Heights in nanometres, forces in millinewtons
=============================================

Inside the package lengths and forces are reduced. A sphere, its work of adhesion and its contact
modulus define what one unit is; two functions convert. Here the sphere is the one of the
experiments in the paper, of soft PDMS on rough nanocrystalline diamond.
"""

import numpy as np
import xarray as xr

import crackfront as cf

sphere = cf.Scales(radius="1.25mm", work_of_adhesion="63mJ/m2", contact_modulus=0.7e6 / 0.75)
f"{1e6 * sphere.lateral:.1f} um, {1e6 * sphere.vertical:.2f} um, {1e3 * sphere.force:.3f} mN"

# %%
# A surface of one's own: heights on a periodic grid with coordinates, each of which states its
# units. Here it is a sum of waves; a measured map would stand here as well.

pixel = 0.8  # micrometres
x = xr.DataArray(pixel * np.arange(150), dims="x", attrs={"units": "um"})
y = xr.DataArray(pixel * np.arange(150), dims="y", attrs={"units": "um"})
turns = 2 * np.pi / 120
waves = np.cos(24 * turns * x) * np.cos(7 * turns * y) + np.sin(5 * turns * x - 31 * turns * y)
heights = (120.0 * waves).assign_coords(x=x, y=y).rename("height").assign_attrs(units="nm")
loop = cf.in_si_units(cf.run_loop(cf.in_reduced_units(heights, sphere)), sphere)
loop[["penetration", "mean_radius", "force"]]

# %%
# What comes out is in SI units, says so, and is drawn in them.

axes = cf.plot_loop(loop)

# %%
# Energy of full conformity, and hysteresis of the two branches (J / m²).

loop[["e_el", "w_appr", "w_retr", "hysteresis"]]
