"""The law of k at the spectra and amplitudes of a sweep, and the measured k relative to it."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

import numpy as np

from crackfront.analysis.estimate import REACH, Estimate, mean_estimate
from crackfront.analysis.law import (
    WEAKEST,
    infinite_ratio,
    pinning_factors,
    shipped_law,
    spectral_breadth,
)
from crackfront.analysis.law_spheres import sphere_estimates
from crackfront.analysis.table import SweepTable
from crackfront.core.adhesion import FieldKind, adhesion_rms, larkin_length
from crackfront.core.arrays import Array
from crackfront.core.spectrum import Spectrum

LARGE = 1.0
"""Size g above which measured k are compared with the law."""

_CURVE_POINTS = 40
"""Points of the curve of k of a spectrum."""


@dataclass(frozen=True, slots=True)
class SweepLaw:
    """The law at the spectra and amplitudes of a sweep."""

    table: SweepTable
    kind: FieldKind
    """What its spectra describe."""
    uncorrelated: bool = False
    """Whether the sites of straight fronts are statistically independent: the limit of weak
    disorder, in which the amplitude only decides the distance of the sites."""

    @property
    def energy(self) -> Array:
        """Mean measured e_el, (n_spectrum, n_amplitude) (Units: w_int)."""
        return mean_estimate(np.where(self.table.finite, self.table.e_el, np.nan))[0].value

    @property
    def support_lengths(self) -> Array:
        """Springs of straight fronts, or contact radii, (n_spectrum, n_amplitude)."""
        table = self.table
        radius = mean_estimate(np.where(table.finite, table.contact_radius, np.nan))[0].value
        return np.where(np.isfinite(table.spring), table.spring, radius)

    def factors(self, index: int, energies: Array, supports: Array) -> tuple[Estimate, Array]:
        """Factors k of a spectrum and sizes g at arrays of e_el and of springs or contact radii.

        They are NaN if a number is out of range, a sphere is too close to pull-off, or the law does
        not cover the spectrum.
        """
        spectrum, unknown = self.table.shape_of(index), np.full(energies.shape, np.nan)
        if not spectrum.is_isotropic:
            return Estimate(unknown, unknown, unknown, unknown), unknown
        factors, sizes = self._factors(spectrum, energies, supports)
        is_covered = self.table.is_covered(index)
        return factors if is_covered else factors.each(lambda _: unknown), sizes

    def _factors(
        self, spectrum: Spectrum, energies: Array, supports: Array
    ) -> tuple[Estimate, Array]:
        """Factors and sizes of :meth:`factors`, of Gaussian surfaces of an isotropic spectrum."""
        if not self.table.on_springs:
            return sphere_estimates(self.kind, spectrum, energies, supports)
        valid = (energies > 0) & (energies < 1) & (supports > 0) & (supports < math.inf)
        w_rms = adhesion_rms(np.where(valid, energies, np.nan))
        sizes = supports * w_rms**2 / larkin_length(self.kind, spectrum, 1.0)
        breadth = spectral_breadth(self.kind, spectrum)
        return pinning_factors(self._disorder(w_rms), sizes, breadth).factor, sizes

    def _disorder(self, w_rms: Array) -> Array:
        """Disorder s for the law, from the rms of w_loc."""
        return np.full(w_rms.shape, WEAKEST) if self.uncorrelated else w_rms

    def cells(self) -> tuple[Estimate, Array]:
        """Factors k and sizes g at every spectrum and amplitude, (n_spectrum, n_amplitude)."""
        rows = zip(self.energy, self.support_lengths, strict=True)
        spectra = [self.factors(index, *row) for index, row in enumerate(rows)]
        factors = np.stack([astuple(factor) for factor, _ in spectra], axis=1)
        return Estimate(*factors), np.stack([sizes for _, sizes in spectra])

    def curve(self, index: int) -> tuple[Array, Array]:
        """Values of e_el and factors k of a spectrum between its amplitudes.

        Both arrays are empty with fewer than two amplitudes. Springs and radii are interpolated
        between amplitudes, on logarithmic axes. k is NaN if g is below the sizes of the law.
        """
        energies, supports = self.energy[index], self.support_lengths[index]
        finite = np.isfinite(energies) & np.isfinite(supports)
        if np.count_nonzero(finite) < 2:
            return np.empty(0), np.empty(0)
        order = np.argsort(energies[finite])
        places, lengths = np.log(energies[finite][order]), np.log(supports[finite][order])
        between = np.linspace(places[0], places[-1], _CURVE_POINTS)
        curve = np.exp(between)
        factor, sizes = self.factors(index, curve, np.exp(np.interp(between, places, lengths)))
        return curve, np.where(sizes >= shipped_law().size[0], factor.value, np.nan)

    @property
    def breadths(self) -> Array:
        """Breadth of each spectrum, (n_spectrum,); NaN where the law does not cover it."""
        table = self.table
        return np.array(
            [
                spectral_breadth(self.kind, table.shape_of(index))
                if table.is_covered(index)
                else math.nan
                for index in range(table.spectrum.size)
            ]
        )

    def infinite(self, factor: Estimate, size: Array) -> Estimate:
        """Measured k of every cell extrapolated to the infinite contact.

        The measured k is multiplied by the law's ratio of k in the infinite contact to k at the
        size. The half-widths of both intervals are added in quadrature.
        """
        breadth = self.breadths[:, None]
        gain = infinite_ratio(self._disorder(adhesion_rms(self.energy)), size, breadth)
        value, relative = factor.value * gain.value, factor.value * gain.standard_error
        error = np.hypot(factor.standard_error * gain.value, relative)
        reach = np.hypot((factor.high - factor.value) * gain.value, REACH * relative)
        return Estimate(value, error, value - reach, value + reach)


def law_departure(factor: Estimate, law: Estimate, size: Array) -> tuple[int, float]:
    """Number of cells with g above 1, and the rms of the relative departure of their k.

    The rms is NaN without such a cell.
    """
    departure = factor.value / law.value - 1
    large = departure[np.isfinite(departure) & (np.nan_to_num(size) > LARGE)]
    return large.size, float(np.sqrt(np.mean(large**2))) if large.size else math.nan
