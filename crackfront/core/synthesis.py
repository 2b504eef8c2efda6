"""Random surfaces: Gaussian fields on a periodic tile, synthesised from a spectrum."""

from __future__ import annotations

import math

import numpy as np
from scipy.fft import irfft, irfft2, rfft2

from crackfront.core.arrays import Array
from crackfront.core.spectrum import Spectrum

_AT_ONCE = 16384
"""Modes that are drawn at once."""

FEWEST_POINTS = 4
"""Fewest points along a side of a tile, which resolve a single wave."""


def gaussian_field(
    spectrum: Spectrum,
    n_point: int | tuple[int, int],
    length: float | tuple[float, float],
    rng: np.random.Generator,
) -> Array:
    """Periodic Gaussian random field with uncorrelated phases.

    Random numbers are drawn for wavevectors, not for pixels: the same generator gives the same
    surface on every grid that resolves the spectrum. A mode on the grid's Nyquist wavevector
    lacks a sign there and is left out.

    Parameters
    ----------
    spectrum : Spectrum
        Spectrum of the field. (Lengths in the unit of `length`)
    n_point : int or (n_x, n_y)
        Points along the sides of the tile.
    length : float or (l_x, l_y)
        Its sides. (Units: length)
    rng : numpy.random.Generator
        Source of the noise.

    Returns
    -------
    (n_x, n_y) array
        Field with zero mean, first axis x, second axis y. (Units: sqrt(plateau) / length)

    Raises
    ------
    ValueError
        If the side of the tile is not positive, or shorter than the shortest wavelength so that no
        mode fits, or if the shortest wavelength is below two pixels.

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. II.
    """
    n_x, n_y = (n_point, n_point) if isinstance(n_point, int) else n_point
    l_x, l_y = length if isinstance(length, tuple) else (length, length)
    highest_x, kept_x = _modes(spectrum.short_cutoff, n_x, l_x)
    highest_y, kept_y = _modes(spectrum.short_cutoff, n_y, l_y)
    step = 2 * np.pi / l_y
    columns = np.arange(highest_y + 1)
    modes = np.zeros((n_x, n_y // 2 + 1), dtype=complex)
    height = max(_AT_ONCE // columns.size, 1)
    for first in range(-highest_x, highest_x + 1, height):
        rows = np.arange(first, min(first + height, highest_x + 1))
        noise = rng.standard_normal((rows.size, 2, columns.size))
        density = spectrum.density_of_modes(step, rows[:, None] * (l_y / l_x), columns)
        amplitude = np.sqrt(density / 2) / math.sqrt(l_x * l_y)
        resolved = np.abs(rows) <= kept_x
        row_modes = (noise[:, 0] + 1j * noise[:, 1]) * amplitude
        modes[rows[resolved], : kept_y + 1] = row_modes[resolved, : kept_y + 1]
    # A real field: on the column q_y = 0 the modes at -q_x are the conjugates of those at q_x.
    modes[0, 0] = 0.0
    modes[-kept_x:, 0] = np.conj(modes[kept_x:0:-1, 0])
    return np.asarray(irfft2(modes, s=(n_x, n_y), norm="forward"))


def _modes(short_cutoff: float, n_point: int, length: float) -> tuple[int, int]:
    """Largest mode of a spectrum along a side of a tile, and largest mode of its grid."""
    if n_point < FEWEST_POINTS or not 0 < length < math.inf:
        raise ValueError(
            f"tile of {n_point} points and side {length} cannot have a surface; use at least "
            f"{FEWEST_POINTS} points and a positive side"
        )
    pixel = length / n_point
    if short_cutoff < 2 * pixel * (1 - 1e-12):
        raise ValueError(
            f"short cutoff {short_cutoff:.6g} is below two pixels ({2 * pixel:.6g}); "
            "refine the grid or raise the cutoff"
        )
    highest = math.floor(length / short_cutoff * (1 + 1e-12))
    if highest < 1:
        raise ValueError(
            f"tile of side {length:.6g} is shorter than the short cutoff "
            f"{short_cutoff:.6g}; enlarge the tile"
        )
    return highest, min(highest, (n_point - 1) // 2)


def resampled(values: Array, shape: tuple[int, int]) -> Array:
    """Periodic field on another grid of the same tile, by its modes.

    Modes on the Nyquist wavevector of either grid, or beyond, are left out.
    """
    modes = rfft2(values, norm="forward")
    kept_x, kept_y = ((min(pair) - 1) // 2 for pair in zip(values.shape, shape, strict=True))
    finer = np.zeros((shape[0], shape[1] // 2 + 1), dtype=complex)
    finer[: kept_x + 1, : kept_y + 1] = modes[: kept_x + 1, : kept_y + 1]
    finer[-kept_x:, : kept_y + 1] = modes[-kept_x:, : kept_y + 1]
    return np.asarray(irfft2(finer, s=shape, norm="forward"))


def uncorrelated_rows(
    spectrum: Spectrum,
    order: float,
    n_point: tuple[int, int],
    pixel: float,
    rng: np.random.Generator,
) -> Array:
    r"""Rows along x that are independent of each other, as a front sees weak disorder from afar.

    Their spectrum is an isotropic field's, integrated across, :math:`q^{2 \alpha} C(q)` with
    the order alpha, of shortest wavelengths of two pixels or more. The n_y rows of n_x points have
    zero mean, and unit variance in the mean over realisations.
    """
    n_x, n_y = n_point
    _, n_mode = _modes(spectrum.short_cutoff, n_x, n_x * pixel)
    wavevector = 2 * np.pi / (n_x * pixel) * np.arange(1, n_mode + 1)
    power = wavevector ** (2 * order) * spectrum.density(wavevector)
    modes = np.zeros((n_x // 2 + 1, n_y), dtype=complex)
    noise = rng.standard_normal((2, n_mode, n_y))
    modes[1 : n_mode + 1] = (noise[0] + 1j * noise[1]) * np.sqrt(power / power.sum())[:, None] / 2
    return np.asarray(irfft(modes, n=n_x, axis=0, norm="forward"))
