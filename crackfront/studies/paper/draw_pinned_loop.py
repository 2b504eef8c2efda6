"""Main Fig. 3c, d: the smooth loop between its JKR curves, and the fronts on the field."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.plots.loop import draw_loop
from crackfront.plots.parts import ADHESION_LABEL, LATERAL_UNIT, field_colours
from crackfront.plots.style import BLACK, BLUE, PAGE, VERMILION, blank_figure, house_style
from crackfront.studies.paper.pinned_loop import PinnedLoop


def pinned_loop_figure(loop: PinnedLoop) -> Figure:
    """The loop beside the fronts of both branches at b = 0.

    Parameters
    ----------
    loop : PinnedLoop
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(PAGE, 0.46 * PAGE)
        left, right = figure.subplots(1, 2, width_ratios=[1, 1])
        works, window = (loop.approach, loop.retraction), (loop.lowest_radius, loop.highest_radius)
        draw_loop(left, loop, works, window, elastic_energy=loop.elastic_energy)
        _draw_fronts(right, loop)
        for axes, letter in ((left, "c"), (right, "d")):
            axes.set_title(letter, loc="left", fontweight="bold")
        return figure


def _draw_fronts(axes: Axes, loop: PinnedLoop) -> None:
    """The part of the fronts that crosses the patch of the field."""
    mean, reach = 1 - loop.elastic_energy, 4 * np.sqrt(loop.elastic_energy)
    image = axes.imshow(
        loop.patch.T,
        origin="lower",
        extent=(loop.x[0], loop.x[-1], loop.y[0], loop.y[-1]),
        cmap=field_colours(),
        vmin=mean - reach,
        vmax=mean + reach,
        interpolation="antialiased",
    )
    bar = axes.figure.colorbar(image, ax=axes, extend="both", pad=0.02)
    bar.set_label(rf"local {ADHESION_LABEL}")
    # From -pi to pi, so that the part about the first ray is one line.
    half = loop.angle.size // 2
    angle = np.roll(np.where(loop.angle < np.pi, loop.angle, loop.angle - 2 * np.pi), half)
    for line, colour, style, label in (
        (0, BLUE, "-", "approach"),
        (1, VERMILION, "-", "retraction"),
        (2, BLACK, (0, (4, 2)), "rigid circle"),
    ):
        radius = np.roll(loop.front[line], half)
        near = np.abs(angle) < 2 * loop.y[-1] / loop.x[0]
        axes.plot(
            (radius * np.cos(angle))[near],
            (radius * np.sin(angle))[near],
            color=colour,
            linestyle=style,
            linewidth=1.0,
            label=label,
        )
    axes.set_xlim(loop.x[0], loop.x[-1])
    axes.set_ylim(loop.y[0], loop.y[-1])
    axes.set_xlabel(rf"$x$ / {LATERAL_UNIT}")
    axes.set_ylabel(rf"$y$ / {LATERAL_UNIT}")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, columnspacing=1.2)
