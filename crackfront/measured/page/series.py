"""A figure of a series of samples: predicted and measured numbers with their intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from crackfront.analysis.estimate import Estimate
from crackfront.plots.parts import PointStyle, spectrum_colour, spectrum_marker
from crackfront.plots.style import BLACK, PAGE, blank_figure, explain, house_style

PREDICTED = {
    "hysteresis": (r"hysteresis (mJ m$^{-2}$)", 1e3),
    "w_appr": (r"$w_\mathrm{appr}$ (mJ m$^{-2}$)", 1e3),
    "w_retr": (r"$w_\mathrm{retr}$ (mJ m$^{-2}$)", 1e3),
    "e_el": (r"$e_\mathrm{el}$ (mJ m$^{-2}$)", 1e3),
    "pull_off_force": ("pull-off force (µN)", 1e6),
}
"""Numbers that a series may show: label of the axis, and factor from SI units."""

_BOUNDS = {"hysteresis": "↑", "e_el": "↑", "w_appr": "↓"}
"""Direction in which a number changes if missing short waves add to e_el; others can do both."""

_SHIFT = 0.14
"""Half of the distance of measured from predicted points. (Units: distance of samples)"""

_MOST_NAMED = 60
"""Largest number of samples with names on the axis."""


@dataclass(frozen=True, slots=True)
class SeriesPoint:
    """A sample in a figure."""

    name: str
    group: str
    predicted: Estimate[float]
    measured: Estimate[float]
    """NaN without such a number. (Units: SI)"""
    is_lower_bound: bool
    """Whether e_el is a lower bound."""


def series_figure(points: Sequence[SeriesPoint], name: str) -> Figure:
    """One number of every sample; groups have a marker and colour, measured points are open."""
    label, factor = PREDICTED[name]
    groups = list(dict.fromkeys(point.group for point in points))
    with house_style():
        figure = blank_figure(min(PAGE, 1.6 + 0.35 * len(points)), 0.42 * PAGE)
        axes = figure.subplots()
        for sample, point in enumerate(points):
            style = _group_style(groups.index(point.group))
            _draw(axes, sample - _SHIFT, point.predicted, factor, style, filled=True)
            _draw(axes, sample + _SHIFT, point.measured, factor, style, filled=False)
            if point.is_lower_bound:
                _draw_bound(axes, sample - _SHIFT, point.predicted, factor, name)
            if not math.isfinite(point.predicted.value):
                axes.annotate(
                    "none",
                    (sample - _SHIFT, 0.02),
                    xycoords=("data", "axes fraction"),
                    ha="center",
                    va="bottom",
                    rotation=90,
                    fontsize=6,
                )
        axes.set_ylabel(label)
        axes.margins(y=0.12)
        axes.set_xlim(-0.6, len(points) - 0.4)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        labelled = points if len(points) <= _MOST_NAMED else ()
        names = [point.name for point in labelled]
        axes.set_xticks(range(len(labelled)), names, rotation=45, ha="right")
        axes.tick_params(axis="x", top=False, length=0)
        _add_legend(axes, groups, any(math.isfinite(point.measured.value) for point in points))
        explain(figure, _explanation(points, _BOUNDS.get(name, "")))
        return figure


def _group_style(group: int) -> PointStyle:
    """Colour and marker of a group, by its number."""
    return PointStyle(spectrum_colour(group), spectrum_marker(group), "")


def _draw(
    axes: Axes,
    abscissa: float,
    number: Estimate[float],
    factor: float,
    style: PointStyle,
    *,
    filled: bool,
) -> None:
    """Draw a number, unless it is NaN, and its interval if it has one."""
    if not math.isfinite(number.value):
        return
    interval = None
    if math.isfinite(number.low):
        below, above = number.value - number.low, number.high - number.value
        interval = [[factor * max(below, 0.0)], [factor * max(above, 0.0)]]
    axes.errorbar(
        [abscissa],
        [factor * number.value],
        interval,
        color=style.colour,
        marker=style.marker,
        markerfacecolor=style.colour if filled else "white",
        linewidth=0.8,
        linestyle="none",
        zorder=3,
    )


def _draw_bound(
    axes: Axes, abscissa: float, number: Estimate[float], factor: float, name: str
) -> None:
    """Draw an arrow at the end of an interval in the direction of the true number."""
    arrow = _BOUNDS.get(name, "")
    end, side = (number.low, "top") if arrow == "↓" else (number.high, "bottom")
    if arrow and math.isfinite(end):
        axes.annotate(arrow, (abscissa, end * factor), ha="center", va=side)


def _add_legend(axes: Axes, groups: Sequence[str], is_measured: bool) -> None:
    """Legend of the groups, and of filled and open points if there are measured ones."""
    entries = []
    for number, group in enumerate(groups):
        style = _group_style(number)
        if group:
            entries.append(_legend_entry(style.colour, style.marker, style.colour, group))
    if is_measured:
        entries.append(_legend_entry(BLACK, "o", BLACK, "predicted"))
        entries.append(_legend_entry(BLACK, "o", "white", "measured"))
    if entries:
        axes.legend(handles=entries, loc="best")


def _legend_entry(colour: str, marker: str, face: str, label: str) -> Line2D:
    """A marker for a legend."""
    return Line2D(
        [], [], color=colour, marker=marker, markerfacecolor=face, linestyle="none", label=label
    )


def _explanation(points: Sequence[SeriesPoint], arrow: str) -> str:
    """Explanation of bars, arrows and words in the figure."""
    sentences = ["Bars: 95% intervals of predictions, two standard errors of measurements."]
    if arrow and any(point.is_lower_bound for point in points):
        word = "at least" if arrow == "↑" else "at most"
        sentences.append(f"Arrows: {word}, as waves shorter than the points are left out.")
    if any(not math.isfinite(point.predicted.value) for point in points):
        sentences.append("none: no prediction; the table says why.")
    return " ".join(sentences)
