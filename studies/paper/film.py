"""The rough film of the paper: its ideal spectrum, and densities and energy of its profiles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from crackfront.core.arrays import Array
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.variables import variable
from crackfront.sweep.section import InputFile, Section
from crackfront.validation import Plateau, Positive
from studies.paper.measured import read_profile_density
from studies.paper.rough import rough_spectrum

CONVERTED_LABEL = r"$q\,C^\mathrm{iso}/\pi$ (paper's conversion)"

POINTS_PER_DECADE = 100
"""Wavevectors at which a density is shown."""


class FilmSection(Section):
    """A soft sphere on a rough film, in SI units."""

    young_modulus: Positive  # of the sphere (Pa)
    poisson_ratio: Annotated[float, Field(ge=0, le=0.5)]
    short_cutoff: Positive  # spectrum of the heights (m, m, 1, m^4)
    roll_off: Positive
    hurst: Annotated[float, Field(gt=0, le=1)]
    plateau: Plateau
    measured: InputFile | None = None  # CSV file of measured points

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Spectrum of the heights (Units: m)."""
        return rough_spectrum(self.short_cutoff, self.roll_off, self.hurst, self.plateau)

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E' = E / (1 - nu^2) (Units: Pa)."""
        return self.young_modulus / (1 - self.poisson_ratio**2)


class FilmParameters(FilmSection):
    """A film whose spectral densities are shown with measured ones, if there are any."""

    longest: Positive  # wavelength that is shown (m)

    @model_validator(mode="after")
    def _usable(self) -> FilmParameters:
        _ = self.spectrum, read_profile_density(self.measured)  # each raises if it is not usable
        return self

    def densities(self, shortest: float) -> FilmDensities:
        """Densities of profiles down to a wavelength (Units: m)."""
        spectrum, points = self.spectrum, read_profile_density(self.measured)
        ends = 2 * np.pi / self.longest, 2 * np.pi / shortest
        count = math.ceil(math.log10(ends[1] / ends[0]) * POINTS_PER_DECADE) + 1
        wavevector = np.geomspace(*ends, count)
        return FilmDensities(
            contact_modulus=self.contact_modulus,
            wavevector=wavevector,
            profile=spectrum.profile_density(wavevector),
            converted=wavevector / np.pi * spectrum.density(wavevector),
            measured_wavevector=points.wavevector,
            measured_profile=points.density,
        )


_WAVE, _POINT = "wavevector", "point"


@dataclass(frozen=True, slots=True)
class FilmDensities:
    """Spectral densities of profiles of a film, from its spectrum and measured."""

    contact_modulus: float = variable("contact modulus E'", "Pa")
    wavevector: Array = variable("wavevector", "m-1", _WAVE)
    profile: Array = variable("spectral density of profiles C_1D", "m3", _WAVE)
    converted: Array = variable("paper's C_1D = q C / pi", "m3", _WAVE)
    measured_wavevector: Array = variable("measured wavevector", "m-1", _POINT)
    measured_profile: Array = variable("measured spectral density of profiles", "m3", _POINT)


def conformity_energy(wavevector: Array, density: Array, contact_modulus: float) -> float:
    """Energy of full conformity (J / m^2) from C_1D (m^3) of profiles, e_el = E'/8 Int q C_1D dq.

    The paper's C(q) = (pi / q) C_1D(q) leads to it too. Wavevectors (1 / m) increase.
    """
    # Trapezoids over log q, in which the data are spaced.
    return float(contact_modulus / 8 * np.trapezoid(wavevector**2 * density, np.log(wavevector)))
