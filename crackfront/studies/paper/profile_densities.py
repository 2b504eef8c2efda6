"""The rough film of the paper: its ideal spectrum, and measured profile densities beside it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.data.section import InputFile, Positive, Section, refusal
from crackfront.studies.paper.measured import MeasuredFileError, Quantity, read_measured

Array = NDArray[np.float64]

_WAVEVECTOR = Quantity("q", {"1/m": 1.0, "1/um": 1e6, "1/nm": 1e9}, positive=True)
_DENSITY = Quantity("C1D", {"m^3": 1.0, "um^3": 1e-18, "nm^3": 1e-27}, positive=True)


class FilmParameters(Section):
    """A rough film under a soft sphere, in SI units.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Sphere. (Units: Pa, 1)
    short_cutoff, roll_off, hurst, plateau : float
        Spectrum of the heights. (Units: m, m, 1, m^4)
    measured : Path or None
        CSV file as :func:`read_profile_density` reads it.
    """

    young_modulus: Positive
    poisson_ratio: Annotated[float, Field(ge=0, le=0.5)]
    short_cutoff: Positive
    roll_off: Positive
    hurst: Annotated[float, Field(gt=0, le=1)]
    plateau: Positive
    measured: InputFile | None = None

    @model_validator(mode="after")
    def _ordered(self) -> FilmParameters:
        if self.roll_off < self.short_cutoff:
            raise refusal(
                f"roll_off {self.roll_off:g} is shorter than short_cutoff {self.short_cutoff:g}; "
                "lower the cutoff or raise the roll-off"
            )
        return self

    @model_validator(mode="after")
    def _readable(self) -> FilmParameters:
        try:
            self.points()
        except MeasuredFileError as error:
            raise refusal(str(error)) from error
        return self

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Spectrum of the heights (Units: m)."""
        return SelfAffineSpectrum(self.short_cutoff, self.roll_off, self.hurst, self.plateau)

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E' = E / (1 - nu^2) (Units: Pa)."""
        return self.young_modulus / (1 - self.poisson_ratio**2)

    def points(self) -> ProfileDensity:
        """What was measured."""
        return NOTHING_MEASURED if self.measured is None else read_profile_density(self.measured)


@dataclass(frozen=True, slots=True)
class ProfileDensity:
    """Measured spectral density of profiles.

    Attributes
    ----------
    wavevector : (n_point,) array
        Increasing. (Units: 1 / m)
    density : (n_point,) array
        C_1D. (Units: m^3)
    """

    wavevector: Array
    density: Array


NOTHING_MEASURED = ProfileDensity(np.empty(0), np.empty(0))


def read_profile_density(path: Path) -> ProfileDensity:
    """Profile density from a CSV file with the columns q (1/m) and C1D (m^3).

    The units are 1/m, 1/um or 1/nm, and m^3, um^3 or nm^3. The mean square height is the integral
    of C1D over q > 0, divided by pi.

    Parameters
    ----------
    path : Path
        CSV file, in the order of increasing wavevectors.

    Raises
    ------
    MeasuredFileError
        If it cannot be read, holds no such columns, units or numbers, has a single row, or if the
        wavevectors do not increase. The sentence names the line.
    """
    table = read_measured(path, (_WAVEVECTOR, _DENSITY))
    wavevector, density = table.numbers
    wrong = np.flatnonzero(np.diff(wavevector) <= 0)
    if wrong.size:
        before, here = wavevector[wrong[0] : wrong[0] + 2]
        raise MeasuredFileError(
            f"{path}, line {table.lines[wrong[0] + 1]}: q is {here:g} 1/m after {before:g} 1/m; "
            "wavevectors must increase"
        )
    if wavevector.size < 2:
        raise MeasuredFileError(
            f"{path}, line {table.lines[0]} is the only row; a density needs two or more"
        )
    return ProfileDensity(wavevector, density)


def conformity_energy(wavevector: Array, density: Array, contact_modulus: float) -> float:
    """Energy of full conformity from the density of profiles, e_el = E'/8 Int q C_1D dq.

    Parameters
    ----------
    wavevector : (n,) array
        Increasing. (Units: 1 / m)
    density : (n,) array
        C_1D. (Units: m^3)
    contact_modulus : float
        E'. (Units: Pa)

    Returns
    -------
    float
        e_el. The paper's C(q) = (pi / q) C_1D(q) leads to it too. (Units: J / m^2)
    """
    # Trapezoids over log q, in which the data are spaced.
    return float(contact_modulus / 8 * np.trapezoid(wavevector**2 * density, np.log(wavevector)))
