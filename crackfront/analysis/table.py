"""What a fit reads: the works of adhesion of a sweep on plain arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CELL_COLUMNS = (
    "e_el",
    "w_rms",
    "w_appr",
    "w_retr",
    "w_appr_from_force",
    "w_retr_from_force",
    "w_appr_numerical_error",
    "w_retr_numerical_error",
)
"""Columns of a table that have a value for every simulation."""


@dataclass(frozen=True, slots=True)
class SweepTable:
    """Apparent works of adhesion of a sweep.

    Attributes
    ----------
    spectrum : (n_spectrum,) str array
        Names of the spectra.
    short_cutoff, roll_off, hurst : (n_spectrum,) array
        Parameters of the spectra. (Lengths in the reduced lateral unit)
    correlation_length : (n_spectrum,) array
        Wavelength of the mean wavevector of w_loc. (Units: reduced lateral length)
    e_el_requested : (n_amplitude,) array
        Energy of full conformity of the spectra. (Units: w_int)
    e_el, w_rms : (n_spectrum, n_amplitude, n_realisation) array
        Energy of full conformity, for a chemical field its equivalent w_rms^2 / 4, and rms of
        w_loc, both measured on the tile. (Units: w_int)
    w_appr, w_retr : (n_spectrum, n_amplitude, n_realisation) array
        Apparent work of adhesion of the branches; NaN where a simulation failed.
        (Units: w_int)
    w_appr_from_force, w_retr_from_force : (n_spectrum, n_amplitude, n_realisation) array
        The same from a JKR fit of force against mean radius. (Units: w_int)
    w_appr_numerical_error, w_retr_numerical_error : (n_spectrum, n_amplitude, n_realisation) array
        Numerical standard errors that the laws state. (Units: w_int)

    Raises
    ------
    ValueError
        If the shapes disagree, or a measured e_el or w_rms is not positive.
    """

    spectrum: NDArray[np.str_]
    short_cutoff: Array
    roll_off: Array
    hurst: Array
    correlation_length: Array
    e_el_requested: Array
    e_el: Array
    w_rms: Array
    w_appr: Array
    w_retr: Array
    w_appr_from_force: Array
    w_retr_from_force: Array
    w_appr_numerical_error: Array
    w_retr_numerical_error: Array

    def __post_init__(self) -> None:
        n_spectrum, n_amplitude = self.spectrum.size, self.e_el_requested.size
        for name in ("short_cutoff", "roll_off", "hurst", "correlation_length"):
            shape = getattr(self, name).shape
            if shape != (n_spectrum,):
                raise ValueError(f"{name} has shape {shape}; there are {n_spectrum} spectra")
        whole = (n_spectrum, n_amplitude, self.e_el.shape[-1])
        for name in CELL_COLUMNS:
            shape = getattr(self, name).shape
            if shape != whole:
                raise ValueError(
                    f"{name} has shape {shape}; (spectrum, amplitude, realisation) is {whole}"
                )
        for name in ("e_el", "w_rms"):
            lowest = np.min(getattr(self, name), where=self.finite, initial=np.inf)
            if not lowest > 0:
                raise ValueError(
                    f"measured {name} is {lowest}, where hysteresis has no scale; leave "
                    "simulations without disorder out of the table"
                )

    @property
    def numerical_error(self) -> Array:
        """Numerical error of k, both branches in opposite directions, as biases are."""
        return (self.w_appr_numerical_error + self.w_retr_numerical_error) / (2 * self.e_el)

    @property
    def finite(self) -> NDArray[np.bool_]:
        """Simulations with a value, (n_spectrum, n_amplitude, n_realisation)."""
        columns = (self.e_el, self.w_rms, self.w_appr, self.w_retr)
        return np.asarray(np.all(np.isfinite(columns), axis=0))

    @property
    def shape(self) -> Array:
        """Number of the shape of each spectrum, (n_spectrum,); shapes differ not by their size."""
        octaves = np.round(np.log2(self.roll_off / self.short_cutoff), 9)
        hurst = np.where(octaves > 0, self.hurst, 0.0)
        return np.asarray(np.unique(np.stack([octaves, hurst]), axis=1, return_inverse=True)[1])
