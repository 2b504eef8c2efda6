"""What a run on a given surface begins with: of a sphere, and of a straight front."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np
from xarray import DataArray

from crackfront.core import jkr
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.schedule import LoadSchedule, protocol
from crackfront.core.cycle.touch import checked_touch
from crackfront.core.field.fields import TileField
from crackfront.core.geometry import line
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.data.arguments import refuse_no_numbers
from crackfront.data.bounds import NUMBER, Range, refuse_outside
from crackfront.simulate.costs import affordable_seconds
from crackfront.simulate.given import surface_adhesion, surface_kind
from crackfront.simulate.simulation import Simulation, missed_error, simulation_field
from crackfront.simulate.surfaces import (
    TileMeasures,
    chosen_simulation,
    refuse_no_fraction,
    stated_spectrum,
    tile_measures,
)


@dataclass(frozen=True, slots=True)
class StraightFront:
    """A straight front on a surface, its contact at smaller x, pulled by springs along x."""

    surface: DataArray
    """The periodic surface, in reduced units."""
    spring: float
    """Length of the springs, w_int / kappa. (Units: that of the surface)"""


def straight_front(surface: DataArray, spring: float) -> StraightFront:
    """A straight front for :func:`crackfront.run_loop`, whose loads are places of its springs.

    Parameters
    ----------
    surface : xarray.DataArray
        Surface, as of :func:`crackfront.surface`.
    spring : float
        Length of the springs, w_int over their stiffness per area. (Units: lateral unit of the
        surface)

    Raises
    ------
    ValueError
        If the spring has no such length, or the surface another name than that of one.
    TypeError
        If an argument is of another type.
    """
    surface_kind(surface)
    refuse_no_numbers(spring=spring)
    refuse_outside("spring", spring, NUMBER)
    return StraightFront(surface, float(spring))


def load_values(loads: Iterable[float | str]) -> tuple[float, ...]:
    """Loads of a protocol as numbers; a ValueError where there is none, or one is no number."""
    found = []
    for given in loads:
        try:
            found.append(float(given))
        except (TypeError, ValueError):
            raise ValueError(f"a load is {given!r}; write numbers alone") from None
        refuse_outside("a load", found[-1], Range(-NUMBER.most, NUMBER.most))
    if not found:
        raise ValueError("there are no loads; give one or more")
    return tuple(found)


class Problem(NamedTuple):
    """Field, first front and loads of a run."""

    field: TileField
    front: Array
    loads: Iterable[Load]
    """As of :func:`crackfront.core.cycle.follow.follow`."""
    expected: int
    """States that it will have, roughly."""
    seconds: float
    """Processor time that they will take, roughly."""
    tolerance: float
    """That of the solver."""
    measures: TileMeasures
    """Those of the tile."""
    simulation: Simulation | None = None
    """One of the same sizes, whose numerical errors are known; where the spectrum is stated."""


def problem_of(
    surface: DataArray | StraightFront,
    loads: tuple[float, ...] | None,
    max_penetration: float | None,
    step: float,
    error: float,
) -> Problem:
    """What a run begins with; arguments as of :func:`crackfront.run_loop`.

    Loads that are None lead up to the largest penetration and to pull-off. The step is the largest
    difference of loads; infinity leaves them as they are.
    """
    if isinstance(surface, StraightFront):
        if loads is None or max_penetration is not None:
            raise ValueError("a straight front needs loads, and no max_penetration; give loads")
        return _line_problem(surface, loads, step)
    if (loads is None) == (max_penetration is None):
        raise ValueError("a sphere needs max_penetration or loads; give one of the two")
    if max_penetration is not None:
        way = LoadSchedule(max_penetration, step).loads()
        # A smooth sphere comes off there; a rough one goes somewhat further.
        n_state = 3 + (2 * max_penetration - jkr.pull_off_penetration()) / step
        return _sphere_problem(surface, max_penetration, way, n_state, error)
    if loads is None or loads[0] < 0:
        raise ValueError(
            f"loads begin with {(loads or (0.0,))[0]:g}; a sphere touches at penetration 0, so "
            "begin there or deeper"
        )
    way, n_state = protocol(loads, step), _n_state(loads, step)
    return _sphere_problem(surface, max(loads), way, n_state, error)


def _n_state(loads: tuple[float, ...], step: float) -> float:
    """Loads of a protocol, about."""
    return len(loads) + sum(abs(one - other) for one, other in pairwise(loads)) / step


def _sphere_problem(
    surface: DataArray, deepest: float, way: Iterator[Load], n_state: float, error: float
) -> Problem:
    """A sphere about the centre of a tile, resolved by the measured laws or else by its pixels."""
    refuse_no_fraction("error", error)
    adhesion = surface_adhesion(surface)
    measures, radius = tile_measures(adhesion), jkr.equilibrium_radius(deepest)
    seconds = affordable_seconds(
        n_angle=2 * math.pi * radius / adhesion.pixel,
        n_point=adhesion.work_of_adhesion.size,
        n_state=n_state,
        n_sample=8 * radius / adhesion.pixel,
    )
    spectrum = stated_spectrum(surface)
    if spectrum is None or adhesion.e_el == 0:
        field, tolerance = contact_field(adhesion, deepest), DEFAULT_TOLERANCE
        front = checked_touch(field, deepest)
        return Problem(field, front, way, int(n_state), seconds, tolerance, measures)
    schedule = LoadSchedule(deepest, 1.0)  # whose step has no effect on sizes
    chosen = chosen_simulation(measures.kind, spectrum, adhesion.e_el, schedule, error=error)
    n_point = min(adhesion.work_of_adhesion.shape)
    sizes = replace(chosen.resolution, tile_side=n_point * adhesion.pixel, n_point=n_point)
    simulation = replace(chosen, resolution=sizes)
    if left := missed_error(simulation, error):
        pixels = spectrum.short_cutoff / adhesion.pixel
        raise ValueError(
            f"error is {error:g}, but the finest numerics on {pixels:.3g} pixels per short cutoff "
            f"leave {left:.2g}; ask for that, or make the surface with this error"
        )
    field, tolerance = simulation_field(simulation, adhesion), chosen.solver.tolerance
    front = checked_touch(field, deepest)
    return Problem(field, front, way, int(n_state), seconds, tolerance, measures, simulation)


def _line_problem(given: StraightFront, loads: tuple[float, ...], step: float) -> Problem:
    """A straight front along y on a periodic tile, one site for every y."""
    adhesion, way, n_state = surface_adhesion(given.surface), protocol(loads, step), 0.0
    # The first front lies as far behind its load as pinning may pull the springs.
    values, n_state = adhesion.work_of_adhesion, _n_state(loads, step)
    behind = 1.25 * given.spring * float(np.ptp(values)) / WORK_OF_ADHESION
    seconds = affordable_seconds(
        n_angle=values.shape[1],
        n_point=values.size,
        n_state=n_state,
        n_sample=2 * (float(np.ptp(loads)) + behind) / adhesion.pixel,
    )
    field = line.line_field(adhesion, given.spring, (min(loads), max(loads)))
    front = line.straight_front(field, adhesion, loads[0])
    # A branch begins with a front of its own: making contact has no energy here.
    started = chain([next(way)._replace(start=front)], way)
    measures = tile_measures(adhesion)
    return Problem(field, front, started, int(n_state), seconds, DEFAULT_TOLERANCE, measures)
