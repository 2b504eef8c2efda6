"""Mean squares of surfaces on a tile, which lack most wavelengths of their spectrum."""

from __future__ import annotations

import math

import numpy as np

from crackfront.core.spectrum import Spectrum


def tile_mean_square(spectrum: Spectrum, side: float, order: float) -> tuple[float, float]:
    """Mean square of a derivative of an order on synthesised tiles, which have discrete modes.

    The mean over realisations, and the standard deviation of one of them; the side is in the unit
    of the spectrum.
    """
    highest = math.ceil(side / spectrum.short_cutoff)
    step = 2 * np.pi / side
    numbers = step * np.arange(-highest, highest + 1)
    wavevector = np.hypot(numbers[:, None], numbers)
    wavevector[highest, highest] = np.inf  # the field has zero mean
    powers = spectrum.density(wavevector) / side**2
    powers[powers > 0] *= wavevector[powers > 0] ** (2 * order)
    # Powers are exponentially distributed, and every mode has a conjugate of the same power.
    return float(np.sum(powers)), float(np.sqrt(2 * np.sum(powers**2)))
