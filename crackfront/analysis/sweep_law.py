"""The law of k at the spectra and amplitudes of a sweep, and the measured k relative to it."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

import numpy as np

from crackfront.analysis.estimate import REACH, Estimate, mean_estimate
from crackfront.analysis.law import (
    WEAKEST,
    infinite_ratio,
    pinning_factor,
    shipped_law,
    spectral_breadth,
)
from crackfront.analysis.law_spheres import sphere_factors
from crackfront.analysis.table import SweepTable
from crackfront.core.adhesion import FieldKind, larkin_length
from crackfront.core.arrays import Array

LARGE = 1.0
"""Size g above which measured k are compared with the law."""

_UNKNOWN = Estimate(*(math.nan,) * 4)

_CURVE = 40
"""Points of the curve of a spectrum."""


@dataclass(frozen=True, slots=True)
class SweepLaw:
    """The law at the spectra and amplitudes of a sweep, by the springs that hold its fronts."""

    table: SweepTable
    kind: FieldKind
    """What its spectra describe."""
    uncorrelated: bool = False
    """Whether sites of straight fronts are independent of each other, the limit of weak disorder.

    The amplitude then decides only the distance of the sites."""

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

    def factor(self, index: int, energy: float, support: float) -> tuple[Estimate[float], float]:
        """Factor k of a spectrum at an e_el and a spring or contact radius, and g; else NaN."""
        if not (0 < energy < 1 and 0 < support < math.inf):
            return _UNKNOWN, math.nan
        spectrum = self.table.shape_of(index)
        if self.table.on_springs:
            w_rms = 2 * math.sqrt(energy)
            size = support / larkin_length(self.kind, spectrum, w_rms)
            disorder = WEAKEST if self.uncorrelated else w_rms
            breadth = spectral_breadth(self.kind, spectrum)
            return pinning_factor(disorder, size, self.kind, breadth).factor, size
        try:
            found = sphere_factors(self.kind, spectrum, energy, support)
        except ValueError:
            # So close to pull-off that nothing holds the edge.
            return _UNKNOWN, math.nan
        return found.both, found.size

    def cells(self) -> tuple[Estimate, Array]:
        """Factors k and sizes g at every spectrum and amplitude, (n_spectrum, n_amplitude)."""
        energies, supports = self.energy, self.support_lengths
        values, sizes = np.empty((4, *energies.shape)), np.empty(energies.shape)
        for cell in np.ndindex(energies.shape):
            found, sizes[cell] = self.factor(cell[0], float(energies[cell]), float(supports[cell]))
            values[:, cell[0], cell[1]] = astuple(found)
        return Estimate(*values), sizes

    def curve(self, index: int) -> tuple[Array, Array]:
        """Values of e_el and factors k of a spectrum between its amplitudes; empty without two.

        Between amplitudes springs and radii are interpolated, in the logarithm of both. Where g is
        below the sizes of the law k is NaN.
        """
        energies, supports = self.energy[index], self.support_lengths[index]
        known = np.isfinite(energies) & np.isfinite(supports)
        if np.count_nonzero(known) < 2:
            return np.empty(0), np.empty(0)
        order = np.argsort(energies[known])
        places, lengths = np.log(energies[known][order]), np.log(supports[known][order])
        between = np.linspace(places[0], places[-1], _CURVE)
        factors, least = np.full(_CURVE, np.nan), shipped_law().size[0]
        for number, support in enumerate(np.interp(between, places, lengths)):
            found, size = self.factor(index, math.exp(between[number]), math.exp(support))
            if size >= least:
                factors[number] = found.value
        return np.exp(between), factors

    def infinite(self, factor: Estimate, size: Array) -> Estimate:
        """Measured k of every cell extrapolated to the infinite contact.

        The gain is the ratio of the law's k in the infinite contact to that at the size. The
        half-widths of the intervals of the measured k and of the gain are added in quadrature.
        """
        energies, values = self.energy, np.full((4, *size.shape), np.nan)
        for cell in np.ndindex(size.shape):
            w_rms = WEAKEST if self.uncorrelated else 2 * math.sqrt(energies[cell])
            breadth = spectral_breadth(self.kind, self.table.shape_of(cell[0]))
            gain = infinite_ratio(w_rms, float(size[cell]), breadth)
            measured, own_error = float(factor.value[cell]), float(factor.standard_error[cell])
            value, relative = measured * gain.value, measured * gain.standard_error
            error = math.hypot(own_error * gain.value, relative)
            reach = math.hypot((float(factor.high[cell]) - measured) * gain.value, REACH * relative)
            values[:, cell[0], cell[1]] = value, error, value - reach, value + reach
        return Estimate(*values)


def law_departure(factor: Estimate, law: Estimate, size: Array) -> tuple[int, float]:
    """Number of cells with g above 1, and the rms of how far their k departs from the law's.

    The departure is relative to the law's k, and NaN where there is no such cell.
    """
    apart = factor.value / law.value - 1
    chosen = apart[np.isfinite(apart) & (np.nan_to_num(size) > LARGE)]
    return chosen.size, float(np.sqrt(np.mean(chosen**2))) if chosen.size else math.nan
