"""A figure of a series of samples: predicted numbers with their intervals, beside measured ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from crackfront.analysis.estimate import Estimate
from crackfront.plots.style import BLACK, COLOURS, MARKERS, PAGE, blank_figure, explain, house_style

PREDICTED = {
    "hysteresis": (r"hysteresis (mJ m$^{-2}$)", 1e3),
    "w_appr": (r"$w_\mathrm{appr}$ (mJ m$^{-2}$)", 1e3),
    "w_retr": (r"$w_\mathrm{retr}$ (mJ m$^{-2}$)", 1e3),
    "e_el": (r"$e_\mathrm{el}$ (mJ m$^{-2}$)", 1e3),
    "pull_off_force": ("pull-off force (µN)", 1e6),
}
"""Numbers that a series may show: label of the axis, and factor from SI units to it."""

_BOUNDS = {"hysteresis": "↑", "e_el": "↑", "w_appr": "↓"}
"""Where the true number lies if shorter waves than the points add to e_el; elsewhere k, which
falls, decides."""

_ASIDE = 0.14
"""Distance of measured points from predicted ones, in samples."""

_MOST_NAMED = 60
"""Samples with their names on the axis."""


@dataclass(frozen=True, slots=True)
class SeriesPoint:
    """A sample in a figure."""

    name: str
    group: str
    predicted: Estimate[float]
    measured: Estimate[float]
    """NaN where there is none. (Units: SI)"""
    is_lower_bound: bool
    """Whether e_el is a least one."""


def series_figure(points: Sequence[SeriesPoint], name: str) -> Figure:
    """One number of every sample; groups have a marker and colour, and measured ones are open."""
    label, factor = PREDICTED[name]
    groups = list(dict.fromkeys(one.group for one in points))
    with house_style():
        figure = blank_figure(min(PAGE, 1.6 + 0.35 * len(points)), 0.42 * PAGE)
        axes = figure.subplots()
        for place, one in enumerate(points):
            colour, marker = _look(groups.index(one.group))
            _draw(axes, place - _ASIDE, one.predicted, factor, colour, marker, filled=True)
            _draw(axes, place + _ASIDE, one.measured, factor, colour, marker, filled=False)
            arrow = _BOUNDS.get(name, "") if one.is_lower_bound else ""
            end, side = one.predicted.high, "bottom"
            if arrow == "↓":
                end, side = one.predicted.low, "top"
            if arrow and math.isfinite(end):
                axes.annotate(arrow, (place - _ASIDE, end * factor), ha="center", va=side)
            if not math.isfinite(one.predicted.value):
                axes.annotate(
                    "none",
                    (place - _ASIDE, 0.02),
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
        named = points if len(points) <= _MOST_NAMED else ()
        axes.set_xticks(range(len(named)), [one.name for one in named], rotation=45, ha="right")
        axes.tick_params(axis="x", top=False, length=0)
        _add_legend(axes, groups, any(math.isfinite(one.measured.value) for one in points))
        explain(figure, _sentences(points, _BOUNDS.get(name, "")))
        return figure


def _look(group: int) -> tuple[str, str]:
    """Colour and marker of a group, by its number."""
    return COLOURS[group % len(COLOURS)], MARKERS[group % len(MARKERS)]


def _draw(
    axes: Axes,
    place: float,
    found: Estimate[float],
    factor: float,
    colour: str,
    marker: str,
    *,
    filled: bool,
) -> None:
    """A number with its interval, if it has one."""
    if not math.isfinite(found.value):
        return
    ends = None
    if math.isfinite(found.low):
        pair = found.value - found.low, found.high - found.value
        ends = [[factor * max(one, 0.0)] for one in pair]
    axes.errorbar(
        [place],
        [factor * found.value],
        ends,
        color=colour,
        marker=marker,
        markerfacecolor=colour if filled else "white",
        linewidth=0.8,
        linestyle="none",
        zorder=3,
    )


def _add_legend(axes: Axes, groups: Sequence[str], is_measured: bool) -> None:
    """Groups by marker, and filled beside open points where any are measured."""
    entries = [
        Line2D([], [], color=colour, marker=marker, linestyle="none", label=group)
        for group, (colour, marker) in zip(groups, map(_look, range(len(groups))), strict=True)
        if group
    ]
    if is_measured:
        entries += [
            Line2D([], [], color=BLACK, marker="o", linestyle="none", label="predicted"),
            Line2D(
                [],
                [],
                color=BLACK,
                marker="o",
                markerfacecolor="white",
                linestyle="none",
                label="measured",
            ),
        ]
    if entries:
        axes.legend(handles=entries, loc="best")


def _sentences(points: Sequence[SeriesPoint], arrow: str) -> str:
    """What bars, arrows and words in the figure mean."""
    found = ["Bars: 95% intervals of predictions, two standard errors of measurements."]
    if arrow and any(one.is_lower_bound for one in points):
        word = "at least" if arrow == "↑" else "at most"
        found.append(f"Arrows: {word}, as waves shorter than the points are left out.")
    if any(not math.isfinite(one.predicted.value) for one in points):
        found.append("none: no prediction; the table says why.")
    return " ".join(found)
