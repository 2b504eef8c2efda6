"""From roughness to the equivalent work of adhesion of a crack front."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np
from scipy.fft import fft2, fftfreq, irfft2, rfft2, rfftfreq
from scipy.special import ndtr

from crackfront.core.arrays import Array
from crackfront.core.units import CONTACT_MODULUS, WORK_OF_ADHESION

if TYPE_CHECKING:
    from crackfront.core.spectrum import Spectrum

FieldKind = Literal["roughness", "chemical"]
"""What a field of heights or of w_loc describes."""

Value = TypeVar("Value", float, Array)


def front_stress_intensity(heights: Array, pixel: float, modulus: float = CONTACT_MODULUS) -> Array:
    r"""Stress intensity K that roughness causes at a straight crack front, of zero mean.

    The front is parallel to `y` and the contact lies at smaller `x` (Sanner et al., Sci. Adv.,
    2024, supplement, Sec. I B):

    .. math:: \tilde K = -\frac{E'}{\sqrt 2}\sqrt{i q_x + |q_y|}\,\tilde h

    Heights (n_x, n_y) are periodic, positive at peaks, with equal grid spacings (Units: length).
    The modulus is E' = E / (1 - nu^2) (Units: pressure), K is in pressure * length**0.5.

    Examples
    --------
    >>> peak = np.cos(2 * np.pi * np.arange(8) / 8)[None, :].repeat(8, axis=0)
    >>> stress = front_stress_intensity(peak, pixel=1.0, modulus=1.0)
    >>> bool(np.allclose(stress, -np.sqrt(np.pi / 8) * peak))
    True
    """
    n_x, n_y = heights.shape
    along_x = 2 * np.pi * fftfreq(n_x, pixel)[:, None]
    along_y = 2 * np.pi * rfftfreq(n_y, pixel)[None, :]
    # In place: memory is largest here, and every copy is one more tile.
    kernel = 1j * along_x + np.abs(along_y)
    np.sqrt(kernel, out=kernel)
    if n_x % 2 == 0:
        # The Nyquist mode stands for both signs of q_x: their mean is real.
        kernel[n_x // 2] = kernel[n_x // 2].real
    kernel[0, 0] = 0.0
    kernel *= -modulus / np.sqrt(2)
    kernel *= rfft2(heights)
    return np.asarray(irfft2(kernel, s=(n_x, n_y)))


def overlap_share(elastic_energy: float) -> float:
    r"""Part of a front where the solids would overlap, on Gaussian roughness of an e_el.

    The solids overlap where K_JKR + K is negative, which needs a K beyond -K_JKR (supplement,
    Sec. I B). With K_JKR^2 = 2 E' w_int and the mean square 2 E' e_el of K this is the part

    .. math:: \Phi\left(-\sqrt{w_{int} / e_{el}}\right)

    of the normal distribution. e_el is in units of w_int.

    Examples
    --------
    >>> f"{overlap_share(0.177):.1%}"
    '0.9%'
    """
    return float(ndtr(-(elastic_energy**-0.5)))


def half_derivative_mean_square(heights: Array, pixel: float) -> float:
    """Mean square half-derivative [h_rms^(1/2)]^2 of a periodic map (Units: length)."""
    n_x, n_y = heights.shape
    power = np.abs(fft2(heights, norm="forward"))
    power **= 2
    power *= 2 * np.pi * np.hypot(fftfreq(n_x, pixel)[:, None], fftfreq(n_y, pixel)[None, :])
    return float(np.sum(power))


@dataclass(frozen=True, slots=True)
class AdhesionMap:
    """Local work of adhesion on a periodic tile, with the measures that its fits refer to."""

    work_of_adhesion: Array
    """Values of w_loc, first axis x. (Units: reduced energy / area, w_int = 1/pi)"""
    pixel: float
    """Grid spacing. (Units: reduced lateral length)"""
    e_el: float
    """Energy of full conformity of the tile; (w_rms / w_int)^2 / 4 if chemical. (Units: w_int)"""
    w_rms: float
    """Rms deviation of w_loc from its mean on the tile. (Units: w_int)"""
    corner: tuple[float, float] = (0.0, 0.0)
    """Coordinates of the first point, where they matter. (Units: reduced lateral length)"""


def rough_adhesion(heights: Array, pixel: float) -> AdhesionMap:
    r"""Work of adhesion equivalent to roughness.

    .. math:: w_{loc} = w_{int} - e_{el} - \sqrt{2 w_{int} / E'}\, K

    Its rms is 2 sqrt(e_el w_int) by Parseval, as in the supplement, Sec. I C; the main text
    prints sqrt(2 e_el w_int).

    Parameters
    ----------
    heights : (n_x, n_y) array
        Periodic roughness, positive at peaks. (Units: reduced; vertical and lateral scales
        combine so that e_el / w_int = pi E'/4 [h^(1/2)]^2)
    pixel : float
        Grid spacing. (Units: reduced lateral length)

    Returns
    -------
    AdhesionMap
        Field of mean w_int - e_el.

    Raises
    ------
    ValueError
        If the energy of full conformity is not below w_int, where no contact conforms.

    References
    ----------
    .. [1] Sanner et al., Sci. Adv. (2024), supplement, Sec. I C.
    """
    energy = CONTACT_MODULUS / 4 * half_derivative_mean_square(heights, pixel)
    relative = energy / WORK_OF_ADHESION
    if not relative < 1:
        raise ValueError(
            f"energy of full conformity is {relative:.4g} w_int; full conformity needs less than "
            "w_int, so lower the roughness"
        )
    coupling = np.sqrt(2 * WORK_OF_ADHESION / CONTACT_MODULUS)
    adhesion = front_stress_intensity(heights, pixel)
    adhesion *= -coupling
    rms = float(np.sqrt(np.mean(adhesion**2)) / WORK_OF_ADHESION)
    adhesion += WORK_OF_ADHESION - energy
    return AdhesionMap(adhesion, pixel, e_el=relative, w_rms=rms)


def chemical_adhesion(fluctuation: Array, pixel: float) -> AdhesionMap:
    """Work of adhesion of a flat but chemically heterogeneous surface, w_int + fluctuation.

    Parameters
    ----------
    fluctuation : (n_x, n_y) array
        Deviation from w_int with zero mean. (Units: w_int)
    pixel : float
        Grid spacing. (Units: reduced lateral length)

    Returns
    -------
    AdhesionMap
        Field of mean w_int.
    """
    rms = float(np.sqrt(np.mean(fluctuation**2)))
    return AdhesionMap(
        work_of_adhesion=WORK_OF_ADHESION * (1 + fluctuation),
        pixel=pixel,
        e_el=rms**2 / 4,
        w_rms=rms,
    )


def mean_adhesion(kind: FieldKind, elastic_energy: Value) -> Value | float:
    """Mean of w_loc: roughness lowers it by e_el, chemistry does not (Units: w_int)."""
    return 1 - elastic_energy if kind == "roughness" else 1.0


def adhesion_rms(elastic_energy: Value) -> Value:
    """Rms of w_loc, 2 sqrt(e_el), for fields of any kind (Units: w_int)."""
    return 2 * np.sqrt(elastic_energy)


def adhesion_order(kind: FieldKind) -> float:
    """Order of the derivative of a field whose spectrum is proportional to the spectrum of w_loc.

    C_w(q) is proportional to q^(2 order) C(q): w_loc follows from a half-derivative of heights, and
    is the field itself if it is chemical.
    """
    return 0.5 if kind == "roughness" else 0.0


def correlation_length(kind: FieldKind, spectrum: Spectrum) -> float:
    """Wavelength of the mean wavevector of w_loc, weighted by its variance (Units: length).

    The kind is what the spectrum describes.
    """
    order = adhesion_order(kind)
    return 2 * np.pi * spectrum.mean_square(order) / spectrum.mean_square(order + 0.5)


def larkin_length(kind: FieldKind, spectrum: Spectrum, w_rms: float) -> float:
    r"""Larkin length: weak disorder bends a front over it by the correlation length of the force.

    .. math:: \ell = 2 \pi \, \xi_u \left(\frac{w_{int}}{w_{rms}}\right)^2, \quad
              \xi_u^2 = \frac{\rho(0)}{-\rho''(0)}

    with the correlator :math:`\rho(u)` of w_loc integrated along the front, whose spectrum is
    :math:`C_w(q, 0)`. The pinning force of second-order perturbation theory is w_rms^2 / w_int. For
    roughness :math:`\xi_u` is the rms height over the rms slope. docs/law.md derives it. Arguments
    are as of :func:`correlation_length`, and the rms of w_loc (units: w_int). (Units: as lengths of
    the spectrum)
    """
    return 2 * np.pi * force_correlation_length(kind, spectrum) / w_rms**2


def force_correlation_length(kind: FieldKind, spectrum: Spectrum) -> float:
    """Distance over which the force on a front is correlated, xi_u of :func:`larkin_length`."""
    order = adhesion_order(kind) - 0.5
    return float(np.sqrt(spectrum.mean_square(order) / spectrum.mean_square(order + 1)))
