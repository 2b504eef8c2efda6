"""Main Fig. 1d: force against radius of a smooth sphere with two works of adhesion."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crackfront.plots.parts import FORCE_LABEL, RADIUS_LABEL, draw_arrow
from crackfront.plots.style import BLUE, COLUMN, VERMILION, blank_figure, house_style
from crackfront.studies.paper.smooth import SmoothLoop

_LEFT = -0.1
"""Where the abscissa begins (Units: reduced lateral length)."""


def smooth_loop_figure(loop: SmoothLoop) -> Figure:
    """Both branches, with arrows in the direction of motion.

    Parameters
    ----------
    loop : SmoothLoop
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(COLUMN, 0.8 * COLUMN)
        axes = figure.add_subplot()
        for direction, colour, name, short, adhesion in (
            (1, BLUE, "approach", "appr", loop.approach),
            (-1, VERMILION, "retraction", "retr", loop.retraction),
        ):
            branch = loop.direction == direction
            radius, force = loop.radius[branch], loop.force[branch]
            label = rf"{name}, $w_\mathrm{{{short}}} = {adhesion:g}\,w_\mathrm{{int}}$"
            axes.plot(radius, force, color=colour, label=label)
            middle = radius.size // 2
            draw_arrow(
                axes, radius[middle - 1 : middle + 1], force[middle - 1 : middle + 1], colour
            )
            end = 0 if direction > 0 else -1
            _draw_jump(axes, direction, float(radius[end]), float(force[end]), colour)
        axes.axhline(0.0, color="0.6", linewidth=0.4, zorder=1)
        _draw_pull_off(axes, loop)
        axes.set_xlim(left=_LEFT)
        axes.set_ylim(bottom=1.12 * float(np.min(loop.force)))
        axes.set_xlabel(RADIUS_LABEL)
        axes.set_ylabel(FORCE_LABEL)
        axes.legend(loc="upper left")
        return figure


def _draw_jump(axes: Axes, direction: int, radius: float, force: float, colour: str) -> None:
    """Thin dashed arrow between no contact and the first or last state."""
    ends = ((0.0, 0.0), (radius, force))
    start, end = ends[::direction]
    axes.annotate(
        "",
        xy=end,
        xytext=start,
        arrowprops={
            "arrowstyle": "-|>",
            "color": colour,
            "linewidth": 0.7,
            "linestyle": (0, (4, 2)),
            "mutation_scale": 6,
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )
    axes.annotate(
        "jump into contact" if direction > 0 else "jump out\nof contact",
        (radius / 2, force / 2),
        xytext=(4 * direction, 4 * direction),
        textcoords="offset points",
        ha="left" if direction > 0 else "right",
        va="bottom" if direction > 0 else "top",
        color=colour,
    )


def _draw_pull_off(axes: Axes, loop: SmoothLoop) -> None:
    """Lowest force of all states, the pull-off force where the force is controlled."""
    lowest = int(np.argmin(loop.force))
    radius, force = loop.radius[lowest], loop.force[lowest]
    axes.plot([_LEFT, radius], [force, force], color="0.3", linewidth=0.6, dashes=(1.5, 1.5))
    axes.plot(radius, force, "o", color=VERMILION, markersize=3.6, zorder=5)
    axes.annotate(
        r"pull-off force, $-\frac{3}{2}\,\pi w_\mathrm{retr}R$",
        (0.0, force),
        xytext=(0, 2),
        textcoords="offset points",
    )
