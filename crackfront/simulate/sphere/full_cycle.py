"""Full cycles of a sphere on a tile, and what all loads of a sphere share."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crackfront.analysis.steady_adhesion import SteadyAdhesion, steady_adhesion
from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap
from crackfront.core.cycle.load_schedule import LoadSchedule
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.cycle.run import run_cycle
from crackfront.core.field.fields import TileField
from crackfront.core.geometry.base import Geometry
from crackfront.core.geometry.sphere import contact_field, sphere
from crackfront.core.solver.relax import Solver
from crackfront.core.spectrum import Spectrum
from crackfront.simulate.contact import ExpectedMotion, Pressed, Problem, Schedule
from crackfront.simulate.laws import sphere_cutoffs
from crackfront.simulate.tiles import Fineness, RandomSurface, Resolution, correlated_adhesion


class SphereSchedule(Schedule, Pressed):
    """Loads of a sphere on a square tile, up to a largest penetration."""

    __slots__ = ()

    @property
    def front_length(self) -> float:
        """Length of the longest front that is smooth (Units: length)."""
        return 2 * math.pi * float(jkr.equilibrium_radius(self.max_penetration))

    def resolution(self, fineness: Fineness) -> Resolution:
        """Sizes on the least tile, which the contact may exceed."""
        return fineness.resolution(fineness.tile_side, self.front_length)

    def tile(self, resolution: Resolution) -> tuple[tuple[int, int], tuple[float, float]]:
        """A square."""
        return (resolution.n_point, resolution.n_point), (
            resolution.tile_side,
            resolution.tile_side,
        )

    def geometry(self, n_site: int) -> Geometry:
        """Sphere with so many rays."""
        return sphere(n_site)

    def adhesion(self, surface: RandomSurface) -> AdhesionMap:
        """Work of adhesion of a surface."""
        return correlated_adhesion(surface)

    def field(self, adhesion: AdhesionMap, resolution: Resolution) -> TileField:
        """Field of a tile up to the largest penetration."""
        return contact_field(
            adhesion,
            self.max_penetration,
            resolution.n_angle,
            resolution.spacing,
            resolution.interpolation,
            band_limited=True,
        )

    @classmethod
    def smallest(cls) -> Schedule:
        """A full cycle of first contact alone."""
        return FullCycle(0.0, 0.5)

    def spring_at(self, work_of_adhesion: float) -> float:
        """Length L_kappa of the springs that restore the edge of the largest smooth contact."""
        return jkr.spring(jkr.equilibrium_radius(self.max_penetration), work_of_adhesion)

    def steady_adhesion(
        self, record: CycleRecord, correlation_length: float, mean_adhesion: float
    ) -> SteadyAdhesion:
        """Means over the states of which every site has travelled a correlation length."""
        return steady_adhesion(record, correlation_length)

    def usual_cutoffs(self, spectrum: Spectrum) -> float:
        """Cutoffs crossed by a sphere of mean radius 1.6 in eight states."""
        return sphere_cutoffs(spectrum)

    def averaged_cutoffs(
        self, steady: SteadyAdhesion, correlation_length: float, short_cutoff: float
    ) -> tuple[float, float, float]:
        """Cutoffs crossed by the circles of the steady window."""
        low, high = steady.lowest_radius, steady.highest_radius
        cutoffs = math.pi * (low + high) / short_cutoff
        n_independent = 1 + (high - low) / correlation_length
        counts = steady.n_approach, steady.n_retraction
        approach, retraction = (cutoffs * min(count, n_independent) for count in counts)
        return approach, retraction, 2 * math.pi * high


@dataclass(frozen=True, slots=True)
class FullCycle(SphereSchedule, LoadSchedule):
    """A sphere from first contact to its largest penetration, and back to pull-off.

    Parameters and errors are as in :class:`crackfront.core.cycle.load_schedule.LoadSchedule`.
    """

    load_name = "full cycle"

    def run(self, problem: Problem, solver: Solver | None, recorder: Recorder) -> CycleRecord:
        """States from first contact to pull-off."""
        return run_cycle(problem.field, self, solver, recorder)

    def expected_motion(self, surface: RandomSurface) -> ExpectedMotion:
        """States of both branches, until contact is lost."""
        spacing = self.step / jkr.penetration_slope(self.max_penetration)
        # The hysteresis lifts w_retr by about twice e_el, and contact is lost that much later.
        lost_at = jkr.pull_off_penetration(1 + 2 * surface.elastic_energy)
        n_state = (2 * self.max_penetration - lost_at) / self.step
        return ExpectedMotion(n_state, spacing / surface.correlation_length)

    def steady_penetration(
        self, surface: RandomSurface, works: tuple[float, float], transient: float, n_state: int
    ) -> float:
        """Penetration that leaves both branches so many steady states at the same radii."""
        low, high = works
        begin = max(jkr.equilibrium_radius(0.0, low), jkr.pull_off_radius(high) - transient)
        step = self.step / jkr.penetration_slope(self.max_penetration)
        return float(jkr.equilibrium_penetration(begin + 2 * transient + n_state * step, low))
