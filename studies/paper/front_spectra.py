"""Spectra of fronts and the roughness exponents that fit them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crackfront.analysis.estimate import mean_estimate
from crackfront.core.arrays import Array
from crackfront.core.variables import ADHESION, LATERAL, variable
from studies.paper.figure import Integers

_DISORDER, _SURFACE, _MODE, _LAG = "disorder", "surface", "mode", "lag"

_BINS_A_DECADE = 12
"""Bins over which the drawn spectra are averaged."""


@dataclass(frozen=True, slots=True)
class RoughnessRecord:
    """Power and height differences of fronts: of a sphere, then straight ones.

    A straight front counts as the perimeter of a circle, and its springs as the stiffness of a
    circle. Both have the same short cutoff.
    """

    short_cutoff: float = variable("shortest wavelength of the roughness", LATERAL)
    elastic_energy: Array = variable("requested e_el", ADHESION, _DISORDER)
    rms: Array = variable("w_rms, of the sphere the mean of its tiles", ADHESION, _DISORDER)
    larkin_length: Array = variable("Larkin length", LATERAL, _DISORDER)
    radius: Array = variable("mean radius of the fronts", LATERAL, _DISORDER)
    ring_stiffness: Array = variable(
        "stiffness of the circle, a dG/da; mode n is stiffer by n", ADHESION, _DISORDER
    )
    longest: Array = variable("longest wavelength of the fit", LATERAL, _DISORDER)
    shortest: Array = variable("shortest wavelength of the fit", LATERAL, _DISORDER)
    mode: Integers = variable("waves around the perimeter", "1", _MODE)
    power: Array = variable(
        "power spectral density along the front, mean of the fronts of a surface",
        f"({LATERAL})^3",
        _DISORDER,
        _SURFACE,
        _MODE,
    )
    lag: Array = variable("distance along the front", LATERAL, _LAG)
    difference: Array = variable("rms difference of the radius", LATERAL, _DISORDER, _LAG)


@dataclass(frozen=True, slots=True)
class RoughnessFit:
    """Roughness exponent zeta, half of its 95% interval over surfaces, both ends of the line."""

    exponent: float
    reach: float
    wavevector: Array
    power: Array


def stiffness_wavevector(record: RoughnessRecord, index: int) -> Array:
    """Wavevector of a straight line of the stiffness of each mode, (n + a dG/da) / a.

    The sphere pulls a front back to its circle, which a straight line does not know; so that
    the spectrum of a front is a power of this stiffness rather than of n alone.
    """
    return (record.mode + record.ring_stiffness[index]) / record.radius[index]


def fitted_roughness(record: RoughnessRecord, index: int) -> RoughnessFit:
    r"""Fit of :math:`C \propto \kappa^{-(1 + 2\zeta)}` with kappa of `stiffness_wavevector`.

    Least squares of the logarithm, each surface by itself, all octaves of the same weight.
    """
    wavelength = 2 * np.pi * record.radius[index] / record.mode
    used = (wavelength >= record.shortest[index]) & (wavelength <= record.longest[index])
    wavevector = stiffness_wavevector(record, index)[used]
    weight = record.mode[used] ** -0.5
    power = record.power[index][:, used]
    slopes = np.polyfit(np.log(wavevector), np.log(power).T, 1, w=weight)[0]
    # The logarithm of the mean of a few fronts is lower than of the mean over all surfaces.
    freed = np.log(power.mean(axis=0)) - slopes.mean() * np.log(wavevector)
    level = np.average(freed, weights=weight**2)
    exponent = mean_estimate(-(1 + slopes) / 2)[0].each(float)
    ends = wavevector[[0, -1]]
    return RoughnessFit(
        exponent=exponent.value,
        reach=exponent.high - exponent.value,
        wavevector=ends,
        power=np.exp(level + slopes.mean() * np.log(ends)),
    )


def binned_spectrum(record: RoughnessRecord, index: int) -> tuple[Array, Array, Array]:
    """Wavevectors, powers and errors over surfaces of one kind of fronts, means over bins."""
    wavevector, power = stiffness_wavevector(record, index), record.power[index]
    place = np.floor(_BINS_A_DECADE * np.log10(wavevector)).astype(int)
    bins = [place == value for value in np.unique(place)]
    means = np.array([power[:, inside].mean(axis=1) for inside in bins])
    middle = np.array([np.exp(np.log(wavevector[inside]).mean()) for inside in bins])
    return middle, means.mean(axis=1), means.std(axis=1, ddof=1) / np.sqrt(power.shape[0])
