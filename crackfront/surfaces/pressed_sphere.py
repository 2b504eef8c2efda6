"""A sphere on a user's surface."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from xarray import DataArray

from crackfront.analysis.steady_adhesion import SteadyAdhesion, steady_adhesion
from crackfront.core import jkr
from crackfront.core.adhesion import AdhesionMap, FieldKind
from crackfront.core.cycle.follow import Load
from crackfront.core.cycle.load_schedule import LoadSchedule, protocol
from crackfront.core.cycle.record import CycleRecord
from crackfront.core.cycle.touch import checked_touch
from crackfront.core.geometry.sphere import contact_field
from crackfront.core.solver import DEFAULT_TOLERANCE
from crackfront.simulate.costs import affordable_seconds
from crackfront.simulate.numerical_errors import missed_error, stated_error
from crackfront.simulate.simulation import Simulation, simulation_field
from crackfront.simulate.sphere.full_cycle import FullCycle
from crackfront.surfaces.loop_setup import (
    LoopContact,
    LoopNumerics,
    LoopSetup,
    check_samples,
    remark_on_mean,
    remark_on_sites,
    state_count,
)
from crackfront.surfaces.random_surface import chosen_simulation, stated_spectrum
from crackfront.surfaces.surface_adhesion import surface_adhesion
from crackfront.surfaces.tile_measures import tile_measures

_USUAL_SAMPLES = 2.0
"""Samples a pixel along a ray where no spectrum is stated."""


@dataclass(frozen=True, slots=True)
class SphereSetup(LoopSetup):
    """Setup of a sphere."""

    simulation: Simulation | None
    """One of the same sizes, whose numerical errors are known; None if no spectrum is stated."""

    def steady_adhesion(self, record: CycleRecord) -> SteadyAdhesion:
        """Means over the states of which every site has travelled a correlation length."""
        return steady_adhesion(record, self.measures.correlation_length)

    def numerical_errors(self, steady: SteadyAdhesion) -> tuple[float, float]:
        """Errors by the laws of the spectrum, where the surface states it."""
        if self.simulation is None or steady.sentence:
            return math.nan, math.nan
        return stated_error(self.simulation, steady, self.measures.correlation_length)


@dataclass(frozen=True, slots=True)
class PressedSphere(LoopContact):
    """A sphere, its apex above the centre of the periodic surface."""

    surface: DataArray
    """The surface, in reduced units."""
    max_penetration: float | None = None
    """Largest penetration of a full cycle, in place of loads. (Units: reduced vertical length)"""

    def setup(
        self, loads: tuple[float, ...] | None, step: float, numerics: LoopNumerics
    ) -> SphereSetup:
        """As :meth:`crackfront.surfaces.loop_setup.LoopContact.setup`."""
        deepest = self.max_penetration
        if loads is None and deepest is not None:
            full_cycle = LoadSchedule(deepest, step).loads()
            # A smooth sphere comes off there; a rough one goes somewhat further.
            n_state = 3 + (2 * deepest - jkr.pull_off_penetration()) / step
            return self._setup(deepest, full_cycle, n_state, numerics)
        if loads is None or deepest is not None:
            raise ValueError("a sphere needs max_penetration or loads; give one of the two")
        if loads[0] < 0:
            raise ValueError(
                f"loads begin with {loads[0]:g}; a sphere touches at penetration 0, so begin there "
                "or deeper"
            )
        return self._setup(max(loads), protocol(loads, step), state_count(loads, step), numerics)

    def _setup(
        self, deepest: float, loads: Iterator[Load], n_state: float, numerics: LoopNumerics
    ) -> SphereSetup:
        """Setup of a run up to a penetration, with its loads and about so many states."""
        adhesion = surface_adhesion(self.surface)
        radius, samples = jkr.equilibrium_radius(deepest), numerics.samples or _USUAL_SAMPLES
        circumference = 2 * math.pi * radius
        seconds = affordable_seconds(
            n_angle=numerics.sites or circumference / adhesion.pixel,
            n_point=adhesion.work_of_adhesion.size,
            n_state=n_state,
            n_sample=4 * samples * radius / adhesion.pixel,
        )
        measures = tile_measures(adhesion)
        check_samples(numerics, adhesion.pixel, measures)
        remarks = [remark_on_mean(measures)]
        simulation = self._simulation(deepest, adhesion, measures.kind, numerics)
        if simulation is None:
            tolerance = DEFAULT_TOLERANCE
            field = contact_field(adhesion, deepest, numerics.sites, adhesion.pixel / samples)
            remarks.append(remark_on_sites(field.geometry.n_site, circumference, measures))
        else:
            tolerance = simulation.solver.tolerance
            field = simulation_field(simulation, adhesion)
        return SphereSetup(
            field=field,
            front=checked_touch(field, deepest),
            loads=loads,
            expected=int(n_state),
            seconds=seconds,
            tolerance=tolerance,
            measures=measures,
            simulation=simulation,
            remark="; ".join(filter(None, remarks)),
        )

    def _simulation(
        self, deepest: float, adhesion: AdhesionMap, kind: FieldKind, numerics: LoopNumerics
    ) -> Simulation | None:
        """Simulation with the numerics that measured laws choose; None where the pixels decide."""
        spectrum = stated_spectrum(self.surface)
        if spectrum is None and numerics.error is not None:
            raise ValueError(
                f"error is {numerics.error:g}, but the surface does not state the spectrum whose "
                "errors were measured; give sites and samples instead"
            )
        if spectrum is None or adhesion.e_el == 0 or numerics.by_pixels:
            return None
        error = numerics.usual_error if numerics.error is None else numerics.error
        schedule = FullCycle(deepest, step=1.0)  # sizes do not depend on the step
        chosen = chosen_simulation(kind, spectrum, adhesion.e_el, schedule, error=error)
        n_point = min(adhesion.work_of_adhesion.shape)
        resolution = replace(chosen.resolution, tile_side=n_point * adhesion.pixel, n_point=n_point)
        simulation = replace(chosen, resolution=resolution)
        # If no error is requested, the result states the remaining one.
        if numerics.error is not None and (remaining := missed_error(simulation, error)):
            pixels = spectrum.short_cutoff / adhesion.pixel
            raise ValueError(
                f"error is {error:g}, but the finest numerics on {pixels:.3g} pixels per short "
                f"cutoff leave {remaining:.2g}; ask for that, or leave error out"
            )
        return simulation
