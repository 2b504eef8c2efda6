"""Straight fronts of figures, on springs and in the limit of weak disorder."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from pydantic import Field

from crackfront.core.adhesion import FieldKind, force_correlation_length, larkin_length
from crackfront.core.arrays import Array
from crackfront.core.cycle.follow import Load, follow
from crackfront.core.field.fields import TileField
from crackfront.core.geometry.line import initial_front
from crackfront.core.outcome import Status
from crackfront.core.solver.relax import Solver
from crackfront.simulate.line.line_loads import LineLoad
from crackfront.simulate.numerics import Numerics
from crackfront.simulate.settings import Settings
from crackfront.simulate.simulation import simulation_adhesion, simulation_field, simulation_of
from crackfront.sweep.section import Section
from crackfront.validation import Positive
from studies.paper.rough import flat_spectrum

_KIND: FieldKind = "roughness"

_SPECTRUM = flat_spectrum(1.0)
"""A flat one, whose short cutoff is the unit of length."""

_PERIOD = 25.0
"""Period of a tile over the expected rms of the front, as in config/line.yaml."""

_TRANSIENT = 6.0
"""Travel before that period, over the expected rms of the front, as in config/line.yaml."""

_STEP = 0.5
"""Largest load step of this travel, in correlation lengths, as in config/line.yaml."""

_TILE_CUTOFFS = 60.0
"""Least sides of a tile."""

Springs = Annotated[tuple[Positive, ...], Field(min_length=2, strict=False)]
"""Lengths of springs over the Larkin length."""


class StraightParameters(Section):
    """Straight fronts in the limit of weak disorder: sites pinned independently of each other."""

    elastic_energy: Positive  # which decides how many sites a Larkin length has (w_int)
    pixels_per_cutoff: Annotated[float, Field(ge=2, allow_inf_nan=False)]  # and sites per cutoff
    length: Positive  # period of a front over L_kappa

    def front(self, spring: float, seed: int, realisation: int, precision: float) -> StraightFront:
        """Front that has forgotten its start, on one tile, on springs of L_kappa / Larkin length.

        The tolerance of the solver may cost a load of `precision` correlation lengths of the force.
        """
        energy, pixels = self.elastic_energy, self.pixels_per_cutoff
        depth = force_correlation_length(_KIND, _SPECTRUM)
        larkin = larkin_length(_KIND, _SPECTRUM, 2 * math.sqrt(energy))
        tolerance = precision * depth / (spring * larkin)
        settings = Settings(None, pixels, 2 * pixels, "cubic", pixels, tolerance)
        numerics = Numerics(settings=settings, tile_roll_offs=1.0, tile_cutoffs=_TILE_CUTOFFS)
        load = LineLoad("larkin_length", self.length, _PERIOD, _TRANSIENT, _STEP, uncorrelated=True)
        schedule = load.for_surface(_KIND, _SPECTRUM, energy, spring, numerics)
        simulation = simulation_of(
            _KIND, _SPECTRUM, energy, schedule, numerics, seed=seed, realisation=realisation
        )
        adhesion = simulation_adhesion(simulation)
        field = simulation_field(simulation, adhesion)
        starting = StraightFront(
            field=field,
            solver=simulation.solver,
            front=initial_front(field, adhesion, 0.0),
            load=schedule.lead_in,
            period=schedule.period,
            spring=schedule.spring,
            larkin_length=larkin,
            force_length=depth,
        )
        loads = np.linspace(0.0, schedule.lead_in, math.ceil(schedule.lead_in / depth) + 1)
        *_, front = starting.moved(loads)
        return replace(starting, front=front)


@dataclass(frozen=True, slots=True)
class StraightFront:
    """A straight front at rest; the unit of all lengths is the short cutoff."""

    field: TileField
    solver: Solver
    front: Array  # (n_site,)
    load: float
    period: float  # of the tile: the front at the load further on by it is the same
    spring: float  # L_kappa
    larkin_length: float
    force_length: float  # correlation length of the force

    def moved(self, loads: Iterable[float]) -> Iterator[Array]:
        """Fronts at rest, one a load; a ValueError says why there is none."""
        steps = (Load(float(load), 1) for load in loads)
        for step in follow(self.field, self.front, steps, self.solver):
            if step.status is not Status.CONVERGED:
                raise ValueError(f"at load {step.load.value:.6g}: {step.status.value}")
            yield step.front
