"""What a surface is: rms measures of all orders, the scales behind them, and e_el."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import beta

from crackfront.analysis.estimate import Estimate
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.topography.densities import Density, isotropic_density, profile_density, topography
from crackfront.topography.fitting import FittedSpectrum, fitted_spectrum
from crackfront.topography.reading import Measurement

Array = NDArray[np.float64]

_ORDERS = (0.0, 0.5, 1.0)
"""Orders of the derivatives: heights, half-derivatives, slopes."""

_SHARE = 0.8
"""Part of a mean square that lies within the scales that dominate it."""

_DECADES = 2
"""Decades below the trusted wavelengths over which the power law is continued, to see whether
waves that were not measured matter."""


@dataclass(frozen=True, slots=True)
class RmsMeasure:
    """Root mean square of a derivative of the heights.

    Attributes
    ----------
    order : float
        Order of the derivative.
    rms : Estimate of a number
        Of the fitted spectrum. (Units: m^(1 - order))
    shortest, longest : float
        Wavelengths that dominate it: a tenth lies below, a tenth above. (Units: m)
    measured : tuple of float
        Of every measurement, over its own trusted wavelengths; lines as those of an isotropic
        surface. (Units: m^(1 - order))
    expected : tuple of float
        What the fitted spectrum has over the same wavelengths.
    """

    order: float
    rms: Estimate[float]
    shortest: float
    longest: float
    measured: tuple[float, ...]
    expected: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class MeasuredSurface:
    """What was measured of a surface, and what follows from it.

    Attributes
    ----------
    measurements : tuple of Measurement
        What was measured.
    isotropic : tuple of Density or None
        Isotropic density of every map; none of a line.
    profiles : tuple of Density
        Density of the lines along x of every measurement.
    fitted : FittedSpectrum
        Its spectrum; maps enter by their isotropic density, lines by that of profiles.
    measures : tuple of RmsMeasure
        Of the heights, their half-derivative and their slopes.
    anisotropy : tuple of float
        Of every map the rms slope along x over that along y; 1 for lines.
    """

    measurements: tuple[Measurement, ...]
    isotropic: tuple[Density | None, ...]
    profiles: tuple[Density, ...]
    fitted: FittedSpectrum
    measures: tuple[RmsMeasure, ...]
    anisotropy: tuple[float, ...]

    @property
    def checksum(self) -> str:
        """Eight hexadecimal digits of the content of all files, in their order."""
        text = "".join(item.checksum for item in self.measurements)
        return hashlib.sha256(text.encode()).hexdigest()[:8]

    def conformity_energy(self, contact_modulus: float) -> Estimate[float]:
        """Energy of full conformity e_el = E'/4 [h_rms^(1/2)]^2, of E' in Pa (Units: J / m^2)."""
        found = self.fitted.estimate(lambda spectrum: spectrum.mean_square(0.5))
        return found.each(lambda number: contact_modulus / 4 * number)

    @property
    def unmeasured_share(self) -> float:
        """What two more decades of the power law would add to e_el, relative to it."""
        spectrum = self.fitted.spectrum
        longer = replace(spectrum, short_cutoff=spectrum.short_cutoff / 10**_DECADES)
        return longer.mean_square(0.5) / spectrum.mean_square(0.5) - 1


def measured_surface(measurements: Sequence[Measurement]) -> MeasuredSurface:
    """Spectrum and measures of a surface of which there is one measurement or several.

    Raises
    ------
    ValueError
        If the densities do not determine a spectrum.
    """
    profiles = tuple(profile_density(item) for item in measurements)
    isotropic = tuple(None if item.is_line else isotropic_density(item) for item in measurements)
    fitted = fitted_spectrum(
        [density or profile for density, profile in zip(isotropic, profiles, strict=True)],
        min(item.shortest for item in measurements),
        max(item.longest for item in measurements),
    )
    return MeasuredSurface(
        measurements=tuple(measurements),
        isotropic=isotropic,
        profiles=profiles,
        fitted=fitted,
        measures=tuple(_measure(order, fitted, measurements) for order in _ORDERS),
        anisotropy=tuple(_anisotropy(item) for item in measurements),
    )


def measured_mean_square(measurement: Measurement, order: float) -> float:
    """Mean square of a derivative of a measurement over its trusted wavelengths.

    A line counts as one of an isotropic surface. (Units: m^(2 - 2 order))
    """
    low, high = 2 * np.pi / measurement.longest, 2 * np.pi / measurement.shortest

    def weight(wavevector: Array) -> Array:
        inside = (wavevector >= low) & (wavevector <= high)
        return np.where(inside, wavevector, 0.0) ** (2 * order) * inside

    found = float(topography(measurement).integrate_psd(weight, reliable=False))
    # A line sees a wave by the cosine of its direction: this is the mean of its power.
    return found / (float(beta(order + 0.5, 0.5)) / math.pi) if measurement.is_line else found


def _measure(
    order: float, fitted: FittedSpectrum, measurements: Sequence[Measurement]
) -> RmsMeasure:
    """Measure of one order."""
    ends = fitted.spectrum.dominant_wavelengths(order, _SHARE)
    return RmsMeasure(
        order,
        fitted.estimate(lambda spectrum: spectrum.mean_square(order) ** 0.5),
        *ends,
        measured=tuple(measured_mean_square(item, order) ** 0.5 for item in measurements),
        expected=tuple(
            _within(fitted.spectrum, item.shortest, item.longest, order) ** 0.5
            for item in measurements
        ),
    )


def _within(spectrum: SelfAffineSpectrum, shortest: float, longest: float, order: float) -> float:
    """Mean square of the waves between two wavelengths."""
    longer = spectrum.longer_than(longest).mean_square(order)
    return spectrum.longer_than(max(shortest, spectrum.short_cutoff)).mean_square(order) - longer


def _anisotropy(measurement: Measurement) -> float:
    """Slope along x over that along y, from the trusted wavelengths."""
    if measurement.is_line:
        return 1.0
    level = topography(measurement)
    high = 2 * np.pi / measurement.shortest

    def along(axis: int) -> float:
        def weight(q_x: Array, q_y: Array) -> Array:
            return np.where(np.hypot(q_x, q_y) <= high, (q_x, q_y)[axis], 0.0) ** 2

        return float(level.integrate_psd(weight, reliable=False))

    return float(np.sqrt(along(0) / along(1)))
