"""Full cycles of a sphere on a tile, and what all loads of a sphere share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import Field, Interpolation, TileField
from crackfront.core.geometry.base import Geometry
from crackfront.core.geometry.sphere import contact_field, sphere
from crackfront.core.solver.relax import Solver
from crackfront.simulate.contact import ExpectedMotion, Schedule
from crackfront.simulate.tiles import RandomSurface

if TYPE_CHECKING:
    from crackfront.analysis.steady_adhesion import SteadyAdhesion


class SphereSchedule(Schedule):
    """Loads of a sphere on a square tile, up to a largest penetration."""

    __slots__ = ()

    uncorrelated = False
    spring = math.nan

    @property
    def n_period(self) -> None:
        """None: a branch is steady once every site has travelled far enough."""

    @property
    def front_length(self) -> float:
        """Length of the longest front that is smooth (Units: length)."""
        return 2 * math.pi * float(jkr.equilibrium_radius(self.max_penetration))

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

    @classmethod
    def smallest(cls) -> Schedule:
        """A full cycle of first contact alone."""
        return FullCycle(0.0, 0.5)

    def spring_at(self, work_of_adhesion: float) -> float:
        """Length L_kappa over which the edge of the largest smooth contact is held."""
        return jkr.spring(jkr.equilibrium_radius(self.max_penetration), work_of_adhesion)

    def refuse_few_sites(self, *_: object) -> None:
        """Refuse nothing: the numerics decide the sites of a sphere."""

    def averaged_sizes(
        self, steady: SteadyAdhesion, correlation_length: float, short_cutoff: float
    ) -> tuple[float, float, float]:
        """Sizes of the circles of the steady window."""
        low, high = steady.lowest_radius, steady.highest_radius
        cutoffs = math.pi * (low + high) / short_cutoff
        apart = 1 + (high - low) / correlation_length
        counts = steady.n_approach, steady.n_retraction
        approach, retraction = (cutoffs * min(count, apart) for count in counts)
        return approach, retraction, 2 * math.pi * high


@dataclass(frozen=True, slots=True)
class FullCycle(SphereSchedule, LoadSchedule):
    """A sphere from first contact to its largest penetration, and back to pull-off.

    Parameters and refusals are those of :class:`crackfront.core.cycle.load_schedule.LoadSchedule`.
    """

    load_name = "full cycle"

    def run(
        self, field: Field, solver: Solver | None, recorder: Recorder, **_: float
    ) -> CycleRecord:
        """States from first contact to pull-off."""
        return run_cycle(field, self, solver, recorder)

    def expected_motion(self, surface: RandomSurface) -> ExpectedMotion:
        """States of both branches, until contact is lost."""
        travel = self.step / jkr.penetration_slope(self.max_penetration)
        # The hysteresis lifts w_retr by about twice e_el, and contact is lost that much later.
        lost_at = jkr.pull_off_penetration(1 + 2 * surface.elastic_energy)
        n_state = (2 * self.max_penetration - lost_at) / self.step
        return ExpectedMotion(n_state, travel / surface.correlation_length)

    def steady_load(
        self, surface: RandomSurface, works: tuple[float, float], travel: float, n_state: int
    ) -> float:
        """Penetration that leaves both branches so many steady states at the same radii."""
        low, high = works
        begin = max(jkr.equilibrium_radius(0.0, low), jkr.pull_off_radius(high) - travel)
        step = self.step / jkr.penetration_slope(self.max_penetration)
        return float(jkr.equilibrium_penetration(begin + 2 * travel + n_state * step, low))
