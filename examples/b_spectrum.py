"""
Which scales matter
===================

This is a self-affine surface with a roll-off. The bars span the wavevectors that carry 80% of the
mean square of heights, of half-derivatives and of slopes. Hysteresis follows from the
half-derivative, that is, from scales between those of the heights and those of the slopes.
"""

from matplotlib import pyplot

import crackfront as cf

surface = cf.random_surface(0.02, 0.05, roll_off=0.5, hurst=0.8, error=0.1, seed=3)
axes = cf.plot_spectrum(surface)

# %%
# The functions draw on axes of your own as well, in the style that these have.

figure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
cf.plot_surface(surface, left)
axes = cf.plot_spectrum(surface, right)

# %%
# The same numbers for the ideal spectrum.

spectrum = cf.SelfAffineSpectrum(short_cutoff=0.02, roll_off=0.5, hurst=0.8)
spectrum = spectrum.with_elastic_energy(0.05)
{order: spectrum.dominant_wavelengths(order) for order in (0.0, 0.5, 1.0)}
