"""The figure of the law of k: the collapse of all measured k, and their limit of infinite size."""

from __future__ import annotations

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
from crackfront.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PAGE,
    PURPLE,
    SKY,
    VERMILION,
    blank_figure,
    explain,
    house_style,
)
from crackfront.plots.sweep_figures import draw_infinite_law
from studies.law.cells import LawCell
from studies.paper.drawing import name_panels, write_beside

_LARGE = 3.0
"""Size g above which points are extrapolated: their gain is small, and its error smaller."""

_LOOKS = {
    "flat": ("flat", GREEN, "s"),
    "flat-chemical": ("flat, chemical", GREEN, "D"),
    "gaussian": ("gaussian", PURPLE, "^"),
    "gaussian-chemical": ("gaussian, chemical", PURPLE, "v"),
    "h03": ("$H=0.3$", ORANGE, "X"),
    "h05": ("$H=0.5$", SKY, "P"),
    "h08": ("$H=0.8$", BLUE, "o"),
    "ring": ("ring", VERMILION, "p"),
    "two-slopes": ("$H=0.9$, then $0.3$", "0.45", "<"),
    "two-reversed": ("$H=0.3$, then $0.9$", "0.45", ">"),
}
"""Name in the legend, colour and marker of every spectrum of straight fronts.

Spectra of two slopes are named from long waves to short ones.
"""


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
    points, names = [], [cell.spectrum.removesuffix("-weak") for cell in cells]
    for name in dict.fromkeys(names):
        rows = [cell for cell, spectrum in zip(cells, names, strict=True) if spectrum == name]
        columns = (
            np.array([getattr(cell, item) for cell in rows])
            for item in ("disorder", "size", "both", "error", "breadth")
        )
        points.append(LawPoints(name, *columns))
    return tuple(points)


def law_figure(fronts: Sequence[LawPoints], spheres: LawPoints) -> Figure:
    """Collapse of straight fronts and spheres on the shipped law, and its infinite contact."""
    drawn = [(points, _style(*_LOOKS[points.name])) for points in fronts]
    drawn.append((spheres, _style(spheres.name, "0.2", "o", is_open=True)))
    with house_style():
        figure = blank_figure(PAGE, 0.56 * PAGE)
        collapse, infinite = figure.subplots(1, 2, width_ratios=(1.2, 1))
        _draw_collapse(collapse, drawn)
        draw_infinite_law(infinite)
        for points, style in drawn:
            _draw_extrapolated(infinite, points, style)
        infinite.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
        infinite.legend(loc="lower left")
        entries = collapse.get_legend_handles_labels()
        figure.legend(*entries, loc="outside upper center", ncols=6, columnspacing=1.4)
        name_panels((collapse, infinite), "ab")
        explain(
            figure,
            "bars: 95% intervals over surfaces; spheres, to which nothing was adjusted, are open "
            f"circles; a: freed of what depends on s, with the law at s = 0, dashed below g = "
            f"{LEAST_SIZE:g}, where its fit begins; b: points of g above {_LARGE:g}, which the law "
            "extrapolates, in the colours of a",
        )
        return figure


def _style(label: str, colour: str, marker: str, *, is_open: bool = False) -> dict[str, Any]:
    """Look of small points with thin bars; open ones are larger and lie below the others."""
    return {
        "label": label,
        "linestyle": "none",
        "marker": marker,
        "color": colour,
        "markerfacecolor": "none" if is_open else colour,
        "markeredgecolor": colour if is_open else "white",
        "markeredgewidth": 0.6 if is_open else 0.25,
        "markersize": 5.0 if is_open else 3.8,
        "elinewidth": 0.4,
        "capsize": 0,
        "zorder": 2.5 if is_open else 3,
    }


def _draw_collapse(axes: Axes, drawn: Sequence[tuple[LawPoints, dict[str, Any]]]) -> None:
    """Draw k freed of its fall with s against the effective size, and the law, then one curve."""
    law = shipped_law()
    k_0, *_, m_4, m_5, _, _, m_8, _ = law.coefficients
    sizes = {
        points.name: effective_size(law.coefficients, points.disorder, points.size, points.breadth)
        for points, _ in drawn
    }
    largest = max(float(np.max(size)) for size in sizes.values())
    lowest, highest = LEAST_SIZE / 4, 2 * largest
    line: dict[str, Any] = {"color": BLACK, "linewidth": 1.0, "zorder": 2}
    label = f"law (rms departure {100 * law.rms:.2g}% for $g>1$)"
    fitted, below = np.geomspace(LEAST_SIZE, highest, 200), np.geomspace(lowest, LEAST_SIZE, 50)
    axes.plot(fitted, law_value(law.coefficients, 0.0, fitted), **line, label=label)
    axes.plot(below, law_value(law.coefficients, 0.0, below), **line, dashes=(3, 1.5))
    for points, style in drawn:
        rise = 1 + m_4 * points.disorder**m_5 * (TYPICAL_BREADTH / points.breadth) ** m_8
        axes.errorbar(
            sizes[points.name],
            points.factor * rise,
            yerr=REACH * points.error * rise,
            **style,
        )
    axes.axhline(k_0, color="0.5", linewidth=0.5, zorder=1)
    name = rf"$k_0={k_0:.2f}$, weak disorder in the infinite contact"
    write_beside(axes, name, (1.1 * lowest, k_0), (0, 2), fontsize=6)
    axes.set_xscale("log")
    axes.set_xlim(lowest, highest)
    axes.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
    label_decimals(axes.xaxis)
    axes.set_xlabel(r"effective size $g_\mathrm{eff}$")
    axes.set_ylabel("$k$, freed of its fall with disorder")


def _draw_extrapolated(axes: Axes, points: LawPoints, style: dict[str, Any]) -> None:
    """Draw points of large g, times what the law gains from there to the infinite contact."""
    large = points.size > _LARGE
    disorder, factor = points.disorder[large], points.factor[large]
    gain = infinite_ratio(np.maximum(disorder, WEAKEST), points.size[large], points.breadth[large])
    error = np.hypot(gain.value * points.error[large], gain.standard_error * factor)
    unnamed = style | {"label": None}
    axes.errorbar(disorder, factor * gain.value, yerr=REACH * error, **unnamed)
