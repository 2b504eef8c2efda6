"""Fronts over the field that pins them, and surfaces."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from crackfront.plots.parts import ADHESION_LABEL, HEIGHT_LABEL, LATERAL_UNIT, field_colours
from crackfront.plots.style import BLUE, VERMILION

Array = NDArray[np.float64]

_MOST_GREYS = 10
"""Shades of the field; few, so that frames of an animation compress well."""

_MARGIN = 1.15
"""How far the axes reach, over the largest radius."""


def draw_field(
    axes: Axes, x: Array, y: Array, adhesion: NDArray[np.floating], mean: float, reach: float
) -> None:
    """Work of adhesion in a few shades, mean - reach to mean + reach, with a colour bar.

    Parameters
    ----------
    x, y : (n_x,), (n_y,) arrays
        Abscissae and ordinates. (Units: reduced lateral length)
    adhesion : (n_x, n_y) array
        Work of adhesion. (Units: w_int)
    mean, reach : float
        Middle of the shades, and how far they go to either side. (Units: w_int)
    """
    levels = MaxNLocator(_MOST_GREYS).tick_values(mean - reach, mean + reach)
    shades = ScalarMappable(BoundaryNorm(levels, field_colours().N), field_colours())
    # Coloured once, not once a frame.
    axes.imshow(
        shades.to_rgba(adhesion.T, bytes=True),
        origin="lower",
        extent=(x[0], x[-1], y[0], y[-1]),
        interpolation="nearest",
    )
    bar = axes.figure.colorbar(shades, ax=axes, pad=0.02, format="{x:.1f}", extend="both")
    bar.set_label(rf"local {ADHESION_LABEL}")
    label_plane(axes)


def draw_heights(axes: Axes, x: Array, y: Array, heights: Array) -> None:
    """Heights in colours, peaks bright, with a colour bar; arrays as of :func:`draw_field`."""
    image = axes.imshow(
        heights.T,
        origin="lower",
        extent=(x[0], x[-1], y[0], y[-1]),
        interpolation="nearest",
        cmap="cividis",
    )
    bar = axes.figure.colorbar(image, ax=axes, pad=0.02)
    bar.set_label(HEIGHT_LABEL.format("height"))
    label_plane(axes)


def draw_fronts(
    axes: Axes, angle: Array, radius: Array, direction: NDArray[np.int64], most: int = 24
) -> None:
    """Fronts of both branches as closed curves, at most so many of a branch, its last among them.

    Parameters
    ----------
    angle : (n_angle,) array
        Angles of the sites. (Units: rad)
    radius : (n_step, n_angle) array
        The fronts. (Units: reduced lateral length)
    direction : (n_step,) int array
        +1 in approach, -1 in retraction.
    """
    for sign, colour, label in ((1, BLUE, "approach"), (-1, VERMILION, "retraction")):
        branch = radius[direction == sign]
        every = -(-len(branch) // most) or 1
        for count, front in enumerate(branch[::-1][::every]):
            name = label if count == 0 else None
            axes.plot(*closed_front(angle, front), color=colour, linewidth=0.7, label=name)
    frame_plane(axes, _MARGIN * float(np.max(radius)))
    axes.legend(loc="upper left", frameon=True, facecolor="white", framealpha=1, edgecolor="none")


def frame_plane(axes: Axes, reach: float) -> None:
    """A square of the plane around the apex, with its names and units."""
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    label_plane(axes)


def label_plane(axes: Axes) -> None:
    """Names and units of both lateral axes."""
    axes.set_xlabel(rf"$x$ / {LATERAL_UNIT}")
    axes.set_ylabel(rf"$y$ / {LATERAL_UNIT}")


def closed_front(angle: Array, radius: Array) -> tuple[Array, Array]:
    """Abscissae and ordinates of a front, the first point repeated at the end."""
    around, out = np.append(angle, angle[0]), np.append(radius, radius[0])
    return out * np.cos(around), out * np.sin(around)
