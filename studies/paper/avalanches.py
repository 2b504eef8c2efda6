"""Computation of avalanches of straight fronts on springs, and of a sphere in retraction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crackfront.core.adhesion import force_correlation_length
from crackfront.core.arrays import Array
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.instabilities import resolved_motion, swept_clusters
from crackfront.core.variables import ADHESION, AREA, ENERGY, LATERAL, VERTICAL, variable
from crackfront.validation import Count, Positive
from studies.paper.events import EventParameters, EventRecord, event_record
from studies.paper.figure import Integers, values_of
from studies.paper.rough import (
    STRONG,
    WEAK,
    RetractionParameters,
    circle_stiffness,
    flat_spectrum,
    surface_means,
)
from studies.paper.straight import Springs
from studies.progress import Progress

_DISORDER, _AVALANCHE = "disorder", "avalanche"


class AvalancheParameters(RetractionParameters):
    """Surfaces, the part of their retraction that is resolved, the range of the fit, and lines.

    The closer the penetrations are to pull-off, the softer is the circle, and the larger may
    avalanches become.
    """

    load_step: Positive  # penetrations that are visited in any case (reduced vertical length)
    travel: Positive  # largest motion of a site in a smooth step, over the short cutoff
    precision: Positive  # penetration to which an avalanche is located; closer ones come out as one
    # Start of the power law, over the Larkin length times the correlation length of the force.
    smallest_area: Positive
    line: EventParameters  # straight fronts, and how their events are told apart
    springs: Springs
    n_tile: Count  # of each spring; each front goes over a whole period


@dataclass(frozen=True, slots=True)
class AvalancheRecord(EventRecord):
    """Whole events of straight fronts, and avalanches of all surfaces of a sphere."""

    short_cutoff: float = variable("shortest wavelength of the roughness", LATERAL)
    correlation_length: float = variable("correlation length of w_loc", LATERAL)
    precision: float = variable("penetration to which they are located", VERTICAL)
    seed: int = variable("seed of the surfaces", "1")
    elastic_energy: Array = variable("requested e_el", ADHESION, _DISORDER)
    rms: Array = variable("w_rms, mean of the tiles", ADHESION, _DISORDER)
    larkin_length: Array = variable("Larkin length", LATERAL, _DISORDER)
    smallest_area: Array = variable("where the power law begins", AREA, _DISORDER)
    circle_length: Array = variable(
        "perimeter over the stiffness of the circle, a dG/da / w_int", LATERAL, _DISORDER
    )
    smooth_area: Array = variable("share of the area left in smooth steps", "1", _DISORDER)
    disorder_index: Integers = variable("which disorder", "1", _AVALANCHE)
    surface: Integers = variable("number of the surface", "1", _AVALANCHE)
    penetration: Array = variable("penetration of the avalanche", VERTICAL, _AVALANCHE)
    area: Array = variable("area that it sweeps", AREA, _AVALANCHE)
    extent: Array = variable("width of its largest patch, area over depth", LATERAL, _AVALANCHE)
    n_patch: Integers = variable("patches that do not touch", "1", _AVALANCHE)
    energy: Array = variable("energy that it dissipates", ENERGY, _AVALANCHE)


class _Avalanche(NamedTuple):
    """One instability."""

    surface: int
    penetration: float
    area: float
    extent: float
    n_patch: int
    energy: float


@dataclass(frozen=True, slots=True)
class _Surface:
    """Avalanches on one surface and what they are compared with."""

    avalanches: list[_Avalanche]
    smooth_area: float
    circle_length: float
    rms: float
    larkin_length: float


def avalanche_record(parameters: AvalancheParameters, progress: Progress) -> AvalancheRecord:
    """Whole events of straight fronts, then avalanches on surfaces of two amplitudes."""
    line, springs = parameters.line, parameters.springs
    whole = event_record(line, springs, parameters.n_tile, parameters.seed, progress)
    energies = {"strong": parameters.strong, "weak": parameters.weak}
    surfaces: dict[str, list[_Surface]] = {name: [] for name in energies}
    for name, energy in energies.items():
        for realisation in range(parameters.n_surface):
            surface = _surface(parameters, energy, realisation)
            surfaces[name].append(surface)
            count = len(surface.avalanches)
            progress(f"{name} disorder, surface {realisation}: {count} avalanches")
    spectrum = flat_spectrum(parameters.short_cutoff)
    kinds = [*surfaces.values()]
    means = surface_means(kinds, "rms", "larkin_length", "circle_length", "smooth_area")
    unit = means["larkin_length"] * force_correlation_length("roughness", spectrum)
    strong, weak = ([event for surface in kind for event in surface.avalanches] for kind in kinds)
    columns = (np.array(column) for column in zip(*strong, *weak, strict=True))
    avalanches: dict[str, Any] = dict(zip(_Avalanche._fields, columns, strict=True))
    return AvalancheRecord(
        **values_of(whole),
        **values_of(parameters, "short_cutoff", "precision", "seed"),
        correlation_length=spectrum.correlation_length,
        elastic_energy=np.array([*energies.values()]),
        **means,
        smallest_area=parameters.smallest_area * unit,
        disorder_index=np.repeat([STRONG, WEAK], [len(strong), len(weak)]),
        **avalanches,
    )


def expected_seconds(parameters: AvalancheParameters) -> float:
    """Processor time as measured with either scale, for any number of fronts (Units: s).

    The sites of a straight front and the loads of its period grow with its spring.
    """
    springs = sum(spring**2 for spring in parameters.springs)
    return 20.0 * parameters.n_surface + 3.1e-5 * springs * parameters.n_tile


def _surface(parameters: AvalancheParameters, energy: float, realisation: int) -> _Surface:
    """Retraction on one surface, resolved."""
    contact = parameters.contact(energy, parameters.precision / 4, realisation)
    start, stop = parameters.first_penetration, parameters.last_penetration
    travel = parameters.travel * parameters.short_cutoff
    front = contact.moved(contact.touched(parameters.max_penetration), start, -1)
    n_load = max(round((start - stop) / parameters.load_step), 1)
    steps = resolved_motion(
        contact.field,
        front,
        start,
        np.linspace(start, stop, n_load + 1)[1:],
        -1,
        travel=travel,
        precision=parameters.precision,
        solver=contact.solver,
    )
    avalanches, last = [], front
    smooth_area = unstable_area = 0.0
    for step in steps:
        area = float(np.pi * np.mean(step.before**2 - step.after**2))
        last = step.after
        if not step.unstable:
            smooth_area += area
        else:
            unstable_area += area
            patches = swept_clusters(step.before, step.after, travel, contact.field.geometry)
            lost = dissipated_energy(step.before, step.after, step.end, contact.field)
            avalanches.append(
                _Avalanche(realisation, step.end, area, patches[0].extent, len(patches), lost)
            )
    middle = float(np.mean([front, last]))
    return _Surface(
        avalanches=avalanches,
        smooth_area=smooth_area / (smooth_area + unstable_area),
        circle_length=2 * np.pi * middle / float(circle_stiffness(middle, (start + stop) / 2)),
        rms=contact.w_rms,
        larkin_length=contact.larkin_length,
    )
