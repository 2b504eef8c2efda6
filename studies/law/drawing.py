"""The figure of the law of k: the collapse of all measured k, and their limit of infinite size."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crackfront.analysis.estimate import REACH
from crackfront.analysis.finding import PERTURBATION_FACTOR
from crackfront.analysis.law import (
    LEAST_SIZE,
    TYPICAL_BREADTH,
    WEAKEST,
    Law,
    infinite_ratio,
    law_value,
    shipped_law,
)
from crackfront.plots.parts import label_decimals
from crackfront.plots.style import BLACK, COLOURS, MARKERS, PAGE, blank_figure, explain, house_style
from crackfront.plots.sweep import draw_infinite_law
from studies.law.cells import LawCell

Array = NDArray[np.float64]

_LARGE = 3.0
"""Sizes g above which points are shown extrapolated: their gain is small, and its error smaller."""


@dataclass(frozen=True, slots=True)
class LawPoints:
    """Measured k of one kind of front, arrays of one shape.

    Attributes
    ----------
    name : str
        What the legend calls them.
    disorder, size : (n,) array
        s and g.
    factor, error : (n,) array
        k and its standard error.
    breadth : (n,) array
        That of the spectra, as :func:`crackfront.analysis.law.slope_breadth`.
    """

    name: str
    disorder: Array
    size: Array
    factor: Array
    error: Array
    breadth: Array


def spectra_points(cells: Sequence[LawCell]) -> tuple[LawPoints, ...]:
    """Straight fronts of `law.csv`, one entry a spectrum."""
    found = []
    for name in dict.fromkeys(cell.spectrum for cell in cells):
        rows = [cell for cell in cells if cell.spectrum == name]
        columns = (
            np.array([getattr(cell, item) for cell in rows])
            for item in ("disorder", "size", "both", "error", "breadth")
        )
        found.append(LawPoints(_front_label(name), *columns))
    return tuple(found)


def _front_label(name: str) -> str:
    """Name of a spectrum, its Hurst exponent in figures: h08-chemical is H = 0.8, chemical."""
    return ", ".join(re.sub(r"^h(\d)(\d)", r"$H=\1.\2$", name).split("-"))


def law_figure(fronts: Sequence[LawPoints], spheres: LawPoints) -> Figure:
    """Collapse of straight fronts and spheres on the shipped law, and its infinite contact.

    Parameters
    ----------
    fronts : sequence of LawPoints
        Straight fronts, an entry a spectrum.
    spheres : LawPoints
        Spheres, to which nothing is adjusted.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.49 * PAGE)
        left, right = figure.subplots(1, 2, width_ratios=(1.2, 1))
        draw_collapse(left, fronts, spheres)
        draw_infinite_law(right)
        for index, points in enumerate(fronts):
            _draw_extrapolated(right, points, *_style(index))
        _draw_extrapolated(right, spheres, BLACK, "o", face="none")
        right.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
        right.legend(loc="lower left")
        for axes, letter in ((left, "a"), (right, "b")):
            axes.set_title(letter, loc="left", fontweight="bold")
        explain(
            figure,
            "bars: 95% intervals over surfaces; spheres, to which nothing was adjusted, are open "
            "circles; a: freed of what depends on s, with the law at s = 0; b: points of g above "
            f"{_LARGE:g}, which the law extrapolates, in the colours of a",
        )
        return figure


def _style(index: int) -> tuple[str, str]:
    """Colour and marker of a spectrum."""
    return COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)]


def draw_collapse(axes: Axes, fronts: Sequence[LawPoints], spheres: LawPoints) -> None:
    """Draw k freed of its fall with s against g / (1 + c s^d), and the law, then one curve."""
    law = shipped_law()
    highest = max(float(np.max(_collapsed(law, one)[0])) for one in (*fronts, spheres))
    abscissa = np.geomspace(LEAST_SIZE / 4, 2 * highest, 200)
    axes.plot(
        abscissa,
        law_value(law.coefficients, 0.0, abscissa),
        color=BLACK,
        linewidth=1.0,
        label=f"law (rms departure {100 * law.rms:.2g}% for $g>1$)",
        zorder=2,
    )
    for index, points in enumerate(fronts):
        _draw_points(axes, *_collapsed(law, points), points.name, *_style(index))
    _draw_points(axes, *_collapsed(law, spheres), spheres.name, BLACK, "o", face="none")
    k_0 = law.coefficients[0]
    axes.axhline(k_0, color="0.5", linewidth=0.5, zorder=1)
    axes.annotate(
        rf"$k_0={k_0:.2f}$, weak disorder in the infinite contact",
        (abscissa[0] * 1.1, k_0),
        xytext=(0, 2),
        textcoords="offset points",
        fontsize=6,
    )
    axes.set_xscale("log")
    axes.set_xlim(abscissa[0], abscissa[-1])
    axes.set_ylim(0.0, 1.12 * PERTURBATION_FACTOR)
    label_decimals(axes)
    axes.set_xlabel(r"size $g\,/\,(1+c\,s^d)$")
    axes.set_ylabel(r"$k\,(1+a\,s^b\,(\beta_0/\beta)^e)$")
    axes.legend(loc="lower right")


def _collapsed(law: Law, points: LawPoints) -> tuple[Array, Array, Array]:
    """Size, k and half of its interval, freed of the dependence on disorder."""
    a, b, c, d, e = law.coefficients[4:]
    rise = 1 + a * points.disorder**b * (TYPICAL_BREADTH / points.breadth) ** e
    return (
        points.size / (1 + c * points.disorder**d),
        points.factor * rise,
        REACH * points.error * rise,
    )


def _draw_extrapolated(
    axes: Axes, points: LawPoints, colour: str, marker: str, face: str = ""
) -> None:
    """Points of large g, times what the law gains from there to the infinite contact."""
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
    _draw_points(
        axes, points.disorder[large], points.factor[large] * gain, reach, "", colour, marker, face
    )


def _draw_points(
    axes: Axes,
    abscissa: Array,
    ordinate: Array,
    reach: Array,
    name: str,
    colour: str,
    marker: str,
    face: str = "",
) -> None:
    """Small points with thin bars."""
    axes.errorbar(
        abscissa,
        ordinate,
        yerr=reach,
        linestyle="none",
        marker=marker,
        color=colour,
        markerfacecolor=face or colour,
        markeredgecolor=colour if face else "white",
        markeredgewidth=0.6 if face else 0.25,
        markersize=3.6 if face else 2.8,
        elinewidth=0.4,
        capsize=0,
        label=name or None,
        zorder=4 if face else 3,
    )
