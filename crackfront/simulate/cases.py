"""Loads and field of one cycle on a given field, geometry by geometry.

What computes is imported where it is used: the help of `crackfront cycle` does not wait for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from crackfront.data.arguments import refuse_no_numbers
from crackfront.data.bounds import NUMBER, Range, refuse_outside

if TYPE_CHECKING:
    from xarray import DataArray

    from crackfront.core.adhesion import AdhesionMap
    from crackfront.core.arrays import Array
    from crackfront.core.cycle.follow import Load
    from crackfront.core.field.fields import Interpolation, TileField
    from crackfront.simulate.surfaces import TileMeasures

PLACE = Range(-NUMBER.most, NUMBER.most)
"""Loads and their steps; what is negative is refused where it cannot be."""


class Problem(NamedTuple):
    """Field, first front and loads of a cycle."""

    field: TileField
    front: Array
    loads: Iterable[Load]
    """As of :func:`crackfront.core.cycle.follow.follow`."""
    expected: int
    """States that it will have, roughly."""
    seconds: float
    """Processor time that they will take, roughly."""
    measures: TileMeasures
    """Those of the tile."""


@dataclass(frozen=True, slots=True)
class Resolution:
    """How a given field is resolved; None leaves the choice to the case."""

    angles: int | None = None
    samples_per_pixel: float | None = None
    interpolation: Interpolation | None = None


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
    from crackfront.simulate.given import surface_kind

    surface_kind(surface)
    refuse_no_numbers(spring=spring)
    refuse_outside("spring", spring, NUMBER)
    return StraightFront(surface, float(spring))


def load_values(loads: Iterable[float | str]) -> tuple[float, ...]:
    """Loads of a protocol as numbers.

    Raises
    ------
    ValueError
        If there is none, or one is no number within bounds.
    """
    found = []
    for given in loads:
        try:
            found.append(float(given))
        except (TypeError, ValueError):
            raise ValueError(f"a load is {given!r}; write numbers alone") from None
        refuse_outside("a load", found[-1], PLACE)
    if not found:
        raise ValueError("there are no loads; give one or more")
    return tuple(found)


def _protocol(loads: tuple[float, ...], step: float | None) -> tuple[Iterator[Load], float]:
    """Loads of a protocol, made when they are taken, and how many there are."""
    from crackfront.core.cycle.schedule import protocol

    step = math.inf if step is None else step
    way = protocol(loads, step)
    return way, len(loads) + sum(abs(one - other) for one, other in pairwise(loads)) / step


@dataclass(frozen=True)
class SphereCase:
    """A sphere that is pressed on a surface and pulled off, about the centre of a tile."""

    max_penetration: float | None = None
    step: float | None = None
    loads: tuple[float, ...] | None = None

    @property
    def ends_by(self) -> tuple[str, ...]:
        """Names of the statuses that are an end of its loads."""
        return ("LOST_CONTACT",) if self.loads is None else ("LOST_CONTACT", "CONVERGED")

    @property
    def deepest(self) -> float:
        """Largest penetration; ValueError if the loads make no contact, or are given twice."""
        if (self.loads is None) == (self.max_penetration is None):
            raise ValueError("a sphere needs max_penetration or loads; give one of the two")
        if self.loads is None:
            return float(self.max_penetration or 0.0)
        if self.loads[0] < 0:
            raise ValueError(
                f"loads begin with {self.loads[0]:g}; a sphere touches at penetration 0, so begin "
                "there or deeper"
            )
        return max(self.loads)

    def way(self) -> tuple[Iterator[Load], float]:
        """Loads in their order, and how many there are, about."""
        from crackfront.core import jkr
        from crackfront.core.cycle.schedule import DEFAULT_STEP, LoadSchedule

        if self.loads is not None:
            return _protocol(self.loads, self.step)
        step = DEFAULT_STEP if self.step is None else self.step
        loads = LoadSchedule(self.deepest, step).loads()
        # A smooth sphere comes off there; a rough one goes somewhat further.
        return loads, 3 + (2 * self.deepest - jkr.pull_off_penetration()) / step

    def problem(self, read: Callable[[], AdhesionMap], sizes: Resolution) -> Problem:
        """Field of a tile, which is kept as its splines alone.

        Without loads, they go from first contact to the largest penetration and to pull-off.
        """
        from crackfront.core import jkr
        from crackfront.core.contact import contact_field
        from crackfront.core.cycle.touch import checked_touch
        from crackfront.simulate.costs import affordable_seconds
        from crackfront.simulate.surfaces import tile_measures

        deepest, (way, n_state) = self.deepest, self.way()
        given, angles, density = read(), sizes.angles, sizes.samples_per_pixel
        radius = jkr.equilibrium_radius(deepest)
        seconds = affordable_seconds(
            n_angle=angles or 2 * math.pi * radius / given.pixel,
            n_point=given.work_of_adhesion.size,
            n_state=n_state,
            n_sample=2 * radius / given.pixel * (density or 4.0),
        )
        spacing, pieces = given.pixel / density if density else None, sizes.interpolation
        field = contact_field(given, deepest, angles, spacing, pieces or "cubic")
        front = checked_touch(field, deepest)
        return Problem(field, front, way, int(n_state), seconds, tile_measures(given))


@dataclass(frozen=True)
class LineCase:
    """A straight front along y on a periodic tile, which springs pull along x."""

    ends_by: ClassVar[tuple[str, ...]] = ("CONVERGED",)

    spring: float
    step: float | None
    loads: tuple[float, ...]

    def problem(self, read: Callable[[], AdhesionMap], sizes: Resolution) -> Problem:
        """Field on the points of a tile, one site for every y unless the resolution says more."""
        import numpy as np

        from crackfront.core.geometry.line import line_field, straight_front
        from crackfront.core.units import WORK_OF_ADHESION
        from crackfront.simulate.costs import affordable_seconds
        from crackfront.simulate.surfaces import tile_measures

        loads = self.loads
        way, n_state = _protocol(loads, self.step)
        given, density = read(), sizes.samples_per_pixel or 1.0
        # The first front lies as far behind its load as pinning may pull the springs.
        values = given.work_of_adhesion / WORK_OF_ADHESION
        behind = 1.25 * self.spring * float(np.ptp(values))
        seconds = affordable_seconds(
            n_angle=sizes.angles or values.shape[1],
            n_point=values.size,
            n_state=n_state,
            n_sample=2 * (float(np.ptp(loads)) + behind) / given.pixel * density,
        )
        field = line_field(
            given,
            self.spring,
            (min(loads), max(loads)),
            n_site=sizes.angles,
            spacing=given.pixel / density,
            interpolation=sizes.interpolation or "cubic",
        )
        front, measures = straight_front(field, given, loads[0]), tile_measures(given)
        # A branch begins with a front of its own: making contact has no energy here.
        started = chain([next(way)._replace(start=front)], way)
        return Problem(field, front, started, int(n_state), seconds, measures)
