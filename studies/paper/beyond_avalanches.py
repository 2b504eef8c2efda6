"""Beyond the paper: avalanches of straight fronts on springs, and of a sphere in retraction."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator

from crackfront.analysis.estimate import with_error
from crackfront.core.adhesion import force_correlation_length
from crackfront.core.arrays import Array
from crackfront.core.cycle.energy import dissipated_energy
from crackfront.core.variables import ADHESION, ENERGY, LATERAL, VERTICAL, variable
from crackfront.data.section import Count, Positive
from crackfront.plots.parts import label_decimals
from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, house_style
from crackfront.simulate.instabilities import resolved_motion, swept_clusters
from studies.paper import events as line_events
from studies.paper.drawing import DASHED, ON_WHITE, THEORY, name_panels
from studies.paper.figure import Check, Figure, Integers, Progress, values_of
from studies.paper.power_law import PowerLaw, truncated_power_law
from studies.paper.rough import (
    STRONG,
    WEAK,
    RetractionParameters,
    circle_stiffness,
    flat_spectrum,
    surface_means,
)
from studies.paper.straight import Springs

_DISORDER, _AVALANCHE = "disorder", "avalanche"


class AvalancheParameters(RetractionParameters):
    """Surfaces, the part of their retraction that is resolved, the range of the fit, and lines.

    The closer the penetrations are to pull-off, the softer is the circle, and the larger may
    avalanches become.
    """

    load_step: Positive  # penetrations that are visited in any case (reduced vertical length)
    travel: Positive  # largest motion of a site in a smooth step, over the short cutoff
    precision: Positive  # penetration to which an avalanche is located; closer ones come out as one
    # Where the power law begins, over the Larkin length times the correlation length of the force.
    smallest_area: Positive
    line: line_events.EventParameters  # straight fronts, and how their events are told apart
    springs: Springs
    n_tile: Count  # of each spring; each front goes over a whole period


@dataclass(frozen=True, slots=True)
class AvalancheRecord(line_events.EventRecord):
    """Whole events of straight fronts, and avalanches of all surfaces of a sphere."""

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
    disorder_index: Integers = variable("which disorder", "1", _AVALANCHE)
    surface: Integers = variable("number of the surface", "1", _AVALANCHE)
    penetration: Array = variable("penetration of the avalanche", VERTICAL, _AVALANCHE)
    area: Array = variable("area that it sweeps", f"({LATERAL})^2", _AVALANCHE)
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
    whole = line_events.event_record(line, springs, parameters.n_tile, parameters.seed, progress)
    surfaces: list[list[_Surface]] = []
    energies = parameters.strong, parameters.weak
    for name, energy in zip(("strong", "weak"), energies, strict=True):
        surfaces.append([])
        for realisation in range(parameters.n_surface):
            surfaces[-1].append(_surface(parameters, energy, realisation))
            count = len(surfaces[-1][-1].avalanches)
            progress(f"{name} disorder, surface {realisation}: {count} avalanches")
    spectrum = flat_spectrum(parameters.short_cutoff)
    means = surface_means(surfaces, "rms", "larkin_length", "circle_length", "smooth_area")
    unit = means["larkin_length"] * force_correlation_length("roughness", spectrum)
    events = [[event for one in kind for event in one.avalanches] for kind in surfaces]
    columns = (np.array(column) for column in zip(*itertools.chain(*events), strict=True))
    avalanches: dict[str, Any] = dict(zip(_Avalanche._fields, columns, strict=True))
    return AvalancheRecord(
        **values_of(whole),
        **values_of(parameters, "short_cutoff", "precision", "seed"),
        correlation_length=spectrum.correlation_length,
        elastic_energy=np.array(energies),
        **means,
        smallest_area=parameters.smallest_area * unit,
        disorder_index=np.repeat([STRONG, WEAK], [len(kind) for kind in events]),
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
    avalanches, areas, last = [], [0.0, 0.0], front
    for step in steps:
        area = float(np.pi * np.mean(step.before**2 - step.after**2))
        areas[step.unstable] += area
        last = step.after
        if step.unstable:
            patches = swept_clusters(step.before, step.after, travel, contact.field.geometry)
            lost = dissipated_energy(step.before, step.after, step.end, contact.field)
            avalanches.append(
                _Avalanche(realisation, step.end, area, patches[0].extent, len(patches), lost)
            )
    middle = float(np.mean([front, last]))
    return _Surface(
        avalanches=avalanches,
        smooth_area=areas[0] / sum(areas),
        circle_length=2 * np.pi * middle / float(circle_stiffness(middle, (start + stop) / 2)),
        rms=contact.w_rms,
        larkin_length=contact.larkin_length,
    )


_TOLERANCE = 0.1
"""Largest deviation of that of a sphere."""


def size_law(record: AvalancheRecord, index: int) -> PowerLaw:
    """Power law of the swept areas of one disorder."""
    rng = np.random.default_rng(np.random.SeedSequence(record.seed, spawn_key=(index,)))
    areas = record.area[record.disorder_index == index]
    return truncated_power_law(areas, float(record.smallest_area[index]), rng)


def avalanche_checks(record: AvalancheRecord) -> tuple[Check, ...]:
    """Exponents, and the lengths between which avalanches lie."""
    extents = [record.extent[record.disorder_index == index] for index in (STRONG, WEAK)]
    smallest = [float(np.quantile(extent, 0.1)) for extent in extents]
    return (
        *line_events.event_checks(record),
        *_checks(record, STRONG, "strong"),
        *_checks(record, WEAK, "weak"),
        Check(
            "sphere: the smallest extent grows for weaker disorder",
            "> 1",
            f"{smallest[WEAK] / smallest[STRONG]:.3g} times",
            smallest[WEAK] > smallest[STRONG],
            f"tenth percentiles {smallest[STRONG]:.3g} and {smallest[WEAK]:.3g}; Larkin lengths "
            f"{record.larkin_length[STRONG]:.3g} and {record.larkin_length[WEAK]:.3g}, correlation "
            f"length {record.correlation_length:.3g}",
        ),
    )


def _checks(record: AvalancheRecord, index: int, name: str) -> Iterator[Check]:
    """Claims about one disorder."""
    chosen = record.disorder_index == index
    energy, extent = record.energy[chosen], record.extent[chosen]
    law, expected = size_law(record, index), line_events.SIZE_EXPONENT
    contained = "contains it" if law.low <= expected <= law.high else "leaves it out"
    yield Check(
        f"sphere, {name} disorder: exponent of the swept areas",
        with_error(expected, _TOLERANCE),
        f"{law.exponent:.2f} ({law.low:.2f} to {law.high:.2f})",
        abs(law.exponent - expected) <= _TOLERANCE,
        f"{law.n_value} of {energy.size} avalanches; the 95% interval of a bootstrap over "
        f"avalanches {contained}; from {law.smallest:.2g} to the cut-off at {law.cutoff:.2g}, "
        f"{np.log10(law.cutoff / law.smallest):.1f} decades; an effective exponent where these are "
        "few, as the sphere's own cut-off need not be exponential",
    )
    yield Check(
        f"sphere, {name} disorder: every avalanche dissipates energy",
        "> 0",
        f"{energy.size} from {energy.min():.2g} to {energy.max():.2g}",
        bool(np.all(energy > 0)),
        f"smooth steps sweep {record.smooth_area[index]:.2g} of the area",
    )
    longest = float(np.quantile(extent, 0.99))
    yield Check(
        f"sphere, {name} disorder: avalanches end below the length on which the circle is stiffer "
        "than the line",
        f"99% below {record.circle_length[index]:.3g}",
        f"{longest:.3g}",
        longest < record.circle_length[index],
        "perimeter over a dG/da; the upper cut-off is that of the sphere, not of the disorder",
    )


_KINDS = ((STRONG, "strong", BLUE, "o"), (WEAK, "weak", VERMILION, "s"))


def avalanche_figure(record: AvalancheRecord) -> Drawing:
    """Whole events of the line above, and below densities of the sphere."""
    with house_style():
        figure = blank_figure(PAGE, 0.76 * PAGE)
        grid = figure.add_gridspec(2, 1)
        above, below = (figure.add_subfigure(grid[row]) for row in range(2))
        lines, panels = above.subplots(1, 3), below.subplots(1, 3)
        line_events.draw_events(lines[0], record)
        line_events.draw_cutoffs(lines[1], record)
        line_events.draw_depths(lines[2], record)
        _draw_areas(panels[0], record)
        _draw_extents(panels[1], record)
        # The reduced unit of energy is pi times w_int times the lateral unit squared.
        energies = record.energy / (record.short_cutoff**2 / np.pi)
        label = r"dissipated energy $/\,w_\mathrm{int}\lambda_\mathrm{s}^2$"
        _draw_densities(panels[2], record, energies, label)
        for axes in (*lines, *panels):
            axes.set(xscale="log", yscale="log")
        name_panels((*lines, *panels), "abcdef")
        # Less than two decades: powers of ten alone would be too few.
        label_decimals(lines[1].xaxis, FixedLocator(record.spring.tolist()))
        for axes in lines[1:]:
            label_decimals(axes.yaxis)
        # The last one is the law of the theory, which the panel names.
        handles, labels = (part[:-1] for part in lines[0].get_legend_handles_labels())
        title = "straight front on springs"
        above.legend(handles, labels, title=title, loc="outside upper center", ncols=len(labels))
        handles, labels = panels[2].get_legend_handles_labels()
        below.legend(handles, labels, title="sphere", loc="outside upper center", ncols=2)
        return figure


def _draw_densities(axes: Axes, record: AvalancheRecord, values: Array, what: str) -> None:
    """Densities of both disorders in logarithmic bins, with the error of counting."""
    edges = line_events.logarithmic_edges(values)
    for index, name, colour, marker in _KINDS:
        chosen = values[record.disorder_index == index]
        middle, density, counts = line_events.binned_density(chosen, edges)
        disorder = rf"$w_\mathrm{{rms}} = {record.rms[index]:.2f}\,w_\mathrm{{int}}$"
        axes.errorbar(
            middle,
            density,
            # A bar that reached zero would have no end on a logarithmic axis.
            yerr=0.98 * (density / np.sqrt(counts)),
            linestyle="none",
            marker=marker,
            markersize=2.6,
            elinewidth=0.6,
            color=colour,
            label=f"{name} disorder, {disorder}, {chosen.size} avalanches",
        )
    axes.set(xlabel=what, ylabel="probability density")


def _draw_areas(axes: Axes, record: AvalancheRecord) -> None:
    """Swept areas with the laws that were fitted, and a line of the exponent of the theory."""
    unit = record.short_cutoff**2
    _draw_densities(axes, record, record.area / unit, r"swept area $S/\lambda_\mathrm{s}^2$")
    for index, _, colour, _ in _KINDS:
        chosen = record.area[record.disorder_index == index]
        law = size_law(record, index)
        areas = np.geomspace(law.smallest, chosen.max(), 100)
        axes.plot(
            areas / unit,
            law.density(areas) * unit * law.n_value / chosen.size,
            color=colour,
            label=rf"$\tau = {law.exponent:.2f}$ ({law.low:.2f} to {law.high:.2f})",
        )
    start = record.smallest_area[STRONG] / unit
    ends = start * np.array([1.0, 40.0])
    level = 4 * float(size_law(record, STRONG).density(record.smallest_area[STRONG])) * unit
    theory = level * (ends / start) ** -line_events.SIZE_EXPONENT
    axes.plot(ends, theory, label=rf"$\tau = {line_events.SIZE_EXPONENT:.2f}$", **THEORY)
    _legend_of(axes, "tau")


def _draw_extents(axes: Axes, record: AvalancheRecord) -> None:
    """Extents, with the Larkin lengths below and the length of the circle above."""
    unit, label = record.short_cutoff, r"extent along the perimeter $/\lambda_\mathrm{s}$"
    _draw_densities(axes, record, record.extent / unit, label)
    for index, _, colour, _ in _KINDS:
        place, first = record.larkin_length[index] / unit, index == STRONG
        name, dots = r"Larkin length $\ell$" if first else None, (0, (1, 1.5))
        axes.axvline(place, color=colour, linewidth=0.8, linestyle=dots, zorder=0, label=name)
    place, label = record.correlation_length / unit, r"correlation length of $w_\mathrm{loc}$"
    axes.axvline(place, color="0.5", zorder=0, label=label, **DASHED)
    _legend_of(axes, "length", **ON_WHITE)


def _legend_of(axes: Axes, word: str, **style: Any) -> None:
    """Legend of what bears a word in its label."""
    entries = zip(*axes.get_legend_handles_labels(), strict=True)
    handles, labels = zip(*(entry for entry in entries if word in entry[1]), strict=True)
    axes.legend(handles, labels, loc="lower left", **style)


FIGURE = Figure(
    title="Beyond the paper: avalanches",
    compute=avalanche_record,
    checks=avalanche_checks,
    draw=avalanche_figure,
    seconds=expected_seconds,
)
