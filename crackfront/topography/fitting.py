"""The self-affine spectrum that fits the densities of all measurements of a surface."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, least_squares

from crackfront.analysis.estimate import Estimate, normal_estimate
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.topography.densities import Density

Array = NDArray[np.float64]

HURST_RANGE = (0.01, 1.0)
"""Hurst exponents that are fitted."""

_STARTS = 6
"""Roll-offs from which the fit begins; the best end counts."""

_PLATEAU = 2.0
"""Longest trusted wavelength over the roll-off from which on a plateau counts as seen; nearer to
it detrending bends a power law to the same shape."""

_DRAWS = 400
_SEED = np.random.SeedSequence(20240229, spawn_key=(0x5F17,))
"""Noise of the draws of a fit, which thus gives the same uncertainties every time."""

_PROJECTED = 100.0
"""How far below the trusted wavelengths the power law goes on in the density of a line, which
holds all shorter waves across it."""


@dataclass(frozen=True, slots=True)
class FittedSpectrum:
    """Spectrum of a surface, with the uncertainty of what follows from it.

    Attributes
    ----------
    spectrum : SelfAffineSpectrum
        Flat to the roll-off, a power law to the shortest trusted wavelength. (Units: m)
    draws : tuple of SelfAffineSpectrum
        Spectra as far from it as the noise of the densities allows.
    longest : float
        Longest trusted wavelength. (Units: m)
    misfit : float
        Chi-squared per degree of freedom, as if bins were independent of each other: what they
        share makes it less than 1. The uncertainties hold its excess over 1.
    has_roll_off : bool
        Whether the plateau lies within the trusted wavelengths: else `roll_off` is near the
        longest of them, and means that alone.
    """

    spectrum: SelfAffineSpectrum
    draws: tuple[SelfAffineSpectrum, ...]
    longest: float
    misfit: float
    has_roll_off: bool

    def projected_density(self, wavevector: Array) -> Array:
        """Density of lines of the surface, whose power law goes on below the trusted wavelengths.

        At wavevectors along a line (Units: 1 / m) it is C_1D. (Units: m^3)
        """
        return _projected(self.spectrum, wavevector)

    def estimate(self, quantity: Callable[[SelfAffineSpectrum], float]) -> Estimate[float]:
        """A quantity of the spectrum with its uncertainty."""
        drawn = [quantity(item) for item in self.draws]
        return normal_estimate(quantity(self.spectrum), float(np.std(drawn)))


def fitted_spectrum(
    densities: Sequence[Density], shortest: float, longest: float
) -> FittedSpectrum:
    """Spectrum that fits densities best.

    Least squares of the logarithms, weighted by the number of modes in every bin. Isotropic
    densities are those of the spectrum, those of profiles its exact projection on a line.

    Parameters
    ----------
    densities : sequence of Density
        One for each measurement of a surface.
    shortest, longest : float
        Wavelengths that are trusted in any of them. (Units: m)

    Raises
    ------
    ValueError
        If the densities do not determine a spectrum.
    """
    count = sum(item.value.size for item in densities)
    if count < 5 or not all(np.all(item.value > 0) for item in densities):
        raise ValueError(
            f"{count} values of a density do not determine a spectrum; use a larger or finer scan"
        )
    best = min(
        (
            _fit(densities, shortest, longest, float(start))
            for start in np.geomspace(shortest, longest, _STARTS + 2)[1:-1]
        ),
        key=lambda result: float(result.cost),
    )
    misfit = 2 * float(best.cost) / (count - 3)
    return FittedSpectrum(
        spectrum=_spectrum(best.x, shortest),
        draws=_draws(best, max(1.0, misfit), shortest, longest),
        longest=longest,
        misfit=misfit,
        has_roll_off=bool(best.x[1] <= math.log(longest / _PLATEAU)),
    )


def _fit(
    densities: Sequence[Density], shortest: float, longest: float, start: float
) -> OptimizeResult:
    """Fit of the logarithms of plateau and roll-off, and of the Hurst exponent."""

    def residuals(parameters: Array) -> Array:
        spectrum = _spectrum(parameters, shortest)
        return np.concatenate(
            [
                (item.logarithm - np.log(_model(spectrum, item))) / item.logarithm_error
                for item in densities
            ]
        )

    shape = SelfAffineSpectrum(shortest, start, 0.8)
    plateau = np.mean([np.mean(item.logarithm - np.log(_model(shape, item))) for item in densities])
    bounds = (
        [-np.inf, math.log(shortest), HURST_RANGE[0]],
        [np.inf, math.log(longest), HURST_RANGE[1]],
    )
    return least_squares(residuals, [plateau, math.log(start), 0.8], bounds=bounds, x_scale="jac")


def _model(spectrum: SelfAffineSpectrum, density: Density) -> Array:
    """What a density should be."""
    if density.is_profile:
        return _projected(spectrum, density.wavevector)
    return spectrum.density(density.wavevector)


def _projected(spectrum: SelfAffineSpectrum, wavevector: Array) -> Array:
    """Density of lines of a spectrum that goes on below its cutoff."""
    longer = replace(spectrum, short_cutoff=spectrum.short_cutoff / _PROJECTED)
    return longer.profile_density(wavevector)


def _spectrum(parameters: Array, shortest: float) -> SelfAffineSpectrum:
    """Spectrum of the parameters of the fit."""
    plateau, roll_off, hurst = map(float, parameters)
    return SelfAffineSpectrum(
        shortest,
        max(shortest, math.exp(roll_off)),
        min(max(hurst, HURST_RANGE[0]), HURST_RANGE[1]),
        math.exp(plateau),
    )


def _draws(
    best: OptimizeResult, misfit: float, shortest: float, longest: float
) -> tuple[SelfAffineSpectrum, ...]:
    """Spectra drawn from the normal distribution of the parameters, within their bounds."""
    # A parameter without effect, as the roll-off at an end, has no variance of its own.
    covariance = misfit * np.linalg.pinv(best.jac.T @ best.jac, rcond=1e-12, hermitian=True)
    noise = np.random.default_rng(_SEED).multivariate_normal(
        best.x, covariance, size=_DRAWS, method="eigh"
    )
    noise[:, 1] = np.clip(noise[:, 1], math.log(shortest), math.log(longest))
    return tuple(_spectrum(row, shortest) for row in noise)
