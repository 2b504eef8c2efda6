"""Main Fig. 1d: force against radius of a smooth sphere with two works of adhesion."""

from __future__ import annotations

from matplotlib.figure import Figure

from crackfront.figures import SmoothLoop
from crackfront.plots.parts import FORCE_LABEL, RADIUS_LABEL, draw_arrow
from crackfront.plots.style import BLUE, COLUMN, VERMILION, blank_figure, house_style


def smooth_loop_figure(loop: SmoothLoop) -> Figure:
    """Both branches, with arrows in the direction of motion.

    Parameters
    ----------
    loop : SmoothLoop
        Data of the figure.
    """
    with house_style():
        figure = blank_figure(COLUMN, 0.75 * COLUMN)
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
        axes.axhline(0.0, color="0.6", linewidth=0.4, zorder=1)
        axes.set_xlabel(RADIUS_LABEL)
        axes.set_ylabel(FORCE_LABEL)
        axes.legend(loc="upper left")
        return figure
