"""Rough contacts of figures: their parameters, the surface, the numerics, fronts on it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator
from scipy.ndimage import map_coordinates

from crackfront.core import jkr
from crackfront.core.adhesion import larkin_length
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load, front_at
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.touch import check_field_size, first_touch
from crackfront.core.field.fields import TileField
from crackfront.core.outcome import Direction, Status
from crackfront.core.solver.relax import Newton, Solver
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.simulate.contact import Pressed
from crackfront.simulate.costs import expected_cost
from crackfront.simulate.laws import measured_energies
from crackfront.simulate.numerical_errors import missed_error
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.run_simulation import compile_solver
from crackfront.simulate.settings import chosen_settings
from crackfront.simulate.simulation import (
    Simulation,
    simulation_adhesion,
    simulation_field,
    simulation_of,
)
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.sweep.section import Section, section_error
from crackfront.validation import Count, Fraction, Positive, Seed
from studies.paper.checks import Check

ONE_DIGIT = 0.5
"""How far k may be from a value that is stated with one digit."""

STRONG, WEAK = 0, 1
"""Places of the two amplitudes that figures of single fronts compare."""

_SIDE = 2.4
"""Side of their tiles over the radius of the smooth contact, so that no place is met twice."""


class RoughParameters(Section):
    """What the rough contact of a figure of whole cycles needs."""

    seed: Seed  # of the surface
    error: Annotated[float, Field(gt=0, lt=1)]  # standard error of k that the numerics may leave
    tile_roll_offs: Positive  # side of the periodic tile, 200 short cutoffs or more

    def simulation_of(
        self,
        spectrum: SelfAffineSpectrum,
        elastic_energy: float,
        schedule: FullCycle,
        realisation: int = 0,
    ) -> Simulation:
        """Simulation of a surface of the seed; raises if its numerics miss the error."""
        numerics = Numerics(error=self.error, tile_roll_offs=self.tile_roll_offs)
        simulation = simulation_of(
            "roughness",
            spectrum,
            elastic_energy,
            schedule,
            numerics,
            seed=self.seed,
            realisation=realisation,
        )
        if least_error := missed_error(simulation, self.error):
            raise section_error(
                f"error is {self.error:g}, but the finest numerics leave {least_error:.2g}; "
                "ask for that"
            )
        return simulation

    def simulation(self) -> Simulation:
        """The simulation of the figure."""
        raise NotImplementedError


def expected_seconds(parameters: RoughParameters) -> float:
    """Processor time that the one simulation of a figure is expected to take (Units: s)."""
    return expected_cost(parameters.simulation()).seconds


class RoughCycleParameters(RoughParameters):
    """What a figure of one cycle needs, apart from the shape of its spectrum."""

    short_cutoff: Positive  # shortest wavelength (reduced lateral length)
    elastic_energy: Fraction  # of full conformity (w_int)
    max_penetration: Positive  # penetrations to visit (reduced vertical length)
    step: Positive

    @model_validator(mode="after")
    def _possible(self) -> RoughCycleParameters:
        self.simulation()
        return self

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Shape of the spectrum, flat where nothing else is said."""
        return flat_spectrum(self.short_cutoff)

    @property
    def schedule(self) -> FullCycle:
        """Penetrations to visit."""
        return FullCycle(self.max_penetration, self.step)

    def simulation(self) -> Simulation:
        """The simulation."""
        return self.simulation_of(self.spectrum, self.elastic_energy, self.schedule)


class DisorderParameters(Section):
    """What a figure needs that follows single fronts in strong and in weak disorder."""

    short_cutoff: Positive  # shortest wavelength of the flat spectrum (reduced lateral length)
    strong: Fraction  # e_el of the two kinds of surfaces (w_int)
    weak: Fraction
    max_penetration: Positive  # where a retraction begins (reduced vertical length)
    error: Positive  # of the factor k, that the resolution may leave
    seed: Count  # of the surfaces of both kinds

    def contact(
        self, elastic_energy: float, tolerance: float, realisation: int = 0, least_angles: int = 4
    ) -> RoughContact:
        """Contact with one surface: e_el in units of w_int, `least_angles` sites or more."""
        spectrum = flat_spectrum(self.short_cutoff)
        side = _SIDE * jkr.equilibrium_radius(self.max_penetration)
        # The laws of errors end at their weakest disorder; weaker disorder gets its numerics.
        energy = max(elastic_energy, measured_energies()[0])
        settings = chosen_settings(self.error, "roughness", spectrum, energy)
        simulation = simulation_of(
            "roughness",
            spectrum,
            elastic_energy,
            FullCycle(self.max_penetration, max(self.max_penetration, 1.0)),
            Numerics(settings=settings, tile_roll_offs=side / self.short_cutoff, tile_cutoffs=1.0),
            seed=self.seed,
            realisation=realisation,
            name="flat",
        )
        resolution = simulation.resolution
        n_angle = max(resolution.n_angle, least_angles)
        simulation = replace(simulation, resolution=replace(resolution, n_angle=n_angle))
        compile_solver(simulation.solver.name, FullCycle)
        adhesion = simulation_adhesion(simulation)
        return RoughContact(
            field=simulation_field(simulation, adhesion),
            solver=Newton(min(tolerance, simulation.solver.tolerance)),
            w_rms=adhesion.w_rms,
            larkin_length=larkin_length("roughness", spectrum, adhesion.w_rms),
        )


class RetractionParameters(DisorderParameters):
    """What a figure needs that measures a part of the retraction on several surfaces."""

    n_surface: Count  # surfaces of each kind
    first_penetration: float  # between them it is measured (reduced vertical length)
    last_penetration: float

    @model_validator(mode="after")
    def _falling(self) -> RetractionParameters:
        largest, first, last = self.max_penetration, self.first_penetration, self.last_penetration
        if not last < first < largest:
            raise section_error(
                "penetrations must fall from max_penetration over first_penetration to "
                f"last_penetration; they are {largest:g}, {first:g} and {last:g}"
            )
        return self


@dataclass(frozen=True, slots=True)
class RoughContact:
    """A sphere whose roughness has a flat spectrum, and the solver of its fronts."""

    field: TileField
    solver: Solver
    w_rms: float  # measured on the tile (w_int)
    larkin_length: float  # (reduced lateral length)

    def touched(self, penetration: float) -> Array:
        """Front of an approach from first contact to a penetration."""
        return self.moved(first_touch(self.field), penetration, 1)

    def moved(self, front: Array, penetration: float, direction: Direction) -> Array:
        """Next metastable front; a ValueError says why there is none."""
        return front_at(self.field, front, Load(penetration, direction), self.solver)


def surface_means(kinds: Sequence[Sequence[object]], *names: str) -> dict[str, Any]:
    """Means over the surfaces of each kind of what was measured on each surface, by its name."""
    return {
        name: np.array([np.mean([getattr(surface, name) for surface in kind]) for kind in kinds])
        for name in names
    }


def circle_stiffness(radius: ArrayLike, penetration: ArrayLike) -> Array:
    """Stiffness (w_int) of a contact's circle at fixed penetration, a dG/da.

    Mode n of the line is stiffer by n.

    >>> from crackfront.core.jkr import pull_off_penetration, pull_off_radius
    >>> abs(float(circle_stiffness(pull_off_radius(), pull_off_penetration()))) < 1e-9
    True
    """
    square = np.square(radius)
    release = jkr.energy_release_rate(radius, penetration) / WORK_OF_ADHESION
    return np.asarray(release * (4 * square / (square - penetration) - 1))


def flat_spectrum(short_cutoff: float) -> SelfAffineSpectrum:
    """Spectrum of the same power at all wavelengths down to the shortest."""
    return SelfAffineSpectrum(short_cutoff, short_cutoff, hurst=1.0)


def rough_spectrum(
    short_cutoff: float, roll_off: float, hurst: float, plateau: float = 1.0
) -> SelfAffineSpectrum:
    """Self-affine spectrum of the parameters of a figure; a pydantic error if impossible."""
    try:
        return SelfAffineSpectrum(short_cutoff, roll_off, hurst, plateau)
    except ValueError as error:
        raise section_error(str(error)) from error


def recorded(
    simulation: Simulation, field: TileField, loads: Iterable[Load], recorder: Recorder
) -> CycleRecord:
    """States of a front that begins in contact that is just made and follows loads."""
    if isinstance(simulation.schedule, Pressed):
        check_field_size(field, simulation.schedule.max_penetration)
    compile_solver(simulation.solver.name, FullCycle)
    recorder.run(field, first_touch(field), loads, simulation.solver)
    return recorder.record()


def whole_cycle(status: str) -> Check:
    """Check of what ended a cycle."""
    lost = Status.LOST_CONTACT.value
    return Check("the cycle is whole: it ends by losing contact", lost, status, status == lost)


def patch_of(field: TileField, x: Array, y: Array) -> NDArray[np.float32]:
    """Work of adhesion in units of w_int around the apex, as the front feels it, (n_x, n_y)."""
    coefficients = field.coefficients[:-3, :-3]
    places = [
        axis * field.inverse_pixel + n_point / 2
        for axis, n_point in zip((x, y), coefficients.shape, strict=True)
    ]
    grid = np.meshgrid(*places, indexing="ij")
    patch = map_coordinates(coefficients, grid, order=3, mode="grid-wrap", prefilter=False)
    return (patch / WORK_OF_ADHESION).astype(np.float32)
