"""The rough contact of the figures that follow single fronts: its field, fronts and lengths."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crackfront.core import jkr
from crackfront.core.adhesion import correlation_length
from crackfront.core.cycle.follow import Load, front_at
from crackfront.core.cycle.instabilities import larkin_length
from crackfront.core.cycle.run import first_touch
from crackfront.core.cycle.schedule import LoadSchedule
from crackfront.core.field.fields import TileField
from crackfront.core.outcome import Direction
from crackfront.core.solver.relax import Newton, Solver
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.data.section import refusal
from crackfront.simulate.contact import simulation_adhesion, simulation_field
from crackfront.simulate.run import compile_solver
from crackfront.simulate.simulation import Numerics, simulation_of

Array = NDArray[np.float64]

STRONG, WEAK = 0, 1
"""Places of the two amplitudes that these figures compare."""

_SIDE = 2.4
"""Side of the tile over the radius of the smooth contact, so that no place is met twice."""


@dataclass(frozen=True, slots=True)
class RoughContact:
    """A sphere whose roughness has a flat spectrum.

    Attributes
    ----------
    field : TileField
        Work of adhesion along the rays.
    tolerance : float
        Largest force along the motion that may be left, relative to w_int per front length.
    rms : float
        w_rms measured on the tile. (Units: w_int)
    larkin_length : float
        Larkin length. (Units: reduced lateral length)
    """

    field: TileField
    tolerance: float
    rms: float
    larkin_length: float

    @property
    def solver(self) -> Solver:
        """How its fronts are found."""
        return Newton(self.tolerance)

    def touched(self, penetration: float) -> Array:
        """Front of an approach from first contact to a penetration."""
        return self.moved(first_touch(self.field), penetration, 1)

    def moved(self, front: Array, penetration: float, direction: Direction) -> Array:
        """Next metastable front; a ValueError says why there is none."""
        return front_at(self.field, front, Load(penetration, direction), self.solver)


def rough_contact(
    short_cutoff: float,
    elastic_energy: float,
    max_penetration: float,
    *,
    realisation: int,
    seed: int,
    error: float,
    tolerance: float,
    least_angles: int = 4,
) -> RoughContact:
    """Contact with one surface.

    Parameters
    ----------
    short_cutoff : float
        Shortest wavelength of the flat spectrum. (Units: reduced lateral length)
    elastic_energy : float
        e_el. (Units: w_int)
    max_penetration : float
        Largest penetration. (Units: reduced vertical length)
    realisation, seed : int
        Number of the surface and seed of all of them.
    error : float
        Error of the factor k that the resolution may leave.
    tolerance : float
        Largest force along the motion that may be left, relative to w_int per front length.
    least_angles : int, optional
        Fewest sites of the front.
    """
    spectrum = SelfAffineSpectrum(short_cutoff, short_cutoff, hurst=1.0)
    side = _SIDE * jkr.equilibrium_radius(max_penetration)
    simulation = simulation_of(
        "roughness",
        spectrum,
        elastic_energy,
        LoadSchedule(max_penetration, max(max_penetration, 1.0)),
        Numerics(error, side / short_cutoff, tile_cutoffs=1.0, max_sweeps=10_000_000),
        seed=seed,
        realisation=realisation,
        name="flat",
    )
    sizes = simulation.resolution
    simulation = replace(
        simulation, resolution=replace(sizes, n_angle=max(sizes.n_angle, least_angles))
    )
    compile_solver(simulation.solver.name)
    adhesion = simulation_adhesion(simulation)
    return RoughContact(
        field=simulation_field(simulation, adhesion),
        tolerance=min(tolerance, simulation.solver.tolerance),
        rms=adhesion.rms,
        larkin_length=larkin_length(correlation_length("roughness", spectrum), adhesion.rms),
    )


def circle_stiffness(radius: ArrayLike, penetration: ArrayLike) -> Array:
    """Stiffness of a contact's circle at fixed penetration, a dG/da; mode n of the line adds n.

    Parameters
    ----------
    radius : array_like
        Mean radius of a front. (Units: reduced lateral length)
    penetration : array_like
        Rigid body penetration, below radius^2. (Units: reduced vertical length)

    Returns
    -------
    array
        Stiffness. (Units: w_int)

    Examples
    --------
    It vanishes where a smooth contact is pulled off:

    >>> from crackfront.core.jkr import pull_off_penetration, pull_off_radius
    >>> abs(float(circle_stiffness(pull_off_radius(), pull_off_penetration()))) < 1e-9
    True
    """
    square = np.square(radius)
    release = jkr.energy_release_rate(radius, penetration) / WORK_OF_ADHESION
    return np.asarray(release * (4 * square / (square - penetration) - 1))


def refuse_rising(largest: float, first: float, last: float) -> None:
    """Refuse penetrations of a retraction that do not fall."""
    if not last < first < largest:
        raise refusal(
            "penetrations must fall from max_penetration over first_penetration to "
            f"last_penetration; they are {largest:g}, {first:g} and {last:g}"
        )
