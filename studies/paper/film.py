"""The rough film of the paper: its ideal spectrum, and the energy of profiles."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.data.section import InputFile, Plateau, Positive, Section
from studies.paper.figure import Array
from studies.paper.measured import ProfileDensity, read_profile_density
from studies.paper.rough import rough_spectrum

CONVERTED_LABEL = r"$q\,C^\mathrm{iso}/\pi$ (paper's conversion)"

POINTS_PER_DECADE = 100
"""Wavevectors at which a density is shown."""


class FilmParameters(Section):
    """A rough film under a soft sphere, in SI units."""

    young_modulus: Positive  # of the sphere (Pa)
    poisson_ratio: Annotated[float, Field(ge=0, le=0.5)]
    short_cutoff: Positive  # spectrum of the heights (m, m, 1, m^4)
    roll_off: Positive
    hurst: Annotated[float, Field(gt=0, le=1)]
    plateau: Plateau
    measured: InputFile | None = None  # CSV file that `read_profile_density` reads

    @model_validator(mode="after")
    def _usable(self) -> FilmParameters:
        _ = self.spectrum, self.points()  # each refuses what it cannot use
        return self

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Spectrum of the heights (Units: m)."""
        return rough_spectrum(self.short_cutoff, self.roll_off, self.hurst, self.plateau)

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E' = E / (1 - nu^2) (Units: Pa)."""
        return self.young_modulus / (1 - self.poisson_ratio**2)

    def points(self) -> ProfileDensity:
        """What was measured."""
        return read_profile_density(self.measured)


def shown_wavevectors(longest: float, shortest: float) -> Array:
    """Wavevectors of two wavelengths and between them, for a logarithmic axis (Units: 1 / m)."""
    ends = 2 * np.pi / longest, 2 * np.pi / shortest
    count = math.ceil(math.log10(ends[1] / ends[0]) * POINTS_PER_DECADE) + 1
    return np.geomspace(*ends, count)


def conformity_energy(wavevector: Array, density: Array, contact_modulus: float) -> float:
    """Energy of full conformity (J / m^2) from C_1D (m^3) of profiles, e_el = E'/8 Int q C_1D dq.

    The paper's C(q) = (pi / q) C_1D(q) leads to it too. Wavevectors (1 / m) increase.
    """
    # Trapezoids over log q, in which the data are spaced.
    return float(contact_modulus / 8 * np.trapezoid(wavevector**2 * density, np.log(wavevector)))
