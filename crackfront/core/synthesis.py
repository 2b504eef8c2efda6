"""Random surfaces: Gaussian fields on a periodic tile, synthesised from a spectrum."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2

from crackfront.core.spectrum import SelfAffineSpectrum

Array = NDArray[np.float64]


def gaussian_field(
    spectrum: SelfAffineSpectrum, n_point: int, length: float, rng: np.random.Generator
) -> Array:
    """Periodic Gaussian random field with uncorrelated phases.

    The random numbers belong to wavevectors, not to pixels: the same generator gives the same
    surface on every grid that resolves the spectrum. A mode on the grid's Nyquist wavevector has
    no sign there and is left out.

    Parameters
    ----------
    spectrum : SelfAffineSpectrum
        Spectrum of the field. (Lengths in the unit of `length`)
    n_point : int
        Points along each side of the tile.
    length : float
        Side of the tile. (Units: length)
    rng : numpy.random.Generator
        Source of the noise.

    Returns
    -------
    (n_point, n_point) array
        Field with zero mean, first axis x, second axis y. (Units: sqrt(plateau) / length)

    Raises
    ------
    ValueError
        If the tile has no extent, the shortest wavelength is below two pixels, or the tile is
        shorter than the shortest wavelength so that it holds no mode.

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. II.
    """
    if n_point < 4 or not 0 < length < math.inf:
        raise ValueError(
            f"tile of {n_point} points and side {length} cannot hold a surface; use at least 4 "
            "points and a positive side"
        )
    pixel = length / n_point
    if spectrum.short_cutoff < 2 * pixel * (1 - 1e-12):
        raise ValueError(
            f"short cutoff {spectrum.short_cutoff:.6g} is below two pixels ({2 * pixel:.6g}); "
            "refine the grid or raise the cutoff"
        )
    highest = math.floor(length / spectrum.short_cutoff * (1 + 1e-12))
    if highest < 1:
        raise ValueError(
            f"tile of side {length:.6g} is shorter than the short cutoff "
            f"{spectrum.short_cutoff:.6g}; enlarge the tile"
        )
    kept = min(highest, (n_point - 1) // 2)
    step = 2 * np.pi / length
    columns = np.arange(highest + 1)
    modes = np.zeros((n_point, n_point // 2 + 1), dtype=complex)
    for row in range(-highest, highest + 1):
        noise = rng.standard_normal((2, highest + 1))
        if abs(row) > kept:
            continue
        amplitude = np.sqrt(spectrum.density(step * np.hypot(row, columns)) / 2) / length
        modes[row, : kept + 1] = ((noise[0] + 1j * noise[1]) * amplitude)[: kept + 1]
    # A real field: on the column q_y = 0 the modes at -q_x are the conjugates of those at q_x.
    modes[0, 0] = 0.0
    modes[-kept:, 0] = np.conj(modes[kept:0:-1, 0])
    return np.asarray(irfft2(modes, s=(n_point, n_point), norm="forward"))


def tile_mean_square(
    spectrum: SelfAffineSpectrum, side: float, order: float
) -> tuple[float, float]:
    """What the mean square of a derivative is on a synthesised tile, on average.

    Parameters
    ----------
    spectrum : SelfAffineSpectrum
        Spectrum of the field. (Lengths in the unit of `side`)
    side : float
        Side of the tile. (Units: length)
    order : float
        Order of the derivative, as in :meth:`SelfAffineSpectrum.mean_square`.

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
