"""Elasticity of the crack front: the half-Laplacian, its stiffness and its energy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

from crackfront.core.units import WORK_OF_ADHESION

Array = NDArray[np.float64]


def half_laplacian(radius: Array) -> Array:
    r"""Half-Laplacian of a front in its angle.

    .. math:: (-\Delta_\theta)^{1/2} a = \sum_n |n| \tilde a_n e^{i n \theta}

    Parameters
    ----------
    radius : (n_angle,) array
        Radius at equally spaced angles. (Units: length)

    Returns
    -------
    (n_angle,) array
        Generalised curvature; it has zero mean. (Units: length)

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. I D.

    Examples
    --------
    >>> angle = 2 * np.pi * np.arange(8) / 8
    >>> bool(np.allclose(half_laplacian(np.cos(3 * angle)), 3 * np.cos(3 * angle)))
    True
    """
    modes = rfft(radius)
    return np.asarray(irfft(np.arange(modes.size) * modes, n=radius.size))


def self_stiffness(n_angle: int) -> float:
    """Restoring force on one site per unit of its own advance, in units of w_int.

    The diagonal of the half-Laplacian: N/4 for even N, (N^2 - 1)/4N for odd N.
    """
    return n_angle / 4 if n_angle % 2 == 0 else (n_angle**2 - 1) / (4 * n_angle)


def line_energy(radius: Array) -> float:
    r"""Energy that distorts the front out of its circle, pi w_int sum_n |n| |a_n|^2.

    Parameters
    ----------
    radius : (n_angle,) array
        Radius at equally spaced angles. (Units: reduced lateral length)

    Returns
    -------
    float
        Energy; its gradient is w_int times the half-Laplacian. (Units: reduced energy)
    """
    product = radius * half_laplacian(radius)
    return float(np.pi * WORK_OF_ADHESION * np.mean(product))
