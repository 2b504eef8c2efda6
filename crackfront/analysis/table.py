"""Rows and coordinates of the table of a sweep, and the part that a fit reads, on plain arrays."""

from __future__ import annotations

import json
from dataclasses import MISSING, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crackfront.analysis.jump_measures import JumpMeasures
from crackfront.analysis.run_measures import RunMeasures
from crackfront.analysis.steady_adhesion import SteadyMeasures
from crackfront.core.arrays import Array
from crackfront.core.spectrum import ENSEMBLE, SelfAffineSpectrum, Spectrum
from crackfront.core.variables import ADHESION, FORCE, LATERAL, VERTICAL, variable, variables

SPECTRUM, AMPLITUDE, REALISATION = "spectrum", "amplitude", "realisation"
"""Dimensions of a sweep."""

PLACE = SPECTRUM, AMPLITUDE, REALISATION
"""Dimensions whose coordinates identify one simulation of a sweep."""

_CELL = SPECTRUM, AMPLITUDE
"""Dimensions of what all realisations share."""

_SHAPE_TEXT = "JSON of parameters in reduced units, where not all are self-affine and Gaussian"


@dataclass(frozen=True)
class SweepRow(SteadyMeasures, RunMeasures):
    """One simulation of a sweep; without a value the works of adhesion are NaN."""

    w_appr_numerical_error: float = variable("expected numerical error of w_appr", ADHESION)
    w_retr_numerical_error: float = variable("expected numerical error of w_retr", ADHESION)
    iterations: int = variable("sweeps of the solver, sum over the cycle", "1")
    n_step: int = variable("states of the cycle", "1")
    pull_off_force: float = variable("lowest force of a full cycle", FORCE)
    end_penetration: float = variable("last penetration; NaN of a straight front", VERTICAL)
    status: str = variable("how it ended: lost_contact or steady where it is complete", "1")
    status_sentence: str = variable("the same in words", "1")
    seed: int = variable("numpy.random.default_rng(seed) gives the surface's noise", "1")
    max_sweeps: int = variable("limit of sweeps of a load step", "1")


@dataclass(frozen=True)
class JumpRow(SweepRow, JumpMeasures):
    """One simulation of a sweep that records jumps."""


def row_type(records_jumps: bool) -> type[SweepRow]:
    """Class of the rows of simulations that record jumps, or do not."""
    return JumpRow if records_jumps else SweepRow


@dataclass(frozen=True, slots=True)
class SweepAxes:
    """Coordinates of the table of a sweep."""

    spectrum: NDArray[np.str_] = variable("name of the spectrum", "1", SPECTRUM)
    short_cutoff: Array = variable("shortest wavelength lambda_s", LATERAL, SPECTRUM)
    roll_off: Array = variable("roll-off lambda_r, or longest wave of effect", LATERAL, SPECTRUM)
    hurst: Array = variable("Hurst exponent; NaN of spectra without one", "1", SPECTRUM)
    correlation_length: Array = variable(
        "wavelength of the mean wavevector of w", LATERAL, SPECTRUM
    )
    spring: Array = variable("springs of a straight front, L_kappa; else NaN", LATERAL, *_CELL)
    n_angle: NDArray[np.int64] = variable("sites of the front", "1", *_CELL)
    sample_spacing: Array = variable("distance of samples along a ray", LATERAL, *_CELL)
    tile_side: Array = variable("side of the periodic tile", LATERAL, *_CELL)
    n_point: NDArray[np.int64] = variable("points along a side of the tile", "1", *_CELL)
    tolerance: Array = variable("largest force along the motion that may be left", ADHESION, *_CELL)
    series: NDArray[np.str_] = variable(
        "digest of the parameters that realisations share", "1", *_CELL
    )
    amplitude: Array = variable("requested e_el (chemical field: w_rms^2/4)", ADHESION, AMPLITUDE)
    w_rms_requested: Array = variable("requested rms, 2 sqrt(e_el w_int)", ADHESION, AMPLITUDE)
    realisation: NDArray[np.int64] = variable("number of the realisation", "1", REALISATION)
    parameters: NDArray[np.str_] | None = variable(_SHAPE_TEXT, "1", SPECTRUM, default=None)


COLUMNS = {item.name: item for item in (*variables(SweepAxes), *variables(JumpRow, *PLACE))}
"""Variables of the table of a sweep, by their names."""


def column(name: str, default: Any = MISSING) -> Any:
    """A field of a dataclass with the unit, text and dimensions of a column of the table."""
    item = COLUMNS[name]
    return variable(item.long_name, item.units, *item.dims, default=default)


@dataclass(frozen=True, slots=True)
class SweepTable:
    """Arrays of a sweep that a fit reads, NaN if a simulation failed."""

    spectrum: NDArray[np.str_] = column("spectrum")
    # The file of a fit states these in shorter words than the table does.
    short_cutoff: Array = variable("shortest wavelength", LATERAL, SPECTRUM)
    roll_off: Array = variable("roll-off wavelength", LATERAL, SPECTRUM)
    correlation_length: Array = variable("correlation length of w_loc", LATERAL, SPECTRUM)
    hurst: Array = variable("Hurst exponent", "1", SPECTRUM)
    amplitude: Array = variable("requested e_el", ADHESION, AMPLITUDE)
    e_el: Array = column("e_el")
    w_rms: Array = column("w_rms")
    w_appr: Array = column("w_appr")
    w_retr: Array = column("w_retr")
    w_appr_from_force: Array = column("w_appr_from_force")
    w_retr_from_force: Array = column("w_retr_from_force")
    w_appr_numerical_error: Array = column("w_appr_numerical_error")
    w_retr_numerical_error: Array = column("w_retr_numerical_error")
    contact_radius: Array = variable("middle of the steady window; else NaN", LATERAL, *PLACE)
    spring: Array = column("spring")
    parameters: NDArray[np.str_] | None = column("parameters", default=None)

    @property
    def numerical_error(self) -> Array:
        """Numerical error of k; the errors of both branches add, as biases of opposite signs."""
        return (self.w_appr_numerical_error + self.w_retr_numerical_error) / (2 * self.e_el)

    @property
    def on_springs(self) -> bool:
        """Whether the fronts are straight and on springs, not on spheres."""
        return bool(np.any(np.isfinite(self.spring)))

    @property
    def finite(self) -> NDArray[np.bool_]:
        """Simulations with a value, (n_spectrum, n_amplitude, n_realisation)."""
        columns = (self.e_el, self.w_rms, self.w_appr, self.w_retr)
        return np.asarray(np.all(np.isfinite(columns), axis=0))

    def shape_of(self, index: int) -> Spectrum:
        """Spectrum of an entry of the table, with any amplitude."""
        if self.parameters is not None:
            shape = Spectrum.stated(json.loads(str(self.parameters[index])))
            assert shape is not None, "the table was written with the parameters of a shape"
            return shape
        columns = self.short_cutoff, self.roll_off, self.hurst
        return SelfAffineSpectrum(*(float(values[index]) for values in columns))

    def is_covered(self, index: int) -> bool:
        """Whether the law of k was measured on such surfaces: Gaussian and isotropic ones."""
        return self.shape_of(index).is_isotropic and not self.ensemble(index)

    def ensemble(self, index: int) -> str:
        """Description of the surfaces of an entry; empty if they are Gaussian."""
        if self.parameters is None:
            return ""
        return str(json.loads(str(self.parameters[index])).get(ENSEMBLE, ""))

    @property
    def shape(self) -> Array:
        """Number of each spectrum's shape, (n_spectrum,); spectra of one shape differ in size."""
        keys = [self._shape_key(index) for index in range(self.spectrum.size)]
        distinct = [*dict.fromkeys(keys)]
        return np.array([distinct.index(key) for key in keys])

    def _shape_key(self, index: int) -> tuple[object, ...]:
        """What two entries share if their surfaces differ in size alone."""
        spectrum = self.shape_of(index)
        lengths, numbers = spectrum.identity
        octaves = np.round(np.log2(np.array(lengths) / spectrum.short_cutoff), 9)
        if isinstance(spectrum, SelfAffineSpectrum) and not np.any(octaves):
            numbers = ()  # a flat spectrum lacks a Hurst exponent
        return *octaves.tolist(), *numbers, self.ensemble(index)

    @property
    def family(self) -> Array:
        """Number of the shape and the springs in correlation lengths, (n_spectrum,)."""
        springs = np.log2(self.spring[:, 0] / self.correlation_length)
        rounded = np.stack([self.shape, np.round(np.nan_to_num(springs), 6)])
        return np.asarray(np.unique(rounded, axis=1, return_inverse=True)[1])
