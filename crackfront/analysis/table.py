"""What the table of a sweep holds, and what a fit reads of it, on plain arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.steady import SteadyMeasures
from crackfront.core.records import ADHESION, FORCE, LATERAL, VERTICAL, variable

Array = NDArray[np.float64]

SPECTRUM, AMPLITUDE, REALISATION = "spectrum", "amplitude", "realisation"
"""Dimensions of a sweep."""

_SHAPE = SPECTRUM, AMPLITUDE


@dataclass(frozen=True)
class RunMeasures:
    """What is measured on the tile of a simulation, and what the simulation cost."""

    e_el: float = variable("energy of full conformity measured on the tile", ADHESION)
    w_rms: float = variable("rms of the local work of adhesion measured on the tile", ADHESION)
    seconds: float = variable("wall time of synthesis and cycle", "s")
    cpu_seconds: float = variable("processor time of synthesis and cycle", "s")
    peak_memory: float = variable(
        "high-water mark of the process when the simulation ended, earlier ones included", "byte"
    )


@dataclass(frozen=True)
class SweepRow(SteadyMeasures, RunMeasures):
    """One simulation of a sweep; without a value the works of adhesion are NaN."""

    w_appr_numerical_error: float = variable("expected numerical error of w_appr", ADHESION)
    w_retr_numerical_error: float = variable("expected numerical error of w_retr", ADHESION)
    iterations: int = variable("sweeps of the solver, sum over the cycle", "1")
    n_step: int = variable("states of the cycle", "1")
    pull_off_force: float = variable("lowest force of a full cycle", FORCE)
    end_penetration: float = variable("penetration at which the cycle ended", VERTICAL)
    status: str = variable("how it ended: lost_contact or steady where it is complete", "1")
    status_sentence: str = variable("the same in words", "1")
    seed: int = variable("numpy.random.default_rng(seed) gives the surface's noise", "1")
    curve: str = variable("file of the simulation in the folder curves", "1")


@dataclass(frozen=True, slots=True)
class SweepAxes:
    """Coordinates of the table of a sweep."""

    spectrum: NDArray[np.str_] = variable("name of the spectrum", "1", SPECTRUM)
    short_cutoff: Array = variable("shortest wavelength lambda_s", LATERAL, SPECTRUM)
    roll_off: Array = variable("roll-off wavelength lambda_r", LATERAL, SPECTRUM)
    hurst: Array = variable("Hurst exponent, without effect on a flat spectrum", "1", SPECTRUM)
    correlation_length: Array = variable(
        "wavelength of the mean wavevector of w", LATERAL, SPECTRUM
    )
    n_angle: NDArray[np.int64] = variable("sites of the front", "1", *_SHAPE)
    sample_spacing: Array = variable("distance of samples along a ray", LATERAL, *_SHAPE)
    tile_side: Array = variable("side of the periodic tile", LATERAL, SPECTRUM)
    n_point: NDArray[np.int64] = variable("points along a side of the tile", "1", *_SHAPE)
    tolerance: Array = variable(
        "largest force along the motion that may be left", ADHESION, *_SHAPE
    )
    amplitude: Array = variable("requested e_el (chemical field: w_rms^2/4)", ADHESION, AMPLITUDE)
    w_rms_requested: Array = variable("requested rms, 2 sqrt(e_el w_int)", ADHESION, AMPLITUDE)
    realisation: NDArray[np.int64] = variable("number of the realisation", "1", REALISATION)


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
