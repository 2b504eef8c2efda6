"""What the contact on nanodiamond (main Fig. 5b, c) is computed from, in SI units."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from pydantic import Field, model_validator

from crackfront.analysis.report import PAPER_FACTOR
from crackfront.core import jkr
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import Scales
from crackfront.data.section import InputFile, Positive, refusal
from crackfront.simulate.simulation import Simulation
from crackfront.studies.paper.force_radius import NOTHING_MEASURED, ForceRadius, read_force_radius
from crackfront.studies.paper.measured import MeasuredFileError
from crackfront.studies.paper.rough import RoughParameters, rough_spectrum

_EVERY_WAVELENGTH = 1e-6
"""Short cutoff over roll-off below which nothing adds to the half-derivative, for H > 1/2."""


class NanodiamondParameters(RoughParameters):
    """What Fig. 5b and 5c show, in SI units.

    Attributes
    ----------
    young_modulus, poisson_ratio, radius, work_of_adhesion : float
        Sphere and w_int. (Units: Pa, 1, m, J / m^2)
    roll_off, short_cutoff, hurst, plateau : float
        Spectrum of the heights. (Units: m, m, 1, m^4)
    largest_force, shown_force : float
        Where the approach turns, and up to where its perimeters are shown. (Units: N)
    step, retraction_step, line_step : float
        Penetration between states of the approach and of the retraction, and between the shown
        perimeters. (Units: m)
    factor : float
        The factor k with which w_int is found from an approach.
    measured : Path or None
        CSV file as :func:`crackfront.studies.paper.force_radius.read_force_radius` reads it.
    """

    young_modulus: Positive
    poisson_ratio: Annotated[float, Field(ge=0, le=0.5)]
    radius: Positive
    work_of_adhesion: Positive
    roll_off: Positive
    short_cutoff: Positive
    hurst: Annotated[float, Field(gt=0.5, le=1)]
    plateau: Positive
    largest_force: Positive
    shown_force: Positive
    step: Positive
    retraction_step: Positive
    line_step: Positive
    factor: Positive = PAPER_FACTOR
    measured: InputFile | None = None

    @model_validator(mode="after")
    def _possible(self) -> NanodiamondParameters:
        if self.shown_force > self.largest_force:
            raise refusal(
                f"shown_force {self.shown_force:g} is above largest_force {self.largest_force:g}; "
                "lower it"
            )
        if self.whole_elastic_energy >= self.work_of_adhesion:
            raise refusal(
                f"energy of full conformity is {self.whole_elastic_energy:.3g} J/m^2, not below "
                f"work_of_adhesion {self.work_of_adhesion:g}; lower the plateau"
            )
        self.simulation()
        try:
            self.points()
        except MeasuredFileError as error:
            raise refusal(str(error)) from error
        return self

    @property
    def scales(self) -> Scales:
        """Reduced units of the scene."""
        modulus = self.young_modulus / (1 - self.poisson_ratio**2)
        return Scales(self.radius, self.work_of_adhesion, modulus)

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Spectrum of the heights (Units: m)."""
        return rough_spectrum(self.short_cutoff, self.roll_off, self.hurst, self.plateau)

    @property
    def elastic_energy(self) -> float:
        """Energy of full conformity of the simulated wavelengths (Units: J / m^2)."""
        return self._energy_of(self.spectrum)

    @property
    def whole_elastic_energy(self) -> float:
        """The same of all wavelengths (Units: J / m^2)."""
        every = _EVERY_WAVELENGTH * self.roll_off
        return self._energy_of(replace(self.spectrum, short_cutoff=every))

    def _energy_of(self, spectrum: SelfAffineSpectrum) -> float:
        """e_el = E'/4 [h_rms^(1/2)]^2 (Units: J / m^2)."""
        return self.scales.contact_modulus / 4 * spectrum.mean_square(0.5)

    def simulation(self) -> Simulation:
        """The simulation, whose field is large enough for the largest force."""
        scales, energy = self.scales, self.elastic_energy / self.work_of_adhesion
        reduced = SelfAffineSpectrum(
            self.short_cutoff / scales.lateral, self.roll_off / scales.lateral, self.hurst
        )
        # The approach is pinned: at this force it is smaller than a sphere with the mean adhesion.
        largest = jkr.radius_at_force(self.largest_force / scales.force, 1 - energy)
        deepest = float(jkr.equilibrium_penetration(largest, 1 - energy))
        schedule = LoadSchedule(deepest, self.step / scales.vertical)
        return self.simulation_of(reduced, energy, schedule)

    def points(self) -> ForceRadius:
        """What was measured.

        Raises
        ------
        MeasuredFileError
            If the file cannot be used.
        """
        return NOTHING_MEASURED if self.measured is None else read_force_radius(self.measured)
