"""The figure of the law of k: the collapse of all measured k, and their limit of infinite size."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.analysis.estimate import REACH
from crackfront.analysis.finding import PERTURBATION_FACTOR
from crackfront.analysis.law import (
    LEAST_SIZE,
    TYPICAL_BREADTH,
    WEAKEST,
    effective_size,
    infinite_ratio,
    law_value,
    shipped_law,
)
from crackfront.core.arrays import Array
from crackfront.plots.parts import label_decimals
from crackfront.plots.style import BLACK, COLOURS, MARKERS, PAGE, blank_figure, explain, house_style
from crackfront.plots.sweep import draw_infinite_law
from studies.law.cells import LawCell
from studies.paper.drawing import name_panels, write_beside

_LARGE = 3.0
"""Size g above which points are extrapolated: their gain is small, and its error smaller."""


@dataclass(frozen=True, slots=True)
class LawPoints:
    """Disorder s, size g, k with its standard error, and breadth of spectra of fronts of a name."""

    name: str
    disorder: Array
    size: Array
    factor: Array
    error: Array
    breadth: Array


def spectra_points(cells: Sequence[LawCell]) -> tuple[LawPoints, ...]:
    """Straight fronts of `cells.csv`, one entry a spectrum, its limit of weak disorder with it."""
    found, names = [], [cell.spectrum.removesuffix("-weak") for cell in cells]
    for name in dict.fromkeys(names):
        rows = [cell for cell, own in zip(cells, names, strict=True) if own == name]
        columns = (
            np.array([getattr(cell, item) for cell in rows])
            for item in ("disorder", "size", "both", "error", "breadth")
        )
        # h08-chemical is H = 0.8, chemical.
        label = ", ".join(re.sub(r"^h(\d)(\d)", r"$H=\1.\2$", name).split("-"))
        found.append(LawPoints(label, *columns))
    return tuple(found)


def law_figure(fronts: Sequence[LawPoints], spheres: LawPoints) -> Figure:
    """Collapse of straight fronts and spheres on the shipped law, and its infinite contact."""
    n_colour, n_marker = len(COLOURS), len(MARKERS)
    # Where colours repeat, markers are others.
    styles = [
        _style(COLOURS[index % n_colour], MARKERS[(index + index // n_colour) % n_marker])
        for index in range(len(fronts))
    ]
    drawn = [*zip(fronts, styles, strict=True), (spheres, _style(BLACK, "o", is_open=True))]
    with house_style():
        figure = blank_figure(PAGE, 0.56 * PAGE)
        left, right = figure.subplots(1, 2, width_ratios=(1.2, 1))
        _draw_collapse(left, drawn)
        draw_infinite_law(right)
        for points, style in drawn:
            _draw_extrapolated(right, points, style)
        right.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
        right.legend(loc="lower left")
        figure.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=6)
        name_panels((left, right), "ab")
        explain(
            figure,
            "bars: 95% intervals over surfaces; spheres, to which nothing was adjusted, are open "
            "circles; a: freed of what depends on s, with the law at s = 0; b: points of g above "
            f"{_LARGE:g}, which the law extrapolates, in the colours of a",
        )
        return figure


def _style(colour: str, marker: str, *, is_open: bool = False) -> dict[str, Any]:
    """Look of small points with thin bars."""
    return {
        "linestyle": "none",
        "marker": marker,
        "color": colour,
        "markerfacecolor": "none" if is_open else colour,
        "markeredgecolor": colour if is_open else "white",
        "markeredgewidth": 0.6 if is_open else 0.25,
        "markersize": 3.6 if is_open else 2.8,
        "elinewidth": 0.4,
        "capsize": 0,
        "zorder": 4 if is_open else 3,
    }


def _draw_collapse(axes: Axes, drawn: Sequence[tuple[LawPoints, dict[str, Any]]]) -> None:
    """Draw k freed of its fall with s against g / (1 + c s^d), and the law, then one curve."""
    law = shipped_law()
    k_0, *_, a, b, _, _, e, _ = law.coefficients
    sizes = {
        one.name: effective_size(law.coefficients, one.disorder, one.size, one.breadth)
        for one, _ in drawn
    }
    largest = max(float(np.max(size)) for size in sizes.values())
    abscissa = np.geomspace(LEAST_SIZE / 4, 2 * largest, 200)
    axes.plot(
        abscissa,
        law_value(law.coefficients, 0.0, abscissa),
        color=BLACK,
        linewidth=1.0,
        label=f"law (rms departure {100 * law.rms:.2g}% for $g>1$)",
        zorder=2,
    )
    for points, style in drawn:
        rise = 1 + a * points.disorder**b * (TYPICAL_BREADTH / points.breadth) ** e
        axes.errorbar(
            sizes[points.name],
            points.factor * rise,
            yerr=REACH * points.error * rise,
            label=points.name,
            **style,
        )
    axes.axhline(k_0, color="0.5", linewidth=0.5, zorder=1)
    name = rf"$k_0={k_0:.2f}$, weak disorder in the infinite contact"
    write_beside(axes, name, (abscissa[0] * 1.1, k_0), (0, 2), fontsize=6)
    axes.set_xscale("log")
    axes.set_xlim(abscissa[0], abscissa[-1])
    axes.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
    label_decimals(axes.xaxis)
    axes.set_xlabel(r"size $g\,(\beta_0/\beta)^f/\,(1+c\,s^d)$")
    axes.set_ylabel(r"$k\,(1+a\,s^b\,(\beta_0/\beta)^e)$")


def _draw_extrapolated(axes: Axes, points: LawPoints, style: dict[str, Any]) -> None:
    """Draw points of large g, times what the law gains from there to the infinite contact."""
    large = points.size > _LARGE
    gains = [
        infinite_ratio(max(float(s), WEAKEST), float(g), float(breadth))
        for s, g, breadth in zip(
            points.disorder[large], points.size[large], points.breadth[large], strict=True
        )
    ]
    gain = np.array([one.value for one in gains])
    error = np.array([one.standard_error for one in gains]) * points.factor[large]
    reach = REACH * np.hypot(gain * points.error[large], error)
    axes.errorbar(points.disorder[large], points.factor[large] * gain, yerr=reach, **style)
