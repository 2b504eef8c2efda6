r"""Work of adhesion of a rough sphere whose crack turns with the angle, ray by ray.

At the angle \theta the front is tangential to the circle. A mode of wavevector q and direction
\varphi sees it at the angle \psi = \varphi - \theta, and the kernel of the straight crack is

.. math:: \sqrt{i q_n + |q_t|} = \sqrt{q}\, e^{i (\pi / 4 - |\psi| / 2)}, \quad |\psi| \le \pi .

Along a ray the field is a sum over the projections of the wavevectors on the ray: a non-uniform
Fourier transform in one dimension, of FINUFFT (the extra `bem`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.fft import fft2, fftfreq

from crackfront.core.adhesion import rough_adhesion
from crackfront.core.arrays import Array
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

_PRECISION = 1e-13
"""Precision of the transforms, relative to the sum of the amplitudes."""


def adhesion_on_rays(
    heights: Array,
    pixel: float,
    angles: Array,
    spacing: float,
    n_sample: int,
    *,
    rotated: bool = True,
) -> Array:
    r"""Equivalent work of adhesion at equally spaced points of rays from the tile's centre.

    Parameters
    ----------
    heights : (n_x, n_y) array
        Periodic roughness without waves of two pixels, positive at peaks; the apex is the tile's
        centre. (Units: reduced vertical length)
    spacing : float
        Distance of the points; the first one is so far from the centre.
        (Units: reduced lateral length)
    rotated : bool, optional
        Whether the crack turns; if not, it is parallel to y everywhere, as in the paper's
        statistics (SI II).

    Returns
    -------
    (n_sample, n_angle) array
        w_loc. (Units: reduced energy / area, w_int = 1/pi)

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. I B, C and III.
    .. [2] Barnett, Magland, af Klinteberg, SIAM J. Sci. Comput. 41, C479 (2019).
    """
    from finufft import nufft1d1

    energy = rough_adhesion(heights, pixel).e_el * WORK_OF_ADHESION
    wavevector, direction, amplitude = _modes(heights, pixel)
    # The transform counts its points from their middle one.
    middle = (1 + n_sample // 2) * spacing
    values = np.zeros((n_sample, angles.size))
    for column, angle in enumerate(angles if amplitude.size else ()):
        projected = wavevector * np.cos(direction - angle)
        seen = direction - angle if rotated else direction
        seen = np.abs(np.arctan2(np.sin(seen), np.cos(seen)))
        strength = amplitude * np.exp(1j * (np.pi / 4 - seen / 2 + projected * middle))
        values[:, column] = nufft1d1(
            projected * spacing, strength, n_sample, eps=_PRECISION, isign=1, nthreads=1
        ).real
    # w_loc = w_int - e_el - sqrt(2 w_int / E') K, with K of the sign of -h (SI I B, C).
    values *= math.sqrt(2 * WORK_OF_ADHESION / CONTACT_MODULUS) * CONTACT_MODULUS / math.sqrt(2)
    values += WORK_OF_ADHESION - energy
    return values


def _modes(heights: Array, pixel: float) -> tuple[Array, Array, NDArray[np.complex128]]:
    """Wavevectors, their directions, and amplitudes there of the half-derivative at the centre."""
    n_x, n_y = heights.shape
    amplitude = fft2(heights, norm="forward")
    along = (2 * np.pi * fftfreq(count, pixel) for count in (n_x, n_y))
    q_x, q_y = np.meshgrid(*along, indexing="ij")
    floor = np.finfo(float).eps * float(np.max(np.abs(amplitude), initial=0.0))
    # One of two conjugate modes is kept, with twice the amplitude.
    is_used = ((q_x > 0) | ((q_x == 0) & (q_y > 0))) & (np.abs(amplitude) > floor)
    q_x, q_y, amplitude = q_x[is_used], q_y[is_used], amplitude[is_used]
    wavevector = np.hypot(q_x, q_y)
    centre = np.exp(0.5j * pixel * (n_x * q_x + n_y * q_y))
    return wavevector, np.arctan2(q_y, q_x), 2 * np.sqrt(wavevector) * amplitude * centre
