"""What surfaces on a tile have of a spectrum, which holds all wavelengths."""

from __future__ import annotations

import math

import numpy as np

from crackfront.core.spectrum import Spectrum


def tile_mean_square(spectrum: Spectrum, side: float, order: float) -> tuple[float, float]:
    """What the mean square of a derivative is on a synthesised tile, on average.

    Parameters
    ----------
    spectrum : Spectrum
        Spectrum of the field. (Lengths in the unit of `side`)
    side : float
        Side of the tile. (Units: length)
    order : float
        Order of the derivative, as in :meth:`~crackfront.core.spectrum.Spectrum.mean_square`.

    Returns
    -------
    tuple of float
        Mean over realisations, which holds only the modes of the tile, and standard deviation of
        one of them.
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
