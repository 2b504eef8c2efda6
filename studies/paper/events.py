"""Whole events of straight fronts: how they are separated, their laws, checks and panels.

A whole event is all that moves when the load is raised by just enough to set off one instability;
its patches need not touch each other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from crackfront.analysis.estimate import with_error
from crackfront.core.arrays import Array
from crackfront.core.variables import variable
from crackfront.data.section import Positive
from crackfront.plots.style import BLACK, COLOURS, MARKERS
from crackfront.simulate.instabilities import resolved_motion, swept_areas, swept_clusters
from studies.paper.figure import Check, Integers, Progress, close_to
from studies.paper.power_law import JointPowerLaw, cutoff_scale, joint_power_law
from studies.paper.rough import surface_means
from studies.paper.straight import StraightParameters

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
        "area that the fronts sweep, over that of the way of their load", "1", _SPRING
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
        each = swept_areas(step.before, step.after, geometry) / whole
        area = float(np.sum(each))
        swept[step.unstable] += area
        if step.unstable:
            events.append((area, area**2 / float(np.sum(each**2)) / sites))
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
        count = sum(len(one.events) for one in fronts[-1])
        progress(f"spring of {spring:g} Larkin lengths: {count} whole events")

    def gathered(name: str) -> tuple[Integers, Array]:
        """Index of the spring of each value, and all values."""
        values = [[value for tile in one for value in getattr(tile, name)] for one in fronts]
        owners = np.repeat(np.arange(len(fronts)), [len(one) for one in values])
        return owners, np.array([value for one in values for value in one])

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


_ROUGHNESS = 0.388
"""Roughness exponent zeta of a line with long-range elasticity (Rosso and Krauth, Phys. Rev. E 65,
025101), from which all others follow."""

SIZE_EXPONENT = 2 - 1 / (1 + _ROUGHNESS)
"""That of the areas of whole events, tau; their patches have 2 tau - 1 (Laurson, Santucci, Zapperi,
Phys. Rev. E 81, 046116)."""

_TOLERANCE = 0.03
"""Largest deviation of an exponent of whole events, if its own interval is not wider."""


def event_law(record: EventRecord) -> JointPowerLaw:
    """Power law of the areas of whole events, all springs together."""
    return _joint(record, record.event_area, record.event_spring, 2)


def _joint(record: EventRecord, values: Array, springs: Integers, key: int) -> JointPowerLaw:
    """Power law of what was measured on all springs."""
    rng = np.random.default_rng(np.random.SeedSequence(key))
    samples = [values[springs == index] for index in range(record.spring.size)]
    return joint_power_law(samples, record.smallest_event, rng)


@dataclass(frozen=True, slots=True)
class Slope:
    """Slope of a logarithm over another, and half of its 95% interval."""

    exponent: float
    reach: float
    level: float


def cutoff_slope(record: EventRecord) -> Slope:
    """Growth of the cut-off of the areas with the spring."""
    rng = np.random.default_rng(np.random.SeedSequence(5))
    samples = [record.event_area[record.event_spring == i] for i in range(record.spring.size)]
    drawn = [
        [np.log(cutoff_scale(rng.choice(sample, sample.size))) for _ in range(_N_BOOTSTRAP)]
        for sample in samples
    ]
    scales = np.log([cutoff_scale(sample) for sample in samples])
    return _slope(np.log(record.spring), scales, np.std(drawn, axis=1))


def depth_slope(record: EventRecord) -> Slope:
    """Growth of the depth of events, area over extent, with their extent, up to L_kappa."""
    extent, depth = record.event_extent, record.event_area / record.event_extent
    used = extent >= record.smallest_event ** (1 / (1 + _ROUGHNESS))
    used &= extent <= record.spring[record.event_spring]
    return _slope(np.log(extent[used]), np.log(depth[used]))


def _slope(abscissa: Array, ordinate: Array, error: Array | None = None) -> Slope:
    """Line of least squares; without errors they follow from the scatter."""
    known = {"cov": True} if error is None else {"w": 1 / error, "cov": "unscaled"}
    (slope, level), covariance = np.polyfit(abscissa, ordinate, 1, **known)
    return Slope(float(slope), float(_NORMAL * math.sqrt(covariance[0, 0])), float(level))


_N_BOOTSTRAP, _NORMAL = 200, 1.96


def event_checks(record: EventRecord) -> Iterator[Check]:
    """Claims about whole events."""
    yield from _law_checks(record)
    cutoff, depth = cutoff_slope(record), depth_slope(record)
    scales = event_law(record).scales
    yield _exponent_check(
        "growth of the cut-off <S^2> / 2 <S> with the length of the springs",
        cutoff.exponent,
        1 + _ROUGHNESS,
        ", ".join(f"{scale:.3g}" for scale in scales) + " on the springs",
        cutoff.reach,
    )
    yield _exponent_check(
        "growth of their depth with their extent",
        depth.exponent,
        _ROUGHNESS,
        "least squares of logarithms, up to the length of the spring",
        depth.reach,
    )
    furthest = float(record.swept_area[np.argmax(np.abs(record.swept_area - 1))])
    yield close_to(
        "the fronts sweep the area that their load moves over, a whole period",
        furthest,
        1.0,
        1e-3,
        remark=f"the furthest of the springs; smooth steps sweep up to "
        f"{record.smooth_event_area.max():.2g} of it",
    )


def _law_checks(record: EventRecord) -> Iterator[Check]:
    """Exponents of what is distributed by a power law: areas, extents and areas of patches."""
    area, growth = event_law(record), 1 + _ROUGHNESS
    patch = _joint(record, record.patch_area, record.patch_spring, 3)
    # If extents scale, their power 1 + zeta has the law of the areas.
    extent = _joint(record, record.event_extent**growth, record.event_spring, 4)
    decades = np.log10(area.scales / area.smallest)
    yield _exponent_check(
        "exponent tau of their areas",
        area.exponent,
        SIZE_EXPONENT,
        f"{area.n_value.sum()} of {record.event_area.size} events above {area.smallest:g}, on "
        f"{record.spring.size} springs of {record.spring.min():g} to {record.spring.max():g} "
        f"Larkin lengths; {decades.min():.1f} to {decades.max():.1f} decades up to the cut-off; "
        f"one fit over all springs, C = {area.shoulder:.2f}, B = {area.tail:.2f}, "
        f"delta = {area.steepness:.2f}",
        area.scatter,
        area.shift,
    )
    yield _exponent_check(
        "exponent of the density of their extents",
        1 + growth * (extent.exponent - 1),
        growth,
        f"{extent.n_value.sum()} events wider than {extent.smallest ** (1 / growth):.2g}; one fit, "
        f"as that of the areas, to extents to the power {growth:g}",
        growth * extent.scatter,
        growth * extent.shift,
    )
    yield _exponent_check(
        "exponent of the areas of their patches, 2 tau - 1",
        patch.exponent,
        2 * SIZE_EXPONENT - 1,
        f"{patch.n_value.sum()} of {record.patch_area.size} patches above {patch.smallest:g}; "
        f"{record.patch_area.size / record.event_area.size:.1f} patches an event",
        patch.scatter,
        patch.shift,
    )


def _exponent_check(
    claim: str, found: float, expected: float, remark: str, scatter: float, shift: float = 0.0
) -> Check:
    """An exponent against that of the theory, within a tolerance or its own interval."""
    reach = math.hypot(scatter, shift)
    of_what = f"95% interval: ± {scatter:.2g} by the scatter of the events"
    if shift:
        of_what += f", ± {shift:.2g} by where the law begins (its change from twice that value on)"
    if scatter > _TOLERANCE:
        more = math.ceil((scatter / _TOLERANCE) ** 2)
        remark += f"; a scatter of {_TOLERANCE} would need about {more} times as many events"
    return Check(
        f"whole events of a straight front: {claim}",
        with_error(expected, max(reach, _TOLERANCE)),
        with_error(found, reach),
        abs(found - expected) <= max(reach, _TOLERANCE),
        f"{of_what}; {remark}",
    )


_BINS_A_DECADE = 5


def draw_events(axes: Axes, record: EventRecord) -> None:
    """Areas of whole events with the law that was fitted to all springs."""
    law = event_law(record)
    for index, spring in enumerate(record.spring):
        areas = record.event_area[record.event_spring == index]
        middle, density, _ = binned_density(areas, logarithmic_edges(areas))
        label = rf"$L_\kappa = {spring:g}\,\ell$, {areas.size} events"
        axes.plot(middle, density, label=label, **_points(index))
        places = np.geomspace(law.smallest, areas.max(), 100)
        share = law.n_value[index] / areas.size
        colour = COLOURS[index % len(COLOURS)]
        axes.plot(places, law.density(places, index) * share, color=colour, linewidth=0.9)
    ends = law.smallest * np.array([1.0, 100.0])
    level = 3 * float(law.density(law.smallest, 0)) * law.n_value[0]
    level /= np.sum(record.event_spring == 0)
    theory = level * (ends / ends[0]) ** -SIZE_EXPONENT
    _draw_theory(axes, ends, theory, rf"\tau = {SIZE_EXPONENT:.2f}", "upper right")
    _name_fit(axes, rf"$\tau = {law.exponent:.2f}$ ({law.low:.2f} to {law.high:.2f})", 0.06)
    axes.set(xlabel=r"area of a whole event $S/\ell\xi_u$", ylabel="probability density")


def draw_cutoffs(axes: Axes, record: EventRecord) -> None:
    """Cut-off of the areas against the length of the springs."""
    slope, law = cutoff_slope(record), event_law(record)
    axes.plot(record.spring, law.scales, "o", color=BLACK, markersize=3.4)
    ends = record.spring[[0, -1]]
    axes.plot(ends, np.exp(slope.level) * ends**slope.exponent, color=BLACK, linewidth=0.9)
    growth = 1 + _ROUGHNESS
    theory = 0.6 * law.scales[0] * (ends / ends[0]) ** growth
    _draw_theory(axes, ends, theory, rf"1 + \zeta = {growth:.3f}", "lower right")
    _name_fit(axes, rf"slope {slope.exponent:.2f} $\pm$ {slope.reach:.2f}", 0.9)
    axes.set(xlabel=r"length of the springs $L_\kappa/\ell$", ylabel=r"cut-off $S_m/\ell\xi_u$")


def draw_depths(axes: Axes, record: EventRecord) -> None:
    """Depth of whole events against their extent, means in logarithmic bins."""
    slope = depth_slope(record)
    extent, depth = record.event_extent, record.event_area / record.event_extent
    for index in range(record.spring.size):
        chosen = record.event_spring == index
        edges = logarithmic_edges(extent[chosen])
        place = np.digitize(extent[chosen], edges)
        means = [
            [np.exp(np.mean(np.log(one[chosen][place == bin]))) for one in (extent, depth)]
            for bin in np.unique(place)
            if np.sum(place == bin) >= _FEWEST_IN_A_BIN
        ]
        axes.plot(*np.transpose(means), **_points(index))
    ends = np.array([record.smallest_event ** (1 / (1 + _ROUGHNESS)), record.spring.max()])
    fit = np.exp(slope.level) * ends**slope.exponent
    axes.plot(ends, fit, color=BLACK, linewidth=0.9)
    theory = 0.7 * fit[0] * (ends / ends[0]) ** _ROUGHNESS
    _draw_theory(axes, ends, theory, rf"\zeta = {_ROUGHNESS}", "lower right")
    _name_fit(axes, rf"slope {slope.exponent:.3f} $\pm$ {slope.reach:.3f}", 0.9)
    axes.set(xlabel=r"extent $l/\ell$", ylabel=r"depth $S/l\xi_u$")


_FEWEST_IN_A_BIN = 10


def logarithmic_edges(values: Array) -> Array:
    """Edges of logarithmic bins that hold all values."""
    low, high = np.log10(values.min()), np.log10(values.max())
    edges = np.logspace(low, high, max(int((high - low) * _BINS_A_DECADE), 4) + 1)
    edges[-1] *= 1 + 1e-9
    return np.asarray(edges)


def binned_density(values: Array, edges: Array) -> tuple[Array, Array, Integers]:
    """Geometric middles of the bins that hold values, the density there, and counts."""
    counts, _ = np.histogram(values, edges)
    density, middle = counts / np.diff(edges) / values.size, np.sqrt(edges[1:] * edges[:-1])
    return middle[counts > 0], density[counts > 0], counts[counts > 0]


def _points(index: int) -> dict[str, Any]:
    """Style of the points of a spring."""
    colour, marker = COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)]
    return {"linestyle": "none", "marker": marker, "markersize": 2.6, "color": colour}


def _draw_theory(axes: Axes, abscissa: Array, ordinate: Array, name: str, place: Any) -> None:
    """Power law of the theory, named in a legend of its own."""
    dashes, name = (4, 2), f"${name}$"
    (line,) = axes.plot(abscissa, ordinate, color="0.35", linewidth=0.8, dashes=dashes, label=name)
    axes.legend(handles=[line], loc=place)


def _name_fit(axes: Axes, text: str, height: float) -> None:
    """What was fitted, in the panel."""
    axes.text(0.05, height, text, transform=axes.transAxes, fontsize="small")
