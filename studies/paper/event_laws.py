"""Laws of whole events of straight fronts, with their checks and panels."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from crackfront.analysis.estimate import REACH, with_error
from crackfront.core.arrays import Array
from crackfront.plots.style import BLACK, COLOURS, MARKERS
from studies.paper.checks import Check, close_to
from studies.paper.events import EventRecord
from studies.paper.figure import Integers
from studies.paper.power_law import JointPowerLaw, cutoff_scale, joint_power_law

_ROUGHNESS = 0.388
"""Roughness exponent zeta of a line with long-range elasticity (Rosso and Krauth, Phys. Rev. E 65,
025101), from which all others follow."""

SIZE_EXPONENT = 2 - 1 / (1 + _ROUGHNESS)
"""Exponent tau of the areas of whole events; their patches have 2 tau - 1 (Laurson, Santucci and
Zapperi, Phys. Rev. E 81, 046116)."""

_TOLERANCE = 0.03
"""Largest deviation of an exponent of whole events, if its own interval is not wider."""


_EXPECTATION = (
    "Straight fronts: theory of depinning with zeta = 0.388 (Rosso and Krauth, Phys. Rev. E 65, "
    "025101), from which tau = 2 - 1 / (1 + zeta) and all other exponents follow. 2 tau - 1 "
    "(Laurson, Santucci and Zapperi, Phys. Rev. E 81, 046116) is the exponent of patches in the "
    "limit of events of many patches. Here an event has three to five patches on the mean. The "
    "largest of them follows the law of the events, so that the exponent of all patches may lie "
    "between tau and 2 tau - 1; longer springs, with more patches an event, were not measured."
)
"""Source of the expectations, and why the exponent of patches may differ."""


def event_law(record: EventRecord) -> JointPowerLaw:
    """Power law of the areas of whole events, all springs together."""
    return _joint(record, record.event_area, record.event_spring, 2)


def _joint(record: EventRecord, values: Array, springs: Integers, key: int) -> JointPowerLaw:
    """Power law of what was measured on all springs."""
    rng = np.random.default_rng(np.random.SeedSequence(key))
    samples = [values[springs == index] for index in range(record.spring.size)]
    return joint_power_law(samples, record.smallest_event, rng)


def _reach(law: JointPowerLaw) -> float:
    """Half of the 95% interval of an exponent: scatter of the events, and where the law begins."""
    return math.hypot(law.scatter, law.shift)


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
    weights = {"cov": True} if error is None else {"w": 1 / error, "cov": "unscaled"}
    (slope, level), covariance = np.polyfit(abscissa, ordinate, 1, **weights)
    return Slope(float(slope), float(REACH * math.sqrt(covariance[0, 0])), float(level))


_N_BOOTSTRAP = 200
"""Samples of a bootstrap, enough for a standard error within 5%."""


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
        f"as for the areas, to extents to the power {growth:g}",
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
    claim: str, measured: float, expected: float, remark: str, scatter: float, shift: float = 0.0
) -> Check:
    """An exponent against the exponent of the theory, within a tolerance or its own interval."""
    reach = math.hypot(scatter, shift)
    interval = f"95% interval: ± {scatter:.2g} by the scatter of the events"
    if shift:
        interval += f", ± {shift:.2g} by where the law begins (its change from twice that value on)"
    if scatter > _TOLERANCE:
        more = math.ceil((scatter / _TOLERANCE) ** 2)
        remark += f"; a scatter of {_TOLERANCE} would need about {more} times as many events"
    return Check(
        f"whole events of a straight front: {claim}",
        with_error(expected, max(reach, _TOLERANCE)),
        with_error(measured, reach),
        abs(measured - expected) <= max(reach, _TOLERANCE),
        f"{interval}; {remark}",
        expectation=_EXPECTATION,
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
    _name_fit(axes, rf"$\tau =$ {with_error(law.exponent, _reach(law))}", 0.06)
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
    _name_fit(axes, f"slope {with_error(slope.exponent, slope.reach)}", 0.9)
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
            [np.exp(np.mean(np.log(values[chosen][place == bin]))) for values in (extent, depth)]
            for bin in np.unique(place)
            if np.sum(place == bin) >= _FEWEST_IN_A_BIN
        ]
        axes.plot(*np.transpose(means), **_points(index))
    ends = np.array([record.smallest_event ** (1 / (1 + _ROUGHNESS)), record.spring.max()])
    fit = np.exp(slope.level) * ends**slope.exponent
    axes.plot(ends, fit, color=BLACK, linewidth=0.9)
    theory = 0.7 * fit[0] * (ends / ends[0]) ** _ROUGHNESS
    _draw_theory(axes, ends, theory, rf"\zeta = {_ROUGHNESS}", "lower right")
    _name_fit(axes, f"slope {with_error(slope.exponent, slope.reach)}", 0.9)
    axes.set(xlabel=r"extent $l/\ell$", ylabel=r"depth $S/l\xi_u$")


_FEWEST_IN_A_BIN = 10


def logarithmic_edges(values: Array) -> Array:
    """Edges of logarithmic bins that contain all values."""
    low, high = np.log10(values.min()), np.log10(values.max())
    edges = np.logspace(low, high, max(int((high - low) * _BINS_A_DECADE), 4) + 1)
    edges[-1] *= 1 + 1e-9
    return np.asarray(edges)


def binned_density(values: Array, edges: Array) -> tuple[Array, Array, Integers]:
    """Geometric middles of the bins that contain values, the density there, and counts."""
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
