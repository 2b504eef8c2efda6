"""Beyond the paper: avalanches of straight fronts on springs, and of a sphere in retraction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import FixedLocator

from crackfront.analysis.estimate import with_error
from crackfront.core.arrays import Array
from crackfront.plots.parts import label_decimals
from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, explain, house_style
from studies.paper import event_laws
from studies.paper.avalanches import AvalancheRecord, avalanche_record, expected_seconds
from studies.paper.checks import Check
from studies.paper.drawing import DASHED, THEORY, name_panels
from studies.paper.figure import Figure
from studies.paper.power_law import PowerLaw, exponent_and_cutoff, truncated_power_law
from studies.paper.rough import STRONG, WEAK

_TOLERANCE = 0.1
"""Largest deviation of the exponent of a sphere."""

_EXPECTATION = (
    "Sphere: avalanches of depinning with zeta = 0.388 have the exponent tau = 1.28 up to the "
    "length on which the circle is stiffer than the line, and extents from the Larkin length on. "
    "Before its cut-off their density lies above the power law (Rosso, Le Doussal, Wiese, Phys. "
    "Rev. B 80, 144204), so that a fit over few decades finds a smaller exponent. The same fit to "
    "straight fronts, whose exponent is found by a joint fit, says whether the decades are enough."
)
"""Source of the expectations of the sphere, and why its exponents may differ."""


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
        *event_laws.event_checks(record),
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
            expectation=_EXPECTATION,
        ),
    )


def _checks(record: AvalancheRecord, index: int, name: str) -> Iterator[Check]:
    """Claims about one disorder."""
    chosen = record.disorder_index == index
    energy, extent = record.energy[chosen], record.extent[chosen]
    law, expected = size_law(record, index), event_laws.SIZE_EXPONENT
    line_exponent, decades = _straight_front_exponent(record, law.decades)
    undecided = ""
    if abs(line_exponent - expected) > _TOLERANCE:
        joint = event_laws.event_law(record).exponent
        undecided = (
            f"over {decades:.1f} decades the same fit gives {line_exponent:.2f} for straight "
            f"fronts, whose exponent by the joint fit is {joint:.2f}"
        )
    contained = "contains it" if law.low <= expected <= law.high else "leaves it out"
    yield Check(
        f"sphere, {name} disorder: exponent of the swept areas",
        with_error(expected, _TOLERANCE),
        f"{law.exponent:.2f} ({law.low:.2f} to {law.high:.2f})",
        abs(law.exponent - expected) <= _TOLERANCE,
        f"{law.n_value} of {energy.size} avalanches; the 95% interval of a bootstrap over "
        f"avalanches {contained}; from {law.smallest:.2g} to the cut-off at {law.cutoff:.2g}, "
        f"{law.decades:.1f} decades",
        undecided=undecided,
        expectation=_EXPECTATION,
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
        "perimeter over a dG/da; the sphere, not the disorder, sets the upper cut-off",
        expectation=_EXPECTATION,
    )


def _straight_front_exponent(record: AvalancheRecord, decades: float) -> tuple[float, float]:
    """Exponent that the fit of the sphere finds for straight fronts, and over how many decades.

    Their spring is the one whose cut-off leaves about as many decades.
    """
    fits = []
    for index in range(record.spring.size):
        areas = record.event_area[record.event_spring == index]
        exponent, cutoff = exponent_and_cutoff(areas, record.smallest_event)
        fits.append((exponent, float(np.log10(cutoff / record.smallest_event))))
    return min(fits, key=lambda fit: abs(fit[1] - decades))


_KINDS = ((STRONG, "strong", BLUE, "o"), (WEAK, "weak", VERMILION, "s"))


def avalanche_figure(record: AvalancheRecord) -> Drawing:
    """Whole events of the line above, and below densities of the sphere."""
    with house_style():
        figure = blank_figure(PAGE, 0.82 * PAGE)
        grid = figure.add_gridspec(2, 1)
        above, below = (figure.add_subfigure(grid[row]) for row in range(2))
        lines, spheres = above.subplots(1, 3), below.subplots(1, 3)
        _draw_lines(lines, record)
        _draw_spheres(spheres, record)
        name_panels((*lines, *spheres), "abcdef")
        # The last entry is the law of the theory, which the panel names.
        handles, labels = (entries[:-1] for entries in lines[0].get_legend_handles_labels())
        title = "straight front on springs"
        above.legend(handles, labels, title=title, loc="outside upper center", ncols=len(labels))
        handles, labels = spheres[2].get_legend_handles_labels()
        below.legend(handles, labels, title="sphere", loc="outside upper center", ncols=2)
        explain(
            figure,
            "a: areas of whole events, all that one instability sets off; b: cut-off "
            "$S_m=\\langle S^2\\rangle/2\\langle S\\rangle$ of these areas; c: depth and extent of "
            "these events; $\\xi_u$: correlation length of the force; d to f: avalanches of the "
            "sphere, bars: errors of counting; lines through points: fits, with 95% intervals; "
            "grey broken lines: theory of depinning with $\\zeta=0.388$ (a to d); e: dotted: "
            "Larkin lengths, grey: correlation length of $w_\\mathrm{loc}$",
        )
        return figure


def _draw_lines(panels: Sequence[Axes], record: AvalancheRecord) -> None:
    """Areas, cut-offs and depths of whole events of straight fronts."""
    event_laws.draw_events(panels[0], record)
    event_laws.draw_cutoffs(panels[1], record)
    event_laws.draw_depths(panels[2], record)
    for axes in panels:
        axes.set(xscale="log", yscale="log")
    # Less than two decades: powers of ten alone would be too few.
    label_decimals(panels[1].xaxis, FixedLocator(record.spring.tolist()))
    for axes in panels[1:]:
        label_decimals(axes.yaxis)


def _draw_spheres(panels: Sequence[Axes], record: AvalancheRecord) -> None:
    """Areas, extents and energies of avalanches of the sphere."""
    _draw_areas(panels[0], record)
    _draw_extents(panels[1], record)
    # The reduced unit of energy is pi times w_int times the lateral unit squared.
    energies = record.energy / (record.short_cutoff**2 / np.pi)
    label = r"dissipated energy $/\,w_\mathrm{int}\lambda_\mathrm{s}^2$"
    _draw_densities(panels[2], record, energies, label)
    for axes in panels:
        axes.set(xscale="log", yscale="log")
    # Room for the legend below the points.
    panels[0].set_ylim(panels[0].get_ylim()[0] / 50)


def _draw_densities(axes: Axes, record: AvalancheRecord, values: Array, label: str) -> None:
    """Densities of both disorders in logarithmic bins, with the error of counting."""
    edges = event_laws.logarithmic_edges(values)
    for index, name, colour, marker in _KINDS:
        chosen = values[record.disorder_index == index]
        middle, density, counts = event_laws.binned_density(chosen, edges)
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
    axes.set(xlabel=label, ylabel="probability density")


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
    theory = level * (ends / start) ** -event_laws.SIZE_EXPONENT
    axes.plot(ends, theory, label=rf"$\tau = {event_laws.SIZE_EXPONENT:.2f}$", **THEORY)
    entries = zip(*axes.get_legend_handles_labels(), strict=True)
    handles, labels = zip(*(entry for entry in entries if "tau" in entry[1]), strict=True)
    axes.legend(handles, labels, loc="lower left")


def _draw_extents(axes: Axes, record: AvalancheRecord) -> None:
    """Extents, with the Larkin lengths and the correlation length of w_loc."""
    unit, label = record.short_cutoff, r"extent along the perimeter $/\lambda_\mathrm{s}$"
    _draw_densities(axes, record, record.extent / unit, label)
    for index, _, colour, _ in _KINDS:
        place = record.larkin_length[index] / unit
        axes.axvline(place, color=colour, linewidth=0.8, linestyle=(0, (1, 1.5)), zorder=0)
    axes.axvline(record.correlation_length / unit, color="0.5", zorder=0, **DASHED)


FIGURE = Figure(
    title="Beyond the paper: sizes of the avalanches of a front",
    compute=avalanche_record,
    checks=avalanche_checks,
    draw=avalanche_figure,
    seconds=expected_seconds,
)
