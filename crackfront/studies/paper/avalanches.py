"""Beyond the paper: sizes, extents and energies of the instabilities of steady retraction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from crackfront.analysis.power_law import PowerLaw, truncated_power_law
from crackfront.core.adhesion import correlation_length
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.cycle.instabilities import resolved_motion, swept_clusters
from crackfront.core.records import ADHESION, ENERGY, LATERAL, VERTICAL, variable
from crackfront.core.spectrum import SelfAffineSpectrum
from crackfront.data.section import Count, Energy, Positive, Section
from crackfront.studies.paper.contact import (
    STRONG,
    WEAK,
    circle_stiffness,
    refuse_rising,
    rough_contact,
)
from crackfront.studies.paper.figure import Check, Progress

Array = NDArray[np.float64]

_DISORDER, _EVENT = "disorder", "avalanche"

SIZE_EXPONENT = 1.28
"""Exponent of avalanche sizes of a line with long-range elasticity (Laurson, Santucci, Zapperi,
Phys. Rev. E 81, 046116)."""

_TOLERANCE = 0.1
"""Largest deviation of the exponent."""


class AvalancheParameters(Section):
    """Surfaces, the part of their retraction that is resolved, and the range of the fit.

    Attributes
    ----------
    short_cutoff : float
        Shortest wavelength of the flat spectrum. (Units: reduced lateral length)
    strong, weak : float
        e_el of the two kinds of surfaces. (Units: w_int)
    n_surface : int
        Surfaces of each kind.
    max_penetration, first_penetration, last_penetration : float
        Where the retraction begins, and between which penetrations it is resolved: the closer to
        pull-off, the softer is the circle, and the larger may avalanches become.
        (Units: reduced vertical length)
    load_step : float
        Penetrations that are visited in any case. (Units: reduced vertical length)
    travel : float
        Largest motion of a site in a smooth step, over the short cutoff.
    precision : float
        Penetration to which an avalanche is located; avalanches that are closer come out as one.
        (Units: reduced vertical length)
    smallest_area : float
        Where the power law begins, over the area of a Larkin length (or a correlation length, if
        that is longer) times a correlation length.
    error : float
        Error of the factor k that the resolution may leave.
    seed : int
        Seed of the surfaces.
    """

    short_cutoff: Positive
    strong: Energy
    weak: Energy
    n_surface: Count
    max_penetration: Positive
    first_penetration: float
    last_penetration: float
    load_step: Positive
    travel: Positive
    precision: Positive
    smallest_area: Positive
    error: Positive
    seed: Count

    @model_validator(mode="after")
    def _usable(self) -> AvalancheParameters:
        refuse_rising(self.max_penetration, self.first_penetration, self.last_penetration)
        return self


@dataclass(frozen=True, slots=True)
class AvalancheRecord:
    """Avalanches of all surfaces."""

    short_cutoff: float = variable("shortest wavelength of the roughness", LATERAL)
    correlation_length: float = variable("correlation length of w_loc", LATERAL)
    precision: float = variable("penetration to which they are located", VERTICAL)
    seed: int = variable("seed of the surfaces", "1")
    elastic_energy: Array = variable("requested e_el", ADHESION, _DISORDER)
    rms: Array = variable("w_rms, mean of the tiles", ADHESION, _DISORDER)
    larkin_length: Array = variable("Larkin length", LATERAL, _DISORDER)
    smallest_area: Array = variable("where the power law begins", f"({LATERAL})^2", _DISORDER)
    circle_length: Array = variable(
        "perimeter over the stiffness of the circle, a dG/da / w_int", LATERAL, _DISORDER
    )
    smooth_area: Array = variable("share of the area left in smooth steps", "1", _DISORDER)
    disorder_index: NDArray[np.int64] = variable("which disorder", "1", _EVENT)
    surface: NDArray[np.int64] = variable("number of the surface", "1", _EVENT)
    penetration: Array = variable("penetration of the avalanche", VERTICAL, _EVENT)
    area: Array = variable("area that it sweeps", f"({LATERAL})^2", _EVENT)
    extent: Array = variable("width of its largest patch, area over depth", LATERAL, _EVENT)
    n_patch: NDArray[np.int64] = variable("patches that do not touch", "1", _EVENT)
    energy: Array = variable("energy that it dissipates", ENERGY, _EVENT)


@dataclass(frozen=True, slots=True)
class _Avalanche:
    """One instability."""

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
    """Avalanches of steady retraction on several surfaces of two amplitudes.

    Parameters
    ----------
    parameters : AvalancheParameters
        What to compute.
    progress : callable
        Called with a line for every surface.
    """
    surfaces: list[list[_Surface]] = []
    for name, energy in (("strong", parameters.strong), ("weak", parameters.weak)):
        surfaces.append([])
        for realisation in range(parameters.n_surface):
            surfaces[-1].append(_surface(parameters, energy, realisation))
            count = len(surfaces[-1][-1].avalanches)
            progress(f"{name} disorder, surface {realisation}: {count} avalanches")
    spectrum = SelfAffineSpectrum(parameters.short_cutoff, parameters.short_cutoff, hurst=1.0)
    correlation = correlation_length("roughness", spectrum)
    rms, larkin, circle, smooth = (
        np.array([np.mean([getattr(one, name) for one in kind]) for kind in surfaces])
        for name in ("rms", "larkin_length", "circle_length", "smooth_area")
    )
    rows = [
        (index, realisation, event)
        for index, kind in enumerate(surfaces)
        for realisation, one in enumerate(kind)
        for event in one.avalanches
    ]
    return AvalancheRecord(
        short_cutoff=parameters.short_cutoff,
        correlation_length=correlation,
        precision=parameters.precision,
        seed=parameters.seed,
        elastic_energy=np.array([parameters.strong, parameters.weak]),
        rms=rms,
        larkin_length=larkin,
        smallest_area=parameters.smallest_area * correlation * np.maximum(larkin, correlation),
        circle_length=circle,
        smooth_area=smooth,
        disorder_index=np.array([index for index, _, _ in rows]),
        surface=np.array([realisation for _, realisation, _ in rows]),
        penetration=np.array([event.penetration for _, _, event in rows]),
        area=np.array([event.area for _, _, event in rows]),
        extent=np.array([event.extent for _, _, event in rows]),
        n_patch=np.array([event.n_patch for _, _, event in rows]),
        energy=np.array([event.energy for _, _, event in rows]),
    )


def _surface(parameters: AvalancheParameters, energy: float, realisation: int) -> _Surface:
    """Retraction on one surface, resolved."""
    contact = rough_contact(
        parameters.short_cutoff,
        energy,
        parameters.max_penetration,
        realisation=realisation,
        seed=parameters.seed,
        error=parameters.error,
        tolerance=parameters.precision / 4,
    )
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
    avalanches, areas, last = [], [0.0, 0.0], front
    for step in steps:
        area = float(np.pi * np.mean(step.before**2 - step.after**2))
        areas[step.unstable] += area
        last = step.after
        if step.unstable:
            patches = swept_clusters(step.before, step.after, travel)
            lost = dissipated_energy(step.before, step.after, step.end, contact.field)
            avalanches.append(_Avalanche(step.end, area, patches[0].extent, len(patches), lost))
    middle = float(np.mean([front, last]))
    return _Surface(
        avalanches=avalanches,
        smooth_area=areas[0] / sum(areas),
        circle_length=2 * np.pi * middle / float(circle_stiffness(middle, (start + stop) / 2)),
        rms=contact.rms,
        larkin_length=contact.larkin_length,
    )


def size_law(record: AvalancheRecord, index: int) -> PowerLaw:
    """Power law of the swept areas of one disorder.

    Parameters
    ----------
    record : AvalancheRecord
        Data of the figure.
    index : {0, 1}
        Strong or weak disorder.
    """
    rng = np.random.default_rng(np.random.SeedSequence(record.seed, spawn_key=(index,)))
    areas = record.area[record.disorder_index == index]
    return truncated_power_law(areas, float(record.smallest_area[index]), rng)


def avalanche_checks(record: AvalancheRecord) -> tuple[Check, ...]:
    """Exponents, and the lengths between which avalanches lie.

    Parameters
    ----------
    record : AvalancheRecord
        Data of the figure.
    """
    checks = [
        check
        for index, name in ((STRONG, "strong"), (WEAK, "weak"))
        for check in _checks(record, index, name)
    ]
    smallest = [
        float(np.quantile(record.extent[record.disorder_index == index], 0.1))
        for index in (STRONG, WEAK)
    ]
    checks.append(
        Check(
            "the smallest extent grows for weaker disorder",
            "> 1",
            f"{smallest[WEAK] / smallest[STRONG]:.3g} times",
            smallest[WEAK] > smallest[STRONG],
            f"tenth percentiles {smallest[STRONG]:.3g} and {smallest[WEAK]:.3g}; Larkin lengths "
            f"{record.larkin_length[STRONG]:.3g} and {record.larkin_length[WEAK]:.3g}, correlation "
            f"length {record.correlation_length:.3g}",
        )
    )
    return tuple(checks)


def _checks(record: AvalancheRecord, index: int, name: str) -> Iterator[Check]:
    """Claims about one disorder."""
    chosen = record.disorder_index == index
    energy, extent = record.energy[chosen], record.extent[chosen]
    law = size_law(record, index)
    contained = "contains it" if law.low <= SIZE_EXPONENT <= law.high else "leaves it out"
    yield Check(
        f"{name} disorder: exponent of the swept areas",
        f"{SIZE_EXPONENT} ± {_TOLERANCE}",
        f"{law.exponent:.2f} ({law.low:.2f} to {law.high:.2f})",
        abs(law.exponent - SIZE_EXPONENT) <= _TOLERANCE,
        f"{law.n_value} of {energy.size} avalanches; the 95% interval of a bootstrap over "
        f"avalanches {contained}; from {law.smallest:.2g} to the cut-off at {law.cutoff:.2g}, "
        f"{np.log10(law.cutoff / law.smallest):.1f} decades; an effective exponent where these are "
        "few, as the sphere's own cut-off need not be exponential",
    )
    yield Check(
        f"{name} disorder: every avalanche dissipates energy",
        "> 0",
        f"{energy.size} from {energy.min():.2g} to {energy.max():.2g}",
        bool(np.all(energy > 0)),
        f"smooth steps sweep {record.smooth_area[index]:.2g} of the area",
    )
    longest = float(np.quantile(extent, 0.99))
    yield Check(
        f"{name} disorder: avalanches end below the length on which the circle is stiffer than "
        "the line",
        f"99% below {record.circle_length[index]:.3g}",
        f"{longest:.3g}",
        longest < record.circle_length[index],
        "perimeter over a dG/da; the upper cut-off is that of the sphere, not of the disorder",
    )
