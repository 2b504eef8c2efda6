"""Main Fig. 4: maps of heights and of the work of adhesion, and profiles of a peak and a valley."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from crackfront.plots.parts import HEIGHT_LABEL, LENGTH_LABEL, label_panel
from crackfront.plots.style import BLUE, PAGE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.mapping import Mapping

Array = NDArray[np.float64]

_ADHESION = r"$w_\mathrm{loc}/w_\mathrm{int}$"
_PLACES = (("peak", "^", VERMILION), ("valley", "v", BLUE))


def mapping_figure(record: Mapping) -> Figure:
    """Heights and work of adhesion on a patch, and profiles across a peak and a valley.

    Parameters
    ----------
    record : Mapping
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.79 * PAGE)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.45, 1))
        maps = [figure.add_subplot(grid[0, column]) for column in (0, 1)]
        _draw_map(maps[0], record, record.heights, "cividis", HEIGHT_LABEL.format("height $h$"))
        _draw_map(maps[1], record, record.adhesion, "viridis", _ADHESION)
        for axes, name in zip(maps, "ab", strict=True):
            label_panel(axes, name)
            axes.set_title("front along $y$, contact at smaller $x$", fontsize=7)
        for column, (place, _, colour) in enumerate(_PLACES):
            parts = grid[1, column].subgridspec(2, 1, hspace=0.0)
            upper = figure.add_subplot(parts[0])
            lower = figure.add_subplot(parts[1], sharex=upper)
            _draw_profile(upper, lower, record, place, colour)
            label_panel(upper, "cd"[column])
        return figure


def _draw_map(axes: Axes, record: Mapping, values: Array, colours: str, label: str) -> None:
    """Map with the places of the two profiles."""
    side = float(record.position[-1])
    image = axes.imshow(
        values.T,
        extent=(0, side, 0, side),
        origin="lower",
        cmap=colours,
        interpolation="bilinear",
    )
    reach = _reach(record)
    for place, marker, _ in _PLACES:
        x, y = record.position[getattr(record, place)]
        axes.plot([x - reach, x + reach], [y, y], color="white", linewidth=0.8)
        axes.plot(x, y, marker, color="white", markeredgecolor="black", markersize=5)
        axes.annotate(
            place,
            (x, y),
            xytext=(0, 6),
            textcoords="offset points",
            ha="center",
            color="black",
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "linewidth": 0, "alpha": 0.8},
        )
    axes.figure.colorbar(image, cax=axes.inset_axes((1.03, 0.0, 0.04, 1.0)), label=label)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(4))
    axes.set_xlabel(LENGTH_LABEL.format("$x$"))
    axes.set_ylabel(LENGTH_LABEL.format("$y$"))


def _draw_profile(upper: Axes, lower: Axes, record: Mapping, place: str, colour: str) -> None:
    """Heights and work of adhesion along x through a peak or a valley."""
    index = getattr(record, place)
    distance = record.position - record.position[index[0]]
    heights, adhesion = record.heights[:, index[1]], record.adhesion[:, index[1]]
    upper.fill_between(distance, heights, heights.min() - 1, color="0.88", linewidth=0)
    upper.plot(distance, heights, color="0.2")
    lower.plot(distance, adhesion, color=colour)
    lower.axhline(1.0, color="0.6", linewidth=0.4, zorder=1)
    lower.axhline(record.mean, color="0.2", linewidth=0.6, dashes=(4, 2), zorder=1)
    for axes in (upper, lower):
        axes.axvline(0.0, color=colour, linewidth=0.6, dashes=(1.5, 1.5), zorder=1)
    reach = _reach(record)
    upper.set_xlim(-reach, reach)
    for axes, every, room in ((upper, record.heights, 0.1), (lower, record.adhesion, 0.05)):
        low, high = float(every.min()), float(every.max())
        axes.set_ylim(low - room * (high - low), high + room * (high - low))
    lower.annotate(
        r"$w_\mathrm{int}-e_\mathrm{el}$",
        (reach, record.mean),
        xytext=(3, 0),
        textcoords="offset points",
        va="center",
        annotation_clip=False,
    )
    lower.xaxis.set_major_locator(MaxNLocator(5))
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(HEIGHT_LABEL.format("$h$").replace(" / ", " /\n"), fontsize=6.5)
    lower.set_ylabel(_ADHESION)
    lower.set_xlabel(LENGTH_LABEL.format(f"distance from the {place} along $x$"))


def _reach(record: Mapping) -> float:
    """Half the length of a profile (Units: reduced lateral length)."""
    return float(record.position[-1]) / 5
