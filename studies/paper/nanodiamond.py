"""A rubber sphere on nanodiamond in SI units: parameters and data of its contact."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from crackfront.analysis.finding import PAPER_FACTOR
from crackfront.analysis.law_spheres import SphereFactors, sphere_factors
from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import Recorder
from crackfront.core.outcome import Status
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import Scales
from crackfront.core.variables import variable
from crackfront.simulate.simulation import Simulation
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.sweep.section import section_error
from crackfront.validation import Count, Positive
from studies.paper.figure import Integers
from studies.paper.film import FilmSection
from studies.paper.measured import ForceRadius, read_force_radius
from studies.paper.rough import RoughParameters
from studies.progress import Progress

_STATE, _POINT = "state", "point"
_LINE, _ANGLE = "line", "angle"
_SURFACE, _INSTABILITY, _ARC = "surface", "instability", "arc"
_SURFACE_ENERGY = "J m-2"
_FIT = (_SURFACE_ENERGY, "bound")

_HURST = 1.0
"""Hurst exponent of the paper's film, of which data are that do not say it."""

EVERY_WAVELENGTH = 1e-6
"""Short cutoff over roll-off below which nothing adds to the half-derivative, for H > 1/2."""


class NanodiamondCycle(RoughParameters, FilmSection):
    """A rubber sphere that is pressed on the film up to a largest force, in SI units."""

    radius: Positive  # of the sphere (m)
    work_of_adhesion: Positive  # w_int (J / m^2)
    hurst: Annotated[float, Field(gt=0.5, le=1)]
    largest_force: Positive  # where the approach turns (N)
    step: Positive  # penetration between states of the approach (m)
    retraction_step: Positive  # and of the retraction

    @model_validator(mode="after")
    def _conforming(self) -> Self:
        if self.whole_elastic_energy >= self.work_of_adhesion:
            raise section_error(
                f"energy of full conformity is {self.whole_elastic_energy:.3g} J/m^2, not below "
                f"work_of_adhesion {self.work_of_adhesion:g}; lower the plateau"
            )
        self.simulation()
        return self

    @property
    def scales(self) -> Scales:
        """Reduced units of the scene."""
        return Scales(self.radius, self.work_of_adhesion, self.contact_modulus)

    @property
    def whole_elastic_energy(self) -> float:
        """Energy of full conformity of all wavelengths (Units: J / m^2)."""
        every = EVERY_WAVELENGTH * self.roll_off
        return self._energy_of(replace(self.spectrum, short_cutoff=every))

    def _energy_of(self, spectrum: SelfAffineSpectrum) -> float:
        """e_el = E'/4 [h_rms^(1/2)]^2 (Units: J / m^2)."""
        return self.contact_modulus / 4 * spectrum.mean_square(0.5)

    def simulation(self, realisation: int = 0) -> Simulation:
        """Simulation of a surface, whose field is large enough for the largest force."""
        scales, energy = self.scales, self._energy_of(self.spectrum) / self.work_of_adhesion
        reduced = SelfAffineSpectrum(
            self.short_cutoff / scales.lateral, self.roll_off / scales.lateral, self.hurst
        )
        # The approach is pinned: at this force it is smaller than a sphere with the mean adhesion.
        largest = jkr.radius_at_force(self.largest_force / scales.force, 1 - energy)
        deepest = float(jkr.equilibrium_penetration(largest, 1 - energy))
        schedule = FullCycle(deepest, self.step / scales.vertical)
        return self.simulation_of(reduced, energy, schedule, realisation)

    def approach(self, recorder: Recorder, largest_force: float) -> Iterator[Load]:
        """Penetrations of the approach until a recorder has a state of a force (N)."""
        scales = self.scales
        for count in itertools.count():
            yield Load(count * self.step / scales.vertical, 1)
            if recorder.status is not Status.CONVERGED:
                return
            if recorder.states[-1].force * scales.force >= largest_force:
                return

    def cycle(self, recorder: Recorder, progress: Progress) -> Iterator[Load]:
        """Penetrations of the approach to the largest force, and down from there."""
        scales = self.scales
        yield from self.approach(recorder, self.largest_force)
        if recorder.status is not Status.CONVERGED:
            return
        last = recorder.states[-1]
        penetration = last.penetration
        progress(f"approach: mean radius {last.mean_radius * scales.lateral:.4g} m at the turn")
        while True:
            penetration -= self.retraction_step / scales.vertical
            yield Load(penetration, -1)


class NanodiamondParameters(NanodiamondCycle):
    """What Fig. 5b and 5c show."""

    shown_force: Positive  # up to which perimeters are shown (N)
    line_step: Positive  # penetration between the shown perimeters (m)
    n_surface: Count  # surfaces whose widest instability is measured
    precision: Positive  # penetration to which it is separated from others (m)
    factor: Positive = PAPER_FACTOR  # the k with which w_int is fitted to an approach

    @model_validator(mode="after")
    def _shown(self) -> Self:
        if self.shown_force > self.largest_force:
            raise section_error(
                f"shown_force {self.shown_force:g} is above largest_force {self.largest_force:g}; "
                "lower it"
            )
        self.points()
        return self

    def points(self) -> ForceRadius:
        """What was measured."""
        return read_force_radius(self.measured)


@dataclass(frozen=True, slots=True)
class NanodiamondContact:
    """States of the cycle, perimeters of its approach and fits, in SI units."""

    status: str = variable("what ended the cycle", "1")
    sphere_radius: float = variable("radius of the sphere", "m")
    work_of_adhesion: float = variable("intrinsic work of adhesion", _SURFACE_ENERGY)
    contact_modulus: float = variable("contact modulus E'", "Pa")
    factor: float = variable("factor k of the fits", "1")
    whole_elastic_energy: float = variable("e_el of all wavelengths", _SURFACE_ENERGY)
    elastic_energy: float = variable("e_el on the tile", _SURFACE_ENERGY)
    short_cutoff: float = variable("shortest wavelength", "m")
    roll_off: float = variable("roll-off wavelength", "m")
    largest_force: float = variable("force at which the approach turns", "N")
    shown_force: float = variable("force up to which perimeters are shown", "N")
    jump_in: float = variable("penetration of the first state after jump-in", "m")
    direction: Integers = variable("+1 in approach, -1 in retraction", "1", _STATE)
    penetration: Array = variable("rigid body penetration", "m", _STATE)
    radius: Array = variable("mean contact radius", "m", _STATE)
    force: Array = variable("normal force", "N", _STATE)
    approach: Array = variable("w_appr, with its standard error", _SURFACE_ENERGY, "estimate")
    retraction: Array = variable("w_retr, with its standard error", _SURFACE_ENERGY, "estimate")
    angle: Array = variable("angle of a site", "rad", _ANGLE)
    line: NDArray[np.float32] = variable("perimeters of the approach", "m", _LINE, _ANGLE)
    line_force: Array = variable("normal force at the perimeters", "N", _LINE)
    threshold: float = variable("advance above which a site has jumped", "m")
    load_step: float = variable("penetration between states of the approach", "m")
    precision: float = variable("penetration to which instabilities are separated", "m")
    tile_side: float = variable("side of the periodic tile", "m")
    surface: Integers = variable("number of the surface", "1", _INSTABILITY)
    extents: Array = variable(
        "widths of the parts that jump in a load step up to the shown force", "m", _INSTABILITY
    )
    widest: Array = variable("widest single instability up to the shown force", "m", _SURFACE)
    arc_angle: Array = variable("the widest instability of the first surface", "rad", _ARC)
    arc_inner: Array = variable("radius before it", "m", _ARC)
    arc_outer: Array = variable("radius after it", "m", _ARC)
    synthetic_fit: Array = variable("w_int from synthetic points: value, low, high", *_FIT)
    simulated_fit: Array = variable("w_int from the simulated approach: value, low, high", *_FIT)
    measured_fit: Array = variable("w_int from the measured approach: value, low, high", *_FIT)
    measured_force: Array = variable("measured force", "N", _POINT)
    measured_radius: Array = variable("measured contact radius", "m", _POINT)
    measured_direction: Integers = variable("+1 in approach, -1 back", "1", _POINT)
    hurst: float | None = variable("Hurst exponent", "1", default=None)

    @property
    def scales(self) -> Scales:
        """Reduced units of the scene."""
        return Scales(self.sphere_radius, self.work_of_adhesion, self.contact_modulus)

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Shape of the spectrum (Units: reduced lateral length)."""
        lateral, hurst = self.scales.lateral, _HURST if self.hurst is None else self.hurst
        return SelfAffineSpectrum(self.short_cutoff / lateral, self.roll_off / lateral, hurst)

    @property
    def law(self) -> SphereFactors:
        """What the law says of the mean contact of the approach."""
        since = (self.direction > 0) & (self.penetration >= self.jump_in)
        radius = float(np.mean(self.radius[since])) / self.scales.lateral
        energy = self.elastic_energy / self.work_of_adhesion
        return sphere_factors("roughness", self.spectrum, energy, radius)
