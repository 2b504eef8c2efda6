"""The rough film of the paper: its ideal spectrum, and what follows from measured points."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import Scales
from crackfront.data.section import InputFile, Plateau, Positive, Section, refusal
from studies.paper.force import adhesion_from_forces
from studies.paper.measured import ForceRadius, ProfileDensity, read_profile_density

Array = NDArray[np.float64]

POINTS_PER_DECADE = 100
"""Wavevectors at which a density is shown."""


class FilmParameters(Section):
    """A rough film under a soft sphere, in SI units.

    Attributes
    ----------
    young_modulus, poisson_ratio : float
        Sphere. (Units: Pa, 1)
    short_cutoff, roll_off, hurst, plateau : float
        Spectrum of the heights. (Units: m, m, 1, m^4)
    measured : Path or None
        CSV file as :func:`studies.paper.measured.read_profile_density` reads it.
    """

    young_modulus: Positive
    poisson_ratio: Annotated[float, Field(ge=0, le=0.5)]
    short_cutoff: Positive
    roll_off: Positive
    hurst: Annotated[float, Field(gt=0, le=1)]
    plateau: Plateau
    measured: InputFile | None = None

    @model_validator(mode="after")
    def _usable(self) -> FilmParameters:
        if self.roll_off < self.short_cutoff:
            raise refusal(
                f"roll_off {self.roll_off:g} is shorter than short_cutoff {self.short_cutoff:g}; "
                "lower the cutoff or raise the roll-off"
            )
        self.points()
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
        return read_profile_density(self.measured)


def shown_wavevectors(longest: float, shortest: float) -> Array:
    """Wavevectors of two wavelengths and between them, for a logarithmic axis (Units: 1 / m)."""
    ends = 2 * np.pi / longest, 2 * np.pi / shortest
    count = math.ceil(math.log10(ends[1] / ends[0]) * POINTS_PER_DECADE) + 1
    return np.geomspace(*ends, count)


def conformity_energy(wavevector: Array, density: Array, contact_modulus: float) -> float:
    """Energy of full conformity from the density of profiles, e_el = E'/8 Int q C_1D dq.

    The paper's C(q) = (pi / q) C_1D(q) leads to it too.

    Parameters
    ----------
    wavevector, density : (n,) array
        Increasing wavevectors, and C_1D there. (Units: 1 / m, m^3)
    contact_modulus : float
        E'. (Units: Pa)

    Returns
    -------
    float
        e_el. (Units: J / m^2)
    """
    # Trapezoids over log q, in which the data are spaced.
    return float(contact_modulus / 8 * np.trapezoid(wavevector**2 * density, np.log(wavevector)))


def fitted_adhesion(
    points: ForceRadius, scales: Scales, elastic_energy: float, factor: float
) -> Array:
    r"""Intrinsic work of adhesion of an approach.

    .. math:: w_{int} = w_{appr} + (1 + k) e_{el}

    with the JKR curve of w_appr fitted to the force at the radii. (e_el does not depend on w_int.)

    Parameters
    ----------
    points : ForceRadius
        Points of the approach, and others.
    scales : Scales
        Sphere and modulus, for any work of adhesion.
    elastic_energy, factor : float
        Energy of full conformity of the surface, and the factor k. (Units: J / m^2, 1)

    Returns
    -------
    (3,) array
        w_int and the ends of the interval that the scatter of the points leaves; NaN where there
        are no points. (Units: J / m^2)
    """
    if points.force.size == 0:
        return np.full(3, np.nan)
    approach = points.direction > 0
    fit = adhesion_from_forces(
        points.radius[approach] / scales.lateral, points.force[approach] / scales.force
    )
    shift = (1 + factor) * elastic_energy
    return np.array([fit.value, fit.low, fit.high]) * scales.work_of_adhesion + shift
