"""Loads of straight fronts, over a whole period of their tile, and how a sweep chooses them.

Fronts do not pass each other, so that the state after one period is the same state shifted, as soon
as the start is forgotten: a mean over the next period is the exact mean over the tile.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.fft import next_fast_len

from crackfront.analysis.standard_error import FEWEST_STATES
from crackfront.analysis.steady_adhesion import SteadyAdhesion, period_adhesion
from crackfront.core.adhesion import (
    AdhesionMap,
    FieldKind,
    correlation_length,
    force_correlation_length,
    larkin_length,
)
from crackfront.core.arguments import check_positive
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.record import CycleRecord, Recorder
from crackfront.core.field.fields import TileField, first_place, last_place
from crackfront.core.geometry.base import Geometry
from crackfront.core.geometry.line import Line, line_field
from crackfront.core.outcome import Direction, Status
from crackfront.core.resources import check_memory
from crackfront.core.solver.relax import Solver
from crackfront.core.spectrum import Spectrum
from crackfront.core.units import WORK_OF_ADHESION
from crackfront.core.words import counted
from crackfront.simulate.contact import (
    ExpectedMotion,
    OnSprings,
    Problem,
    Schedule,
    SurfaceLoads,
)
from crackfront.simulate.laws import LAW_CUTOFFS
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.tiles import (
    Fineness,
    RandomSurface,
    Resolution,
    correlated_adhesion,
    uncorrelated_adhesion,
)

if TYPE_CHECKING:
    from crackfront.simulate.simulation import Simulation

_BEHIND = 1.3
"""Largest pinning force of a first front, relative to second-order theory."""


SpringUnit = Literal["correlation_length", "larkin_length"]

LAW_LENGTH = 10.0
"""Length of the fronts on which the law of k was measured, relative to their springs.

On a shorter front k is larger: the front is pinned as a whole.
"""

_DEPTH, _ROUGHNESS = 1.43, 0.4
"""Rms of a front over the force's correlation length, 1.43 (L_kappa / Larkin length)^0.4: measured
over all spectra, amplitudes and springs of `config/line.yaml`, within a fifth."""

_LEAD_IN = 3.0
"""Correlation lengths after which a front has forgotten its start, in addition to its roughness."""


@dataclass(frozen=True, slots=True)
class LineSchedule(Schedule, OnSprings):
    """Loads of a straight front on a tile, first forward, then back over the same places.

    ValueError if a length is not positive and finite.
    """

    spring: float
    """Length of the springs, L_kappa. (Units: length)"""
    length: float
    """Period of the front. (Units: length)"""
    period: float
    """Period of the tile along the motion, over which each branch is averaged. (Units: length)"""
    lead_in: float
    """Travel before that, after which the start is forgotten. (Units: length)"""
    step: float
    """Largest load step. (Units: length)"""
    uncorrelated: bool = False
    """Whether sites are independent of each other, the limit of weak disorder."""

    load_name = "straight front"

    def __post_init__(self) -> None:
        lengths = ("spring", "length", "period", "lead_in", "step")
        check_positive(**{name: getattr(self, name) for name in lengths})

    @property
    def n_period(self) -> int:
        """Steps of one period, at the end of which each branch is averaged."""
        return math.ceil(self.period / self.step)

    @property
    def loads(self) -> Array:
        """Places of the springs' other end, in the order of the advance (Units: length)."""
        step = self.period / self.n_period
        n_step = math.ceil(self.lead_in / step) + self.n_period
        return step * np.arange(n_step + 1, dtype=float)

    @property
    def front_length(self) -> float:
        """Period of the front (Units: length)."""
        return self.length

    def resolution(self, fineness: Fineness) -> Resolution:
        """Sizes on a tile as long as the front.

        A period has whole samples, so that a period further on all is the same. Independent sites
        lie at the points of the tile.
        """
        resolution = fineness.resolution(self.length, self.front_length)
        n_site = resolution.n_point if self.uncorrelated else resolution.n_angle
        spacing = self.period / math.ceil(self.period / resolution.spacing)
        return replace(resolution, n_angle=n_site, spacing=spacing)

    def tile(self, resolution: Resolution) -> tuple[tuple[int, int], tuple[float, float]]:
        """One period along the motion and one of the front."""
        n_period = round(self.period * resolution.n_point / resolution.tile_side)
        return (n_period, resolution.n_point), (self.period, resolution.tile_side)

    def geometry(self, n_site: int) -> Geometry:
        """Line on springs that do not pull at w_int."""
        return Line(n_site, self.length, WORK_OF_ADHESION / self.spring, WORK_OF_ADHESION)

    def adhesion(self, surface: RandomSurface) -> AdhesionMap:
        """Work of adhesion of a surface, or of independent rows for weak disorder."""
        if self.uncorrelated:
            return uncorrelated_adhesion(surface)
        return correlated_adhesion(surface)

    def field(self, adhesion: AdhesionMap, resolution: Resolution) -> TileField:
        """Field of a tile over all loads."""
        return line_field(
            adhesion,
            self.spring,
            (0.0, float(self.loads[-1])),
            n_site=resolution.n_angle,
            spacing=resolution.spacing,
            interpolation=resolution.interpolation,
            band_limited=not self.uncorrelated,
        )

    def run(self, problem: Problem, solver: Solver | None, recorder: Recorder) -> CycleRecord:
        """Both branches over the lead-in and a period, `STEADY` where both are whole.

        e_el decides how far behind the load a branch begins.
        """
        field = problem.field
        # The pinning force of second-order theory is w_rms^2 / w_int = 4 e_el.
        pinned = _BEHIND * 4 * problem.elastic_energy * self.spring
        # As far behind as the field allows, never less than pinning may stop the front.
        inside = min(-first_place(field), last_place(field) - float(self.loads[-1]))
        behind = min(pinned + self.step, max(inside, pinned))
        directions: tuple[Direction, Direction] = (1, -1)
        loads: list[Load] = []
        for direction in directions:
            first, *further = self.loads[::direction].tolist()
            start = np.full(field.geometry.n_site, first - direction * behind)
            loads += [Load(first, direction, start), *(Load(place, direction) for place in further)]
        recorder.run(field, np.full(field.geometry.n_site, -behind), loads, solver)
        return recorder.record(Status.STEADY if recorder.status is Status.CONVERGED else None)

    @classmethod
    def smallest(cls) -> Schedule:
        """A front of one spring over a tile of one point."""
        return cls(spring=1.0, length=4.0, period=1.0, lead_in=1.0, step=1.0)

    def expected_motion(self, surface: RandomSurface) -> ExpectedMotion:
        """States of the lead-in and of the period, in both directions."""
        return ExpectedMotion(2.0 * self.loads.size, self.step / surface.correlation_length)

    def spring_at(self, work_of_adhesion: float) -> float:
        """Length of the springs, whatever the work of adhesion."""
        return self.spring

    def steady_adhesion(
        self, record: CycleRecord, correlation_length: float, mean_adhesion: float
    ) -> SteadyAdhesion:
        """Means over the last period of each branch."""
        return period_adhesion(record, self.n_period, mean_adhesion, correlation_length)

    def usual_cutoffs(self, spectrum: Spectrum) -> float:
        """Cutoffs crossed, for which settings are chosen, whatever the spectrum."""
        return LAW_CUTOFFS

    def averaged_cutoffs(
        self, steady: SteadyAdhesion, correlation_length: float, short_cutoff: float
    ) -> tuple[float, float, float]:
        """Cutoffs crossed in one period of the tile, equal for both branches."""
        cutoffs = self.length / short_cutoff * (1 + self.period / correlation_length)
        return cutoffs, cutoffs, self.length


@dataclass(frozen=True, slots=True)
class LineLoad(SurfaceLoads):
    """Springs and loads of the straight fronts of a sweep."""

    spring_unit: SpringUnit
    """Unit in which the spectra state the length of their springs."""
    length: float
    """Period of the front over the length of its springs."""
    period: float
    """Period of the tile along the motion over the expected rms of the front."""
    transient: float
    """Travel before a branch is averaged, over the same rms."""
    step: float
    """Largest load step, in correlation lengths."""
    uncorrelated: bool = False
    """Whether sites are independent of each other, the limit of weak disorder."""

    def usual_cutoffs(self, spectrum: Spectrum) -> float:
        """Cutoffs crossed, for which settings are chosen, whatever the spectrum."""
        return LAW_CUTOFFS

    def for_surface(
        self,
        kind: FieldKind,
        spectrum: Spectrum,
        elastic_energy: float,
        spring: float,
        numerics: Numerics,
    ) -> LineSchedule:
        """Loads of one spectrum and amplitude on springs of so many units; whole pixels.

        Along both axes the tile has the roll-offs and short cutoffs of the numerics or more.
        """
        larkin = larkin_length(kind, spectrum, 2 * math.sqrt(elastic_energy))
        correlation = correlation_length(kind, spectrum)
        spring_length = spring * (
            correlation if self.spring_unit == "correlation_length" else larkin
        )
        settings = numerics.settings_of(
            kind, spectrum, elastic_energy, self.usual_cutoffs(spectrum)
        )
        pixel = spectrum.short_cutoff / settings.pixels_per_cutoff
        least = numerics.tile_side(spectrum)
        rms = front_rms(force_correlation_length(kind, spectrum), spring_length / larkin)
        return LineSchedule(
            spring=spring_length,
            length=pixel * _points(max(self.length * spring_length, least) / pixel),
            period=pixel * _points(max(self.period * rms, least) / pixel),
            lead_in=_LEAD_IN * correlation + self.transient * rms,
            step=self.step * correlation,
            uncorrelated=self.uncorrelated,
        )

    def check_resolution(self, simulation: Simulation) -> None:
        """Raise ValueError if a Larkin length has few sites, or a period few states."""
        resolution, schedule = simulation.resolution, simulation.schedule
        name, energy = simulation.spectrum_name, simulation.elastic_energy
        larkin = larkin_length(simulation.kind, simulation.spectrum, 2 * math.sqrt(energy))
        site = resolution.tile_side / resolution.n_angle
        if larkin < 2 * site:
            raise ValueError(
                f"numerics: the Larkin length of {name} at e_el {energy:g} is {larkin:.3g}, below "
                f"two sites ({2 * site:.3g}); lower the amplitude or use more sites"
            )
        if isinstance(schedule, LineSchedule) and schedule.n_period < FEWEST_STATES:
            raise ValueError(
                f"load.line: the period of {name} at e_el {energy:g} has "
                f"{counted(schedule.n_period, 'state')}, and errors need {FEWEST_STATES} or more; "
                "lower step or raise period"
            )


def front_rms(force_correlation_length: float, size: float) -> float:
    """Rms deviation of a front from its mean on springs of a size g (Units: length)."""
    return _DEPTH * force_correlation_length * max(size, 0.1) ** _ROUGHNESS


def _points(least: float) -> int:
    """Points of a side, an even product of small primes; TooLargeError above any memory."""
    remedy = "lower length, period, springs or pixels_per_cutoff"
    check_memory(f"sides of {least:.2g} points", 32.0 * least, remedy, anywhere=True)
    return 2 * int(next_fast_len(math.ceil(least / 2 * (1 - 1e-12)), real=True))
