"""A measured surface: its spectrum, rms measures with their dominant scales, and e_el."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crackfront.analysis.estimate import Estimate
from crackfront.core.spectrum import TabulatedSpectrum
from crackfront.measured.density.bands import Scan, analysed_scan
from crackfront.measured.options import ReadingOptions
from crackfront.measured.scan.reading import Measurement, read_measurements
from crackfront.measured.spectrum.draws import ORDERS
from crackfront.measured.spectrum.joining import JointSpectrum, Shares, joint_spectrum

_UNDETERMINED = 1e4
"""Ratio of the ends of the interval of e_el above which scans do not determine a spectrum."""

DOMINANT_SHARE = 0.8
"""Part of a mean square within its dominant scales."""


@dataclass(frozen=True, slots=True)
class RmsMeasure:
    """Root mean square of a derivative of the heights."""

    order: float
    rms: Estimate[float]
    """Rms by the joint spectrum. (Units: m^(1 - order))"""
    shortest: float
    longest: float
    """Ends of the dominant wavelengths: a tenth of the mean square is below, a tenth above.
    (Units: m)"""


@dataclass(frozen=True, slots=True)
class RoughSurface:
    """Rms measures of a surface, and its energy of full conformity."""

    measures: tuple[RmsMeasure, ...]
    """Measures of the heights, their half-derivative and their slopes."""
    half_derivative: Estimate[float]
    """Mean square of the half-derivative by the spectrum. (Units: m)"""
    recorded: Estimate[float]
    """Mean square of the half-derivative in the recorded waves. (Units: m)"""

    def conformity_energy(
        self, contact_modulus: float, half_derivative: Estimate[float] | None = None
    ) -> Estimate[float]:
        """Energy of full conformity e_el = E'/4 [h_rms^(1/2)]^2, for E' in Pa (Units: J / m^2).

        `half_derivative` replaces the mean square of the spectrum (Units: m).
        """
        square = half_derivative or self.half_derivative
        return square.each(lambda number: contact_modulus / 4 * number)


@dataclass(frozen=True, slots=True)
class MeasuredSurface(RoughSurface):
    """A surface by its scans."""

    scans: tuple[Scan, ...]
    """The measurements with their trusted bands."""
    joint: JointSpectrum
    """Spectrum of all scans: isotropic densities of maps, densities of profiles of lines."""

    @property
    def spectrum(self) -> TabulatedSpectrum:
        """Spectrum for predictions (Units: m)."""
        return self.joint.spectrum

    @property
    def shares(self) -> Shares:
        """Contributions to e_el."""
        return self.joint.shares

    @property
    def shortest(self) -> float:
        """Shortest measured wavelength (Units: m)."""
        return self.joint.shortest

    @property
    def longest(self) -> float:
        """Longest measured wavelength (Units: m)."""
        return self.joint.longest

    @property
    def checksum(self) -> str:
        """Eight hexadecimal digits from the content of all files, in their order."""
        text = "".join(scan.measurement.checksum for scan in self.scans)
        return hashlib.sha256(text.encode()).hexdigest()[:8]


def measured_surface(
    measurements: Sequence[Measurement], shortest: float | None = None, longest: float | None = None
) -> MeasuredSurface:
    """Spectrum and measures of a surface from one or several measurements.

    Ends of the trusted wavelengths (Units: m) replace those that the densities show. ValueError if
    the densities do not determine a spectrum.
    """
    several = len(measurements) > 1
    scans = tuple(
        analysed_scan(measurement, shortest, longest, has_common_band=several)
        for measurement in measurements
    )
    try:
        joint = joint_spectrum(scans)
    except np.linalg.LinAlgError:
        raise ValueError(
            f"{_names(scans)}: the density does not determine a spectrum, as it does not fall like "
            "the density of a surface; use a finer or larger scan, or name --shortest and "
            "--longest about the waves of its roughness"
        ) from None
    _check_determined(scans, joint)
    return MeasuredSurface(
        scans=scans,
        joint=joint,
        measures=tuple(_rms_measure(order, joint) for order in ORDERS),
        half_derivative=joint.draws.mean_square(0.5),
        recorded=joint.draws.recorded_mean_square(0.5),
    )


def read_surface(paths: Sequence[Path], options: Sequence[ReadingOptions]) -> MeasuredSurface:
    """Surface from files, with options for each of them.

    ValueError if a file cannot be used, or the densities do not determine a spectrum; OSError if a
    file cannot be opened.
    """
    measurements = read_measurements(paths, options)
    return measured_surface(measurements, options[0].shortest, options[0].longest)


def _check_determined(scans: Sequence[Scan], joint: JointSpectrum) -> None:
    """ValueError if e_el is too uncertain, as for a surface whose roughness cannot be resolved."""
    energy = joint.draws.mean_square(0.5)
    if energy.high < _UNDETERMINED * energy.low:
        return
    if any(joint.density.disagrees(index) for index in range(len(scans))):
        advice = (
            "the scans disagree where they overlap, so predict from each alone, and leave out the "
            "scan that does not resolve the surface"
        )
    elif any(scan.band.stripes for scan in scans):
        advice = (
            "waves along an axis are left out because the instrument may have shifted rows; if "
            "they are grooves, the surface is not isotropic, as the theory assumes"
        )
    else:
        advice = (
            "use a finer or larger scan, or name --shortest and --longest about the waves of its "
            "roughness"
        )
    raise ValueError(
        f"{_names(scans)}: the density does not determine e_el: the upper end of its interval is "
        f"{energy.high / energy.low:.0e} times the lower end; {advice}"
    )


def _names(scans: Sequence[Scan]) -> str:
    """Paths of scans, for a sentence."""
    return " and ".join(str(scan.measurement.path) for scan in scans)


def _rms_measure(order: float, joint: JointSpectrum) -> RmsMeasure:
    """Measure of an order."""
    draws = joint.draws
    rms = draws.estimate(np.sqrt(draws.estimated[ORDERS.index(order)]))
    return RmsMeasure(order, rms, *joint.spectrum.dominant_wavelengths(order, DOMINANT_SHARE))
