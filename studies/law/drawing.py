"""The figure of the law of k: the collapse of all measured k, and their limit of infinite size."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.analysis.estimate import REACH
from crackfront.analysis.finding import PERTURBATION_FACTOR
from crackfront.analysis.law import (
    LEAST_SIZE,
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
    VERMILION,
    blank_figure,
    house_style,
)
from crackfront.plots.sweep_figures import draw_infinite_law
from studies.law.cells import LawCell
from studies.paper.drawing import name_panels

_LARGE = 3.0
"""Size g above which points are extrapolated: their gain is small, and its error smaller."""

_SPHERES = "spheres, not fitted"
"""Name of the spheres in the legend."""

_FAMILIES = {
    "flat": ("flat", "flat-chemical"),
    "Gaussian": ("gaussian", "gaussian-chemical"),
    "$H=0.3$ to $0.8$": ("h03", "h05", "h08"),
    "two slopes": ("two-slopes", "two-reversed"),
    "ring": ("ring",),
    _SPHERES: (_SPHERES,),
}
"""Spectra that share a colour and a marker, by their name in the legend."""

_LOOKS = ((GREEN, "s"), (PURPLE, "^"), (BLUE, "o"), (ORANGE, "X"), (VERMILION, "p"), ("0.2", "o"))
"""Colour and marker of every family."""


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
    drawn = [
        (points, _style(name, colour, marker, is_open=name == _SPHERES))
        for (name, members), (colour, marker) in zip(_FAMILIES.items(), _LOOKS, strict=True)
        for points in (*fronts, replace(spheres, name=_SPHERES))
        if points.name in members
    ]
    with house_style():
        figure = blank_figure(PAGE, 0.52 * PAGE)
        collapse, infinite = figure.subplots(1, 2, width_ratios=(1.15, 1))
        _draw_collapse(collapse, drawn)
        draw_infinite_law(infinite)
        for points, style in drawn:
            _draw_extrapolated(infinite, points, style)
        infinite.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
        infinite.legend(loc="lower left")
        entries = dict(zip(*reversed(collapse.get_legend_handles_labels()), strict=True))
        collapse.legend(list(entries.values()), list(entries), loc="lower right")
        name_panels((collapse, infinite), "ab")
        return figure


def _style(label: str, colour: str, marker: str, *, is_open: bool) -> dict[str, Any]:
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
    """Draw k over its value in the infinite contact against the effective size, and the law."""
    law = shipped_law()
    sizes = [
        effective_size(law.coefficients, points.disorder, points.size, points.breadth)
        for points, _ in drawn
    ]
    lowest, highest = LEAST_SIZE / 4, 2 * max(float(np.max(size)) for size in sizes)
    line: dict[str, Any] = {"color": BLACK, "linewidth": 1.0, "zorder": 4}
    fitted, below = np.geomspace(LEAST_SIZE, highest, 200), np.geomspace(lowest, LEAST_SIZE, 50)
    limit = law_value(law.coefficients, 0.0, math.inf)
    axes.plot(fitted, law_value(law.coefficients, 0.0, fitted) / limit, **line, label="law")
    axes.plot(below, law_value(law.coefficients, 0.0, below) / limit, **line, dashes=(3, 1.5))
    for (points, style), size in zip(drawn, sizes, strict=True):
        infinite = law_value(law.coefficients, points.disorder, math.inf, points.breadth)
        axes.errorbar(size, points.factor / infinite, yerr=REACH * points.error / infinite, **style)
    axes.axhline(1.0, color="0.5", linewidth=0.5, zorder=1)
    axes.set(xscale="log", xlim=(lowest, highest), ylim=(0.0, 1.12))
    label_decimals(axes.xaxis)
    axes.set_xlabel(r"effective size $g_\mathrm{eff}$")
    axes.set_ylabel(r"$k$ / its limit in the infinite contact")


def _draw_extrapolated(axes: Axes, points: LawPoints, style: dict[str, Any]) -> None:
    """Draw points of large g, times what the law gains from there to the infinite contact."""
    large = points.size > _LARGE
    disorder, factor = points.disorder[large], points.factor[large]
    gain = infinite_ratio(np.maximum(disorder, WEAKEST), points.size[large], points.breadth[large])
    error = np.hypot(gain.value * points.error[large], gain.standard_error * factor)
    unnamed = style | {"label": None}
    axes.errorbar(disorder, factor * gain.value, yerr=REACH * error, **unnamed)
