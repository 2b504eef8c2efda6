"""What a surface is: rms measures of all orders, the scales behind them, and e_el."""

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
"""Upper over lower end of the interval of e_el from which on scans determine no spectrum."""

DOMINANT_SHARE = 0.8
"""Part of a mean square that lies within the scales that dominate it."""


@dataclass(frozen=True, slots=True)
class RmsMeasure:
    """Root mean square of a derivative of the heights."""

    order: float
    rms: Estimate[float]
    """Of the joint spectrum. (Units: m^(1 - order))"""
    shortest: float
    longest: float
    """Wavelengths that dominate it: a tenth lies below, a tenth above. (Units: m)"""


@dataclass(frozen=True, slots=True)
class RoughSurface:
    """Rms measures of a surface, and its energy of full conformity."""

    measures: tuple[RmsMeasure, ...]
    """Of the heights, their half-derivative and their slopes."""
    half_derivative: Estimate[float]
    """Mean square of the half-derivative of the spectrum. (Units: m)"""
    recorded: Estimate[float]
    """That of what was measured. (Units: m)"""

    def conformity_energy(
        self, contact_modulus: float, half_derivative: Estimate[float] | None = None
    ) -> Estimate[float]:
        """Energy of full conformity e_el = E'/4 [h_rms^(1/2)]^2, of E' in Pa (Units: J / m^2).

        By another mean square of the half-derivative where one is given. (Units: m)
        """
        square = half_derivative or self.half_derivative
        return square.each(lambda number: contact_modulus / 4 * number)


@dataclass(frozen=True, slots=True)
class MeasuredSurface(RoughSurface):
    """What was measured of a surface, and what follows from it."""

    scans: tuple[Scan, ...]
    """The measurements with their trusted bands."""
    joint: JointSpectrum
    """Their spectrum; maps enter by their isotropic density, lines by that of profiles."""

    @property
    def spectrum(self) -> TabulatedSpectrum:
        """Spectrum that predictions take (Units: m)."""
        return self.joint.spectrum

    @property
    def shares(self) -> Shares:
        """Where e_el comes from."""
        return self.joint.shares

    @property
    def shortest(self) -> float:
        """Shortest wavelength that is measured (Units: m)."""
        return self.joint.shortest

    @property
    def longest(self) -> float:
        """Longest wavelength that is measured (Units: m)."""
        return self.joint.longest

    @property
    def checksum(self) -> str:
        """Eight hexadecimal digits of the content of all files, in their order."""
        text = "".join(one.measurement.checksum for one in self.scans)
        return hashlib.sha256(text.encode()).hexdigest()[:8]


def measured_surface(
    measurements: Sequence[Measurement], shortest: float | None = None, longest: float | None = None
) -> MeasuredSurface:
    """Spectrum and measures of a surface of which there is one measurement or several.

    Ends of the trusted wavelengths (Units: m) stand in place of those that are found in each.
    ValueError if the densities do not determine a spectrum.
    """
    several = len(measurements) > 1
    scans = tuple(
        analysed_scan(item, shortest, longest, among_others=several) for item in measurements
    )
    try:
        joint = joint_spectrum(scans)
    except np.linalg.LinAlgError:
        raise ValueError(
            f"{_names(scans)}: the density determines no spectrum, as it does not fall as those of "
            "surfaces do; use a finer or larger scan, or name --shortest and --longest about the "
            "waves of its roughness"
        ) from None
    _refuse_undetermined(scans, joint)
    return MeasuredSurface(
        scans=scans,
        joint=joint,
        measures=tuple(_rms_measure(order, joint) for order in ORDERS),
        half_derivative=joint.draws.mean_square(0.5),
        recorded=joint.draws.recorded_mean_square(0.5),
    )


def read_surface(paths: Sequence[Path], options: Sequence[ReadingOptions]) -> MeasuredSurface:
    """Surface of files, each of which is read by its options.

    ValueError if a file cannot be used, or the densities do not determine a spectrum; OSError if
    one cannot be opened.
    """
    measurements = read_measurements(paths, options)
    return measured_surface(measurements, options[0].shortest, options[0].longest)


def _refuse_undetermined(scans: Sequence[Scan], joint: JointSpectrum) -> None:
    """Refuse scans whose e_el may be anything, as of a surface that shows no roughness."""
    energy = joint.draws.mean_square(0.5)
    if energy.high < _UNDETERMINED * energy.low:
        return
    if any(joint.density.disagrees(index) for index in range(len(scans))):
        advice = "they disagree where they overlap, so predict from each alone, and leave out the "
        advice += "one that does not resolve the surface"
    elif any(one.band.stripes for one in scans):
        advice = "waves along an axis are left out, as of rows that the instrument has shifted; if "
        advice += "they are grooves, the surface is not isotropic, as the theory needs it"
    else:
        advice = "use a finer or larger scan, or name --shortest and --longest about the waves of "
        advice += "its roughness"
    raise ValueError(
        f"{_names(scans)}: the density does not determine e_el, the upper end of whose "
        f"interval is {energy.high / energy.low:.0e} times the lower one; {advice}"
    )


def _names(scans: Sequence[Scan]) -> str:
    """Paths of scans, for a sentence."""
    return " and ".join(str(one.measurement.path) for one in scans)


def _rms_measure(order: float, joint: JointSpectrum) -> RmsMeasure:
    """Measure of one order."""
    draws = joint.draws
    rms = draws.estimate(np.sqrt(draws.estimated[ORDERS.index(order)]))
    return RmsMeasure(order, rms, *joint.spectrum.dominant_wavelengths(order, DOMINANT_SHARE))
