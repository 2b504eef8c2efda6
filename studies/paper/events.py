"""Whole events of straight fronts: how they are separated.

A whole event is all that moves when the load is raised by just enough to set off one instability;
its patches need not touch each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crackfront.core.arrays import Array
from crackfront.core.cycle.instabilities import resolved_motion, swept_areas, swept_clusters
from crackfront.core.variables import variable
from crackfront.validation import Positive
from studies.paper.figure import Integers
from studies.paper.rough import surface_means
from studies.paper.straight import StraightParameters
from studies.progress import Progress

_SPRING, _EVENT, _PATCH = "spring", "event", "patch"

_AREA, _EXTENT = "Larkin length times correlation length of the force", "Larkin length"


class EventParameters(StraightParameters):
    """Straight fronts whose whole events are separated, and the range of the fit.

    The unit of their loads is what moves a front by the area of L_kappa times the correlation
    length of the force, so that about as many events lie between loads whatever the spring.
    """

    load_step: Positive  # loads that are visited in any case, in their unit
    travel: Positive  # of a site in a smooth step at most, in correlation lengths of the force
    precision: Positive  # load to which an event is located; those that are closer come out as one
    smallest_area: Positive  # where the power law begins, over Larkin length times the other


@dataclass(frozen=True, slots=True)
class EventRecord:
    """Whole events of straight fronts."""

    front_length: float = variable("least period of the fronts over L_kappa", "1")
    sites_per_larkin_length: float = variable("sites on a Larkin length", "1")
    smallest_event: float = variable("area where the power law begins", _AREA)
    spring: Array = variable("length of the springs, L_kappa", _EXTENT, _SPRING)
    swept_area: Array = variable(
        "area that the fronts sweep, over the area that their load sweeps", "1", _SPRING
    )
    smooth_event_area: Array = variable("share of that left in smooth steps", "1", _SPRING)
    event_spring: Integers = variable("which spring", "1", _EVENT)
    event_area: Array = variable("area that the event sweeps", _AREA, _EVENT)
    event_extent: Array = variable(
        "its extent, the square of the mean motion over the mean square, times the period",
        _EXTENT,
        _EVENT,
    )
    patch_spring: Integers = variable("which spring", "1", _PATCH)
    patch_area: Array = variable("area of a connected part of an event", _AREA, _PATCH)


@dataclass(frozen=True, slots=True)
class _Events:
    """Whole events of one front over one period."""

    events: list[tuple[float, float]]  # areas and extents
    patches: list[float]
    swept_area: float
    smooth_event_area: float
    sites_per_larkin_length: float


def _events(parameters: EventParameters, spring: float, seed: int, tile: int) -> _Events:
    """Period of one front, resolved."""
    precision = parameters.precision / parameters.length / 4
    pulled = parameters.front(spring, seed, tile, precision)
    field, geometry = pulled.field, pulled.field.geometry
    unit = pulled.force_length / parameters.length
    n_load = math.ceil(pulled.period / (parameters.load_step * unit))
    travel = parameters.travel * pulled.force_length
    steps = resolved_motion(
        field,
        pulled.front,
        pulled.load,
        pulled.load + pulled.period * np.arange(1, n_load + 1) / n_load,
        1,
        travel=travel,
        precision=parameters.precision * unit,
        solver=pulled.solver,
    )
    whole = pulled.larkin_length * pulled.force_length
    sites = geometry.n_site * pulled.larkin_length / geometry.length
    events, patches, swept = [], [], [0.0, 0.0]
    for step in steps:
        shares = swept_areas(step.before, step.after, geometry) / whole
        area = float(np.sum(shares))
        swept[step.unstable] += area
        if step.unstable:
            events.append((area, area**2 / float(np.sum(shares**2)) / sites))
            parts = swept_clusters(step.before, step.after, travel, geometry)
            patches += [part.area / whole for part in parts]
    total, loaded = sum(swept), geometry.length * pulled.period / whole
    return _Events(events, patches, total / loaded, swept[0] / total, sites)


def event_record(
    parameters: EventParameters,
    springs: Sequence[float],
    n_tile: int,
    seed: int,
    progress: Progress,
) -> EventRecord:
    """Whole events of straight fronts on several springs, over one period of each of the tiles."""
    fronts: list[list[_Events]] = []
    for spring in springs:
        fronts.append([_events(parameters, spring, seed, tile) for tile in range(n_tile)])
        count = sum(len(tiles.events) for tiles in fronts[-1])
        progress(f"spring of {spring:g} Larkin lengths: {count} whole events")

    def gathered(name: str) -> tuple[Integers, Array]:
        """Index of the spring of each value, and all values."""
        values = [[value for tile in tiles for value in getattr(tile, name)] for tiles in fronts]
        owners = np.repeat(np.arange(len(fronts)), [len(tiles) for tiles in values])
        return owners, np.array([value for tiles in values for value in tiles])

    event_spring, events = gathered("events")
    patch_spring, patch_area = gathered("patches")
    return EventRecord(
        front_length=parameters.length,
        sites_per_larkin_length=fronts[0][0].sites_per_larkin_length,
        smallest_event=parameters.smallest_area,
        spring=np.array(springs),
        **surface_means(fronts, "swept_area", "smooth_event_area"),
        event_spring=event_spring,
        event_area=events[:, 0],
        event_extent=events[:, 1],
        patch_spring=patch_spring,
        patch_area=patch_area,
    )
