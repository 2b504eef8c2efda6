"""Kinds of load with the methods that simulations use, and the loads of a full cycle."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.touch import checked_touch
from crackfront.core.field.fields import Field, Interpolation, TileField
from crackfront.core.geometry.base import Geometry
from crackfront.core.geometry.sphere import contact_field, sphere
from crackfront.core.outcome import Direction
from crackfront.core.solver.relax import Solver

DEFAULT_STEP = 0.004
"""Load step that leaves the dissipated energies of a full cycle within 1% of the quasi-static loop.

docs/experiments/hard-cases.md has the measure. (Units: reduced vertical length)
"""


class Schedule(ABC):
    """A kind of load, with the methods that simulations use.

    A kind is a frozen dataclass, whose fields enter the keys of simulations, with these attributes
    and the methods that are abstract here.
    """

    __slots__ = ()

    straight: bool
    """Whether the front is a straight one on springs."""
    full_cycle = False
    """Whether the load goes from first contact to pull-off."""
    uncorrelated: bool
    """Whether sites are independent of each other."""
    max_penetration: float
    """Largest penetration of a sphere; else 0. (Units: reduced vertical length)"""
    spring: float
    """Length of the springs of a straight front; else NaN. (Units: length)"""

    @property
    @abstractmethod
    def n_period(self) -> int | None:
        """States at the end of each branch that are averaged; None where travel decides."""

    @property
    @abstractmethod
    def front_length(self) -> float:
        """Length of the longest front that is smooth (Units: length)."""

    @abstractmethod
    def fitted(self, side: float, spacing: float) -> tuple[float, float]:
        """Side of the tile along the front, of a least one, and distance of samples, of a largest.

        (Units: length)
        """

    @abstractmethod
    def tile(self, n_point: int, side: float) -> tuple[tuple[int, int], tuple[float, float]]:
        """Points and sides along x and y of a tile with so many points on its side along y."""

    @abstractmethod
    def geometry(self, n_site: int) -> Geometry:
        """Contact, whose springs do not pull at w_int."""

    @abstractmethod
    def field(
        self, adhesion: AdhesionMap, n_site: int, spacing: float, interpolation: Interpolation
    ) -> TileField:
        """Field of a tile, as of :func:`crackfront.core.geometry.sphere.contact_field`."""

    @abstractmethod
    def run(
        self,
        field: Any,
        solver: Solver,
        recorder: Recorder,
        *,
        correlation_length: float,
        elastic_energy: float,
    ) -> CycleRecord:
        """States of the whole load on a field of a correlation length and an e_el (w_int)."""

    def for_surface(self, *_: object) -> Schedule:
        """Loads on one surface, by default the same on all."""
        return self


class SphereSchedule(Schedule):
    """Loads of a sphere on a square tile, up to a largest penetration."""

    __slots__ = ()

    straight = uncorrelated = False
    spring = math.nan
    n_period = None

    @property
    def front_length(self) -> float:
        """Length of the longest front that is smooth (Units: length)."""
        return 2 * math.pi * float(jkr.equilibrium_radius(self.max_penetration))

    def fitted(self, side: float, spacing: float) -> tuple[float, float]:
        """The side and the distance themselves."""
        return side, spacing

    def tile(self, n_point: int, side: float) -> tuple[tuple[int, int], tuple[float, float]]:
        """As many points along x."""
        return (n_point, n_point), (side, side)

    def geometry(self, n_site: int) -> Geometry:
        """Sphere with so many rays."""
        return sphere(n_site)

    def field(
        self, adhesion: AdhesionMap, n_site: int, spacing: float, interpolation: Interpolation
    ) -> TileField:
        """Field of a tile up to the largest penetration."""
        return contact_field(
            adhesion, self.max_penetration, n_site, spacing, interpolation, band_limited=True
        )


@dataclass(frozen=True, slots=True)
class LoadSchedule(SphereSchedule):
    """Penetrations 0, step, 2 step ... max, and back until contact is lost.

    Parameters
    ----------
    max_penetration : float
        Largest penetration; it is visited even where it is no multiple of the step.
        (Units: reduced vertical length)
    step : float
        Difference of penetrations. (Units: reduced vertical length)

    Raises
    ------
    ValueError
        If the step is not positive, or the largest penetration is negative: the sphere makes
        contact at 0.

    Examples
    --------
    >>> list(LoadSchedule(0.5, 0.25).approach())
    [0.0, 0.25, 0.5]
    """

    max_penetration: float
    step: float

    full_cycle = True

    def __post_init__(self) -> None:
        if not (math.isfinite(self.step) and self.step > 0):
            raise ValueError(f"load step is {self.step}; it must be positive")
        if not (math.isfinite(self.max_penetration) and self.max_penetration >= 0):
            raise ValueError(
                f"max penetration {self.max_penetration} never makes contact; the sphere touches "
                "at 0, so set it to 0 or more"
            )

    @property
    def _whole_steps(self) -> int:
        """Number of whole steps that fit under the largest penetration."""
        return math.floor(self.max_penetration / self.step * (1 + 1e-12))

    def approach(self) -> Iterator[float]:
        """Penetrations of the approach, increasing."""
        for k in range(self._whole_steps + 1):
            yield k * self.step
        if self._whole_steps * self.step < self.max_penetration * (1 - 1e-12):
            yield self.max_penetration

    def retraction(self) -> Iterator[float]:
        """Penetrations below the largest one, decreasing without end."""
        k = self._whole_steps
        if k * self.step >= self.max_penetration * (1 - 1e-12):
            k -= 1
        while True:
            yield k * self.step
            k -= 1

    def loads(self) -> Iterator[Load]:
        """Penetrations of a whole cycle, without end, each with its direction."""
        yield from (Load(penetration, 1) for penetration in self.approach())
        yield from (Load(penetration, -1) for penetration in self.retraction())

    def run(
        self, field: Field, solver: Solver | None, recorder: Recorder, **_: float
    ) -> CycleRecord:
        """States from first contact to pull-off."""
        recorder.run(field, checked_touch(field, self.max_penetration), self.loads(), solver)
        return recorder.record()


def protocol(loads: Sequence[float], step: float = math.inf) -> Iterator[Load]:
    """Loads in their order, each with its direction; one that stands twice is a hold.

    Where two are further apart than a step, equal steps lead from one to the next.

    Raises
    ------
    ValueError
        If there is no load, or the step is not positive.

    Examples
    --------
    >>> [load.value for load in protocol([1.0, 2.0, 0.5], 1.0)]
    [1.0, 2.0, 1.25, 0.5]
    """
    if not step > 0:
        raise ValueError(f"load step is {step}; it must be positive")
    if not len(loads):
        raise ValueError("there are no loads; give one or more")
    return _way(loads, step)


def _way(loads: Sequence[float], step: float) -> Iterator[Load]:
    """Loads of a protocol, one after the other."""
    direction: Direction = 1
    yield Load(float(loads[0]), direction)
    for before, after in pairwise(map(float, loads)):
        direction = direction if after == before else 1 if after > before else -1
        count = max(1, math.ceil(abs(after - before) / step * (1 - 1e-12)))
        for k in range(1, count):
            yield Load(before + (after - before) * (k / count), direction)
        yield Load(after, direction)
