"""Loads and field of one cycle on a given field, geometry by geometry.

The fields of a case are options of `crackfront cycle`. What computes is imported where it is used:
the command's help does not wait for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import MISSING, dataclass
from dataclasses import field as dataclass_field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from crackfront.data.bounds import NUMBER, PENETRATION, Range

if TYPE_CHECKING:
    from crackfront.core.adhesion import AdhesionMap
    from crackfront.core.arrays import Array
    from crackfront.core.cycle.follow import Load
    from crackfront.core.field.fields import Field, Interpolation
    from crackfront.simulate.fields import PolarSamples
    from crackfront.simulate.surfaces import TileMeasures

_PLACE, _DEPTH = (Range(-bounds.most, bounds.most) for bounds in (NUMBER, PENETRATION))
"""What the parser accepts; loads refuse negative steps and penetrations themselves."""


def option(text: str, bounds: Range, *, flag: str | None = None, default: Any = MISSING) -> Any:
    """A field of a case, which an option of the command line fills; needed without a default.

    `text` is its help, `bounds` what it may be, `flag` how it is written, if not as the field.
    """
    return dataclass_field(default=default, metadata={"text": text, "flag": flag, "bounds": bounds})


class Problem(NamedTuple):
    """Field, first front and loads of a cycle."""

    field: Field
    front: Array
    loads: Iterable[Load]
    """As of :func:`crackfront.core.cycle.follow.follow`."""
    expected: int
    """States that it will have, roughly."""
    seconds: float
    """Processor time that they will take, roughly."""
    sites: Array | None = None
    """Coordinates that are not those of the geometry, (n_site,)."""
    measures: TileMeasures | None = None
    """Those of the tile of a sphere."""


@dataclass(frozen=True, slots=True)
class Resolution:
    """How a given field is resolved; None leaves the choice to the case."""

    angles: int | None
    samples_per_pixel: float | None
    interpolation: Interpolation | None


@dataclass(frozen=True)
class SphereCase:
    """A sphere that is pressed on a surface and pulled off, about the centre of a tile."""

    ends_by: ClassVar[str] = "LOST_CONTACT"

    max_penetration: float = option("Largest penetration.", _DEPTH)
    step: float | None = option(
        "Difference of loads.  [default on a sphere: 0.004, dissipated energies to 1%]",
        _PLACE,
        default=None,
    )

    def problem(self, read: Callable[[], AdhesionMap | PolarSamples], sizes: Resolution) -> Problem:
        """Field of a tile, which is kept as its splines alone, or of samples on rays.

        The load goes from first contact to the largest penetration, and back to pull-off.
        """
        from crackfront.core import jkr
        from crackfront.core.adhesion import AdhesionMap
        from crackfront.core.contact import contact_field
        from crackfront.core.cycle.schedule import DEFAULT_STEP, LoadSchedule
        from crackfront.core.cycle.touch import checked_touch
        from crackfront.simulate.costs import affordable_seconds
        from crackfront.simulate.surfaces import tile_measures

        step = DEFAULT_STEP if self.step is None else self.step
        way = LoadSchedule(self.max_penetration, step).loads()
        # A smooth sphere comes off there; a rough one goes somewhat further.
        n_state = 3 + (2 * self.max_penetration - jkr.pull_off_penetration()) / step
        given, angles, density = read(), sizes.angles, sizes.samples_per_pixel
        if isinstance(given, AdhesionMap):
            radius = jkr.equilibrium_radius(self.max_penetration)
            seconds = affordable_seconds(
                n_angle=angles or 2 * math.pi * radius / given.pixel,
                n_point=given.work_of_adhesion.size,
                n_state=n_state,
                n_sample=2 * radius / given.pixel * (density or 4.0),
            )
            spacing, pieces = given.pixel / density if density else None, sizes.interpolation
            field: Field = contact_field(
                given, self.max_penetration, angles, spacing, pieces or "cubic"
            )
            sites, measures = None, tile_measures(given)
        elif angles is not None or density is not None:
            raise ValueError(
                "--angles and --samples-per-pixel are for tiles; a polar field brings its own "
                "samples"
            )
        else:
            field, sites, measures = given.field, given.angles, None
            seconds = affordable_seconds(
                n_angle=sites.size,
                n_point=given.field.products.size,
                n_state=n_state,
                n_sample=2 * given.field.places.size,
            )
        front = checked_touch(field, self.max_penetration)
        return Problem(field, front, way, int(n_state), seconds, sites, measures)


@dataclass(frozen=True)
class LineCase:
    """A straight front along y on a periodic tile, which springs pull along x and back."""

    ends_by: ClassVar[str] = "CONVERGED"

    spring: float = option("Length of the springs, w_int / kappa, in the unit of the tile.", NUMBER)
    first: float = option("First load, and the last.", _PLACE, flag="--from")
    last: float = option("Load at which the motion turns.", _PLACE, flag="--to")
    step: float | None = option("Difference of loads.", _PLACE)

    def problem(self, read: Callable[[], AdhesionMap | PolarSamples], sizes: Resolution) -> Problem:
        """Field on the points of a tile, one site for every y unless the resolution says more."""
        import numpy as np

        from crackfront.core.adhesion import AdhesionMap
        from crackfront.core.cycle.schedule import there_and_back
        from crackfront.core.geometry.line import line_field, straight_front
        from crackfront.core.units import WORK_OF_ADHESION
        from crackfront.simulate.costs import affordable_seconds

        step, travel = self.step or 0.0, self.last - self.first
        given, density = read(), sizes.samples_per_pixel or 1.0
        if not isinstance(given, AdhesionMap):
            raise ValueError("a line needs a tile work_of_adhesion(x, y), not samples on rays")
        # The first front lies as far behind its load as pinning may pull the springs.
        values = given.work_of_adhesion / WORK_OF_ADHESION
        behind = 1.25 * self.spring * float(np.ptp(values))
        seconds = affordable_seconds(
            n_angle=sizes.angles or values.shape[1],
            n_point=values.size,
            n_state=3 + max(2 * travel / step, 0.0) if step > 0 else 0.0,
            n_sample=2 * (abs(travel) + behind) / given.pixel * density,
        )
        way = there_and_back(self.first, self.last, step)
        field = line_field(
            given,
            self.spring,
            (self.first, self.last),
            n_site=sizes.angles,
            spacing=given.pixel / density,
            interpolation=sizes.interpolation or "cubic",
        )
        front = straight_front(field, given, self.first)
        return Problem(field, front, [way[0]._replace(start=front), *way[1:]], len(way), seconds)


CASES: dict[str, type[Any]] = {"sphere": SphereCase, "line": LineCase}
"""Cases by the name of their geometry."""
