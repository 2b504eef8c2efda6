"""Power spectra of rough surfaces and the rms of any derivative that follows from them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq
from scipy.special import beta, betainc

from crackfront.core.units import CONTACT_MODULUS

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SelfAffineSpectrum:
    r"""Isotropic 2D spectrum: flat to q_r, falling as q^(-2-2H) to q_s, zero beyond.

    Parameters
    ----------
    short_cutoff : float
        Shortest wavelength lambda_s = 2 pi / q_s. (Units: length)
    roll_off : float
        Roll-off wavelength lambda_r = 2 pi / q_r; equal to `short_cutoff` for a flat spectrum.
        (Units: length)
    hurst : float
        Hurst exponent H in (0, 1]; without effect on a flat spectrum.
    plateau : float, optional
        Value C_0 below the roll-off. (Units: length**4 for heights)

    Raises
    ------
    ValueError
        If a length is not positive, the roll-off is shorter than the cutoff, or H is outside
        (0, 1].

    References
    ----------
    .. [1] Jacobs, Junge, Pastewka, Surf. Topogr.: Metrol. Prop. 5, 013001 (2017).

    Examples
    --------
    >>> flat = SelfAffineSpectrum(short_cutoff=0.02, roll_off=0.02, hurst=0.8)
    >>> round(flat.with_elastic_energy(0.05).elastic_energy, 12)
    0.05
    """

    short_cutoff: float
    roll_off: float
    hurst: float
    plateau: float = 1.0

    def __post_init__(self) -> None:
        for name in ("short_cutoff", "roll_off", "plateau"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise ValueError(f"{name} is {value}; it must be positive and finite")
        if self.roll_off < self.short_cutoff:
            raise ValueError(
                f"roll_off {self.roll_off} is shorter than short_cutoff {self.short_cutoff}; "
                "lower the cutoff or raise the roll-off (equal values give a flat spectrum)"
            )
        if not 0 < self.hurst <= 1:
            raise ValueError(f"hurst is {self.hurst}; it must lie in (0, 1]")

    def density(self, wavevector: ArrayLike) -> Array:
        """Spectral density C(q).

        Parameters
        ----------
        wavevector : array_like
            Magnitude q >= 0. (Units: 1 / length)

        Returns
        -------
        array
            C(q), zero beyond q_s. (Units: those of `plateau`)
        """
        # A mode on the cutoff itself belongs to the spectrum whatever the round-off of its q.
        q = np.asarray(wavevector, dtype=float) * self.roll_off / (2 * np.pi)
        falling = self.plateau * np.maximum(q, 1.0) ** (-2 - 2 * self.hurst)
        return np.where(q <= self.roll_off / self.short_cutoff * (1 + 1e-12), falling, 0.0)

    def mean_square(self, order: float) -> float:
        r"""Mean square of the derivative of a given order.

        .. math:: (h^{(\alpha)}_{rms})^2 = \frac{1}{4\pi^2} \int d^2q\, q^{2\alpha} C(q)

        Parameters
        ----------
        order : float
            Order alpha: 0 for heights, 1/2 for the half-derivative, 1 for slopes.

        Returns
        -------
        float
            Mean square. (Units: those of `plateau` / length**(2 + 2 * order))
        """
        knee, cutoff = 2 * math.pi / self.roll_off, 2 * math.pi / self.short_cutoff
        exponent = 2 * (order - self.hurst)
        growth = math.log(cutoff / knee)
        # expm1(x L) / x tends to the logarithm L where order and Hurst exponent agree.
        tail = growth if exponent == 0 else math.expm1(exponent * growth) / exponent
        moment = knee ** (2 + 2 * order) * (1 / (2 + 2 * order) + tail)
        return self.plateau * moment / (2 * math.pi)

    def profile_density(self, wavevector: ArrayLike) -> Array:
        r"""Spectral density of a profile along a line (1D PSD), the projection of C.

        .. math:: C_{1D}(q) = \frac{1}{2\pi} \int dk\, C(\sqrt{q^2 + k^2})

        Parameters
        ----------
        wavevector : array_like
            Magnitude q > 0. (Units: 1 / length)

        Returns
        -------
        array
            C_1D(q); the mean square height is its integral over q > 0, divided by pi.
            (Units: those of `plateau` / length)

        Examples
        --------
        >>> spectrum = SelfAffineSpectrum(short_cutoff=1e-6, roll_off=1.0, hurst=1.0)
        >>> q = 1e3
        >>> round(float(spectrum.profile_density(q) / (q / np.pi * spectrum.density(q))), 4)
        0.7854
        """
        q = np.asarray(wavevector, dtype=float)
        knee, cutoff = 2 * math.pi / self.roll_off, 2 * math.pi / self.short_cutoff
        on_plateau = np.sqrt(np.maximum(knee**2 - q**2, 0.0))
        # With k = q tan(phi) the tail is an incomplete beta function, here of its complement.
        power = self.hurst + 0.5
        beyond_knee, beyond_cutoff = (
            betainc(power, 0.5, np.minimum((q / limit) ** 2, 1.0)) for limit in (knee, cutoff)
        )
        tail = knee * (knee / q) ** (2 * power) * beta(power, 0.5) / 2
        return self.plateau / np.pi * (on_plateau + tail * (beyond_knee - beyond_cutoff))

    def longer_than(self, wavelength: float) -> SelfAffineSpectrum:
        """Part of the spectrum with wavelengths above one that is not below the short cutoff."""
        return replace(self, short_cutoff=wavelength, roll_off=max(self.roll_off, wavelength))

    def dominant_wavelengths(self, order: float, share: float = 0.8) -> tuple[float, float]:
        """Range of wavelengths that carries a share of the mean square of a derivative.

        Half of the rest lies at shorter wavelengths, the other half at longer ones.

        Parameters
        ----------
        order : float
            Order alpha, as in :meth:`mean_square`.
        share : float, optional
            Part of the mean square within the range.

        Returns
        -------
        tuple of float
            Shortest and longest wavelength. (Units: length)
        """
        total, rest = self.mean_square(order), (1 - share) / 2

        def wavelength_above_which(part: float) -> float:
            # On the plateau the share of longer waves falls at least as fast as this.
            longest = self.roll_off * part ** (-1 / (2 + 2 * order))
            root = brentq(
                lambda log: self.longer_than(math.exp(log)).mean_square(order) / total - part,
                math.log(self.short_cutoff) + 1e-14,
                math.log(longest) + 1e-9,
                xtol=1e-13,
            )
            return math.exp(root)

        return wavelength_above_which(1 - rest), wavelength_above_which(rest)

    @property
    def elastic_energy(self) -> float:
        """Energy of full conformity e_el = E'/4 [h_rms^(1/2)]^2, in units of w_int."""
        return math.pi * CONTACT_MODULUS / 4 * self.mean_square(0.5)

    @property
    def correlation_length(self) -> float:
        """Wavelength of the mean wavevector of w_loc, weighted by its variance (Units: length)."""
        return 2 * math.pi * self.mean_square(0.5) / self.mean_square(1.0)

    def with_elastic_energy(self, elastic_energy: float) -> SelfAffineSpectrum:
        """Same shape, scaled to an energy of full conformity (in units of w_int)."""
        return replace(self, plateau=self.plateau * elastic_energy / self.elastic_energy)
