"""Rough contacts of figures: the surface, the numerics for an asked error, and first touch."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from scipy.ndimage import map_coordinates

from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import first_touch, refuse_outgrown
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import TileField
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.data.section import Energy, Positive, Section, refusal
from crackfront.simulate.run import compile_solver
from crackfront.simulate.simulation import Numerics, Simulation, missed_error, simulation_of

Array = NDArray[np.float64]

ONE_DIGIT = 0.5
"""How far k may be from a value that is given with one digit."""


class RoughParameters(Section):
    """What the rough contact of every figure needs.

    Attributes
    ----------
    seed : int
        Seed of the surface.
    error : float
        Standard error of k that the numerics may leave.
    tile_roll_offs : float
        Side of the periodic tile in roll-off wavelengths; it has at least 200 short cutoffs.
    """

    seed: Annotated[int, Field(ge=0)]
    error: Annotated[float, Field(gt=0, lt=1)]
    tile_roll_offs: Positive

    def simulation_of(
        self, spectrum: SelfAffineSpectrum, elastic_energy: float, schedule: LoadSchedule
    ) -> Simulation:
        """Simulation of the first surface of the seed.

        Parameters
        ----------
        spectrum : SelfAffineSpectrum
            Shape of the spectrum. (Units: reduced lateral length)
        elastic_energy : float
            Energy of full conformity. (Units: w_int)
        schedule : LoadSchedule
            Penetrations; the largest decides the number of sites.

        Raises
        ------
        PydanticCustomError
            If the finest numerics leave more than the asked error.
        """
        numerics = Numerics(self.error, self.tile_roll_offs)
        simulation = simulation_of(
            "roughness", spectrum, elastic_energy, schedule, numerics, seed=self.seed
        )
        if left := missed_error(simulation, self.error):
            raise refusal(
                f"error is {self.error:g}, but the finest numerics leave {left:.2g}; ask for that"
            )
        return simulation


class RoughCycleParameters(RoughParameters):
    """What a figure of a whole cycle needs beside the shape of its spectrum.

    Attributes
    ----------
    short_cutoff : float
        Shortest wavelength. (Units: reduced lateral length)
    elastic_energy : float
        Energy of full conformity. (Units: w_int)
    max_penetration, step : float
        Penetrations to visit. (Units: reduced vertical length)
    """

    short_cutoff: Positive
    elastic_energy: Energy
    max_penetration: Positive
    step: Positive

    @model_validator(mode="after")
    def _possible(self) -> RoughCycleParameters:
        self.simulation()
        return self

    @property
    def spectrum(self) -> SelfAffineSpectrum:
        """Shape of the spectrum, flat where nothing else is said."""
        return SelfAffineSpectrum(self.short_cutoff, self.short_cutoff, hurst=1.0)

    @property
    def schedule(self) -> LoadSchedule:
        """Penetrations to visit."""
        return LoadSchedule(self.max_penetration, self.step)

    def simulation(self) -> Simulation:
        """The simulation."""
        return self.simulation_of(self.spectrum, self.elastic_energy, self.schedule)


def rough_spectrum(
    short_cutoff: float, roll_off: float, hurst: float, plateau: float = 1.0
) -> SelfAffineSpectrum:
    """Spectrum of the parameters of a figure.

    Parameters
    ----------
    short_cutoff, roll_off, hurst, plateau
        As in :class:`crackfront.core.spectrum.SelfAffineSpectrum`.

    Raises
    ------
    PydanticCustomError
        If there is no such spectrum.
    """
    try:
        return SelfAffineSpectrum(short_cutoff, roll_off, hurst, plateau)
    except ValueError as error:
        raise refusal(str(error)) from error


def recorded(
    simulation: Simulation, field: TileField, loads: Iterable[Load], recorder: Recorder
) -> CycleRecord:
    """States of a front that begins in contact that is just made and follows loads.

    Parameters
    ----------
    simulation : Simulation
        What is simulated.
    field : TileField
        Its field.
    loads : iterable of Load
        Where it goes.
    recorder : Recorder
        What is kept, and who is told.

    Raises
    ------
    ValueError
        If a smooth sphere would outgrow the field at the largest penetration.
    """
    refuse_outgrown(field, simulation.schedule.max_penetration)
    compile_solver(simulation.solver.name)
    recorder.run(field, first_touch(field), loads, simulation.solver)
    return recorder.record()


def patch_of(field: TileField, x: Array, y: Array) -> NDArray[np.float32]:
    """Work of adhesion around the apex, as the front feels it.

    Parameters
    ----------
    field : TileField
        Field on a tile.
    x : (n_x,) array
        Abscissae. (Units: reduced lateral length)
    y : (n_y,) array
        Ordinates. (Units: reduced lateral length)

    Returns
    -------
    (n_x, n_y) float32 array
        Work of adhesion. (Units: w_int)
    """
    coefficients = field.coefficients[:-3, :-3]
    places = [
        axis * field.inverse_pixel + n_point / 2
        for axis, n_point in zip((x, y), coefficients.shape, strict=True)
    ]
    grid = np.meshgrid(*places, indexing="ij")
    patch = map_coordinates(coefficients, grid, order=3, mode="grid-wrap", prefilter=False)
    return (patch / WORK_OF_ADHESION).astype(np.float32)
